"""
A sweep with error bars
=======================

The alignment time over the press force, from runs that are coarse on purpose: every time comes with
an estimate of its error, and the true error is smaller.
"""

import matplotlib.pyplot as plt
import numpy as np

from vibralign import Batch, align, load_device

ENLARGED = 10_000  # the bars, to be seen at all

device = load_device("peg.yaml")
press_force = np.linspace(0.8, 2.0, 61) * device.parameters.press_force
batch = Batch.of(device.parameters, press_force=press_force)
coarse = align(batch, shape=device.shape, tolerance=1e-5)
fine = align(batch, shape=device.shape, tolerance=1e-12)

newtons, to_ms = press_force * device.units.force, 1e3 * device.units.time
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
