"""
One run with its forces
=======================

A peg is pressed beside its hole and vibrated: its path, and the forces on it, until it is inserted.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibralign import INSERTION, load_device, simulate

device = load_device("peg.yaml")
units = device.units
run = simulate(device, scene=INSERTION)
print(f"{run.message}; aligned after {1e3 * run.tau_align * units.time:.1f} ms")

time = 1e3 * run.time * units.time
x, _, tilt = run.state.T[:3]
forces = {
    "under both tips": run.contact_force * units.force,
    "left side": run.side_force * units.force,
    "right side": run.right_force * units.force,
}

figure, (path, loads) = plt.subplots(2, 1, sharex=True, layout="constrained")
path.plot(time, 1e3 * x * units.amplitude, label="lateral distance (mm)")
path.plot(time, 1e3 * run.depth * units.amplitude, label="depth (mm)")
path.plot(time, np.degrees(tilt), label="tilt (degrees)")
for place, force in forces.items():
    loads.plot(time, force, label=place)
for axes in (path, loads):
    axes.axvline(1e3 * run.tau_align * units.time, color="grey", linestyle=":")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3)
loads.set(xlabel="time (ms)", ylabel="normal force (N)")
plt.show()
