"""Files of a calibration: weighted samples, and the device file that names them."""

from pathlib import Path
from typing import Any

import xarray as xr

from model.sweeps.files import read_text, write_text
from model.sweeps.io import described, write_dataset
from vibralign.answers.maps import quantity_attributes
from vibralign.device import StatedDevice
from vibralign.device.unknown import SAMPLES, SECTION
from vibralign.known.calibrate import Calibration


def dataset_of(found: Calibration) -> xr.Dataset:
    """Return samples and weights in SI units."""
    variables: dict[str, Any] = {
        name: ("sample", column, quantity_attributes(name)) for name, column in found.sets.items()
    }
    words = "share of what is possible that the sample stands for"
    described_weight = {"long_name": words, "units": "1"}
    variables["weight"] = ("sample", found.samples.weights, described_weight)
    attributes = {
        "title": "What trials tell of a device",
        "summary": f"Samples of {', '.join(found.sets)} that {len(found.trials)} trials leave "
        "possible, with their weights.",
        "device": str(found.device.source),
        "effective_sample_size": found.samples.effective,
        "horizon": found.horizon,
        "fit": found.fit.share,
    }
    return described(xr.Dataset(variables, attrs=attributes))


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
