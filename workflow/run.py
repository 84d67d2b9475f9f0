"""Run one job of the study: ``python workflow/run.py REQUEST FILES``, as every rule does.

``REQUEST`` is a JSON object: ``job`` names the file in jobs/, ``run`` the run, such as
chunk/fig06/0, and ``record`` the sidecar, empty for none. Its ``params``, and ``inputs`` and
``outputs`` of ``FILES``, hold the arguments of the job's function by name. Before anything is
computed, an argument that is missing, unknown or of another type is refused; and so is a job whose
code or configuration was edited after it was submitted, since it may wait on a cluster for hours.
"""

import json
import sys
import traceback
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from model.tracking.provenance import Job, code_hash, edited_since

_HERE = Path(__file__).resolve().parent


def _files(named: dict[str, Any]) -> Iterable[Path]:
    """Yield the files of a rule's inputs or outputs: each name has one, or a list of them."""
    for files in named.values():
        yield from map(Path, [files] if isinstance(files, str) else files)


def main() -> None:
    """Call the job's function, and write its sidecar last: it says that the outputs are whole."""
    request, files = map(json.loads, sys.argv[1:])
    name, inputs, outputs = request["job"], files["inputs"], files["outputs"]
    job = Job(*request["run"].split("/"), sources=(_HERE / "run.py", _HERE / f"jobs/{name}.py"))
    code = code_hash(_HERE.parent, "workflow/run.py", f"workflow/jobs/{name}.py")
    if edited := edited_since(files["study"], name, code):
        sys.exit(f"job {name} refused: its {edited} was edited after it was submitted; start again")
    function: Any = import_module(f"jobs.{name}").run
    given = json.dumps({**request["params"], **inputs, **outputs})
    try:
        facts = TypeAdapter(function).validate_json(given)
    except ValidationError as invalid:  # the last line is what the index of runs shows
        traceback.print_exc()
        faults = (f"{'.'.join(map(str, e['loc']))}: {e['msg']}" for e in invalid.errors())
        sys.exit(f"job {name} refused: {'; '.join(faults)}")
    if request["record"]:
        made, read = list(_files(outputs)), list(_files(inputs))
        job.finish(Path(request["record"]), made, read, **(facts or {}))


if __name__ == "__main__":
    main()
