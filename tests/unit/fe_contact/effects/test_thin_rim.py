"""Thin rim: called for by a web, changes what the closed forms say, and nothing for solid bodies."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from fe_contact import Gear, GearBlank, GearPair, analyze
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS, ContactScene
from fe_contact.effects.thin_rim import ThinRim
from fe_contact.errors import InputError
from fe_contact.geometry import web_compliance
from fe_contact.options import AnalysisOptions, TableAxes

PINION = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
WHEEL = replace(PINION, teeth=30, blank=GearBlank(8e-3, 8e-3, 50e-3))
SOLID, WEBBED = GearPair(PINION, WHEEL.with_parts(("seat",))), GearPair(PINION, WHEEL)
COARSE = {"torques": [100.0], "level": "draft", "positions": 8}


def test_called_for_by_a_web_only() -> None:
    off, on = (
        ThinRim().called_for(ContactScene(p, np.array([50.0, 100.0]), EFFECTS)) for p in (SOLID, WEBBED)
    )
    assert (off.on, off.neutral) == (False, True)
    assert on.on
    assert on.reason == "wheel with rim and web"


def test_contributes_nothing_else() -> None:
    model = ContactModel()
    after = ThinRim().contribute(ContactScene(WEBBED, np.array([100.0]), EFFECTS), model)
    assert [f.name for f in fields(model) if getattr(after, f.name) != getattr(model, f.name)] == ["parts"]


@pytest.mark.law
def test_off_is_the_solid_pair_and_on_for_it_changes_no_bit() -> None:
    solid = analyze(SOLID, **COARSE, model="plane_strain")  # type: ignore[arg-type]
    for pair, choice in ((SOLID, "on"), (WEBBED, "off")):
        found = analyze(pair, **COARSE, model="plane_strain", effects={"thin_rim": choice})  # type: ignore[arg-type]
        assert np.array_equal(found.static_transmission_error, solid.static_transmission_error)
    webbed = analyze(WEBBED, **COARSE, model="plane_strain")  # type: ignore[arg-type]
    change = webbed.mean(torque=100.0).value - solid.mean(torque=100.0).value
    least = 100.0 / PINION.base_radius * web_compliance(WHEEL)
    assert least < change < 6.0 * least


def test_a_web_acts_across_the_face() -> None:
    assert not check_request(SOLID, TableAxes(torques=[1.0])).model.across_face
    checked = check_request(WEBBED, TableAxes(torques=[1.0]))
    assert checked.model.across_face
    assert checked.model.parts == ("blank",)


def test_a_web_off_the_middle_is_refused_in_the_plane_unless_it_is_left_out() -> None:
    tilting = GearPair(PINION, replace(WHEEL, blank=GearBlank(8e-3, 8e-3, web_offset=2e-3)))
    with pytest.raises(InputError) as refusal:
        check_request(tilting, TableAxes(torques=[1.0]), AnalysisOptions(model="plane_strain"))
    assert refusal.value.field == "wheel.blank.web_offset"
    check_request(
        tilting, TableAxes(torques=[1.0]), AnalysisOptions(model="plane_strain", effects={"thin_rim": "off"})
    )
