"""The switches of the variants."""

import dataclasses

import pytest

from model.physics.variants import VARIANT_NAMES
from vibralign import Variants

# R1 to R9 of docs/paper.md, without R7, which has no switch.
TABLE = {
    "normal_sign", "friction_law", "contact_damping_law", "side_gap", "side_force", "preload",
    "alignment_criterion", "moment_arms",
}  # fmt: skip


def test_every_row_of_the_table_is_a_switch():
    assert set(VARIANT_NAMES) == TABLE


def test_consistent_is_the_default_and_printed_is_all_printed():
    assert Variants() == Variants.consistent()
    assert set(dataclasses.asdict(Variants()).values()) == {"consistent"}
    assert set(dataclasses.asdict(Variants.printed()).values()) == {"printed"}


@pytest.mark.parametrize("name", sorted(TABLE))
def test_each_switch_is_set_by_name_alone(name):
    readings = Variants(**{name: "printed"})
    assert [other for other in TABLE if readings.is_printed(other)] == [name]
