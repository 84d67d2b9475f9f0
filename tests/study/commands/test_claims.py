"""``python -m study claims``: the ledger of a build."""

import json

from study import __main__ as cli
from study.claims import CLAIMS, tally


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
