"""``python -m study claims``: the ledger of what is on disk."""

import json
from pathlib import Path

import pytest

from model.sweeps.io import write_dataset
from study import __main__ as cli
from study.claims import CLAIMS
from study.claims.regime import Regime
from tests.study.claims_data import Course, falling, runs
from tests.study.report_data import weighed_data


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results with two figures, and one of the ledger's own runs."""
    folder = tmp_path_factory.mktemp("results")
    for name, dataset in {**runs("fig06", falling), **Course().datasets}.items():
        write_dataset(dataset, folder / f"data/{name}.nc")
    own = runs("rubbing")["rubbing"]
    write_dataset(own, folder / "data/claims/rubbing.nc")
    return folder


def test_every_claim_has_a_line_and_the_last_counts(root: Path, capsys) -> None:
    assert cli.main(["claims", "--root", str(root)]) == cli.DONE
    head, *lines, last = capsys.readouterr().out.splitlines()
    assert head.split()[:3] == ["claim", "verdict", "number"]
    assert [line.split()[0] for line in lines] == [claim.id for claim in CLAIMS]
    verdicts = {line.split()[0]: line.split()[1] for line in lines}
    assert verdicts["F6d"] == verdicts["F5a"] == "reproduced"
    assert verdicts["F8f"] == "contradicted"
    assert verdicts["F13"] == "not"
    numbers = dict(each.rsplit(" ", 1) for each in last.split(", "))
    assert list(numbers) == ["reproduced", "mixed", "contradicted", "not checkable"]
    assert sum(map(int, numbers.values())) == len(CLAIMS)
    write_dataset(weighed_data()["null"], root / "data/null.nc")
    assert cli.main(["claims", "--root", str(root)]) == cli.DONE
    *_, last = capsys.readouterr().out.splitlines()
    assert "where 4 random devices show 0 to" in last
    assert cli.main(["claims", "--root", str(root), "--json"]) == cli.DONE
    found = json.loads(capsys.readouterr().out)
    assert [each["claim"] for each in found] == [claim.id for claim in CLAIMS]
    (line,) = [each for each in found if each["claim"] == "F6d"]
    assert line["seen"] == "k_φ = 5: -1; k_φ = 7: -1"
    assert line["reason"]
    assert float(line["bits"]) in (1.0, 2.0)


def test_the_regime_is_a_line_for_every_figure(root: Path, capsys) -> None:
    assert cli.main(["claims", "--root", str(root), "--regime"]) == cli.DONE
    head, fig05, fig06 = capsys.readouterr().out.splitlines()
    assert head.split() == ["figure", *Regime._fields]
    assert fig05.split()[0] == "fig05"
    of_aligned = ["0", "0", "0.1", "0.1", "1", "0", "0.325", "0.675"]  # from f0 = 7 on in a period
    assert fig06.split() == ["fig06", "1", *of_aligned]
    assert cli.main(["claims", "--root", str(root), "--regime", "--json"]) == cli.DONE
    assert json.loads(capsys.readouterr().out)[1]["tilt"] == 0.1


def test_a_dataset_that_cannot_be_judged_is_named(tmp_path, capsys) -> None:
    path = tmp_path / "data/fig06.nc"
    write_dataset(runs("fig06", falling)["fig06"].drop_vars("unvibrated"), path)
    assert cli.main(["claims", "--root", str(tmp_path), "--regime"]) == cli.REFUSED
    assert "fig06 has no column for 'unvibrated'" in capsys.readouterr().err
    path.write_bytes(b"CDF")
    assert cli.main(["claims", "--root", str(tmp_path)]) == cli.REFUSED
    assert "fig06.nc: cannot be read as netCDF" in capsys.readouterr().err
