"""Masks of events for the modes of lanes: they contain every event that may apply."""

from itertools import product

import numpy as np
import pytest

from model.compile.jit import python_of
from model.engines.batch.event_kernels import in_vector_kernels
from model.events.insertion import INSERTION
from model.events.scenes import ALIGNMENT, Scene
from model.physics.modes import CLOSED, OPEN, RELEASED, SLIP_POSITIVE, START, STICKING
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Constants

ANY, SLIPS, FLAGS = (OPEN, CLOSED, RELEASED), (STICKING, SLIP_POSITIVE, -SLIP_POSITIVE), (0, 1)
FIELDS = {
    "edge": (LEFT_EDGE, RIGHT_EDGE), "face": ANY, "side": ANY, "corner": ANY, "wall": ANY,
    "dropped": FLAGS, "in_slot": FLAGS, "slip_at_corner": FLAGS, "slip_at_wall": FLAGS,
}  # fmt: skip


@pytest.mark.parametrize("scene", [ALIGNMENT, INSERTION], ids=lambda scene: scene.name)
def test_masks_hold_every_event_that_applies(scene: Scene) -> None:
    lanes, table = in_vector_kernels(scene).events, scene.events
    p = Constants(*np.ones(len(Constants._fields)).tolist())
    p = p._replace(**{name: 0.0 for name in Constants._fields if name.startswith("printed_")})
    rng, held, left_out = np.random.default_rng(0), 0, 0
    for values in product(*FIELDS.values()):
        slips = (int(rng.choice(SLIPS)) for _ in range(2))
        named = dict(zip(FIELDS, values, strict=True))
        flags = {name: bool(named[name]) for name in list(FIELDS)[5:]}
        mode = START._replace(**(named | flags), corners_inside=bool(rng.integers(2)))
        if scene is ALIGNMENT and (mode.edge, mode.wall, mode.corner) != (RIGHT_EDGE, OPEN, OPEN):
            continue
        mode = mode._replace(**dict(zip(("support_slip", "side_slip"), slips, strict=True)))
        if (mode.in_slot and not mode.dropped) or (kind := lanes.kind_of(mode)) < 0:
            continue
        mask, held = lanes.applicable(kind, mode), held + 1
        for which, event in enumerate(table):
            applies = any(python_of(case)(p, mode) for case, _ in event.function)
            assert mask & 1 << which or not applies, (event.name, mode)
            left_out += not mask & 1 << which
    assert held > 50
    assert left_out > held
