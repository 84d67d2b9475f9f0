"""Series: they solve the equations of motion and give event quantities."""

import itertools

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval

from model.compile.entries import compiled
from model.compile.vector_code import WIDTH
from model.engine import event_search, lane_events, peaks, series_kernels, step, workspace
from model.engine.event_search import first_crossing
from model.engine.lane_events import (
    QUANTITIES,
    TERMS,
    LaneEvents,
    applicable_in,
    kind_of_mode,
    lane_events_of,
)
from model.engine.mode_kinds import (
    ALIGNMENT_KINDS,
    BETWEEN_WALLS,
    FREE,
    ON_LEFT_EDGE,
    ON_RIGHT_EDGE,
    SIDE_CONTACTS,
    SLIDES,
    STICKS,
    ModeKind,
    kinds_of,
)
from model.engine.series import (
    CORNER_OFFSET,
    LANE_CONSTANTS,
    SIDE_SIGN,
    SUPPORT_SIGN,
    EventQuantities,
)
from model.engine.series_layout import (
    FRACTIONS,
    LACK,
    LINES,
    MOST_ERROR_ORDER,
    NODES,
    ORDER,
    ORDERS,
    SINES,
    SUMMED_ORDERS,
    TILT,
)
from model.engine.workspace import COEFFICIENTS, CONTACTS_AT, LAST_ORDER, new_workspace
from model.events.event_functions import NEVER
from model.events.insertion import INSERTION
from model.events.kernels import in_kernels, level
from model.events.scenes import ALIGNMENT
from model.events.sources import CornerPositions, corner_positions
from model.events.table import number_of
from model.physics.contacts import (
    contact_load,
    corner_on_flat,
    corner_on_wall,
    edge_on_side,
    support_on_face,
)
from model.physics.modes import CLOSED, OPEN, RELEASED, START, Mode
from model.physics.motion import motion_at
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, STATE_SIZE, State
from model.physics.parameters import Constants
from vibralign import Settings

EDGE, FACE, SUPPORT_SLIP, SIDE, SIDE_SLIP = (
    workspace.MODE_LINE + Mode._fields.index(name)
    for name in ("edge", "face", "support_slip", "side", "side_slip")
)
SIGNS = slice(SUPPORT_SIGN, SIDE_SIGN + 1)
KINDS = FREE, SLIDES, STICKS
KIND_NAMES = {FREE: "free", SLIDES: "slides", STICKS: "sticks"}
SHAPES = "square", "round"
each_kind = pytest.mark.parametrize(
    ("shape", "support", "side"),
    [(shape, support, side) for shape in SHAPES for support in KINDS for side in KINDS],
    ids=lambda value: KIND_NAMES.get(value, value),
)
NORMAL = {FREE: OPEN, SLIDES: CLOSED, STICKS: CLOSED}


LANES = {shape: lane_events_of(in_kernels(ALIGNMENT, shape == "round").events) for shape in SHAPES}
crossing, enter_series, fill_series, fill_errors, level_at = map(
    compiled,
    (
        event_search.crossing, lane_events.enter_series, series_kernels.fill_series,
        series_kernels.fill_errors, level,
    ),
)  # fmt: skip
largest_force, largest_tilt, motion, rates_in_step, step_all = map(
    compiled,
    (
        peaks.largest_force, peaks.largest_tilt, motion_at, event_search.rates_in_step,
        step.step_all,
    ),
)  # fmt: skip


def kind_of(support: int, side: int) -> int:
    """Return the number of the kind of mode with these states of A1 and A2."""
    return ALIGNMENT_KINDS.index(ModeKind(ON_RIGHT_EDGE, support, side))


PLACES = [name for name in EventQuantities._fields if name in CornerPositions._fields]
NAMES = Constants._fields[:LANE_CONSTANTS]
PRESS_RATE, RAMP_END = 0.1, 3.0  # the press grows during every step


def draw_constants(rng: np.random.Generator, w: np.ndarray) -> None:
    """Write random constants into the lanes."""
    ramp = {"press_rate": PRESS_RATE, "ramp_end": RAMP_END}
    others = [n for n, name in enumerate(NAMES) if name not in ramp]
    w[others] = rng.uniform(0.5, 1.5, (len(others), WIDTH))
    for name, value in ramp.items():
        w[NAMES.index(name)] = value


class Step:
    """One step of WIDTH random runs in the same kind of mode, of at most ``longest``."""

    def __init__(
        self,
        support: int,
        side: int,
        longest: float,
        tolerance: float = 1e-300,
        displacement: float | np.ndarray = 0.0,
        shape: str = "square",
        *,
        seed: int = 0,
    ) -> None:
        rng = np.random.default_rng(8 * support + side + 100 * seed)
        lanes = self.lanes = LANES[shape]
        self.watched = [each.number for each in lanes.all]
        self.w = new_workspace(lanes.lines)
        draw_constants(rng, self.w)
        named = dict(zip(NAMES, self.w, strict=False))
        named["contact_stiffness"][:] = 50.0
        named["friction"][:] = 0.3
        self.w[SIGNS], self.w[EDGE] = rng.choice([-1.0, 1.0], (2, WIDTH)), RIGHT_EDGE
        self.w[workspace.TIME], self.w[workspace.HALT] = 0.3, 10.0
        self.w[workspace.TOLERANCE], self.w[workspace.LONGEST] = tolerance, longest
        self.w[FACE], self.w[SIDE] = NORMAL[support], NORMAL[side]
        signs = self.w[SIGNS]
        self.w[SUPPORT_SLIP] = 0.0 if support == STICKS else signs[0]
        self.w[SIDE_SLIP] = 0.0 if side == STICKS else signs[1]
        state = rng.uniform(-0.3, 0.3, (6, WIDTH))
        if shape == "round":  # with tips: the part over the rim of the hole
            named["slot_half_width"][:] = 1.1 * named["half_width"]
            state[0] = named["half_width"] * (0.6 + state[0])
        self.w[COEFFICIENTS : COEFFICIENTS + 6] = state + displacement
        self.w[workspace.ERROR : workspace.ERROR + 6] = displacement
        control = Settings().control._replace(carries_error=1.0)
        kind = kind_of(support, side)
        self.applicable = int(applicable_in(lanes, kind, self.constants(0), self.mode(0)))
        self.w[workspace.APPLICABLE] = self.applicable
        for number in (kind, len(lanes.series.fill) + kind):
            lanes.series.load(number)
        step_all(lanes, kind, self.applicable, control, lanes.series.addresses, self.w)
        coefficients = self.w[COEFFICIENTS : COEFFICIENTS + ORDERS * LINES]
        self.further = coefficients.reshape(ORDERS, LINES, WIDTH)
        self.series = self.further[: ORDER + 1]

    def constants(self, lane: int) -> Constants:
        values = np.zeros(len(Constants._fields))
        values[:LANE_CONSTANTS] = self.w[:LANE_CONSTANTS, lane]
        return self.lanes.events.constants(*values.tolist())

    def mode(self, lane: int) -> Mode:
        face, slip, side, side_slip = (
            int(self.w[line, lane]) for line in (FACE, SUPPORT_SLIP, SIDE, SIDE_SLIP)
        )
        return Mode(RIGHT_EDGE, face, OPEN, 0.0, False, slip, side, side_slip, False)

    def applies(self, which: int, lane: int) -> bool:
        """Return whether an event applies in the mode of a lane."""
        applies = self.w[self.lanes.samples + which, lane] != NEVER
        return bool(applies and self.applicable & 1 << which)

    def at(self, time: float | np.ndarray, lane: int) -> np.ndarray:
        """States and event quantities at ``time`` after the start of the step."""
        return np.power.outer(time, np.arange(len(self.series))) @ self.series[:, :SINES, lane]

    def rates(self, time: float, lane: int) -> np.ndarray:
        """Time derivatives of the states at ``time`` after the start of the step."""
        orders = np.arange(1, len(self.series))
        return (orders * time ** (orders - 1)) @ self.series[1:, :6, lane]


def residual(step: Step, time: float) -> float:
    """Largest difference, over all lanes, between the series and the equations of motion."""
    missed = 0.0
    for lane in range(WIDTH):
        q = State(*step.at(time, lane)[:6].tolist())
        at = motion(0.3 + time, q, step.constants(lane), step.mode(lane))
        right = np.array([q.x_rate, q.y_rate, q.tilt_rate, at.x, at.y, at.tilt])
        missed = max(missed, float(np.abs(step.rates(time, lane) - right).max()))
    return missed


@each_kind
def test_rates_in_a_step_are_those_of_the_motion(shape: str, support: int, side: int) -> None:
    step = Step(support, side, 0.1, shape=shape)
    for lane in range(WIDTH):
        length = step.w[workspace.STEP_LENGTH, lane]
        for theta in (0.0, 0.4, 1.0):
            q = State(*step.at(theta * length, lane)[:6].tolist())
            found = rates_in_step(q, theta, step.w, lane)
            at = motion(0.3 + theta * length, q, step.constants(lane), step.mode(lane))
            expected = (q.x_rate, q.y_rate, q.tilt_rate, at.x, at.y, at.tilt)
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


@each_kind
def test_a_carried_error_is_the_derivative_of_the_series(shape, support, side):
    # The series are linearised at the displaced state: at the highest order that is a difference of
    # some hundred displacements.
    error = 1e-8 * np.random.default_rng(0).uniform(-1.0, 1.0, (6, WIDTH))
    more, less = (
        Step(support, side, 0.1, displacement=each, shape=shape) for each in (error, -error)
    )
    more.w[workspace.FILLED_ORDER] = MOST_ERROR_ORDER
    lanes = more.lanes
    fill_errors(lanes, kind_of(support, side), lanes.series.addresses, more.w)
    errors = more.w[workspace.ERROR :][: ORDERS * LINES].reshape(ORDERS, LINES, WIDTH)
    found = errors[: MOST_ERROR_ORDER + 1, :6]
    expected = 0.5 * (more.series - less.series)[: MOST_ERROR_ORDER + 1, :6]
    size = np.abs(expected).max(axis=1, keepdims=True)
    assert np.abs(found - expected).max() < 1e-5 * size.max()
    assert (np.abs(found - expected) < 1e-5 * size + 1e-14).all()


@each_kind
def test_the_series_solve_the_equations_of_motion_to_their_order(
    shape: str, support: int, side: int
) -> None:
    step = Step(support, side, 0.1, shape=shape)
    assert residual(step, 1e-3) < 1e-10
    for series in (step.series, step.further):
        step.series = series
        # The residual falls by 2^-15 if the time is halved: times closer than that are needed for
        # enough residuals above rounding.
        times = 2.0 * 0.9 ** np.arange(60)
        missed = np.array([residual(step, time) for time in times])
        clean = (missed < 1e-4) & (missed > 1e-11)
        assert clean.sum() >= 5
        slope = np.polyfit(np.log(times[clean]), np.log(missed[clean]), 1)[0]
        assert slope >= 0.95 * (len(step.series) - 2)


def mode_of(kind: ModeKind, signs: np.ndarray) -> Mode:
    """Return a mode of a kind, with these signs of the slips."""
    support, side = SIDE_CONTACTS[kind.support], SIDE_CONTACTS[kind.side]
    slips = np.where([support.sticks, side.sticks], 0, signs).astype(int).tolist()
    without_load = RELEASED if kind.position == ON_LEFT_EDGE and not support.corner else OPEN
    return START._replace(
        edge=LEFT_EDGE if kind.position == ON_LEFT_EDGE else RIGHT_EDGE,
        face=CLOSED if support.edge else without_load, corner=int(support.corner),
        slip_at_corner=support.slip_at_corner, support_slip=slips[0],
        side=int(side.edge), wall=int(side.corner), slip_at_wall=side.slip_at_corner,
        side_slip=slips[1],
        dropped=True, in_slot=kind.position == BETWEEN_WALLS,
    )  # fmt: skip


def test_a_mode_has_the_number_of_its_kind():
    for scene, inserts in ((ALIGNMENT, False), (INSERTION, True)):
        lanes = lane_events_of(in_kernels(scene).events)
        for number, kind in enumerate(kinds_of(inserts)):
            assert kind_of_mode(lanes, mode_of(kind, np.array([-1, 1]))) == number


# Each kind of place, support and side with each other costs a second: all in the nightly tests.
USUAL = [kind for kind in kinds_of(inserts=True) if FREE in kind[1:]]
RARE = [kind for kind in kinds_of(inserts=True) if kind not in USUAL]
NIGHTLY = [pytest.param(kind, marks=pytest.mark.nightly) for kind in RARE]


def pressing(rng: np.random.Generator, kind: ModeKind, shape: str, w: np.ndarray):
    """Draw states in which every contact of a kind presses, 0.01 deep at least.

    Return them, shape (6, WIDTH), with the half-widths of the slot, the depths of the corner on the
    flat when it began to press, of 0 between walls, and where a state was found.
    """
    a, b = w[[NAMES.index("half_width"), NAMES.index("half_height")]][..., None]
    draws = 2_000 if FREE in kind[1:] else 200_000  # both sides rarely press
    x, tilt = rng.uniform(-0.7, 0.7, (2, WIDTH, draws))
    y = rng.uniform(-1.0, 2.5, x.shape)
    tips = shape == "round" and kind.position != BETWEEN_WALLS
    hole = a * rng.uniform(1.001 if tips else 0.7, 1.4, x.shape)
    offset = rng.uniform(-1.0, 0.0, x.shape) * (kind.position != BETWEEN_WALLS)
    c, s = np.cos(tilt), np.sin(tilt)
    at = LEFT_EDGE if kind.position == ON_LEFT_EDGE else RIGHT_EDGE

    def beside(side):
        corner = side * x + a * c + side * b * s
        return a - hole * c + side * (x * c + y * s), corner - hole

    depths = b - (at * hole - x) * s - y * c, b * c - at * a * s - y - offset
    if tips:
        place = np.maximum(at * (x * c + y * s), 0.1)
        square = place**2 + hole**2 - a**2
        reach = np.sqrt((c * place) ** 2 + np.maximum(square, 0.0) * s * s)
        rim_x = at * square / (c * place + reach)
        depths = np.where(place > 0.1, b - (rim_x - x) * s - y * c, -1.0), depths[1]
    depths = beside(RIGHT_EDGE) if kind.position == BETWEEN_WALLS else depths
    holds = np.full(x.shape, True)
    for side, found in ((kind.support, depths), (kind.side, beside(LEFT_EDGE))):
        for presses, depth in zip(SIDE_CONTACTS[side][:2], found, strict=True):
            holds &= (depth > 0.01) | (not presses)
    first = np.arange(WIDTH), holds.argmax(axis=1)
    rates = rng.uniform(-0.02, 0.02, (3, WIDTH))
    state = np.array([x[first], y[first], tilt[first], *rates])
    return state, hole[first], offset[first], holds.any(axis=1)


@pytest.mark.parametrize("kind", [*USUAL, *NIGHTLY])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_series_of_the_insertion_scene_solve_the_equations_of_motion(shape, kind):
    rng = np.random.default_rng(kind)
    w = new_workspace(workspace.EVENT_LINES)
    draw_constants(rng, w)
    line = {name: n for n, name in enumerate(NAMES)}
    w[line["contact_stiffness"]], w[line["friction"]] = 50.0, 0.3
    signs = rng.choice([-1.0, 1.0], (2, WIDTH))
    w[SIGNS] = signs
    state, *others, presses = pressing(rng, kind, shape, w)
    w[line["slot_half_width"]], w[CORNER_OFFSET] = others
    w[COEFFICIENTS : COEFFICIENTS + 6] = state
    angle = w[line["frequency"]] * 0.3 + w[line["phase"]]
    sines = np.sin(state[2]), np.cos(state[2]), np.sin(angle), np.cos(angle)
    w[COEFFICIENTS + SINES : COEFFICIENTS + SINES + 4] = sines
    w[COEFFICIENTS + LACK] = PRESS_RATE * (RAMP_END - 0.3)
    w[COEFFICIENTS + LINES + LACK] = -PRESS_RATE
    w[LAST_ORDER] = ORDER
    lanes = lane_events_of(in_kernels(INSERTION, shape == "round").events)
    number = kinds_of(inserts=True).index(kind)
    lanes.series.load(number)
    fill_series(lanes, number, lanes.series.addresses, w)
    series = w[COEFFICIENTS : COEFFICIENTS + (ORDER + 1) * LINES].reshape(ORDER + 1, LINES, WIDTH)
    time, orders = 1e-3, np.arange(1, ORDER + 1)
    # Where friction nearly has no solution, the remainder of the series counts at this time.
    remainder = (
        ORDER * np.abs(series[ORDER - 1 :, :STATE_SIZE]).max(axis=(0, 1)) * time ** (ORDER - 1)
    )
    compared = np.flatnonzero(presses & (remainder < 1e-12))
    assert compared.size >= WIDTH / 2
    for lane in compared:
        values = np.zeros(len(Constants._fields))
        values[:LANE_CONSTANTS] = w[:LANE_CONSTANTS, lane]
        p, mode = lanes.events.constants(*values.tolist()), mode_of(kind, signs[:, lane])
        mode = mode._replace(corner_offset=float(w[CORNER_OFFSET, lane]))
        found = time ** np.arange(ORDER + 1) @ series[:, :SINES, lane]
        q = State(*found[:6].tolist())
        at = motion(0.3 + time, q, p, mode)
        right = [q.x_rate, q.y_rate, q.tilt_rate, at.x, at.y, at.tilt]
        rates = (orders * time ** (orders - 1)) @ series[1:, :6, lane]
        assert rates == pytest.approx(right, rel=1e-9, abs=1e-9)
        places = [getattr(corner_positions(q, p), name) for name in PLACES]
        at_places = found[[workspace.LINE[name] for name in PLACES]]
        assert at_places == pytest.approx(places, rel=1e-11, abs=1e-11)
        edges = [edge_on_side(each, q, p) for each in (RIGHT_EDGE, LEFT_EDGE)]
        corners = [corner_on_wall(each, q, p) for each in (RIGHT_EDGE, LEFT_EDGE)]
        if not mode.in_slot:
            edges[0] = support_on_face(mode.edge, q, p)
            corners[0] = corner_on_flat(mode.edge, q, p)
            corners[0] = corners[0]._replace(depth=corners[0].depth - mode.corner_offset)
        loads = [contact_load(each.depth, each.closing_rate, q, p) for each in (*edges, *corners)]
        lines = [workspace.LINE[f"{each}_load"] for each in ("face", "side", "corner", "wall")]
        assert found[lines] == pytest.approx(loads, rel=1e-9)
        slips = [
            (corners[0] if mode.slip_at_corner else edges[0]).slip,
            (corners[1] if mode.slip_at_wall else edges[1]).slip,
        ]
        if SIDE_CONTACTS[kind.support].sticks:
            slips[0] = at.support_friction
        if SIDE_CONTACTS[kind.side].sticks:
            slips[1] = at.side_friction
        frictions = [workspace.LINE[f"{each}_friction"] for each in ("support", "side")]
        assert found[frictions] == pytest.approx(slips, rel=1e-9)


SAMPLED_LINES = [TILT, *range(6, SINES - 2)]  # lines that are sampled at every node


@each_kind
def test_curvature_bounds_bound_the_distance_from_a_line(
    shape: str, support: int, side: int
) -> None:
    step = Step(support, side, 0.05, tolerance=1e-6, shape=shape)
    for lane in range(WIDTH):
        length = step.w[workspace.STEP_LENGTH, lane]
        bends = step.w[workspace.VALUES + NODES * SINES :][SAMPLED_LINES, lane]
        for start in (0.0, 0.25, 0.5, 0.75):
            left, middle, right = (
                step.at((start + part) * length, lane)[SAMPLED_LINES] for part in (0.0, 0.125, 0.25)
            )
            off = np.abs(middle - 0.5 * (left + right))
            assert (off <= 0.25**2 / 8.0 * bends * (1.0 + 1e-9) + 1e-12).all()


def sampled(
    step: Step, which: int, places: np.ndarray, series: np.ndarray, lane: int, last: int = ORDER
) -> np.ndarray:
    """A level from the series of its quantities, of either sign, to the last order."""
    lanes = step.lanes
    functions, count = [], QUANTITIES if which < lanes.events.combined else 1
    for sign in (1.0, -1.0):
        enter_series(lanes, which, sign, series, step.w, lane)
        series.reshape(QUANTITIES, TERMS)[:, last + 1 :] = 0.0
        functions.append(polyval(places, series.reshape(QUANTITIES, TERMS)[:count].T).max(axis=0))
    return np.min(functions, axis=0)


@each_kind
def test_series_of_levels_are_those_of_the_levels(shape: str, support: int, side: int) -> None:
    step, compared = Step(support, side, 0.4, tolerance=1e-6, shape=shape), 0
    series = np.zeros(QUANTITIES * TERMS)
    assert (step.w[workspace.STEP_LENGTH] > 0.02).all()  # long enough for levels to bend
    nodes, orders = (0.0, *FRACTIONS), (ORDER, *SUMMED_ORDERS)
    lines = step.lanes.samples + step.lanes.events.count * np.arange(NODES)
    for lane in range(WIDTH):
        for which in step.watched:
            expected = step.w[lines + which, lane]
            if step.applies(which, lane) and not has_rate(step.lanes, which):
                found = np.concatenate([
                    sampled(step, which, np.array([node]), series, lane, last)
                    for node, last in zip(nodes, orders, strict=True)
                ])  # fmt: skip
                assert found == pytest.approx(expected, rel=1e-10, abs=1e-11)
                compared += 1
    assert compared >= 5 * WIDTH


def test_a_level_with_a_rate_is_that_of_the_event_function() -> None:
    step, series, compared = Step(FREE, FREE, 0.2, tolerance=1e-6), np.zeros(QUANTITIES * TERMS), 0
    for lane in range(WIDTH):
        for which in (each for each in step.watched if has_rate(step.lanes, each)):
            for theta in (0.0, 0.3, 1.0) if step.applies(which, lane) else ():
                q = State(*step.at(theta * step.w[workspace.STEP_LENGTH, lane], lane)[:6].tolist())
                expected = level_at(
                    step.lanes.events, which, 0.0, q, step.constants(lane), step.mode(lane)
                )
                found = sampled(step, which, np.array([theta]), series, lane)
                assert found == pytest.approx(expected, rel=1e-9, abs=1e-10)
                compared += 1
    assert compared >= 3 * WIDTH


@each_kind
def test_peaks_are_those_of_the_step_or_its_part(shape: str, support: int, side: int) -> None:
    step = Step(support, side, 0.4, tolerance=1e-6, shape=shape)
    assert (step.w[workspace.STEP_LENGTH] > 0.02).all()  # long enough for levels to bend
    for lane in range(WIDTH):
        length = step.w[workspace.STEP_LENGTH, lane]
        for until in (1.0, 0.6, 0.1):
            course = step.at(np.linspace(0, until, 3001) * length, lane)
            lines = [CONTACTS_AT, CONTACTS_AT + 2]
            forces = course[:, lines]
            tilt = largest_tilt(0.0, until, step.w, lane)
            assert tilt == pytest.approx(np.abs(course[:, TILT]).max(), rel=1e-6)
            for line, force in zip(lines, forces.T, strict=True):
                found = largest_force(line, 0.0, until, step.w, lane)
                assert found == pytest.approx(max(force.max(), 0.0), rel=1e-6)


def has_rate(lanes: LaneEvents, which: int) -> bool:
    """Return whether a level has a series, but no samples."""
    (event,) = (each for each in lanes.all if each.number == which)
    return any(level.has_rate for case in event.cases for level in case.levels)


def test_the_first_fall_is_found_however_short_what_follows() -> None:
    # Against 1,001 samples of every level that applies, on steps ten times as long as usual.
    places, short, fell = np.linspace(0.0, 1.0, 1001), 0, 0
    series = np.zeros(QUANTITIES * TERMS)
    for seed, support in itertools.product(range(8 // WIDTH), KINDS):
        for side in KINDS:
            step = Step(support, side, 0.4, tolerance=1e-2, seed=seed)
            for lane in range(WIDTH):
                for which in step.watched:
                    if not step.applies(which, lane) or has_rate(step.lanes, which):
                        continue
                    values = sampled(step, which, places, series, lane)
                    if values[0] <= 1e-6:
                        continue
                    below = np.flatnonzero(values < 0.0)
                    quarters = int(step.w[step.lanes.subintervals + which, lane])
                    if below.size == 0:
                        continue
                    assert quarters & 1 << min(int(4.0 * places[below[0] - 1]), 3)
                    theta = crossing(step.lanes, which, 1.0, series, step.w, lane)
                    fell += 1
                    assert places[below[0] - 1] <= theta <= places[below[0]]
                    nodes = values[:: (places.size - 1) // 4]
                    short += bool((nodes > 0.0).all())
    assert fell > 50
    assert short > 0  # what begins and ends between two of the step's own samples


def test_a_fall_soon_after_a_level_has_left_zero_is_found() -> None:
    # Set 80389 of the insertion fuzz: A1 leaves the face, returns, and soon passes its end, all in
    # the first sixteenth of a step.
    series = np.zeros((QUANTITIES, TERMS))
    series[:, 0] = -1.0
    series[0, :3] = 0.0, 0.05, -1.0
    series[1, :2] = -0.06, 1.0
    theta = first_crossing(
        LANES["square"], number_of("right_edge_enters"), 1, 1.0, series.reshape(-1)
    )
    assert theta == pytest.approx(0.05)
