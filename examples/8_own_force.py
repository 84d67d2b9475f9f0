"""
A force of one's own
====================

A cable pulls at the peg: the edits of the how-to give this force to a copy of the package.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import vibralign

ABOVE, TERM = "    press_force: float", "lateral_suspension(q, p),"
NEW = '    side_pull: float = entry("f_x", "pull of a cable", FORCE, default=0.0)\n'
EDITS = {"parameters": (ABOVE, NEW + ABOVE), "forces": (TERM, f"{TERM[:-1]} + p.side_pull,")}
RUN = """import json, sys; from vibralign import load_device, simulate
for pull in sys.argv[1:]:
    run = simulate(load_device("peg.yaml", {"side_pull": pull}), horizon=11.0, tolerance=1e-6)
    print(json.dumps([run.time.tolist(), run.state[:, 0].tolist()]))"""
PULLS = ("-0.5 N", "0 N", "0.5 N")
with tempfile.TemporaryDirectory() as folder:
    for package in ("model", "vibralign"):
        shutil.copytree(Path(vibralign.__file__).parents[1] / package, Path(folder) / package)
    for name, edit in EDITS.items():
        file = Path(folder) / f"model/physics/{name}.py"
        file.write_text(file.read_text("utf-8").replace(*edit), "utf-8")
    own = {**os.environ, "PYTHONPATH": folder, "VIBRALIGN_NO_COMPILATION": "1"}  # not worth it
    printed = subprocess.check_output([sys.executable, "-c", RUN, *PULLS], env=own)
for pull, path in zip(PULLS, printed.splitlines(), strict=True):
    plt.plot(*json.loads(path), label=f"pulled by {pull}")
plt.gca().set(xlabel="time, dimensionless", ylabel="distance of the axes, dimensionless")
plt.legend()
plt.show()
