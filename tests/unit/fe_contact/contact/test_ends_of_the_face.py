"""Free ends of the face in the contact problem: where they are, and that no reference length remains."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fe_contact.contact import ContactModel, ContactProblem
from fe_contact.contact import problem as contact_problem
from fe_contact.contact.candidates import PatchRule, contact_candidates
from fe_contact.contact.free_end import ENDLESS, end_softness
from fe_contact.contact.slices import Slices
from fe_contact.geometry import Gear, GearPair

MODULE, FACE = 3e-3, 24e-3
GEAR = Gear(teeth=24, normal_module=MODULE, face_width=FACE, bore_diameter=12 * MODULE)
RULE = PatchRule(half_width=0.6e-3, edge_length=0.3e-3, edge_load=1e-6)
SOFT = 1.3e-11, 0.7e-11


def problem(pair: GearPair, slices: int = 9) -> ContactProblem:
    laid = Slices.of_pair(pair, slices)
    model = ContactModel(across_face=slices > 1)
    candidates = contact_candidates(pair, model, np.array([0.1, 0.6]), RULE, laid)
    count = candidates.slices.pair.size
    return ContactProblem(candidates, np.zeros((2, count, count)), 1e11, *SOFT)


def pair_of(wheel: Gear, offset: float = 0.0) -> GearPair:
    return GearPair(GEAR, wheel, 72e-3, axial_offset=offset)


def test_both_gears_of_equal_faces_end_at_both_ends():
    slices = problem(pair_of(GEAR)).candidates.slices
    softness = end_softness(GEAR.material.poissons_ratio)
    assert slices.end_1 == slices.end_2 == (-0.5 * FACE, 0.5 * FACE, softness)


def test_a_body_that_goes_on_beside_the_contact_has_no_end_there():
    wide = problem(pair_of(replace(GEAR, face_width=1.5 * FACE))).candidates.slices
    assert wide.end_1[:2] == (-0.5 * FACE, 0.5 * FACE)
    assert wide.end_2[:2] == (-math.inf, math.inf)
    shifted = problem(pair_of(GEAR, 0.25 * FACE)).candidates.slices
    assert shifted.end_1[:2] == (-math.inf, 0.5 * FACE)
    assert shifted.end_2[:2] == (-0.25 * FACE, math.inf)


def test_a_plane_has_no_ends():
    plane = problem(pair_of(GEAR), slices=1)
    assert plane.candidates.slices.endless
    assert np.all(plane.law_length == plane.candidates.slices.law_length)


def test_contacts_give_way_more_at_the_ends_alone():
    made = problem(pair_of(GEAR))
    line = (made.law_length[0] / made.candidates.slices.law_length)[made.candidates.pair == 0]
    assert line == pytest.approx(line[::-1], rel=1e-12)
    assert line[0] > 1.1 and line[0] == line.max()
    assert np.all(line >= 1.0)
    assert np.all(line[18:-18] < 1.01)


def test_an_even_load_moves_an_end_slice_alike_for_any_reference_length(monkeypatch):
    """What the law gives way more is less in the bodies: means over a slice stay."""
    moved = []
    for smooth in (1.5, 2.0, 4.0):
        monkeypatch.setattr(contact_problem, "SMOOTH", smooth)
        made = problem(pair_of(GEAR))
        slices = made.candidates.slices
        local = slices.mean(sum(made.half_planes) * np.log(made.law_length)) / slices.width
        moved.append(np.diagonal(made.bodies, axis1=1, axis2=2) + np.where(slices.present, local, 0.0))
    assert moved[1] == pytest.approx(moved[0], rel=1e-9)
    assert moved[2] == pytest.approx(moved[0], rel=1e-9)
    without = replace(made.candidates.slices, end_1=ENDLESS, end_2=ENDLESS)
    endless = replace(made, candidates=replace(made.candidates, slices=without))
    assert not np.allclose(endless.bodies, made.bodies, rtol=1e-3, atol=0.0)
