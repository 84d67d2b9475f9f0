"""Masks of events for the modes of lanes: they contain every event that may apply."""

from itertools import product

import numpy as np
import pytest

from model.engine.lane_events import applicable_in, kind_of_mode, lane_events_of
from model.engine.mode_kinds import kinds_of, lane_modes, mode_in_kind
from model.engine.track import COLUMNS
from model.events.insertion import INSERTION
from model.events.kernels import in_kernels
from model.events.scenes import ALIGNMENT, Scene
from model.physics.modes import (
    CLOSED,
    MODE_KINDS,
    OPEN,
    RELEASED,
    SLIP_POSITIVE,
    START,
    STICKING,
    Mode,
)
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Batch, Constants, Shape
from model.runs.engine import run_tracked
from model.runs.settings import Settings
from verification.fuzz import SCENES, draw

ANY, SLIPS, FLAGS = (OPEN, CLOSED, RELEASED), (STICKING, SLIP_POSITIVE, -SLIP_POSITIVE), (0, 1)
FIELDS = {
    "edge": (LEFT_EDGE, RIGHT_EDGE), "face": ANY, "side": ANY, "corner": ANY, "wall": ANY,
    "dropped": FLAGS, "in_slot": FLAGS, "slip_at_corner": FLAGS, "slip_at_wall": FLAGS,
}  # fmt: skip


@pytest.mark.parametrize("is_round", [False, True], ids=["square", "round"])
@pytest.mark.parametrize("scene", [ALIGNMENT, INSERTION], ids=lambda scene: scene.name)
def test_masks_hold_every_event_that_applies(scene: Scene, is_round: bool) -> None:
    lanes = lane_events_of(in_kernels(scene, is_round).events)
    p = lanes.events.constants(*np.ones(len(Constants._fields)).tolist())
    p = p._replace(**{name: 0.0 for name in Constants._fields if name.startswith("printed_")})
    rng, held, left_out = np.random.default_rng(0), 0, 0
    for values in product(*FIELDS.values()):
        slips = (int(rng.choice(SLIPS)) for _ in range(2))
        named = dict(zip(FIELDS, values, strict=True))
        flags = {name: bool(named[name]) for name in list(FIELDS)[5:]}
        # Runs of the alignment scene end as the corners are inside; others have dropped before.
        inside = bool(rng.integers(2)) and flags["dropped"] and scene is INSERTION
        mode = START._replace(**(named | flags), corners_inside=inside)
        if scene is ALIGNMENT and (mode.wall != OPEN or mode.in_slot or mode.slip_at_wall):
            continue
        mode = mode._replace(**dict(zip(("support_slip", "side_slip"), slips, strict=True)))
        if mode.in_slot and (not mode.dropped or mode.edge == LEFT_EDGE):
            continue  # A1 and B1 are the right side of the slot
        kind = kind_of_mode(lanes, mode)
        mask, held = int(applicable_in(lanes, kind, p, mode)), held + 1
        for which, each in enumerate(lanes.events.all):
            event = each.event
            applies = any(case(p, mode) for case, _ in event.function)
            assert mask & 1 << which or not applies, (event.name, mode)
            left_out += not mask & 1 << which
    assert held > 50
    assert left_out > held


@pytest.mark.parametrize("sets", [60, pytest.param(100, marks=pytest.mark.nightly)])
@pytest.mark.parametrize("shape", ["square", "round"])
@pytest.mark.parametrize("scene", [ALIGNMENT, INSERTION], ids=lambda scene: scene.name)
def test_every_mode_that_runs_meet_has_been_listed(scene: Scene, shape: Shape, sets: int) -> None:
    """Its mask is empty otherwise: lanes would pass its events."""
    batch = draw(31, 0, sets, SCENES[scene.name][1])
    lanes = lane_events_of(in_kernels(scene, shape == "round").events)
    settings = Settings(scene=scene, shape=shape, horizon=10.0, max_evaluations=20_000)
    first, met = COLUMNS.index("mode_edge"), set()
    for part in (batch[row] for row in range(len(batch))):
        _, track = run_tracked(*settings.rows(Batch.stack([part])), settings.tolerance, settings)
        met |= {*map(tuple, track[:, first : first + len(START)])}
    modes = [
        Mode(*(kind(value) for kind, value in zip(MODE_KINDS, row, strict=True))) for row in met
    ]
    keys = {(int(kind_of_mode(lanes, mode)), mode_in_kind(mode)) for mode in modes}
    assert len(keys) > 5
    assert keys <= {key for _, key in lane_modes(scene is INSERTION, kinds_of(scene is INSERTION))}
