"""
A device in SI units from its data sheet
========================================

Peg, holder and vibrator stated with their units: with which amplitude of the vibrator the peg
aligns, how fast, and with which of them it does so from every phase and tilt at touch-down.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibralign import align, load_device, reliable_at

stated = load_device("peg.yaml")
print(*stated.doubts or ["nothing in the sheet looks doubtful"], sep="\n")
print(f"contact stiffness from the materials: {stated.values['contact_stiffness']:.3g} N/m")

amplitude = np.linspace(0.3e-3, 3e-3, 96)  # m
runs = align([stated.changed(amplitude=value) for value in amplitude])
milliseconds = 1e3 * runs.tau_align * stated.units.time
millimetres = 1e3 * amplitude
reliable = reliable_at(stated, amplitude=amplitude)

figure, axes = plt.subplots(layout="constrained")
axes.plot(millimetres, milliseconds, "o", mfc="none", label="from the start of the sheet")
axes.plot(millimetres[reliable], milliseconds[reliable], "o", label="from every start")
axes.axvline(1e3 * stated.quantities["amplitude"], color="grey", linestyle=":", label="the sheet")
axes.set(xlabel="amplitude (mm)", ylabel="alignment time (ms)", yscale="log")
axes.legend()
plt.show()
