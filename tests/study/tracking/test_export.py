"""Contents of an export to MLflow; in the nightly, with the real MLflow.

MLflow is not in the environment that `make` builds: `pip install 'vibralign[export]'` adds it.
"""

from pathlib import Path
from typing import Any

import pytest

from study import __main__ as cli
from study.tracking import TrackingError, export
from study.tracking.export import metrics_of, parameters_of, results_of, tags_of, to_mlflow
from study.tracking.history import load_history
from study.tracking.invocation import Invocation


@pytest.fixture
def built(recorded) -> Any:
    """An invocation that made a dataset and a table, with one failed figure."""
    with recorded.invoked("failed"):
        recorded.merge()
        recorded.claims()
        recorded.fail("plot/fig06", "ValueError: no such colour\n")
    return recorded


def record_of(built: Any) -> dict[str, Any]:
    return load_history(built.root)[-1] | {"study": {"settings": {"horizon": 100.0}}}


def test_results_are_what_the_invocation_made_not_what_replaced_it(built) -> None:
    record = load_history(built.root)[0]
    assert set(results_of(record, built.root)) == {"data/fig06.nc", "claims.csv"}
    built.built(0.5)
    first, later = load_history(built.root)
    assert set(results_of(first, built.root)) == {"claims.csv"}
    assert set(results_of(later, built.root)) == {"data/fig06.nc"}


def test_results_are_placed_where_the_job_left_them(recorded) -> None:
    with recorded.invoked():
        recorded.compare()
        recorded.run_of_claims()
    (record,) = load_history(recorded.root)
    assert set(results_of(record, recorded.root)) == {
        "data/precision.csv", "benchmarks/precision.csv", "data/claims/fig06.nc",
    }  # fmt: skip


def test_parameters_metrics_and_tags_are_those_of_the_record(built) -> None:
    record = record_of(built)
    figure = {"count": 3, "title": "Alignment"}
    record["study"]["figures"] = {"fig06": figure}
    assert parameters_of(record) == {"settings.horizon": "100.0", "figures.fig06.count": "3"}
    metrics = metrics_of(record)
    assert metrics["fig06.aligned"] == 3.0
    assert metrics["trajectories"] == 4.0
    assert metrics["runs_failed"] == 1.0
    assert metrics["runs_done"] == len(record["runs"]) == 2
    tags = tags_of(record)
    assert tags["invocation"] == record["invocation"]
    assert tags["outcome"] == "failed"
    assert tags["failed.plot/fig06"] == "ValueError: no such colour"
    Invocation(built.root).record_idle("failed", "the configuration breaks a rule")
    assert tags_of(record_of(built))["reason"] == "the configuration breaks a rule"


def test_without_the_extra_it_is_named(built, tmp_path: Path, monkeypatch, capsys) -> None:
    def absent(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(export, "import_module", absent)
    with pytest.raises(TrackingError, match=r"needs mlflow, .* 'vibralign\[export\]'"):
        to_mlflow(record_of(built), built.root, f"sqlite:///{tmp_path}/runs.db")
    words = ["export", "mlflow", "--tracking-uri", f"sqlite:///{tmp_path}/runs.db"]
    assert cli.main([*words, "--root", str(built.root)]) == cli.REFUSED
    assert "needs mlflow" in capsys.readouterr().err


@pytest.mark.nightly
@pytest.mark.filterwarnings("ignore")  # MLflow's, and its to mend
def test_mlflow_holds_an_invocation_once_with_its_data(built, tmp_path: Path, capsys) -> None:
    mlflow = pytest.importorskip("mlflow", reason="the extra export is not installed")
    uri = f"sqlite:///{tmp_path}/mlruns.db"
    record = record_of(built)
    name = to_mlflow(record, built.root, uri)
    client = mlflow.MlflowClient(tracking_uri=uri)
    run = client.get_run(name)
    assert run.info.status == "FAILED"
    assert run.data.params == parameters_of(record) == {"settings.horizon": "100.0"}
    assert run.data.metrics == metrics_of(record)
    assert tags_of(record).items() <= run.data.tags.items()
    artifacts = tmp_path / "mlruns-artifacts"
    (dataset,) = artifacts.rglob("fig06.nc")
    assert dataset.read_bytes() == (built.root / "data/fig06.nc").read_bytes()
    assert list(artifacts.rglob("invocation.json"))
    (table,) = artifacts.rglob("claims.csv")
    assert table.parent.name == "artifacts", "beside the folders, as in the results root"

    words = ["export", "mlflow", "--tracking-uri", uri, "--root", str(built.root)]
    assert cli.main(words) == cli.DONE
    assert f"{uri}: run {name} of experiment" in capsys.readouterr().out, "it is held already"
    experiment = run.info.experiment_id
    half = client.create_run(experiment, tags={"invocation": "20990101T000000Z-dead"})
    whole = to_mlflow({**record, "invocation": "20990101T000000Z-dead"}, built.root, uri)
    assert whole != half.info.run_id, "what an interrupted export left is written anew"
    assert {each.info.run_id for each in client.search_runs([experiment])} == {name, whole}
