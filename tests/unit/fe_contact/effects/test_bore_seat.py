"""Bore seat: called for by a seat, changes the turn on it, and nothing for fixed bores."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from fe_contact import BoreSeat, Gear, GearPair
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS, ContactScene
from fe_contact.effects.bore_seat import BoreSeatElasticity
from fe_contact.errors import InputError
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.planning.plan import make_plan

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
SEATED = replace(GEAR, seat=BoreSeat(tangential_foundation=1e13))
FIXED, PAIR = GearPair(GEAR, GEAR), GearPair(SEATED, GEAR)


def test_called_for_by_a_seat_only() -> None:
    off, on = (
        BoreSeatElasticity().called_for(ContactScene(p, np.array([100.0]), EFFECTS)) for p in (FIXED, PAIR)
    )
    assert (off.on, off.neutral) == (False, True)
    assert (on.on, on.reason) == (True, "pinion on a seat of the bore")


def test_contributes_nothing_else_and_off_is_the_fixed_bore() -> None:
    model = ContactModel()
    after = BoreSeatElasticity().contribute(ContactScene(PAIR, np.array([100.0]), EFFECTS), model)
    assert [f.name for f in fields(model) if getattr(after, f.name) != getattr(model, f.name)] == ["parts"]
    loads = np.array([1e3])
    assert make_plan(PAIR, loads, AnalysisOptions(), model).bodies(PAIR) == (GEAR, GEAR)
    assert make_plan(PAIR, loads, AnalysisOptions(), after).bodies(PAIR) == (SEATED, GEAR)
    assert make_plan(FIXED, loads, AnalysisOptions(), after).bodies(FIXED)[0] is GEAR


def test_a_seat_acts_across_the_face_and_is_refused_in_the_plane() -> None:
    assert check_request(PAIR, TableAxes(torques=[1.0])).model.across_face
    with pytest.raises(InputError) as refusal:
        check_request(PAIR, TableAxes(torques=[1.0]), AnalysisOptions(model="plane_strain"))
    assert refusal.value.field == "pinion.seat"
    check_request(
        PAIR, TableAxes(torques=[1.0]), AnalysisOptions(model="plane_strain", effects={"bore_seat": "off"})
    )
