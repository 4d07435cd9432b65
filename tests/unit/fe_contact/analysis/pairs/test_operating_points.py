"""Operating points of a table over other bodies: what is known of them stays."""

from __future__ import annotations

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import Gear, GearPair
from fe_contact.analysis.pairs.pair_contact import OperatingPoints, PairContact, operating_points
from fe_contact.analysis.request.request_check import check_request
from fe_contact.planning.plan import make_plan

MISALIGNMENTS, CHANGES = (-2e-5, 0.0, 2e-5), (0.0, 1e-4)


@pytest.fixture(scope="module")
def laid_out() -> tuple[OperatingPoints, OperatingPoints, PairContact]:
    """Operating points over a draft, those laid out afresh over a standard mesh, and the pair on it."""
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    axes = {"misalignments": MISALIGNMENTS, "center_distance_changes": CHANGES}
    checked = check_request(GearPair(gear, gear, 80e-3), *table_request(torques=[100.0], **axes))
    request = checked.request
    plans = [
        make_plan(request.pair, request.load, request.options, checked.model, level)
        for level in ("draft", "standard")
    ]
    draft, standard = (PairContact(request.pair, plan) for plan in plans)
    first, second = (operating_points(request.scene, request.choices, each) for each in (draft, standard))
    return first, second, standard


def test_other_bodies_are_laid_out_as_afresh(laid_out):
    first, afresh, bodies = laid_out
    found = first.on_bodies(bodies)
    assert found.shape == afresh.shape == (3, 2)
    assert found.nominal is bodies
    for place, other in zip(found.places, afresh.places, strict=True):
        assert place.model == other.model
        assert place.contact.pair == other.contact.pair
        assert place.contact.plan is bodies.plan


def test_places_of_one_center_distance_share_their_compliance_on_other_bodies(laid_out):
    first, _, bodies = laid_out
    found = first.on_bodies(bodies)
    contacts = np.array([id(place.contact) for place in found.places]).reshape(found.shape)
    assert np.all(contacts == contacts[0])
    assert contacts[0, 0] != contacts[0, 1]
    assert all(place.contact._problems is not bodies._problems for place in found.places)
