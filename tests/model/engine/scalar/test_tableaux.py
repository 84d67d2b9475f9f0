"""Order of the steps, of their error estimates and of their dense outputs, by rooted trees.

Butcher's conditions: a Runge-Kutta method has order p if Σ b_i Φ_i(t) = 1/γ(t) for every rooted
tree t of at most p nodes, and a continuous extension has order p if Σ b_i(θ) Φ_i(t) = θ^|t| / γ(t).
"""

import dataclasses
from functools import cache
from itertools import combinations_with_replacement

import numpy as np
import pytest

from model.engine.scalar.tableaux import DOP853

DENSE_ORDER = 7
# Sums of up to 256 products of coefficients of up to 1e3, each good to 1e-16.
ROUNDING = 1e-12


@cache
def trees(nodes):
    """All rooted trees of ``nodes`` nodes, each as the sorted tuple of its branches."""

    def forests(rest, largest):
        if rest == 0:
            yield ()
        for size in range(min(rest, largest), 0, -1):
            for count in range(rest // size, 0, -1):
                for some in combinations_with_replacement(trees(size), count):
                    for others in forests(rest - size * count, size - 1):
                        yield some + others

    return tuple(forests(nodes - 1, nodes - 1))


def size(tree):
    return 1 + sum(size(branch) for branch in tree)


def density(tree):
    """γ(t): the product of the sizes of all subtrees."""
    return size(tree) * int(np.prod([density(branch) for branch in tree]))


def weights(tree, a):
    """Φ_i(t), shape (stages,)."""
    product = np.ones(len(a))
    for branch in tree:
        product = product * (a @ weights(branch, a))
    return product


def test_the_number_of_trees_is_known():
    # Cayley's numbers, A000081.
    assert [len(trees(nodes)) for nodes in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]


def test_step_meets_every_order_condition():
    b = DOP853.a[DOP853.stages]
    for nodes in range(1, DOP853.order + 1):
        for tree in trees(nodes):
            assert abs(b @ weights(tree, DOP853.a) - 1 / density(tree)) < ROUNDING


@pytest.mark.parametrize(("row", "order"), [(0, 5), (1, 3)], ids=["order 5", "order 3"])
def test_error_weights_vanish_to_the_order_of_the_embedded_method(row, order):
    # The estimate is step minus embedded method: it sees nothing of trees both integrate exactly.
    def largest(nodes):
        return max(abs(DOP853.error[row] @ weights(t, DOP853.a)) for t in trees(nodes))

    for nodes in range(1, order + 1):
        assert largest(nodes) < ROUNDING
    assert largest(order + 1) > 1e-6


def test_error_order_is_that_of_the_combined_estimate():
    # h |E1|² / |E2|: with E1 of order h^5 and E2 of order h^3, h^8, one more than 7.
    assert DOP853.error_order == 7


@pytest.mark.parametrize("theta", [0.2, 0.5, 0.9, 1.0])
def test_dense_output_meets_every_order_condition(theta):
    b = DOP853.dense @ theta ** np.arange(1, DOP853.dense.shape[1] + 1)
    for nodes in range(1, DENSE_ORDER + 1):
        for tree in trees(nodes):
            defect = b @ weights(tree, DOP853.a) - theta**nodes / density(tree)
            assert abs(defect) < 100 * ROUNDING  # coefficients of the extension reach 400


def perturbed(array, index, by):
    changed = array.copy()
    changed[index] += by
    return changed


@pytest.mark.parametrize(
    ("field", "index", "message"),
    [
        ("a", (1, 2), "not strictly lower triangular"),
        ("c", (2,), "row sums"),
        ("error", (0, 3), "error weights do not sum to zero"),
        ("dense", (4, 2), "does not end at the step"),
        ("dense", (1, 0), "does not start along k_1|does not end at the step"),
    ],
)
def test_a_changed_coefficient_is_refused(field, index, message):
    changed = perturbed(getattr(DOP853, field), index, 1e-6)
    with pytest.raises(ValueError, match=f"tableau DOP853: .*({message})"):
        dataclasses.replace(DOP853, **{field: changed})


def test_weights_that_miss_a_quadrature_condition_are_refused():
    # Two equal and opposite changes keep the row sum: only the moments show it.
    last = DOP853.stages
    a = perturbed(perturbed(DOP853.a, (last, 0), 1e-6), (last, 1), -1e-6)
    dense = DOP853.dense + np.outer(a[last] - DOP853.a[last], [0, 3, -2, 0, 0, 0, 0])
    with pytest.raises(ValueError, match="tableau DOP853: order condition 2 fails"):
        dataclasses.replace(DOP853, a=a, dense=dense)
