"""Delete what is not as its job left it, below every results root in this folder."""

import sys
from pathlib import Path

from model.tracking.records import discard_damaged


def main() -> None:
    """Do it, and say what was deleted."""
    for history in sorted(Path().glob("*/history")):
        for name in discard_damaged(history.parent):
            print(f"{name}: not as its job left it, will be made anew", file=sys.stderr)


if __name__ == "__main__":
    main()
