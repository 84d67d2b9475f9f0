"""Reports of the parts of a fuzz campaign: added up, stored, and summed up in words."""

from collections import Counter

from verification.fuzz import Finding, Report
from verification.fuzz_campaign import HOLDS, added, read_report, report_text, summary

GOOD = Report(
    2000, Counter({"aligned: none": 900, "left_scene: overshot": 1100}), 3, 50, 40, 10**6, [], []
)
BAD = Report(
    1000, Counter({"aligned: none": 1000}), 1, 5, 4, 10**5, [Finding(2007, "is finite", "inf")], []
)


def test_parts_add_up():
    both = added([GOOD, BAD])
    assert both.sets == 3000
    assert both.endings == {"aligned: none": 1900, "left_scene: overshot": 1100}
    assert (both.sensitive, both.against_neighbour, both.against_tighter) == (4, 55, 44)
    assert both.findings == BAD.findings


def test_a_report_is_read_as_it_was_stored(tmp_path):
    stored = tmp_path / "0.json"
    stored.write_text(report_text(BAD), encoding="utf-8")
    assert read_report(stored) == BAD


def test_the_last_line_says_whether_every_property_holds():
    assert summary(GOOD, 2007).splitlines()[-1] == HOLDS
    assert summary(BAD, 2007).splitlines()[-2:] == ["1 sets: is finite", "    set 2007: inf"]
    failed = [Finding(number, "failed", "") for number in range(20)]
    many = summary(GOOD._replace(unexplained=failed), 2007).splitlines()
    assert "20 sets: failed" in many
    assert many[-1].startswith("more than a share of")
