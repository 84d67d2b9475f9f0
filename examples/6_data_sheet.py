"""
A device in SI units from its data sheet
========================================

Peg, holder and vibrator stated with their units: with which tilt stiffness the peg aligns, how
fast, and with which of them it does so from every phase and tilt at touch-down.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibralign import align, load_device, reliable_at

stated = load_device("peg.yaml")
print(*stated.doubts or ["nothing in the sheet looks doubtful"], sep="\n")
print(f"contact stiffness from the materials: {stated.values['contact_stiffness']:.3g} N/m")

stiffness = np.linspace(0.05, 1.0, 96)  # N m/rad
runs = align([stated.at({"tilt_stiffness": value}).parameters for value in stiffness])
milliseconds = 1e3 * runs.tau_align * stated.units.time
reliable = reliable_at(stated, tilt_stiffness=stiffness)

figure, axes = plt.subplots(layout="constrained")
axes.plot(stiffness, milliseconds, "o", markerfacecolor="none", label="from the start of the sheet")
axes.plot(stiffness[reliable], milliseconds[reliable], "o", label="from every start")
axes.axvline(stated.quantities["tilt_stiffness"], color="grey", linestyle=":", label="the sheet")
axes.set(xlabel="tilt stiffness (N m/rad)", ylabel="alignment time (ms)", yscale="log")
axes.legend()
plt.show()
