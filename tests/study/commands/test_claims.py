"""``python -m study claims``: the ledger of a build, and the regime of its figures."""

import json

import pytest

from study import __main__ as cli
from study.claims import CLAIMS, tally
from study.claims.regime import Regime


def test_every_entry_has_a_line_and_the_last_counts(root, lines, capsys) -> None:
    assert cli.main(["claims", "--root", str(root)]) == cli.DONE
    head, *rows, last = capsys.readouterr().out.splitlines()
    assert head.split()[:3] == ["entry", "verdict", "random"]
    assert [row.split()[0] for row in rows] == [claim.id for claim in CLAIMS]
    assert last == tally([line.verdict for line in lines])
    assert cli.main(["claims", "--root", str(root), "--json"]) == cli.DONE
    found = json.loads(capsys.readouterr().out)
    assert [each["claim"] for each in found] == [claim.id for claim in CLAIMS]
    assert [each["fails"] for each in found] == [line.fails for line in lines]


def test_the_regime_is_a_line_for_every_figure(root, datasets, capsys) -> None:
    assert cli.main(["claims", "--root", str(root), "--regime"]) == cli.DONE
    head, *rows = capsys.readouterr().out.splitlines()
    assert head.split() == ["figure", *Regime._fields]
    assert [row.split()[0] for row in rows] == sorted(datasets)
    assert cli.main(["claims", "--root", str(root), "--regime", "--json"]) == cli.DONE
    found = json.loads(capsys.readouterr().out)
    aligned = (datasets["fig07"]["outcome"].values == 0).mean()
    assert found[2]["aligned"] == pytest.approx(aligned, abs=1e-3)
