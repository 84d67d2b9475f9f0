"""Campaign of `make fuzz`: run random sets and print every property that they break."""

import argparse
import sys
from collections import Counter
from time import perf_counter

from verification.fuzz import SETTINGS, UNEXPLAINED_SHARE, Finding, try_sets

_AT_ONCE = 2000
_SHOWN = 10  # findings of each kind


def main() -> int:
    """Run the campaign of the command line; return 1 if a property is broken, else 0."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=10_000, help="how many")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--seed", type=int, default=2007)
    arguments = parser.parse_args()
    if arguments.sets < 1 or arguments.first < 0 or arguments.seed < 0:
        parser.error("--sets must be >= 1, --first and --seed >= 0")
    started = perf_counter()
    endings: Counter[str] = Counter()
    findings: list[Finding] = []
    unexplained: list[Finding] = []
    sensitive = done = near = alone = 0
    for first in range(0, arguments.sets, _AT_ONCE):
        count = min(_AT_ONCE, arguments.sets - first)
        report = try_sets(arguments.seed, arguments.first + first, count)
        endings.update(report.endings)
        findings += report.findings
        unexplained += report.unexplained
        sensitive += report.sensitive
        near += report.against_neighbour
        alone += report.against_reference
        done += count
        for finding in report.findings:
            print(f"set {finding.number}: {finding.what}: {finding.found}", flush=True)
        if first // _AT_ONCE % 10 == 0:
            print(f"{done} sets, {len(findings)} findings, {perf_counter() - started:.0f} s",
                  flush=True)  # fmt: skip
    print(f"{done} sets of seed {arguments.seed} from {arguments.first}, horizon "
          f"{SETTINGS.horizon:g}, tolerance {SETTINGS.tolerance:g}, at most "
          f"{SETTINGS.max_evaluations} evaluations a run; {sensitive} sensitive; "
          f"{near} compared with a neighbour, {alone} with the reference engine")  # fmt: skip
    for name, number in endings.most_common():
        print(f"{number:9}  {name}")
    told = findings + unexplained
    for what, number in Counter(finding.what for finding in told).items():
        print(f"{number} sets: {what}")
        for finding in [each for each in told if each.what == what][:_SHOWN]:
            print(f"    set {finding.number}: {finding.found}")
    if not findings:
        print("every property holds")
    return 1 if findings or len(unexplained) > UNEXPLAINED_SHARE * done else 0


if __name__ == "__main__":
    sys.exit(main())
