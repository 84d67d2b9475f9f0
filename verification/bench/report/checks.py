"""Alignment times beside those of other codes, as last measured: for the report and the docs.

They take minutes and an environment of their own, so that no build of the study makes them anew.
"""

from typing import NamedTuple


class Check(NamedTuple):
    """Random sets that a second code ran as well.

    Attributes:
        code: the second code.
        states: what it states again, and so what it shares no error in.
        sets: number of sets that align.
        agrees: how many agree, and by what measure.
        median: median distance of the alignment times.
        largest: largest distance, or a quantile.
        command: command that measures it.
        commit: commit at which it was measured.
    """

    code: str
    states: str
    sets: str
    agrees: str
    median: str
    largest: str
    command: str
    commit: str


HEAD = ("code", "states again", ">sets", "agree", ">apart: median", ">largest", "by", "commit")
CHECKS = (
    Check(
        "independent solution", "contacts, friction, events, transitions",
        "215", "214 within the estimated errors, all within ten times them", "4 × 10⁻¹³",
        "3 × 10⁻¹⁰", "make accuracy, its first 500 sets", "ac68ce1",
    ),
    Check(
        "heyoka 7.13, tolerance 10⁻¹⁵", "equations of motion, events under one edge",
        "600", "600 within the estimated errors", "4 × 10⁻¹³", "8 × 10⁻¹⁰",
        "make truth", "ac68ce1",
    ),
)  # fmt: skip

# CPU µs of a trajectory at a true error of 10⁻⁸, as `make bench` gave them.
SPEED_HEAD = ("code", ">W1", ">W2", ">W3", ">Fig. 6", ">Fig. 13")
SPEEDS = (
    ("batch engine, one run", "7.0", "441", "549", "95", "138"),
    ("batch engine, with its estimate of the error", "10.4", "543", "742", "142", "238"),
    ("heyoka, batch", "27.0", "956", "not reached", "379", "389"),
    ("heyoka, scalar", "55.0", "3,315", "5,576", "948", "1,154"),
    ("scipy, restarted at events, its best", "3,325", "336,531", "406,508", "not reached",
     "not reached"),
)  # fmt: skip
SPEEDS_BY = "make bench, 25 November 2026, an Intel Xeon, commit 0717e3e"
