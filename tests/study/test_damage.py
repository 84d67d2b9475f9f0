"""A file that is empty, cut off or something else is made again, or refused with the remedy."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from model.compile import cache, machine_code
from model.compile.entries import compiled
from model.compile.kernels import kernel
from model.compile.webassembly import WebAssembly
from model.runs import in_browser
from model.sweeps.io import DatasetError, read_dataset, write_dataset
from study.claims.ledger import read_ledger
from study.csv_tables import TableError
from study.tracking import TrackingError, code
from study.tracking.compare import changed_verdicts
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


@kernel
def halved(x):
    return 0.5 * x


class Kernel:
    """The compiled code of a kernel: compiled again."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(cache, "cache_folder", lambda: folder)
        self.use()
        (self.path,) = folder.iterdir()

    def use(self) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(machine_code, "_LOADED", {})  # as in another process
            assert compiled(halved)(8.0) == 4.0


class Outline:
    """The hash and imports of a source file: worked out again."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(code, "_outlines", lambda: folder)
        self.expected = code._parsed.__wrapped__(Path(code.__file__))
        (self.path,) = folder.iterdir()

    def use(self) -> None:
        assert code._parsed.__wrapped__(Path(code.__file__)) == self.expected


class Page:
    """The engine of a page: compiled again."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
        made = WebAssembly(b"\0asm" + bytes(range(200)), stack=0)
        declared = in_browser._Declared(None, {"given": np.zeros(1)})
        monkeypatch.setattr(in_browser, "_declared", lambda *_: declared)
        monkeypatch.setattr(
            in_browser,
            "_compile_apart",
            lambda folder, shape, scene: in_browser._compile(folder, shape, scene.name),
        )
        monkeypatch.setattr(in_browser, "web_assembly_of", lambda _: made)
        monkeypatch.setattr(in_browser, "_folder", lambda *_: folder / "webassembly")
        self.path = folder / "webassembly" / name
        self.use()

    def use(self) -> None:
        assert in_browser.module_for().binary.startswith(b"\0asm")


MADE_AGAIN: dict[str, Callable[[Path, pytest.MonkeyPatch], Any]] = {
    "kernel": Kernel,
    "outline of a source": Outline,
    "interface of a page": lambda folder, patch: Page(folder, patch, "interface.json"),
    "engine of a page": lambda folder, patch: Page(folder, patch, "engine.wasm"),
}


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=list(DAMAGES))
@pytest.mark.parametrize("kind", MADE_AGAIN.values(), ids=list(MADE_AGAIN))
def test_what_can_be_made_again_is(tmp_path, monkeypatch, kind, damage):
    made = kind(tmp_path, monkeypatch)
    made.use()
    whole = made.path.read_bytes()
    made.path.write_bytes(damage(whole))
    made.use()
    assert len(made.path.read_bytes()) == pytest.approx(len(whole), abs=64)
    made.path.unlink()
    made.use()


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
    "claims": Refused(
        "claims.csv", lambda path: path.write_text("id,verdict\nF6a,reproduced\n", "utf-8"),
        lambda path: changed_verdicts(path, path), TrackingError, "build it again",
    ),
    "table": Refused(
        "claims.csv",
        lambda path: path.write_bytes((PROJECT / "tests/reference/claims.csv").read_bytes()),
        read_ledger, TableError, "build it again",
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
