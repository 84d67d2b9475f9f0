"""Exports of an invocation of the study: an MLflow run, a Workflow Run RO-Crate.

Files stay the tracker (records.py). An export is made afterwards, by one writer, and needs the
extra ``export``.
"""

import contextlib
import fcntl
import mimetypes
import os
import tempfile
from collections.abc import Iterator
from datetime import datetime
from importlib import import_module
from pathlib import Path
from typing import Any

from model.study.files import whole_folder
from model.tracking.provenance import file_hash, write_json
from model.tracking.records import PARTS, Record, kept_result

# What a crate has beside the Snakefile, so that it can be run again without the repository.
_SOURCES = ("workflow", "config", "profiles", "src", "verification")
_BESIDE = ("CITATION.cff", "Containerfile", "LICENSE", "Makefile", "README.md", "pyproject.toml",
           "requirements.lock")  # fmt: skip
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": "Workflow RO-Crate",
}
_ABOUT = (
    "Vibratory alignment of a peg with a hole: a study rebuilt from its equations to its figures"
)


class ExportError(ValueError):
    """An export that cannot be made; the message names the missing part."""


def _needed(module: str) -> Any:
    try:
        return import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        raise ExportError(
            f"this export needs {package}, which is not installed: pip install 'vibralign[export]'"
        ) from None


def results_of(record: Record, root: Path) -> dict[str, Path]:
    """Return the existing results of an invocation, by path below the results root.

    Datasets and verdicts are kept by the history; pictures and the report only as long as nothing
    has replaced them.
    """
    found = {}
    for run in record["runs"]:
        if run["rule"] in PARTS | {"kernels", "unlocated_kernels"}:
            continue
        for name, sha256 in run["outputs"].items():
            place = os.path.normpath(Path(run["folder"], name))
            for file in (kept_result(root, name, sha256), root / place):
                if file.is_file() and file_hash(file) == sha256:
                    found[place] = file
                    break
    return found


# --- MLflow -------------------------------------------------------------------------------------


def to_mlflow(record: Record, root: Path, store: Path, experiment: str = "vibralign") -> str:
    """Write an invocation as a run of MLflow and return the run's id.

    An invocation that the store already holds is not written again; one that an interrupted export
    left half there is.

    Args:
        record: of the invocation, as from ``history.load_history``.
        root: the results root that it belongs to.
        store: the SQLite file; artifacts go into a folder beside it, "<stem>-artifacts".
        experiment: the name to file it under.

    Raises:
        ExportError: mlflow is not installed.
    """
    os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")  # read when mlflow is imported
    mlflow, entities = _needed("mlflow"), _needed("mlflow.entities")
    store.parent.mkdir(parents=True, exist_ok=True)
    with _only_writer(store):
        client = mlflow.MlflowClient(tracking_uri=f"sqlite:///{store.resolve()}")
        held = _experiment(client, experiment, store)
        for run in client.search_runs([held], f"tags.invocation = '{record['invocation']}'"):
            if run.info.status != "RUNNING":
                return str(run.info.run_id)
            client.delete_run(run.info.run_id)
        run = client.create_run(
            held, _milliseconds(record["started"]), _tags(record), record["invocation"]
        )
        name: str = run.info.run_id
        parameters = [entities.Param(key, value[:6000]) for key, value in _parameters(record)]
        for first in range(0, len(parameters), 100):  # as many as one call may carry
            client.log_batch(name, params=parameters[first : first + 100])
        ended = _milliseconds(record["ended"] or record["started"])
        metrics = [entities.Metric(key, value, ended, 0) for key, value in _metrics(record)]
        for first in range(0, len(metrics), 1000):
            client.log_batch(name, metrics=metrics[first : first + 1000])
        _log_artifacts(client, name, record, root)
        status = {"done": "FINISHED", "failed": "FAILED"}.get(record["outcome"], "KILLED")
        client.set_terminated(name, status, ended)
    return name


@contextlib.contextmanager
def _only_writer(store: Path) -> Iterator[None]:
    """Wait until no other export writes to the store, since two that create it crash."""
    with store.with_suffix(".lock").open("w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _experiment(client: Any, name: str, store: Path) -> str:
    held = client.get_experiment_by_name(name)
    if held is not None:
        return str(held.experiment_id)
    artifacts = store.resolve().with_name(f"{store.stem}-artifacts")
    return str(client.create_experiment(name, artifact_location=artifacts.as_uri()))


def _milliseconds(moment: str) -> int:
    return round(datetime.fromisoformat(moment).timestamp() * 1000)


def _tags(record: Record) -> dict[str, str]:
    git = record["git"]
    tags = {
        "invocation": record["invocation"],
        "outcome": record["outcome"],
        "command": " ".join(record["command"]),
        "host": record["host"],
        "mlflow.source.name": "Snakefile",
        "mlflow.source.type": "PROJECT",
        **{f"version.{name}": version for name, version in record["versions"].items()},
        **{f"failed.{each['run']}": each["reason"][:4000] for each in record["failures"]},
    }
    if "reason" in record:
        tags |= {"reason": record["reason"][:4000]}
    if "commit" in git:
        tags |= {"mlflow.source.git.commit": git["commit"], "dirty": str(git["dirty"])}
    return tags


def _parameters(record: Record) -> Iterator[tuple[str, str]]:
    """Yield the study's numbers by their path in the configuration."""

    def flat(value: Any, path: str) -> Iterator[tuple[str, str]]:
        if isinstance(value, dict):
            for name, each in value.items():
                yield from flat(each, f"{path}.{name}" if path else name)
        elif path.rpartition(".")[2] not in ("title", "caption"):
            yield path, str(value)

    yield from flat(record.get("study", {}), "")


def _metrics(record: Record) -> Iterator[tuple[str, float]]:
    """Yield counts of every figure, times of every run, and the sums."""
    wholes = [run for run in record["runs"] if run["rule"] in ("merge", "history")]
    for run in wholes:
        for name, count in run.get("counts", {}).items():
            yield f"{run['figure']}.{name}", float(count)
    for run in record["runs"]:
        yield f"seconds.{run['run']}", float(run["wall_seconds"])
    yield "runs_done", float(len(record["runs"]))
    yield "runs_failed", float(len(record["failures"]))
    for name in ("trajectories", "rhs_evaluations"):
        yield name, float(sum(run.get("counts", {}).get(name, 0) for run in wholes))
    if record["wall_seconds"] is not None:
        yield "seconds", float(record["wall_seconds"])


def _log_artifacts(client: Any, run: str, record: Record, root: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "invocation.json"
        write_json(record, path)
        client.log_artifact(run, str(path))
        for place, file in results_of(record, root).items():
            link = Path(folder) / Path(place).name  # under the name it had, not its hash
            link.symlink_to(file.resolve())
            above = Path(place).parent.as_posix()
            client.log_artifact(run, str(link), None if above == "." else above)
            link.unlink()


# --- RO-Crate -----------------------------------------------------------------------------------


def to_rocrate(record: Record, root: Path, project: Path, target: Path) -> None:
    """Write an invocation as a Workflow Run RO-Crate, the folder ``target``, whole or not at all.

    Args:
        record: of the invocation, as from ``history.load_history``.
        root: the results root that it belongs to.
        project: the checkout that holds the Snakefile.
        target: a folder that does not exist yet.

    Raises:
        ExportError: rocrate is not installed, the target exists, or the Snakefile does not.
    """
    rocrate = _needed("rocrate.rocrate")
    if target.exists():
        raise ExportError(f"{target}: exists already; name a folder that does not")
    if not (project / "Snakefile").is_file():
        raise ExportError(f"{project}: holds no Snakefile; name the checkout of the project")
    crate = rocrate.ROCrate(version="1.1")
    with tempfile.TemporaryDirectory() as folder:
        study, log = Path(folder) / "study.json", Path(folder) / "invocation.json"
        write_json(record.get("study", {}), study)
        write_json(record, log)
        _describe(crate, record)
        workflow = _add_workflow(crate, record, project)
        study_file = _add_file(crate, study, "study.json", name="The study as it was configured")
        workflow.append_to("input", _study_parameter(crate, study_file))
        results = [
            _add_file(crate, path, place, name=place, identifier=f"sha256:{file_hash(path)}")
            for place, path in results_of(record, root).items()
        ]
        action = crate.add_action(
            workflow, f"#{record['invocation']}", study_file, results, _action(crate, record)
        )
        crate.root_dataset["mentions"] = action
        words = "The invocation with a sidecar of every run"
        _add_file(crate, log, "invocation.json", name=words)
        with whole_folder(target) as part:
            crate.write(part)


def _entity(crate: Any, identifier: str, **properties: Any) -> Any:
    kind = properties.pop("type")
    context = _needed("rocrate.model.contextentity")
    return crate.add(
        context.ContextEntity(crate, identifier, properties={"@type": kind, **properties})
    )


def _add_file(crate: Any, path: Path, place: str, **properties: str) -> Any:
    media = mimetypes.MimeTypes().guess_type(place)[0] or "text/plain"
    return crate.add_file(path, place, properties={"encodingFormat": media, **properties})


def _describe(crate: Any, record: Record) -> None:
    crate.name = f"vibralign {record['versions'].get('vibralign', '')}".strip()
    crate.description = f"{_ABOUT}. Invocation {record['invocation']}, {record['outcome']}."
    crate.license = _entity(
        crate, "https://spdx.org/licenses/MIT",
        type="CreativeWork", name="MIT License", description="permissive licence",
    )  # fmt: skip
    crate.publisher = _entity(
        crate, "#contributors", type="Organization", name="vibralign contributors"
    )
    crate.root_dataset["author"] = crate.publisher
    crate.datePublished = datetime.fromisoformat(record["ended"] or record["started"])
    crate.root_dataset["conformsTo"] = [
        _entity(crate, profile, type="CreativeWork", name=name, version=profile.split("/")[-1])
        for profile, name in _PROFILES.items()
    ]


def _add_workflow(crate: Any, record: Record, project: Path) -> Any:
    workflow = crate.add_workflow(
        project / "Snakefile", "Snakefile", main=True, lang="snakemake", gen_cwl=False
    )
    words = {"name": "vibralign", "description": _ABOUT, "encodingFormat": "text/plain"}
    commit = record["git"].get("commit")
    if commit:
        words["version"] = commit + ("+changes" if record["git"]["dirty"] else "")
    for name, value in words.items():
        workflow[name] = value
    places = [path for folder in _SOURCES for path in sorted((project / folder).rglob("*"))]
    for path in [*(project / name for name in _BESIDE), *places]:
        if path.is_file() and "__pycache__" not in path.parts:
            _add_file(crate, path, path.relative_to(project).as_posix())
    return workflow


def _study_parameter(crate: Any, study: Any) -> Any:
    """Return the workflow's one formal parameter, of which the file ``study`` is the value."""
    parameter = crate.add_formal_parameter("study", "File", identifier="#study")
    study["exampleOfWork"] = parameter
    parameter["workExample"] = study
    return parameter


def _action(crate: Any, record: Record) -> dict[str, Any]:
    """Return the properties of the invocation as an action."""
    failed = record["outcome"] != "done"
    failures = "; ".join(f"{each['run']}: {each['reason']}" for each in record["failures"])
    error = failures or record.get("reason", record["outcome"])
    return {
        "name": f"Invocation {record['invocation']}",
        "description": " ".join(record["command"]),
        "startTime": record["started"],
        "endTime": record["ended"] or record["started"],
        "actionStatus": f"http://schema.org/{'Failed' if failed else 'Completed'}ActionStatus",
        "agent": crate.publisher,
        **({"error": error} if failed else {}),
    }
