"""The refined map against the full one, on maps with known areas, islands and jumps."""

import numpy as np
import pytest

from model.study.maps.lattice import BESIDE, Lattice, Refined, refine

CELLS = 256
COARSE = 16
LINES = 64


def plane(cells: int = CELLS) -> tuple[np.ndarray, np.ndarray]:
    """x and y of every node, from 0 to 1."""
    along = np.arange(cells + 1) / cells
    y, x = np.meshgrid(along, along, indexing="ij")
    return x, y


class Map:
    """A known map that records the nodes asked for, and refuses to be asked twice."""

    def __init__(self, kind: np.ndarray, value: np.ndarray | None = None) -> None:
        self.kind = np.asarray(kind, dtype=np.int64)
        self.value = np.full(kind.shape, np.nan) if value is None else value
        self.asked = np.zeros(kind.shape, dtype=np.bool_)

    def __call__(self, rows: np.ndarray, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        assert not self.asked[rows, columns].any()
        self.asked[rows, columns] = True
        return self.kind[rows, columns], self.value[rows, columns]


def half(cells: int = CELLS) -> np.ndarray:
    x, y = plane(cells)
    return y > 0.3 + 0.4 * x + 0.05 * np.sin(9.0 * x)


def disc(x0: float, y0: float, radius: float, cells: int = CELLS) -> np.ndarray:
    x, y = plane(cells)
    return (x - x0) ** 2 + (y - y0) ** 2 < radius**2


def stripe(angle: float, offset: float, width: float, length: float = 9.0) -> np.ndarray:
    """A band of ``width`` cells around a line through near the middle, ``length`` of the side."""
    x, y = plane()
    across = (x - 0.5) * np.sin(angle) - (y - 0.5) * np.cos(angle) - offset
    along = (x - 0.5) * np.cos(angle) + (y - 0.5) * np.sin(angle)
    return (np.abs(across) <= 0.5 * width / CELLS) & (np.abs(along) <= 0.5 * length)


def fractal() -> np.ndarray:
    """The Mandelbrot set's neighbourhood: a border with islands on every scale."""
    x, y = plane()
    c = (x * 3.0 - 2.2) + 1j * (y * 2.6 - 1.3)
    z = np.zeros_like(c)
    inside = np.ones(c.shape, dtype=np.bool_)
    for _ in range(30):
        z[inside] = z[inside] ** 2 + c[inside]
        inside &= np.abs(z) <= 2.0
    return inside


def refined(kind: np.ndarray, value: np.ndarray | None = None, **rule: float) -> Refined:
    given = {"cells": CELLS, "coarse": COARSE, "lines": LINES, **rule}
    return refine(Map(kind, value), Lattice(**given))


def wrong(found: Refined, kind: np.ndarray) -> int:
    return int((found.kind != kind).sum())


def unflagged(found: Refined, kind: np.ndarray) -> int:
    return int(((found.kind != kind) & ~found.flagged).sum())


def test_a_border_is_followed_to_a_node_and_filled_nodes_near_it_are_marked():
    """A filled node is wrong where the border crosses an edge of two cells' length twice."""
    kind = half()
    found = refined(kind)
    assert found.computed.mean() < 0.06
    away = np.argwhere(found.kind != kind)
    assert len(away) <= 0.02 * CELLS
    assert unflagged(found, kind) == 0
    assert not ((found.kind != kind) & ~found.beside(1)).any()
    beside = found.beside(2)
    assert not (beside & found.computed).any()
    for row, column in np.argwhere(beside)[::50]:
        near = found.kind[max(row - 2, 0) : row + 3, max(column - 2, 0) : column + 3]
        assert near.min() != near.max()


def test_a_straight_border_equals_the_full_map():
    x, _ = plane()
    for place in (0.3, 0.301, 0.304):
        kind = x > place
        assert wrong(refined(kind), kind) == 0
        assert wrong(refined(kind.T), kind.T) == 0


def test_three_areas_that_meet_in_a_point():
    x, y = plane()
    kind = np.where(y > x, 0, np.where(x + y > 1.0, 1, 2))
    found = refined(kind)
    assert not ((found.kind != kind) & ~found.beside(1)).any()


@pytest.mark.parametrize("angle", [0.0, 0.1, 0.5, 0.785398, 1.2, np.pi / 2])
@pytest.mark.parametrize("offset", [0.013, 0.0503, 0.121])
def test_a_stripe_as_wide_as_half_a_coarse_cell_across_a_line_is_found_whole(angle, offset):
    """One of its nodes on a line finds the rest."""
    kind = stripe(angle, offset, COARSE / 2 + 1.0)
    assert kind.any()
    assert unflagged(refined(kind), kind) == 0


def test_without_lines_such_a_stripe_is_missed():
    kind = stripe(0.0, 0.03125, COARSE / 2 + 1.0)
    assert wrong(refined(kind, lines=0), kind) == kind.sum()


@pytest.mark.parametrize("kind", [half(), fractal(), disc(0.3, 0.6, 0.04)])
def test_cells_that_touch_differ_in_size_by_a_factor_of_two_at_most(kind):
    sizes = refined(kind).size[:-1, :-1]  # a node's own cell is the one it is the first corner of
    assert (sizes.min(), sizes.max()) == (1, COARSE)
    for down, right in ((1, 0), (0, 1), (1, 1)):
        ratio = sizes[down:, right:] / sizes[: CELLS - down, : CELLS - right]
        assert ratio.max() <= 2.0
        assert ratio.min() >= 0.5


def test_a_dot_is_found_beside_a_larger_island_but_not_alone():
    x0, y0 = 99.0 / CELLS, 90.0 / CELLS
    dot = np.zeros((CELLS + 1, CELLS + 1), dtype=np.bool_)
    dot[90:92, 107:109] = True
    lone, both = dot, dot | disc(x0, y0, 6.0 / CELLS)
    always = {"lines": 2 * COARSE}
    assert wrong(refined(lone, **always), lone) == dot.sum()
    assert unflagged(refined(both, **always), both) == 0


def test_an_island_is_missed_only_if_it_holds_no_node_computed_in_any_case():
    """Small discs are found if they hold a corner of a coarse cell or a node on a line."""
    always = Lattice(cells=CELLS, coarse=COARSE, lines=LINES).watched()
    always[::COARSE, ::COARSE] = True
    met = []
    for place in np.random.default_rng(1).uniform(0.1, 0.9, (30, 2)):
        kind = disc(*place, 5.0 / CELLS)
        met.append(unflagged(refined(kind), kind) == 0)
        assert met[-1] == bool((kind & always).any())
    assert set(met) == {True, False}


def test_a_fractal_border_is_followed_and_islands_are_found_once_met():
    kind = fractal()
    found = refined(kind)
    away = found.kind != kind
    assert away.mean() < 4e-3
    assert found.computed.mean() < 0.4


def test_where_outcomes_alternate_there_is_a_patch_and_no_border():
    """One corner of the map is noise; the border of the rest is still followed."""
    kind = half().astype(np.int64)
    noise = slice(192, 257), slice(0, 65)
    kind[noise] = np.random.default_rng(3).integers(0, 2, kind[noise].shape)
    plain, found = refined(kind, coarse=8), refined(kind, coarse=8, patch=4)
    assert not plain.patch.any()
    assert plain.computed[noise].mean() > 0.7
    assert found.computed[noise].mean() < 0.25
    assert found.patch[noise].mean() > 0.8
    away = np.zeros_like(found.patch)
    away[180:, :77] = True
    assert not (found.patch & ~away).any()
    assert ((found.kind != kind) & found.patch).any()
    assert unflagged(found, kind) == 0


def test_nodes_twice_as_far_are_flagged_where_the_border_is_crooked():
    x, y = plane()
    straight, comb = x > 0.3, x > 0.3 + 0.04 * np.sign(np.sin(80.0 * y))
    for kind, crooked in ((straight, False), (comb, True)):
        found = refined(kind, patch=8)
        far = found.beside(2 * BESIDE) & ~found.beside(BESIDE)
        assert found.flagged[far].any() == crooked
        assert found.flagged[found.beside(BESIDE)].all()


def test_values_are_interpolated_and_jumps_followed():
    x, y = plane()
    value = 2.0 * x + 3.0 * y + np.where(half(), 5.0, 0.0)
    kind = np.zeros(value.shape, dtype=np.int64)
    found = refined(kind, value, jump=0.5)
    assert (np.abs(found.value - value) > 0.5).mean() < 1e-3
    smooth = refined(kind, 2.0 * x + 3.0 * y, jump=0.5)
    assert np.allclose(smooth.value, 2.0 * x + 3.0 * y, atol=1e-12)
    assert smooth.size.min() == COARSE


@pytest.mark.parametrize("parts", [2, 3, 5])
def test_a_map_made_in_parts_is_the_map_made_in_one_piece(parts):
    x, _ = plane()
    kind, value = fractal(), np.where(half(), 1.0, 0.0) + x
    lattice = Lattice(cells=CELLS, coarse=COARSE, lines=LINES, jump=0.3)
    whole = refine(Map(kind, value), lattice)
    cells = np.arange((CELLS // COARSE) ** 2).reshape(CELLS // COARSE, -1) % parts
    known = np.zeros(kind.shape, dtype=np.bool_)
    for part in range(parts):
        known |= refine(Map(kind, value), lattice, within=cells == part).computed
    assert not (known & ~whole.computed).any()
    fresh = []

    def remembered(rows, columns):
        fresh.append(int((~known[rows, columns]).sum()))
        return kind[rows, columns].astype(np.int64), value[rows, columns]

    again = refine(remembered, lattice)
    for name in ("kind", "computed", "size"):
        assert np.array_equal(getattr(again, name), getattr(whole, name))
    assert sum(fresh) < 0.2 * whole.computed.sum()


@pytest.mark.parametrize("cells", [256, 512])
def test_the_cost_grows_with_the_length_of_the_border(cells):
    def cost(cells: int) -> int:
        lattice = Lattice(cells=cells, coarse=cells // 16, lines=cells // 4)
        return int(refine(Map(half(cells)), lattice).computed.sum())

    assert cost(cells) < 2.1 * cost(cells // 2)


def test_the_smallest_lattices_are_full_maps():
    for cells in (1, 2, 4):
        lattice = Lattice(cells=cells, coarse=1)
        kind = np.arange((cells + 1) ** 2).reshape(cells + 1, -1) % 3
        found = refine(Map(kind), lattice)
        assert found.computed.all()
        assert np.array_equal(found.kind, kind)


REFUSED: list[tuple[dict[str, int], str]] = [
    ({"cells": 100, "coarse": 4}, "cells = 100: must be a power of two"),
    ({"cells": 64, "coarse": 3}, "coarse = 3: must be a power of two"),
    ({"cells": 64, "coarse": 128}, "coarse = 128: must be at most cells = 64"),
    ({"cells": 64, "coarse": 8, "lines": 12}, "lines = 12: must be a multiple of coarse = 8"),
    ({"cells": 64, "coarse": 8, "patch": 3}, "patch = 3: must be 0 or the side of a cell: 8, 4, 2"),
]


@pytest.mark.parametrize(("rule", "words"), REFUSED)
def test_an_invalid_lattice_is_refused(rule: dict[str, int], words: str):
    with pytest.raises(ValueError, match=words):
        Lattice(**rule)


def test_a_finger_between_two_rows_of_corners_is_followed_to_its_end():
    kind = np.zeros((65, 65), dtype=np.int64)
    kind[:21, :9] = 1
    kind[19, 9:40] = 1  # one node high, on an odd row, beyond the cells that hold a corner of it
    found = refine(Map(kind, np.zeros(kind.shape)), Lattice(cells=64, coarse=8))
    assert np.array_equal(found.kind, kind)
    assert found.computed[18:21, 9:40].all()
