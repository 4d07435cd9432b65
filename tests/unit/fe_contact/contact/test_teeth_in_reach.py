"""How many teeth have to be condensed so that every contact finds its tooth."""

import numpy as np
import pytest

from fe_contact import Gear, GearPair, analyze
from fe_contact.contact import ContactModel, PatchRule, Slices, contact_candidates, teeth_in_reach

RULE = PatchRule(half_width=3e-4, edge_length=2e-4)
COMMON = {"normal_module": 1e-3, "face_width": 10e-3, "bore_diameter": 15e-3}


def off_center() -> GearPair:
    """Contact ratio below two, but A more than one base pitch before the pitch point."""
    pinion = Gear(teeth=42, profile_shift_coefficient=-0.4, **COMMON)
    return GearPair(pinion, Gear(teeth=57, profile_shift_coefficient=0.4, **COMMON))


def nearly_off_center() -> GearPair:
    """A lies one base pitch before the pitch point here, and nearer to it at a larger center distance."""
    pinion = Gear(teeth=42, profile_shift_coefficient=-0.2, **COMMON)
    return GearPair(pinion, Gear(teeth=57, profile_shift_coefficient=0.2, **COMMON))


@pytest.mark.parametrize(
    "pair", [off_center(), off_center().swapped(), GearPair(*2 * [Gear(teeth=20, **COMMON)])]
)
@pytest.mark.parametrize("corners", [False, True])
def test_no_candidate_lies_beyond_the_teeth_in_reach(pair, corners):
    positions = np.linspace(0.0, 1.0, 400, endpoint=False)
    model = ContactModel(corner_contact=corners)
    found = contact_candidates(pair, model, positions, RULE, Slices.of_pair(pair, 1))
    assert np.abs(found.pair).max() <= teeth_in_reach(pair) // 2


def test_usual_pairs_need_what_their_contact_ratio_says():
    gear = Gear(teeth=20, **COMMON)
    assert teeth_in_reach(GearPair(gear, gear)) == 5


@pytest.mark.law
def test_a_path_of_contact_off_the_pitch_point_is_analyzed():
    pair = off_center()
    assert pair.transverse_contact_ratio < 2.0
    path = pair.path_of_contact
    assert path.pitch_point - path.start > path.base_pitch
    table = analyze(pair, torques=[1.0], model="plane_strain", level="draft", positions=16, receipt="minimal")
    assert table.n_failed == 0


def test_so_is_one_that_only_another_center_distance_moves_there():
    near = nearly_off_center()
    far = near.at_center_distance(near.center_distance + 0.1e-3)
    assert teeth_in_reach(near) == 7 and teeth_in_reach(far) == 5
    table = analyze(
        far, torques=[1.0], model="plane_strain", level="draft", positions=16, receipt="minimal",
        center_distance_changes=[-0.1e-3, 0.0],
    )  # fmt: skip
    assert table.n_failed == 0
