"""
A study in one call
===================

How fast the peg aligns over frequency and amplitude, and where it does so from every phase of the
vibrator: ranges with units in, a dataset with units out, drawn by xarray.
"""

import matplotlib.pyplot as plt
import numpy as np

import vibralign
from vibralign import Outcome

# %%
# One call runs all nodes; text has units, numbers are in SI units.
phases = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
study = vibralign.sweep(
    "peg.yaml", frequency="20..120 Hz", amplitude="0.5..3 mm", phase=phases, points=24
)

# %%
# The outcome is a flag, the error an estimate, and what the answer assumes stands beside them.
aligned = study.outcome == Outcome.ALIGNED
print(f"{100 * float(aligned.mean()):.0f} % of {aligned.size:,} runs align")
print(f"the largest error among them is {float(study.tau_error.max()):.1g} {study.tau_error.units}")

# %%
# xarray draws with names and units: the longest time over the phases, where all of them align.
longest = study.tau_align.where(aligned).max("phase", skipna=False, keep_attrs=True)
longest.plot(x="frequency")
plt.title("from every phase of the vibrator")
plt.show()
