"""The environment of the benchmark holds everything that its start needs."""

import re
import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
# As in an environment without ``absent``; peers are imported one by one, and later.
_START = """
import sys
from importlib.abc import MetaPathFinder

class Absent(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] in absent:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
import verification.bench.__main__
"""


def start_without(absent):
    return subprocess.run(
        [sys.executable, "-c", f"absent = {sorted(absent)!r}{_START}"],
        cwd=ROOT, check=False, capture_output=True, text=True,
    )  # fmt: skip


def test_the_benchmark_starts_with_no_more_than_its_lock_file_has():
    lock = (ROOT / "requirements-bench.lock").read_text(encoding="utf-8")
    present = set(re.findall(r"^([a-z0-9][a-z0-9._-]*)==", lock, flags=re.MULTILINE))
    present |= {"vibralign"}
    absent = {
        module
        for module, distributions in packages_distributions().items()
        if not present & {re.sub(r"[-_.]+", "-", name).lower() for name in distributions}
    } - set(sys.stdlib_module_names)
    assert "snakemake" in absent
    run = start_without(absent)
    assert run.returncode == 0, run.stderr
