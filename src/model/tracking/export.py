"""Export of an invocation of the study to MLflow; needs the extra ``export``.

The history is kept in files (history.py). An export is a copy of one of its records.
"""

import os
import tempfile
from collections.abc import Iterator
from datetime import datetime
from importlib import import_module
from pathlib import Path
from typing import Any

from model.study.files import write_json
from model.tracking import TrackingError
from model.tracking.history import Record, kept_result
from model.tracking.job import file_hash

EXPERIMENT = "vibralign"
_SQLITE = "sqlite:///"


def results_of(record: Record, root: Path) -> dict[str, Path]:
    """Return the results of an invocation that still exist, by path below the results root.

    The history keeps datasets and verdicts. Pictures and the report exist until a later invocation
    replaces them.
    """
    found = {}
    for run in record["runs"]:
        if run.get("part"):
            continue
        for name, sha256 in run["outputs"].items():
            if name.endswith(".json"):  # hashes of compiled code
                continue
            place = os.path.normpath(Path(run["folder"], name))
            for file in (kept_result(root, name, sha256), root / place):
                if file.is_file() and file_hash(file) == sha256:
                    found[place] = file
                    break
    return found


def to_mlflow(record: Record, root: Path, uri: str) -> str:
    """Write an invocation as a run of MLflow and return the run's id.

    ``uri`` is the address of an MLflow server, or "sqlite:///FILE" for a file, which is made if it
    is missing. A run that is complete in the store is not written again; what an interrupted export
    left is deleted and written anew.
    """
    os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")  # read when mlflow is imported
    try:
        mlflow, entities = import_module("mlflow"), import_module("mlflow.entities")
    except ImportError:
        raise TrackingError(
            "this export needs mlflow, which is not installed: pip install 'vibralign[export]'"
        ) from None
    client = mlflow.MlflowClient(tracking_uri=uri)
    experiment = _experiment(client, uri)
    for run in client.search_runs([experiment], f"tags.invocation = '{record['invocation']}'"):
        if run.info.status != "RUNNING":
            return str(run.info.run_id)
        client.delete_run(run.info.run_id)
    started, ended = (
        round(datetime.fromisoformat(record[key] or record["started"]).timestamp() * 1000)
        for key in ("started", "ended")
    )
    run = client.create_run(experiment, started, tags_of(record), record["invocation"])
    name: str = run.info.run_id
    parameters = [entities.Param(*each) for each in parameters_of(record).items()]
    for first in range(0, len(parameters), 100):  # as many as one call may carry
        client.log_batch(name, params=parameters[first : first + 100])
    metrics = [entities.Metric(*each, ended, 0) for each in metrics_of(record).items()]
    client.log_batch(name, metrics=metrics)
    _log_artifacts(client, name, record, root)
    status = {"done": "FINISHED", "failed": "FAILED"}.get(record["outcome"], "KILLED")
    client.set_terminated(name, status, ended)
    return name


def _experiment(client: Any, uri: str) -> str:
    """Return the id of the experiment; artifacts of a file go into a folder beside it."""
    held = client.get_experiment_by_name(EXPERIMENT)
    if held is not None:
        return str(held.experiment_id)
    artifacts = None  # a server knows its own place
    if uri.startswith(_SQLITE):
        store = Path(uri.removeprefix(_SQLITE)).resolve()
        artifacts = store.with_name(f"{store.stem}-artifacts").as_uri()
    return str(client.create_experiment(EXPERIMENT, artifact_location=artifacts))


def tags_of(record: Record) -> dict[str, str]:
    """Return the tags of an invocation: command, commit, versions, and reasons of failed jobs."""
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


def parameters_of(record: Record) -> dict[str, str]:
    """Return the configuration as path and value, without titles and captions."""

    def flat(value: Any, path: str) -> Iterator[tuple[str, str]]:
        if isinstance(value, dict):
            for name, each in value.items():
                yield from flat(each, f"{path}.{name}" if path else name)
        elif path.rpartition(".")[2] not in ("title", "caption"):
            yield path, str(value)[:6000]  # as much as MLflow keeps

    return dict(flat(record.get("study", {}), ""))


def metrics_of(record: Record) -> dict[str, float]:
    """Return counts by figure, seconds by run, and the sums of both."""
    wholes = [run for run in record["runs"] if run["rule"] in ("merge", "sweep") and run["figure"]]
    metrics = {
        f"{run['figure']}.{name}": float(count)
        for run in wholes
        for name, count in run.get("counts", {}).items()
    }
    metrics |= {f"seconds.{run['run']}": float(run["wall_seconds"]) for run in record["runs"]}
    metrics |= {"runs_done": len(record["runs"]), "runs_failed": len(record["failures"])}
    for name in ("trajectories", "rhs_evaluations"):
        metrics[name] = sum(run.get("counts", {}).get(name, 0) for run in wholes)
    if record["wall_seconds"] is not None:
        metrics["seconds"] = record["wall_seconds"]
    return {name: float(value) for name, value in metrics.items()}


def _log_artifacts(client: Any, run: str, record: Record, root: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "invocation.json"
        write_json(record, path)
        client.log_artifact(run, str(path))
        for place, file in results_of(record, root).items():
            link = Path(folder) / Path(place).name  # the history names its copy by a hash
            link.symlink_to(file.resolve())
            above = Path(place).parent.as_posix()
            client.log_artifact(run, str(link), None if above == "." else above)
            link.unlink()
