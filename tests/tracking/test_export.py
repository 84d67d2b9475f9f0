"""Exports: the real MLflow holds the run, a validator accepts the crate.

They need the extra ``export``: `make export-test` runs them in an environment that has it.
"""

import importlib
import json
import multiprocessing
from pathlib import Path
from typing import Any

import pytest

from model.cli import main as cli
from model.tracking import export
from model.tracking.export import ExportError, results_of, to_mlflow, to_rocrate
from model.tracking.history import load_history
from model.tracking.invocation import Invocation

PROJECT = Path(__file__).resolve().parents[2]
CONTEXT = "https://w3id.org/ro/crate/1.1/context"

# Other people's packages, whose warnings are theirs to mend.
pytestmark = pytest.mark.filterwarnings("ignore")


def needs(module: str) -> Any:
    return pytest.importorskip(module, reason=f"the extra export is not installed: {module}")


@pytest.fixture
def built(recorded) -> Any:
    """An invocation that made a dataset and a table, and in which another figure failed."""
    invocation = recorded.invocation()
    recorded.merge()
    recorded.claims()
    recorded.fail("plot/fig06", "ValueError: no such colour\n")
    invocation.end("failed")
    return recorded


def record_of(built: Any) -> dict[str, Any]:
    return load_history(built.root)[-1] | {"study": {"settings": {"horizon": 100.0}}}


def test_results_are_what_the_invocation_made_not_what_replaced_it(built) -> None:
    record = load_history(built.root)[0]
    assert set(results_of(record, built.root)) == {"data/fig06.nc", "claims.csv"}
    second = built.invocation()
    built.merge(0.5)
    second.end("done")
    made, later = (
        results_of(each, built.root)["data/fig06.nc"] for each in load_history(built.root)
    )
    assert made.read_bytes() != later.read_bytes()


def test_results_are_placed_where_the_job_left_them(recorded) -> None:
    invocation = recorded.invocation()
    recorded.compare()
    recorded.fixed_steps()
    invocation.end("done")
    (record,) = load_history(recorded.root)
    assert set(results_of(record, recorded.root)) == {
        "data/precision.nc", "benchmarks/precision.csv", "data/fixed_steps/fig06.nc",
    }  # fmt: skip


def test_without_the_extra_it_is_named(built, tmp_path: Path, monkeypatch) -> None:
    def absent(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(export, "import_module", absent)
    record = record_of(built)
    with pytest.raises(ExportError, match=r"needs mlflow, .* 'vibralign\[export\]'"):
        to_mlflow(record, built.root, tmp_path / "runs.db")
    with pytest.raises(ExportError, match=r"needs rocrate, .* 'vibralign\[export\]'"):
        to_rocrate(record, built.root, PROJECT, tmp_path / "crate")
    assert not list(tmp_path.glob("crate*"))


# --- MLflow -------------------------------------------------------------------------------------


def test_mlflow_holds_parameters_metrics_tags_and_data(built, tmp_path: Path) -> None:
    mlflow = needs("mlflow")
    store = tmp_path / "mlruns.db"
    name = to_mlflow(record_of(built), built.root, store)
    run = mlflow.MlflowClient(tracking_uri=f"sqlite:///{store}").get_run(name)
    assert run.info.status == "FAILED"
    assert run.data.params["settings.horizon"] == "100.0"
    assert run.data.metrics["fig06.aligned"] == 3.0
    assert run.data.metrics["trajectories"] == 4.0
    assert run.data.metrics["runs_failed"] == 1.0
    assert run.data.tags["failed.plot/fig06"] == "ValueError: no such colour"
    artifacts = tmp_path / "mlruns-artifacts"
    (dataset,) = artifacts.rglob("fig06.nc")
    assert dataset.read_bytes() == (built.root / "data/fig06.nc").read_bytes()
    assert list(artifacts.rglob("invocation.json"))
    (table,) = artifacts.rglob("claims.csv")
    assert table.parent.name == "artifacts", "beside the folders, as in the results root"


def test_mlflow_holds_why_an_invocation_was_refused(recorded, tmp_path: Path) -> None:
    mlflow = needs("mlflow")
    Invocation(recorded.root).pass_by("failed", None, "the configuration breaks a rule")
    (record,) = load_history(recorded.root)
    name = to_mlflow(record, recorded.root, tmp_path / "mlruns.db")
    run = mlflow.MlflowClient(tracking_uri=f"sqlite:///{tmp_path / 'mlruns.db'}").get_run(name)
    assert run.data.tags["reason"] == "the configuration breaks a rule"


def test_mlflow_holds_an_invocation_once(built, tmp_path: Path) -> None:
    mlflow = needs("mlflow")
    store = tmp_path / "mlruns.db"
    first = to_mlflow(record_of(built), built.root, store)
    assert to_mlflow(record_of(built), built.root, store) == first
    client = mlflow.MlflowClient(tracking_uri=f"sqlite:///{store}")
    experiment = client.get_experiment_by_name("vibralign").experiment_id
    half = client.create_run(experiment, tags={"invocation": "20990101T000000Z-dead"})
    again = {**record_of(built), "invocation": "20990101T000000Z-dead"}
    whole = to_mlflow(again, built.root, store)
    assert whole != half.info.run_id, "what an interrupted export left is written anew"
    assert {run.info.run_id for run in client.search_runs([experiment])} == {first, whole}


def test_two_writers_of_a_fresh_store_wait_for_each_other(built, tmp_path: Path) -> None:
    needs("mlflow")
    store = tmp_path / "mlruns.db"
    records = [{**record_of(built), "invocation": f"2099010{i}T000000Z-abcd"} for i in (1, 2)]
    spawn = multiprocessing.get_context("spawn")
    with spawn.Pool(2) as pool:
        names = pool.starmap(to_mlflow, [(record, built.root, store) for record in records])
    assert len(set(names)) == 2


# --- RO-Crate -----------------------------------------------------------------------------------

# The context of RO-Crate 1.1 as published (CC0), from the package rocrate 0.13.0. A validator
# fetches it from the web, and a test must not depend on that.
PUBLISHED = Path(__file__).with_name("ro-crate-1.1-context.jsonld")


def test_the_context_is_the_published_one() -> None:
    published = json.loads(PUBLISHED.read_text(encoding="utf-8"))
    assert (published["@id"], published["version"]) == (CONTEXT, "1.1.0")


def offline_cache(path: Path) -> Path:
    """A cache of the web for the validator, which holds the context's address."""
    requests, cached = needs("requests"), needs("requests_cache")
    headers = {"Accept": "application/ld+json"}
    request = requests.Request("GET", CONTEXT, headers=headers).prepare()
    response = cached.CachedResponse(
        status_code=200,
        url=CONTEXT,
        headers={"Content-Type": "application/ld+json"},
        request=cached.CachedRequest.from_request(request),
    )
    response._content = PUBLISHED.read_bytes()
    with cached.CachedSession(str(path), backend="sqlite") as session:
        session.cache.save_response(response, cache_key=session.cache.create_key(request))
    return path


def issues(crate: Path, cache: Path) -> list[str]:
    services = needs("rocrate_validator.services")
    settings = services.ValidationSettings(
        rocrate_uri=str(crate),
        profile_identifier="workflow-run-crate",
        requirement_severity=importlib.import_module("rocrate_validator.models").Severity.REQUIRED,
        offline=True,
        cache_path=cache,
    )
    return [f"{each.check.identifier}: {each.message}" for each in
            services.validate(settings).get_issues()]  # fmt: skip


def test_a_validator_accepts_the_crate_and_sees_a_missing_action(built, tmp_path: Path) -> None:
    needs("rocrate")
    crate, cache = tmp_path / "crate", offline_cache(tmp_path / "web")
    to_rocrate(record_of(built), built.root, PROJECT, crate)
    assert issues(crate, cache) == []
    metadata = crate / "ro-crate-metadata.json"
    graph = json.loads(metadata.read_text(encoding="utf-8"))
    actions = [each for each in graph["@graph"] if each["@type"] == "CreateAction"]
    assert [each["actionStatus"] for each in actions] == ["http://schema.org/FailedActionStatus"]
    assert "plot/fig06: ValueError: no such colour" in actions[0]["error"]
    assert (crate / "data/fig06.nc").is_file()
    assert (crate / "workflow/rules/figures.smk").is_file()
    del actions[0]["instrument"]
    metadata.write_text(json.dumps(graph), encoding="utf-8")
    assert any("instrument" in each for each in issues(crate, cache)), "the validator can fail"


def test_a_crate_overwrites_nothing_and_needs_the_workflow(built, tmp_path: Path) -> None:
    needs("rocrate")
    with pytest.raises(ExportError, match="exists already"):
        to_rocrate(record_of(built), built.root, PROJECT, tmp_path)
    with pytest.raises(ExportError, match="holds no Snakefile"):
        to_rocrate(record_of(built), built.root, tmp_path, tmp_path / "crate")


def test_the_command_exports(built, tmp_path: Path, capsys) -> None:
    needs("rocrate")
    arguments = ["--root", str(built.root), "--project", str(PROJECT)]
    assert cli.main(["export", "ro-crate", str(tmp_path / "crate"), *arguments]) == cli.DONE
    assert "Workflow Run RO-Crate of " in capsys.readouterr().out
    assert cli.main(["export", "ro-crate", str(tmp_path / "crate"), *arguments]) == cli.REFUSED
    assert "exists already" in capsys.readouterr().err
