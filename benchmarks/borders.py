"""Error estimates along scans through borders of alignment: ``python -m benchmarks.borders``.

Random devices, drawn by the law of ``make accuracy``, are scanned through their frequency, and by
fewer values through every other parameter that is not zero, from half its value to twice. Scans
that meet no border of alignment are left out. Alignment times at several tolerances are compared
with those at ``TIGHT``. The table tells, of the errors that are not flagged, the shares below the
estimate and below ten times it (decision 3), and the largest error over its estimate.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from study.config import load_study, study_path
from verification.accuracy import TIGHT
from verification.trials import trial_of
from vibralign import Batch, Outcome, Parameters, Settings, align

TOLERANCES = (1e-6, 1e-8, 1e-10)
_SHARE_OF_FREQUENCIES = 0.1  # values of another parameter over those of the frequency

Floats = NDArray[np.float64]


def scan(device: Parameters, name: str, count: int) -> Batch:
    """Return ``count`` sets with a parameter from half its value to twice, in equal ratios."""
    value: float = getattr(device, name)
    return Batch.of(device, **{name: value * np.geomspace(0.5, 2.0, count)})


def errors_over_estimates(batch: Batch, settings: Settings, tolerance: float) -> Floats:
    """Return |error| over estimate of the alignments that are not flagged, shape (alignments,).

    A set that ends otherwise than at ``TIGHT`` counts as an infinite error. The estimate at
    ``TIGHT`` is added to that of the run. Empty if the batch meets no border of alignment.
    """
    truth = align(batch, settings, tolerance=TIGHT)
    aligns = truth.outcome == Outcome.ALIGNED
    if aligns.all() or not aligns.any():
        return np.empty(0)
    runs = align(batch, settings, tolerance=tolerance)
    judged = ~(runs.sensitive | truth.sensitive) & (aligns | (runs.outcome == Outcome.ALIGNED))
    ratio = np.abs(runs.tau_align - truth.tau_align) / (runs.tau_error + truth.tau_error)
    found: Floats = np.where(np.isfinite(ratio), ratio, np.inf)[judged]
    return found


def scans(devices: int, count: int) -> Iterator[Batch]:
    """Yield the scans of random devices."""
    trial = trial_of(load_study(study_path()), "error")
    batch = trial.batch(np.arange(devices))
    for device in (batch[i] for i in range(devices)):
        for name, value in device.given().items():
            if value:
                fewer = max(2, round(_SHARE_OF_FREQUENCIES * count))
                yield scan(device, name, count if name == "frequency" else fewer)


def line(tolerance: float, ratios: Floats) -> str:
    """Return a row of the table."""
    below, nearly = 100.0 * np.mean(ratios <= 1.0), 100.0 * np.mean(ratios <= 10.0)
    return f"{tolerance:9.0e} {ratios.size:8d} {below:7.2f} % {nearly:7.2f} % {ratios.max():8.2g}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.borders", description=__doc__)
    parser.add_argument("--devices", type=int, default=20)
    parser.add_argument("--frequencies", type=int, default=4000)
    given = parser.parse_args(arguments)
    settings = Settings(alignment_only=True)
    sys.stdout.write("tolerance   errors   below  below ten   worst\n")
    batches = list(scans(given.devices, given.frequencies))
    for tolerance in TOLERANCES:
        ratios = [errors_over_estimates(batch, settings, tolerance) for batch in batches]
        sys.stdout.write(line(tolerance, np.concatenate(ratios)) + "\n")
        sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
