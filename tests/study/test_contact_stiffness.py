"""Figures on other bases: the bases, and the differences found."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr

from model.runs.simulate import simulate
from model.study.config import Study, load_study, study_path
from model.study.contact_comparison import (
    OnBase,
    claims_on_bases,
    on_bases,
    settled_from,
    stiffest,
)
from model.study.contact_stiffness import (
    RATIO,
    VARIATION,
    critical_damping,
    stiffness_dataset,
    stiffness_plan,
    variations_of,
)
from tests.study.claims_data import NAN, curves, falling, within


@pytest.fixture(scope="module")
def study() -> Study:
    """The study with few bases and points."""
    full = load_study(study_path())
    spec = full.contact_stiffness
    figures = {
        "fig06": spec.figures["fig06"].model_copy(update={"points": 3}),
        "fig13": spec.figures["fig13"].model_copy(update={"points": 2}),
    }
    few: dict[str, Any] = {"stiffnesses": [30.0, 1000.0], "damped_at": [100.0], "figures": figures}
    small = spec.model_copy(update={**few, "damping_ratios": [0.0, 1.0]})
    return full.model_copy(update={"contact_stiffness": small})


def test_critical_damping_is_where_the_contact_stops_oscillating(study: Study) -> None:
    device = study.parameters("fig06").replace(
        lateral_stiffness=0.0, lateral_damping=0.0, axial_damping=0.0, tilt_damping=0.0,
        tilt_stiffness=0.0, friction=0.0, frequency=0.0, press_force=100.0, initial_tilt=0.0,
    )  # fmt: skip
    stiffness = 1e6  # then what is not the contact hardly moves during one oscillation

    def swings(ratio: float) -> bool:
        """Return True if the edge passes its depth at rest on the way into the face."""
        damping = ratio * critical_damping(device, stiffness)
        given = device.replace(contact_stiffness=stiffness, contact_damping=damping)
        run = simulate(given, horizon=0.02)
        x, y, tilt = run.state[:, :3].T
        depth = given.half_height - (given.slot_half_width - x) * np.sin(tilt) - y * np.cos(tilt)
        return bool(depth.max() > 1.001 * depth[-1])

    assert swings(0.8)
    assert not swings(1.1)


def test_the_devices_own_base_comes_first_and_only_once(study: Study) -> None:
    variations = variations_of(study, "fig06")
    own = study.parameters("fig06")
    assert variations[0].stiffness == own.contact_stiffness
    assert variations[0].damping == pytest.approx(own.contact_damping)
    assert [each.stiffness for each in variations] == [100.0, 30.0, 1000.0, 100.0, 100.0]
    assert [each.ratio for each in variations[3:]] == [0.0, 1.0]
    assert len({each.ratio for each in variations[:3]}) == 1
    assert variations[3].damping == 0.0


def test_a_plan_changes_the_base_and_nothing_else(study: Study) -> None:
    plan = stiffness_plan(study, "fig13")
    own = study.parameters("fig13").given()
    for variation, sweep in zip(plan.variations, plan.sweeps, strict=True):
        base = {"contact_stiffness": variation.stiffness, "contact_damping": variation.damping}
        assert sweep.parameters == pytest.approx({**own, **base}, nan_ok=True) or all(
            sweep.parameters[name] == value for name, value in {**own, **base}.items()
        )
        assert sweep.shape == (2, 2)
        assert sweep.settings.horizon == study.contact_stiffness.horizon
    other = study.model_copy(
        update={"contact_stiffness": study.contact_stiffness.model_copy(update={"horizon": 50.0})}
    )
    assert stiffness_plan(other, "fig13").identity != plan.identity


def test_a_dataset_has_every_base_along_one_dimension(study: Study) -> None:
    plan = stiffness_plan(study, "fig06")
    dataset = stiffness_dataset(plan, "Fig. 6")
    assert dataset["tau_align"].dims == (VARIATION, "tilt_stiffness", "press_force")
    assert dataset["tau_align"].shape == (5, 3, 3)
    assert dataset["contact_stiffness"].dims == dataset[RATIO].dims == (VARIATION,)
    assert dataset["contact_stiffness"].values.tolist() == [100.0, 30.0, 1000.0, 100.0, 100.0]
    assert dataset["friction"].dims == ()
    assert dataset.attrs["sweep"] == plan.identity
    rows = on_bases(dataset)
    assert [row.stiffness for row in rows] == dataset["contact_stiffness"].values.tolist()
    assert rows[stiffest(dataset)].other_end == 0.0


def made_up(*bases: tuple[float, float, Any]) -> xr.Dataset:
    """Fig. 6 on bases of (stiffness, ratio, duration)."""
    parts = [
        curves("fig06", tau)["fig06"].assign_coords(contact_stiffness=k, damping_ratio=ratio)
        for k, ratio, tau in bases
    ]
    varied = ["contact_stiffness", RATIO]
    return xr.concat(parts, VARIATION, coords=varied, combine_attrs="override")


def test_differences_are_counted_against_the_stiffest_base() -> None:
    dataset = made_up(
        (100.0, 0.05, within(0.0, 5.0, 4.0)),
        (1e3, 0.05, 5.1),
        (1e4, 0.05, 5.0),
        (1e5, 1.0, 9.0),
    )
    own, stiff, limit, damped = on_bases(dataset)
    assert stiffest(dataset) == 2, "of those with the device's damping ratio"
    ends = float((curves("fig06")["fig06"]["press_force"].values > 5.0).mean())
    assert own.aligned == pytest.approx(1.0 - ends)
    assert own.other_end == pytest.approx(ends)
    assert own.apart == pytest.approx(0.2)
    assert own.other_time == 1.0
    assert stiff.apart == pytest.approx(0.02)
    assert (stiff.other_end, stiff.other_time) == (0.0, 0.0)
    assert (limit.apart, limit.other_end) == (0.0, 0.0)
    assert damped.apart == pytest.approx(0.8)
    assert settled_from(on_bases(dataset)) == 1e3


def test_sensitive_points_are_left_out() -> None:
    dataset = made_up((100.0, 0.05, 5.0), (1e4, 0.05, 5.0))
    dataset["tau_align"].values[0, :, :10] = NAN
    dataset["outcome"].values[0, :, :10] = 1
    assert on_bases(dataset)[0].other_end > 0.0
    dataset["sensitive"].values[1, :, :10] = 1
    assert on_bases(dataset)[0].other_end == 0.0


def test_no_stiffness_is_sufficient_while_the_last_one_changes_runs() -> None:
    row = OnBase(100.0, 0.05, 1.0, 1.0, 0.0, 0.0, 0.0)
    rows = [row, replace(row, stiffness=1e4, other_time=0.5), replace(row, stiffness=1e6)]
    assert math.isinf(settled_from(rows))
    none_aligned = replace(row, stiffness=1e4, other_time=NAN, apart=NAN)
    assert settled_from([row, none_aligned, replace(row, stiffness=1e6)]) == 100.0


def test_claims_are_judged_on_every_base() -> None:
    dataset = made_up((100.0, 0.05, falling), (1e4, 0.05, lambda _, f: 1.0 + f))
    rows = {row.claim.id: row for row in claims_on_bases({"fig06": dataset})}
    assert [each.verdict for each in rows["F6d"].findings] == ["reproduced", "contradicted"]
    assert "F13" not in rows, "what these figures do not let one judge is left out"
    assert np.all([len(row.findings) == 2 for row in rows.values()])
