"""
A sweep with error bars
=======================

The alignment time over the press force, from runs that are coarse on purpose: every time comes with
an estimate of its error, and the true error is smaller.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibralign import align, load_device

ENLARGED = 10_000  # the bars, to be seen at all

device = load_device("peg.yaml")
newtons = np.linspace(0.8, 2.0, 61) * device.quantities["press_force"]
devices = [device.changed(press_force=force) for force in newtons]
coarse, fine = align(devices, tolerance=1e-5), align(devices, tolerance=1e-12)

to_ms = 1e3 * device.units.time
time, estimated = coarse.tau_align * to_ms, coarse.tau_error * to_ms
true = np.abs(coarse.tau_align - fine.tau_align) * to_ms

figure, (times, errors) = plt.subplots(2, 1, sharex=True, layout="constrained")
times.errorbar(newtons, time, ENLARGED * estimated, fmt=".", capsize=3)
times.set(ylabel="alignment time (ms)", title=f"error bars {ENLARGED:,} times as long")
errors.semilogy(newtons, estimated, ".", label="estimated")
errors.semilogy(newtons, true, "x", label="true")
errors.set(xlabel="press force (N)", ylabel="error (ms)")
errors.legend()
plt.show()
