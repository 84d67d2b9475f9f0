"""
A round peg and a square one
============================

Lowered still, pressed and then vibrated, a round peg is reliable on less of both planes than the
same one, square: the legends have the shares. Beyond the dotted line the press does not tilt a
round part, and only those that the vibration lifts off go in.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from vibralign import load_device, reliable_at

stated = load_device("peg.yaml").changed(vibrator="still", approach_speed="10 mm/s")
planes = {  # quantities with their symbols and ranges, in mm, N and Hz
    "misalignment": (np.linspace(0.25, 2.0, 12), "press_force", "N", np.linspace(1.0, 25.0, 12)),
    "amplitude": (np.linspace(0.1, 3.0, 12), "frequency", "Hz", np.linspace(5.0, 150.0, 12)),
}
figure, panels = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
shares = {}
for axes, (across, (mm, upward, unit, values)) in zip(panels, planes.items(), strict=True):
    x, y = np.meshgrid(mm, values)
    points = {across: 1e-3 * x.ravel(), upward: y.ravel()}
    for shape, colour in (("square", "tab:blue"), ("round", "tab:orange")):
        reliable = reliable_at(replace(stated, stated_shape=shape), **points).reshape(x.shape)
        shares[across, shape] = share = reliable.mean()
        axes.contourf(x, y, reliable, [0.5, 1.5], colors=colour, alpha=0.4)
        axes.contour(x, y, reliable, [0.5], colors=colour)
        axes.plot([], [], color=colour, label=f"{shape}: {share:.0%}")
    axes.set(xlabel=f"{across} (mm)", ylabel=f"{upward.replace('_', ' ')} ({unit})")
    axes.legend(title="reliable", loc="upper right")
a, delta = stated.quantities["half_width"], stated.quantities["clearance"]
panels[0].axvline(1e3 * a * np.sqrt(2.0 * delta), color="black", linestyle=":")
plt.show()
