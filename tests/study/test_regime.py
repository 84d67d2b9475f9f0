"""The regime of a figure: of its aligned points, from made-up controls."""

import numpy as np
import pytest

from model.events.outcomes import Unvibrated
from study.claims.data import MissingDataError, Tables
from study.claims.regime import Regime, regime_of
from tests.study.claims_data import NAN, runs


def test_every_number_is_a_share_or_a_tilt_of_the_aligned_points() -> None:
    # 4 of 40 forces align without vibration, the next 4 topple, the next 4 rest upright; those
    # above 5 do not align.
    def ends(_: float, f: float) -> float:
        return float(Unvibrated.ALIGNS if f < 1.2 else Unvibrated.LEAVES if f < 2.2 else 1)

    made = runs(
        "fig06",
        lambda _, f: NAN if f > 5.2 else (1.25 if f < 2.0 else 1.26),  # a period is 1.2566
        unvibrated=ends,
        unvibrated_tilt=lambda k, f: 0.0 if 2.2 < f < 3.2 else (0.1 if ends(k, f) == 1 else NAN),
        tilt_at_alignment=lambda _, f: -0.3 if f < 0.4 else 0.1,
        tau_corners_inside=lambda _, f: NAN if f > 4.9 else 5.1,
        separations=lambda _, f: 2.0 if f < 0.6 else 0.0,
    )
    found = regime_of(Tables.of(made), "fig06")
    assert found == pytest.approx(
        Regime(
            aligned=20 / 40,
            static=4 / 20, not_resting=12 / 20, tilt=0.1, tilt_largest=0.3, corners=19 / 20,
            lift_offs=2 / 20, first_period=7 / 20, creeps=13 / 20,
        )
    )  # fmt: skip


def test_without_aligned_points_or_twins_there_is_no_regime() -> None:
    never = regime_of(Tables.of(runs("fig06", NAN)), "fig06")
    assert never.aligned == 0.0
    assert np.isnan(never[1:]).all()
    without = {"fig06": runs("fig06")["fig06"].drop_vars("unvibrated")}
    with pytest.raises(MissingDataError, match="has no column for"):
        regime_of(Tables.of(without), "fig06")
