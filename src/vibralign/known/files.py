"""Files of a calibration: samples, trials and predictions, and the device file that names them."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from model.sweeps.files import read_text, write_text
from model.sweeps.io import described, write_dataset
from vibralign.answers.maps import quantity_attributes
from vibralign.device import StatedDevice
from vibralign.device.unknown import SAMPLES, SECTION
from vibralign.known.calibrate import Calibration


def _in_words(meaning: str, unit: str) -> dict[str, Any]:
    return {"long_name": meaning, "units": unit}


def dataset_of(found: Calibration) -> xr.Dataset:
    """Return samples, weights, trials and predictions in SI units."""
    variables: dict[str, Any] = {
        name: ("sample", column, quantity_attributes(name)) for name, column in found.sets.items()
    }
    words = "share of what is possible that the sample stands for"
    variables["weight"] = ("sample", found.samples.weights, _in_words(words, "1"))
    trials = found.trials
    times = {
        "observed_time": ([t.time for t in trials], "alignment time, NaN where it did not align"),
        "waited": ([t.waited for t in trials], "time after which it had failed or was stopped"),
    }
    for name, (column, meaning) in times.items():
        seconds = [np.nan if each is None else each for each in column]
        variables[name] = ("trial", seconds, _in_words(meaning, "s"))
    quantiles = np.where(np.isfinite(found.fit.times), found.fit.times, np.nan)
    words = "predicted alignment time, NaN where it fails"
    variables["predicted_time"] = (("trial", "quantile"), quantiles, _in_words(words, "s"))
    words = "probability of the result as the other trials predict it, from both ends"
    variables["predicted"] = ("trial", np.array(found.fit.predicted), _in_words(words, "1"))
    for name in sorted({n for t in trials for n in t.device.changes if n in t.device.quantities}):
        own = np.array([t.device.quantities[name] for t in trials])
        key = f"trial_{name}" if name in variables else name
        variables[key] = ("trial", own, quantity_attributes(name))
    rows = [t.row for t in trials]
    coordinates = {
        "trial": ("trial", rows, _in_words("row of the table", "1")),
        "quantile": ("quantile", [0.05, 0.5, 0.95], _in_words("quantile", "1")),
    }
    attributes = {
        "title": "What trials tell of a device",
        "summary": f"Samples of {', '.join(found.sets)} that {len(trials)} trials leave possible, "
        "with their weights, and what they predict of each trial.",
        "device": str(found.device.source),
        "effective_sample_size": found.samples.effective,
        "horizon": found.horizon,
        "fit": found.fit.share,
    }
    return described(xr.Dataset(variables, coordinates, attributes))


def device_text(device: StatedDevice, samples: str) -> str:
    """Return the file of a device with the line that names its samples.

    Raises:
        ValueError: quantities were changed, which the file does not have.
    """
    if device.changes:
        words = ", ".join(device.changes)
        raise ValueError(f"--out: the file would not have --set {words}: write it into the file")
    lines = read_text(device.source).rstrip("\n").splitlines()
    kept = [line for line in lines if not line.startswith(f"{SAMPLES}:")]
    return "\n".join([*kept, f"{SAMPLES}: {samples} # what trials leave of {SECTION}", ""])


def write(found: Calibration, path: Path) -> Path:
    """Write the samples beside ``path``, then the device file; return the path of the samples."""
    samples = path.with_suffix(".nc")
    text = device_text(found.device, samples.name)
    write_dataset(dataset_of(found), samples)
    write_text(text, path)
    return samples
