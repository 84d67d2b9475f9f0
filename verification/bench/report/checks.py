"""Alignment times and speed beside those of other codes, as last measured: for report and docs.

They take minutes and an environment of their own, so that no build of the study makes them anew.
"""

# Random sets that align, which a second code ran as well: what it states again, and so shares no
# error in; number of sets; how many agree, and how far alignment times are apart.
HEAD = ("code", "states again", ">sets", "agree", ">apart: median", ">largest", "by", "commit")
CHECKS = (
    (
        "independent solution", "contacts, friction, events, transitions",
        "215", "214 within the estimated errors, all within ten times them", "4 × 10⁻¹³",
        "3 × 10⁻¹⁰", "make accuracy, its first 500 sets", "ac68ce1",
    ),
    (
        "heyoka 7.13, tolerance 10⁻¹⁵", "equations of motion, events under one edge",
        "600", "600 within the estimated errors", "4 × 10⁻¹³", "8 × 10⁻¹⁰",
        "a command of that commit", "ac68ce1",
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
