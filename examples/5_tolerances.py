"""
Tolerances and yield
====================

A device with the tolerances of its sheet: the share of devices that align whatever the phase of the
vibrator at touch-down, and the quantities that are to blame for the others.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibralign import Settings, load_device, yield_of

stated = load_device("peg.yaml", {"misalignment": "0.9 mm ± 0.5 mm"})  # worse than its sheet
phases = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
starts = [{"phase": phase, "gripper_tilt": 0.001} for phase in phases]
found, drawn = yield_of(stated, starts, Settings(tolerance=1e-6), devices=512)
print(found.blame)  # of the failures, and of the spread of times
print(f"{100 * found.share:.1f} % align, {100 * found.low:.1f} to {100 * found.high:.1f} %")

figure, (devices, blame) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
for goes_in, mark, name in ((True, ".", "aligns"), (False, "x", "does not")):
    some = drawn.goes_in == goes_in
    misalignment = 1e3 * drawn.values["misalignment"][some]
    devices.plot(drawn.values["friction"][some], misalignment, mark, label=name)
devices.set(xlabel="friction", ylabel="misalignment (mm)")
devices.legend()
indices = found.sobol_indices[::-1]
blame.barh([each.quantity for each in indices], [each.failure for each in indices])
blame.set_xlabel("total Sobol' index of failure")
plt.show()
