"""Files: links, long names and full disks; YAML that says something else than it seems to."""

import errno
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.sweeps.files import parse_yaml, write_text
from model.sweeps.io import read_dataset, write_dataset
from vibralign.commands.files import check_file

DATASET = xr.Dataset({"x": ("n", np.arange(5000.0) ** 0.5)}, attrs={"figure": "fig06"})


@contextmanager
def small_files(size: int) -> Iterator[None]:
    """Limit files to ``size`` bytes: writing more fails, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("size", [0, 10_000])
def test_a_dataset_that_does_not_fit_names_the_cause_and_leaves_the_old_one(tmp_path, size):
    path = tmp_path / "map.nc"
    write_dataset(DATASET, path)
    before = path.read_bytes()
    assert len(before) > 10_000
    for write in (write_dataset, lambda _, path: write_text("x" * 20_000, path)):
        with small_files(size), pytest.raises(OSError, match="too large") as refusal:
            write(DATASET, path)
        assert (refusal.value.errno, refusal.value.filename) == (errno.EFBIG, str(path))
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_what_a_link_points_to_is_replaced(tmp_path):
    disk, link = tmp_path / "disk", tmp_path / "map.nc"
    disk.mkdir()
    link.symlink_to(disk / "old.nc")
    check_file(link, "--out", ["nc"])
    write_dataset(DATASET, link)
    assert link.is_symlink()
    assert read_dataset(disk / "old.nc").equals(DATASET)
    assert [path.name for path in disk.iterdir()] == ["old.nc"]
    link.unlink()
    link.symlink_to(tmp_path / "nowhere/old.nc")
    with pytest.raises(ValueError, match=r"--out .*map.nc: a link into .*nowhere, which does not"):
        check_file(link, "--out", ["nc"])


def test_a_name_is_as_long_as_the_system_allows(tmp_path):
    longest = tmp_path / f"{'x' * 252}.nc"
    check_file(longest, "--out", ["nc"])
    write_text("", longest)
    with pytest.raises(ValueError, match=r"--out .*: File name too long"):
        check_file(Path(tmp_path, f"{'x' * 253}.nc"), "--out", ["nc"])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: {b: 1, b: 2}", "line 1: b: given twice"),
        ("a: 1\nb: [2]\na: 3", "line 3: a: given twice"),
        ("horizon: 0300", "line 1: YAML takes 0300 for a number of base 8 or 60"),
        ("horizon: 5:00", "YAML takes 5:00 for a number of base 8 or 60"),
        ("a: 1\nmass:\t0.3 kg\n\tb: 1", "has a tab, which YAML refuses: write spaces"),
    ],
)
def test_yaml_that_may_mean_two_things_is_refused(text, words):
    with pytest.raises(ValueError, match=words):
        parse_yaml(text)


def test_other_yaml_is_read_as_it_stands():
    text = "a: 0\nb: 0.5\nc: [1, 2.5e+3, '050', 10:00 h]\nd: {a: }\n"
    expected = {"a": 0, "b": 0.5, "c": [1, 2500.0, "050", "10:00 h"], "d": {"a": None}}
    assert parse_yaml(text) == expected
    assert parse_yaml("") is None
