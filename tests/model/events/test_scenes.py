"""Scenes: the contacts that they declare."""

import pytest

from model.events.scenes import CONTACT_NAMES
from vibralign import Scene


@pytest.mark.parametrize("name", CONTACT_NAMES)
def test_a_declared_contact_reaches_the_kernels_under_its_own_name(name):
    declared = Scene("one", frozenset({name})).declared
    assert [other for other in CONTACT_NAMES if getattr(declared, other)] == [name]


def test_an_unknown_contact_is_refused_with_the_valid_ones():
    with pytest.raises(ValueError, match=r"\['edge_on_top'\].*edge_on_face, edge_on_side"):
        Scene("mine", frozenset({"edge_on_top"}))
