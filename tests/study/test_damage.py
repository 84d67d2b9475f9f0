"""A file that is empty, cut off or something else is made again, or refused with the remedy."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.sweeps.io import DatasetError, read_dataset, write_dataset
from study.claims.ledger import read_ledger
from study.tracking import TrackingError
from study.tracking.history import load_history
from study.tracking.reference import verify
from vibralign.device import DeviceError, load_device

PROJECT = Path(__file__).resolve().parents[2]
PEG = PROJECT / "tests" / "square" / "devices" / "peg.yaml"

DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda _: b"",
    "cut off": lambda content: content[: len(content) // 2],
    "zeros": lambda content: bytes(len(content)),
    "a picture": lambda _: b"\x89PNG\r\n\x1a\n\x00\x00\xff",
    "other text": lambda _: b"[1, 2]\n",
}


@dataclass(frozen=True)
class Refused:
    """Writer and reader of a whole file, and what the message of a damaged one must hold."""

    name: str
    write: Callable[[Path], object]
    read: Callable[[Path], object]
    error: type[Exception]
    remedy: str


def small() -> xr.Dataset:
    values = np.arange(2.0)
    return xr.Dataset({"tau_align": ("friction", values)}, attrs={"figure": "fig06"})


RECORD = {"start": 1, "outcome": "done", "started": "2026", "runs": [], "failures": []}
REFUSED = {
    "dataset": Refused(
        "fig06.nc", lambda path: write_dataset(small(), path), read_dataset,
        DatasetError, "build it again",
    ),
    "record of a start": Refused(
        "history/1.json", lambda path: path.write_text(json.dumps(RECORD), encoding="utf-8"),
        lambda path: load_history(path.parents[1]), TrackingError, "delete it",
    ),
    "table": Refused(
        "claims.csv",
        lambda path: path.write_bytes((PROJECT / "tests/reference/claims.csv").read_bytes()),
        read_ledger, ValueError, "build it again",
    ),
    "device": Refused(
        "peg.yaml", lambda path: path.write_bytes(PEG.read_bytes()), load_device, DeviceError, "",
    ),
}  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=list(DAMAGES))
@pytest.mark.parametrize("kind", REFUSED.values(), ids=list(REFUSED))
def test_what_cannot_is_refused_with_the_remedy(tmp_path, kind, damage):
    path = tmp_path / kind.name
    path.parent.mkdir(exist_ok=True)
    kind.write(path)
    path.write_bytes(damage(path.read_bytes()))
    if damage is DAMAGES["cut off"] and kind.name.endswith(".csv"):
        return  # a shorter table; the hash in the record tells
    with pytest.raises(kind.error) as refusal:
        kind.read(path)
    assert str(path) in str(refusal.value)
    assert kind.remedy in str(refusal.value)


def test_a_file_of_another_program_or_an_earlier_version_is_refused(tmp_path, make_dataset):
    foreign = tmp_path / "foreign.nc"
    xr.Dataset({"temperature": ("x", [1.0])}).to_netcdf(foreign)
    with pytest.raises(DatasetError, match="is not a dataset of this study: build it again"):
        read_dataset(foreign)
    for folder, dataset in (("old", make_dataset()), ("new", make_dataset())):
        (tmp_path / folder / "data").mkdir(parents=True)
        write_dataset(dataset, tmp_path / folder / "data" / "fig06.nc")
    write_dataset(make_dataset().drop_vars("reason"), tmp_path / "new" / "data" / "fig06.nc")
    (finding,) = verify(tmp_path / "new", tmp_path / "old" / "data", ["fig06"])
    assert "(No variable named 'reason'): build it again" in finding.words
