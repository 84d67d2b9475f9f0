"""Solve the cases of the study by the independent solution, and keep them: stored.csv beside it.

``python -m verification.bench.store``: some 20 seconds, after an edit of a case or of the solver.
"""

import csv

from study.config import load_study, study_path
from verification.bench.plans import independent_cases
from verification.independent import solve
from verification.independent.stored import TABLE, key_of

_HEAD = ("key", "ending", "time", "tau", "x", "y", "tilt", "x_rate", "y_rate", "tilt_rate")


def main() -> None:
    """Write the table."""
    rows = []
    for parameters, horizon in independent_cases(load_study(study_path())).values():
        found = solve(parameters, horizon)
        numbers = [repr(float(each)) for each in (found.time, found.tau, *found.state)]
        rows.append([key_of(parameters, horizon), found.ending, *numbers])
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([_HEAD, *rows])


if __name__ == "__main__":
    main()
