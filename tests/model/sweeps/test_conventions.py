"""Every kind of file that the project writes keeps to CF and ACDD, by the checker of IOOS."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from model.sweeps.axes import Axis
from model.sweeps.io import write_dataset
from model.sweeps.settings import Ensemble, RunSettings
from model.sweeps.sweep import Sweep, merge, run
from model.sweeps.version import version
from study.config import Study
from study.config.identification import Grid
from study.evidence.cases import cases_dataset, cases_plan
from study.plans import sweep_of
from vibralign import Parameters
from vibralign.answers.maps import QuantityAxis, map_of
from vibralign.device import load_device

PEG = Path(__file__).resolve().parents[2] / "square" / "devices" / "peg.yaml"
# The checker seeks the coordinates of a file anew for each variable: five sixths of its time.
CHECKER = """
import sys
from functools import cache

from compliance_checker.cf import util
from compliance_checker.runner import CheckSuite, ComplianceChecker

for name in ("get_auxiliary_coordinate_variables", "get_geophysical_variables"):
    setattr(util, name, cache(getattr(util, name)))
CheckSuite.load_all_available_checkers()
*files, out = sys.argv[1:]
suites = ["cf:1.11", "acdd:1.3"]
ComplianceChecker.run_checker(
    files, suites, 0, "strict", output_filename=out, output_format=["json_new"]
)
"""


def map_over_force(device: Parameters) -> Sweep:
    settings = RunSettings(readings="consistent", horizon=20.0, tolerance=1e-6)
    x = Axis(parameter="tilt_stiffness", start=2.0, stop=16.0, count=3)
    y = Axis(parameter="press_force", start=1.0, stop=9.0, count=3)
    variables = "outcome", "reason", "tau_align", "tau_error", "contact_force_max"
    return Sweep(
        name="map", kind="map", parameters=device.given(), settings=settings, dimensions=[y, x],
        variables=variables, ensemble=Ensemble(phases=2, tilts=[1.0], every=1),
    )  # fmt: skip


def map_in_si() -> Sweep:
    settings = RunSettings(readings="consistent", horizon=20.0, tolerance=1e-6)
    x = QuantityAxis(parameter="tilt_stiffness", start=0.3, stop=1.0, count=3)
    y = QuantityAxis(parameter="gripper_tilt", start=0.001, stop=0.003, count=3)
    starts = Ensemble(phases=2, tilts=[1.0], every=1)
    return map_of(load_device(PEG), settings, (x, y), starts)


def few(study: Study, name: str) -> Sweep:
    """A sweep with two values of each parameter."""
    sweep = sweep_of(study, name)
    dimensions = [
        part.model_copy(update={"count": 2} if isinstance(part, Axis) else {})
        for part in sweep.dimensions
    ]
    return Sweep.model_validate({**sweep.model_dump(), "dimensions": dimensions})


def swept(study: Study, name: str) -> xr.Dataset:
    sweep = few(study, name)
    return merge(sweep, name, [run(sweep)])


def judged(study: Study) -> xr.Dataset:
    """Verdicts by case."""
    counts = dict.fromkeys(study.named("curves", "map"), 3) | {"fig05": 1}
    tiny = Grid(counts=counts, horizon=1.0, tolerance=1e-4)
    plan = cases_plan(study)
    return cases_dataset(
        plan.model_copy(update={"grid": tiny, "near": 1, "assumptions": {}}), np.arange(3)
    )


@pytest.fixture(scope="module")
def written(
    small_study: Callable[[int, int], Study],
    device: Parameters,
    tmp_path_factory: pytest.TempPathFactory,
) -> dict[str, Path]:
    """A file of every kind: the figures' are like the two sweeps, a map like that in SI units."""
    study, in_si = small_study(4, 3), map_in_si()
    forces = map_over_force(device)
    datasets = {
        **{name: swept(study, name) for name in ("fig05", "jamming")},
        "chunk": run(few(study, "fig06"), 0, 2),
        "map": merge(forces, "A map", [run(forces)]),
        "map_in_si": merge(in_si, "A map", [run(in_si)]),
        "cases": judged(study),
    }
    paths = {kind: tmp_path_factory.mktemp("files") / f"{kind}.nc" for kind in datasets}
    for kind, dataset in datasets.items():
        write_dataset(dataset, paths[kind])
    return paths


def test_the_checker_finds_nothing_wanting(written, tmp_path):
    """At every level of CF, and of what ACDD highly recommends but names of CF's own table.

    That table has quantities of the Earth, and no tilt of a peg.
    """
    out = tmp_path / "report.json"
    command = [sys.executable, "-c", CHECKER, *map(str, written.values()), str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    reports = json.loads(out.read_text(encoding="utf-8"))
    assert len(reports) == len(written)
    wanting = [
        (Path(file).name, each["name"], message)
        for file, report in reports.items()
        for suite, levels in {"cf:1.11": "all", "acdd:1.3": "high"}.items()
        for each in report[suite][f"{levels}_priorities"]
        for message in each["msgs"]
        if message != "standard_name"
    ]
    assert wanting == []


def test_every_file_says_where_it_comes_from(written):
    for path in written.values():
        with netCDF4.Dataset(path) as file:
            assert file.Conventions == "CF-1.11, ACDD-1.3"
            assert file.history == f"written by vibralign {version()}"
            assert file.product_version == version()
            assert file.creator_name == "vibralign contributors"
            assert "Baskutienė" in file.references
            assert file.keywords
            assert file.citation


def test_nan_is_a_missing_value_and_an_angle_is_in_radians(written):
    with netCDF4.Dataset(written["map_in_si"]) as file:
        assert np.isnan(file["tau_align"]._FillValue)
        assert "_FillValue" not in file["gripper_tilt"].ncattrs()
        assert np.ma.is_masked(file["tau_align"][:])
        assert file["gripper_tilt"].units == file["phase"].units == "radian"
        assert file["inertia"].units == "kg m²"
    with netCDF4.Dataset(written["fig05"]) as file:
        assert file["tilt"].units == file["rest_tilt"].units == "radian"
        assert file["time"].dimensions == file["tilt"].dimensions == ("sample",)
        assert "time" in file["tilt"].coordinates.split()


def test_a_pressed_start_is_stated(fixed_study):
    pressed = fixed_study.settings.model_copy(update={"start": "pressed"})
    study = fixed_study.model_copy(update={"settings": pressed})
    assert swept(study, "fig06").attrs["start"] == "pressed"
    assert swept(fixed_study, "fig06").attrs["start"] == "simultaneous"
