"""Copy of a record of the history (history.py) as a run of MLflow; needs the extra ``export``."""

import os
import tempfile
from datetime import datetime
from importlib import import_module
from pathlib import Path

from pandas import json_normalize

from study.tracking import TrackingError
from study.tracking.history import Record
from study.tracking.job import file_hash

EXPERIMENT = "vibralign"


def results_of(record: Record, root: Path) -> dict[str, Path]:
    """Return results that still exist, by path below the root; replaced ones do not."""
    found = {}
    for run in record["runs"]:
        for name, sha256 in {} if run.get("part") else run["outputs"].items():
            place = os.path.normpath(Path(run["folder"], name))
            file = root / place
            stands = file.is_file() and file_hash(file) == sha256
            if stands and not name.endswith(".json"):  # hashes of compiled code
                found[place] = file
    return found


def to_mlflow(record: Record, root: Path, uri: str) -> str:
    """Write an invocation as a run of MLflow and return the run's id.

    ``uri`` is the address of an MLflow server, or "sqlite:///FILE" for a file, which is made if it
    is missing. A run that is whole in the store stays; what an interrupted export left is replaced.
    """
    os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")  # read when mlflow is imported
    try:
        mlflow = import_module("mlflow")
    except ImportError:
        words = "this export needs mlflow, which is not installed: pip install 'vibralign[export]'"
        raise TrackingError(words) from None
    client, artifacts = mlflow.MlflowClient(tracking_uri=uri), None  # a server's own place
    if uri.startswith("sqlite:///"):
        store = Path(uri.removeprefix("sqlite:///")).resolve().with_suffix("")
        artifacts = f"{store.as_uri()}-artifacts"
    held = client.get_experiment_by_name(EXPERIMENT)
    number = held.experiment_id if held else client.create_experiment(EXPERIMENT, artifacts)
    for run in client.search_runs([number], f"tags.invocation = '{record['invocation']}'"):
        if run.info.status != "RUNNING":
            return str(run.info.run_id)
        client.delete_run(run.info.run_id)
    times = (record["started"], record["ended"] or record["started"])
    started, ended = (round(1000 * datetime.fromisoformat(each).timestamp()) for each in times)
    run = client.create_run(number, started, tags_of(record), record["invocation"])
    name: str = run.info.run_id
    metrics = [mlflow.entities.Metric(*each, ended, 0) for each in metrics_of(record).items()]
    parameters = [mlflow.entities.Param(*each) for each in parameters_of(record).items()]
    client.log_batch(name, metrics, parameters)
    client.log_dict(name, record, "invocation.json")
    with tempfile.TemporaryDirectory() as folder:
        for place, file in results_of(record, root).items():
            link = Path(folder, place)
            link.parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(file.resolve())
        client.log_artifacts(name, folder)
    status = {"done": "FINISHED", "failed": "FAILED"}.get(record["outcome"], "KILLED")
    client.set_terminated(name, status, ended)
    return name


def tags_of(record: Record) -> dict[str, str]:
    """Return the tags of an invocation: command, commit, versions, and reasons of failed jobs."""
    tags = {name: record[name] for name in ("invocation", "outcome", "host")}
    tags |= {"command": " ".join(record["command"]), "reason": record.get("reason", "")}
    tags |= {"mlflow.source.name": "Snakefile", "mlflow.source.type": "PROJECT"}
    tags |= {f"version.{name}": version for name, version in record["versions"].items()}
    tags |= {f"failed.{each['run']}": each["reason"] for each in record["failures"]}
    if git := record["git"]:
        tags |= {"mlflow.source.git.commit": git["commit"], "dirty": str(git["dirty"])}
    return {name: value[:4000] for name, value in tags.items() if value}


def parameters_of(record: Record) -> dict[str, str]:
    """Return the configuration by path without titles and captions, as much as MLflow keeps."""
    flat, words = json_normalize(record.get("study", {})), ("title", "caption")
    return {key: str(flat[key][0])[:6000] for key in flat if key.rpartition(".")[2] not in words}


def metrics_of(record: Record) -> dict[str, float]:
    """Return counts by figure, seconds by run, and the sums of both."""
    wholes = [run for run in record["runs"] if run["rule"] in ("merge", "sweep") and run["figure"]]
    counts = [(run["figure"], *each) for run in wholes for each in run.get("counts", {}).items()]
    metrics = {f"{figure}.{kind}": count for figure, kind, count in counts}
    metrics |= {f"seconds.{run['run']}": run["wall_seconds"] for run in record["runs"]}
    metrics |= {"runs_done": len(record["runs"]), "runs_failed": len(record["failures"])}
    for total in ("trajectories", "rhs_evaluations"):
        metrics[total] = sum(count for _, kind, count in counts if kind == total)
    metrics["seconds"] = record["wall_seconds"]
    return {name: float(value) for name, value in metrics.items() if value is not None}
