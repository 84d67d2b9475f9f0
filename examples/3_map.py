"""
A map with its reliable area
============================

Where a peg aligns over tilt stiffness and frequency, how fast, and inside the line from every
phase and tilt at touch-down.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibralign import align, load_device, reliable_at

stated = load_device("peg.yaml")
tilt_stiffness = np.linspace(0.1, 1.2, 24)  # N m/rad
frequency = np.linspace(5.0, 100.0, 24)  # Hz
x, y = np.meshgrid(tilt_stiffness, frequency)

# %%
# Every node is run. The command ``vibralign map`` makes finer maps in less time: it computes nodes
# along borders, and fills those in between.
pairs = zip(x.flat, y.flat, strict=True)
nodes = [stated.changed(tilt_stiffness=k, frequency=f) for k, f in pairs]
duration = 1e3 * stated.units.time * align(nodes).tau_align.reshape(x.shape)
reliable = reliable_at(stated, tilt_stiffness=x.ravel(), frequency=y.ravel()).reshape(x.shape)
print(f"aligns at {np.isfinite(duration).mean():.0%} of the nodes, reliably: {reliable.mean():.0%}")

figure, axes = plt.subplots(layout="constrained")
axes.set_facecolor("lightgrey")  # where it does not align
mesh = axes.pcolormesh(x, y, duration, norm="log")
axes.contour(x, y, reliable, [0.5], colors="tab:orange", linewidths=2.0)
axes.plot(stated.quantities["tilt_stiffness"], stated.quantities["frequency"], "w*")
axes.set(xlabel="tilt stiffness (N m/rad)", ylabel="frequency (Hz)")
figure.colorbar(mesh, label="alignment time (ms)")
plt.show()
