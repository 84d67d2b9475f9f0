"""Scenes: the contacts that they declare."""

import pytest

from model.events.scenes import CONTACT_NAMES
from vibralign import ALIGNMENT, INSERTION, PRINTED_CONTACTS, SUSPENDED, Scene


def test_the_insertion_scene_declares_every_kind_of_contact():
    assert set(ALIGNMENT.contacts) == {"edge_on_face", "edge_on_side", "corner_on_flat"}
    assert INSERTION.contacts - ALIGNMENT.contacts == {"corner_on_wall"}
    assert all(INSERTION.declared)


def test_the_printed_scene_has_no_corner_and_the_suspended_one_nothing():
    assert not PRINTED_CONTACTS.declared.corner_on_flat
    assert PRINTED_CONTACTS.declared.edge_on_face
    assert PRINTED_CONTACTS.declared.edge_on_side
    assert not any(SUSPENDED.declared)


@pytest.mark.parametrize("name", CONTACT_NAMES)
def test_a_declared_contact_reaches_the_kernels_under_its_own_name(name):
    declared = Scene("one", frozenset({name})).declared
    assert [other for other in CONTACT_NAMES if getattr(declared, other)] == [name]


def test_an_unknown_contact_is_refused_with_the_valid_ones():
    with pytest.raises(ValueError, match=r"\['edge_on_top'\].*edge_on_face, edge_on_side"):
        Scene("mine", frozenset({"edge_on_top"}))
