"""Tables for a terminal."""

import pytest

from vibralign.commands.tables import cell, pairs, table


def test_columns_are_aligned_numbers_to_the_right() -> None:
    rows = [{"run": "merge/fig06", "seconds": 1.25}, {"run": "plot", "seconds": 12, "note": "x"}]
    assert table(rows, ("run", "seconds", "note")) == [
        "run          seconds  note",
        "merge/fig06     1.25",
        "plot              12  x",
    ]


def test_a_table_without_rows_is_its_heading() -> None:
    assert table([], ("a", "b")) == ["a  b"]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, ""),
        (True, "yes"),
        (0.1234567, "0.123457"),
        ([1.0, 2.5], "1, 2.5"),
        ({"friction": 0.1, "press_force": 2.0}, "friction = 0.1, press_force = 2"),
    ],
)
def test_values_are_written_short(value: object, text: str) -> None:
    assert cell(value) == text


def test_pairs_stand_one_to_a_line() -> None:
    assert pairs({"a": 1, "longer": None}) == ["a       1", "longer"]
