"""
Without vibration
=================

The same peg, pressed the same way: vibrated it creeps into its hole, not vibrated it rests tilted
on the edge.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibralign import load_device, simulate

device = load_device("peg.yaml")
runs = {
    "vibrated": simulate(device),
    "only pressed": simulate(device.changed(frequency=0.0)),
}

figure, (across, tilts) = plt.subplots(2, 1, sharex=True, layout="constrained")
for name, run in runs.items():
    print(f"{name}: {run.message}")
    time = 1e3 * run.time * device.units.time
    x, _, tilt = run.state.T[:3]
    across.plot(time, 1e3 * x * device.units.amplitude, label=name)
    tilts.plot(time, np.degrees(tilt), label=name)
across.set_ylabel("distance of the axes (mm)")
across.legend()
tilts.set(xlabel="time (ms)", ylabel="tilt (degrees)")
tilts.set_xlim(0.0, 3e3 * runs["vibrated"].time[-1] * device.units.time)
plt.show()
