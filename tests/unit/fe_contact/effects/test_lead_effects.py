"""What differs over the face: called for where it should be, and seen by the search for touching points."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fe_contact.contact import PatchRule, Slices, contact_candidates, with_gaps
from fe_contact.contact.model import ContactModel
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.effects.corner_contact import CornerContact
from fe_contact.effects.flank_modification import LeadModification, ProfileModification
from fe_contact.geometry import FlankGrid, FlankModification, Gear, GearPair

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=24e-3, bore_diameter=40e-3)
POSITIONS = np.arange(16) / 16
SLICES = 8
TWIST = 30e-6


def scene(torque: float = 100.0, **modification: Any) -> ContactScene:
    gear = replace(GEAR, modification=FlankModification(**modification))
    return ContactScene(GearPair(gear, GEAR, center_distance=80e-3), np.array([torque]), EFFECTS)


def candidates(case: ContactScene, model: ContactModel):
    slices = Slices.of_pair(case.pair, SLICES)
    plain = contact_candidates(case.pair, model, POSITIONS, PatchRule(3e-4, 2e-4), slices)
    return with_gaps(case.pair, plain, model)


def test_twist_calls_for_the_lead_and_not_for_the_profile():
    twisted = scene(flank_twist=TWIST)
    assert LeadModification().called_for(twisted).on
    assert not ProfileModification().called_for(twisted).on
    model, ledger = compose(twisted, {})
    assert model.across_face
    assert len(model.gaps) == 1
    assert {entry.name for entry in ledger if entry.on} >= {"lead_modification", "face_load_distribution"}


def test_each_slice_of_a_twisted_flank_is_a_sloped_profile():
    """The touching points move off the line of action as on a profile slope of that slice's amount."""
    twisted = scene(flank_twist=TWIST)
    found = candidates(twisted, LeadModification().contribute(twisted, ContactModel()))
    for place in np.unique(found.face_position):
        amount = 4.0 * TWIST * place / GEAR.face_width  # tip minus form point
        sloped = scene(profile_slope=amount)
        expected = candidates(sloped, ProfileModification().contribute(sloped, ContactModel()))
        ours, theirs = found.face_position == place, expected.face_position == place
        for name in ("s_1", "s_2", "gap"):
            values = getattr(found.touch, name)[:, ours], getattr(expected.touch, name)[:, theirs]
            # the search ends on a grid of about 1e-4 of its reach
            assert values[0] == pytest.approx(values[1], rel=0.0, abs=3e-7 if name != "gap" else 1e-11)
    plain = candidates(twisted, ContactModel())
    assert np.abs(found.touch.s_1 - plain.touch.s_1)[np.isfinite(found.gap)].max() > 3e-5


def test_a_free_flank_made_of_a_twist_is_that_twist():
    twisted = scene(flank_twist=TWIST)
    roll = (GEAR.form_roll_length, GEAR.tip_roll_length)
    face = (-0.5 * GEAR.face_width, 0.5 * GEAR.face_width)
    free = scene(flank_grid=FlankGrid(roll, face, ((TWIST, -TWIST), (-TWIST, TWIST))))
    assert LeadModification().called_for(free).on
    first, second = (
        candidates(case, LeadModification().contribute(case, ContactModel())).touch
        for case in (free, twisted)
    )
    for name in ("s_1", "s_2", "gap"):
        assert getattr(first, name) == pytest.approx(getattr(second, name), rel=0.0, abs=1e-12)


def test_a_tip_edge_is_clear_only_if_it_is_so_all_over_the_face():
    relief = {"tip_relief": 200e-6, "tip_relief_length": 1e-3}
    deep = replace(GEAR, modification=FlankModification(**relief))
    low = replace(GEAR, modification=FlankModification(**relief, flank_twist=200e-6))
    clear, touching = (
        ContactScene(GearPair(deep, g, 80e-3), np.array([100.0]), EFFECTS) for g in (deep, low)
    )
    assert not CornerContact().called_for(clear).on
    assert CornerContact().called_for(touching).on
