"""A row of a batch has the results of its single run to the bit, in any order, on any cores."""

from dataclasses import fields

import numpy as np
import pytest

from vibralign import Alignments, Batch, Outcome, align

ROWS = 70  # more than two blocks of a thread, and not a multiple


@pytest.fixture(scope="module")
def batch(device):
    """Aligning and other rows, quick and slow ones, with derived and given rests."""
    rng = np.random.default_rng(3)
    return Batch.of(
        device,
        press_force=rng.uniform(0.3, 6.0, ROWS),
        frequency=10.0 ** rng.uniform(-0.5, 1.2, ROWS),
        tilt_stiffness=rng.uniform(2.0, 200.0, ROWS),
        friction=rng.uniform(0.0, 0.3, ROWS),
        rest_x=np.where(np.arange(ROWS) % 3 == 0, 0.1, 0.2),
    )


@pytest.fixture(scope="module")
def result(batch):
    return align(batch, horizon=40.0)


def same(one, other, rows=slice(None)):
    """Return whether all arrays are equal to the bit, NaN included."""
    return all(
        np.array_equal(getattr(one, field.name), getattr(other, field.name)[rows], equal_nan=True)
        if getattr(one, field.name).dtype.kind == "f"
        else np.array_equal(getattr(one, field.name), getattr(other, field.name)[rows])
        for field in fields(Alignments)
    )


def test_the_batch_is_a_mixed_one(result):
    assert len(result) == ROWS
    assert (result.outcome == Outcome.ALIGNED).sum() > 10
    assert (result.outcome != Outcome.ALIGNED).sum() > 5
    assert result.rhs_evaluations.max() > 5 * result.rhs_evaluations.min()


@pytest.mark.parametrize("row", [0, 1, 31, 32, 69])
def test_a_row_is_the_run_of_its_parameters_to_the_bit(batch, result, row):
    alone = align([batch[row]], horizon=40.0)
    assert same(alone, result, slice(row, row + 1))


def test_every_array_has_a_row_for_each_parameter_set_and_its_own_kind(result):
    for field in fields(Alignments):
        assert getattr(result, field.name).shape == (ROWS,)
    assert result.outcome.dtype == result.reason.dtype == np.int8
    assert result.sensitive.dtype == np.bool_
    assert result.rhs_evaluations.dtype == result.separations.dtype == np.int64
    assert result.tau_align.dtype == np.float64
