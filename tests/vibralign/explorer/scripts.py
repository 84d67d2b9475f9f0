"""The page's scripts in Node, without a browser: what they make of a model's values."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import vibralign.explorer

NODE = shutil.which("node")
FOLDER = Path(vibralign.explorer.__file__).parent
_SCRIPTS = ("amounts", "state", "map")


def evaluate(model: dict[str, Any], expression: str) -> Any:
    """Return the value of an expression of the page's functions and its MODEL; null is NaN."""
    scripts = [(FOLDER / f"page.{name}.js").read_text(encoding="utf-8") for name in _SCRIPTS]
    read = "(_, value) => (value === null ? NaN : value)"
    program = [*scripts, f"const MODEL = JSON.parse({json.dumps(json.dumps(model))}, {read});"]
    program.append(f"console.log(JSON.stringify({expression}));")
    assert NODE is not None
    run = subprocess.run(
        [NODE, "-"], input="\n".join(program), capture_output=True, text=True, check=True
    )
    return json.loads(run.stdout)
