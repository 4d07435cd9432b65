"""Effects of the bodies: bore seat, thin rim and finite width, called for where they act."""

import dataclasses
from dataclasses import fields, replace

import numpy as np
import pytest
from analysis_requests import table_request
from spur_gears import GEAR, PAIR

from fe_contact import BoreSeat, FlankModification, Gear, GearBlank, GearPair, analyze
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS, ContactScene
from fe_contact.effects.bore_seat import BoreSeatElasticity
from fe_contact.effects.face_load_distribution import FaceLoadDistribution
from fe_contact.effects.finite_width import FiniteWidth
from fe_contact.effects.thin_rim import ThinRim
from fe_contact.errors import InputError
from fe_contact.geometry import web_compliance
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.material import Material
from fe_contact.options import AnalysisOptions, TableAxes
from fe_contact.planning.plan import make_plan

SEATED = replace(GEAR, seat=BoreSeat(tangential_foundation=1e13))
FIXED, SEATED_PAIR = GearPair(GEAR, GEAR), GearPair(SEATED, GEAR)


def test_a_seat_calls_for_its_effect_and_off_is_the_fixed_bore():
    off, on = (
        BoreSeatElasticity().called_for(ContactScene(p, np.array([100.0]), EFFECTS))
        for p in (FIXED, SEATED_PAIR)
    )
    assert (off.on, off.neutral) == (False, True)
    assert (on.on, on.reason) == (True, "pinion on a seat of the bore")
    model = ContactModel()
    after = BoreSeatElasticity().contribute(ContactScene(SEATED_PAIR, np.array([100.0]), EFFECTS), model)
    assert [f.name for f in fields(model) if getattr(after, f.name) != getattr(model, f.name)] == ["parts"]
    loads = np.array([1e3])
    assert make_plan(SEATED_PAIR, loads, AnalysisOptions(), model).bodies(SEATED_PAIR) == (GEAR, GEAR)
    assert make_plan(SEATED_PAIR, loads, AnalysisOptions(), after).bodies(SEATED_PAIR) == (SEATED, GEAR)
    assert make_plan(FIXED, loads, AnalysisOptions(), after).bodies(FIXED)[0] is GEAR


def test_a_seat_acts_across_the_face_and_is_refused_in_the_plane():
    assert check_request(SEATED_PAIR, TableAxes(torques=[1.0])).model.across_face
    with pytest.raises(InputError) as refusal:
        check_request(SEATED_PAIR, TableAxes(torques=[1.0]), AnalysisOptions(model="plane_strain"))
    assert refusal.value.field == "pinion.seat"
    check_request(
        SEATED_PAIR, *table_request(torques=[1.0], model="plane_strain", effects={"bore_seat": "off"})
    )


PINION = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
WHEEL = replace(PINION, teeth=30, blank=GearBlank(8e-3, 8e-3, 50e-3))
SOLID, WEBBED = GearPair(PINION, WHEEL.with_parts(("seat",))), GearPair(PINION, WHEEL)
COARSE = {"torques": [100.0], "level": "draft", "positions": 8}


def test_called_for_by_a_web_only_and_contributes_nothing_else():
    off, on = (
        ThinRim().called_for(ContactScene(p, np.array([50.0, 100.0]), EFFECTS)) for p in (SOLID, WEBBED)
    )
    assert (off.on, off.neutral) == (False, True)
    assert on.on
    assert on.reason == "wheel with rim and web"
    model = ContactModel()
    after = ThinRim().contribute(ContactScene(WEBBED, np.array([100.0]), EFFECTS), model)
    assert [f.name for f in fields(model) if getattr(after, f.name) != getattr(model, f.name)] == ["parts"]


@pytest.mark.law
def test_off_is_the_solid_pair_and_on_for_it_changes_no_bit():
    solid = analyze(SOLID, **COARSE, model="plane_strain")
    for pair, choice in ((SOLID, "on"), (WEBBED, "off")):
        found = analyze(pair, **COARSE, model="plane_strain", effects={"thin_rim": choice})
        assert np.array_equal(found.static_transmission_error, solid.static_transmission_error)
    webbed = analyze(WEBBED, **COARSE, model="plane_strain")
    change = webbed.mean(torque=100.0).value - solid.mean(torque=100.0).value
    minimum = 100.0 / PINION.base_radius * web_compliance(WHEEL)
    assert minimum < change < 6.0 * minimum


def test_a_web_acts_across_the_face_and_off_the_middle_not_in_the_plane():
    assert not check_request(SOLID, TableAxes(torques=[1.0])).model.across_face
    checked = check_request(WEBBED, TableAxes(torques=[1.0]))
    assert checked.model.across_face
    assert checked.model.parts == ("blank",)
    tilting = GearPair(PINION, replace(WHEEL, blank=GearBlank(8e-3, 8e-3, web_offset=2e-3)))
    with pytest.raises(InputError) as refusal:
        check_request(tilting, TableAxes(torques=[1.0]), AnalysisOptions(model="plane_strain"))
    assert refusal.value.field == "wheel.blank.web_offset"
    check_request(tilting, *table_request(torques=[1.0], model="plane_strain", effects={"thin_rim": "off"}))


def model(**options: object):
    asked = {"torques": [100.0], "level": "draft"} | options
    return check_request(PAIR, *table_request(**asked))


def test_an_aligned_spur_pair_is_corrected_and_nothing_else():
    scene = ContactScene(PAIR, np.array([100.0]), EFFECTS)
    assert FiniteWidth().called_for(scene).on
    assert not FaceLoadDistribution().called_for(scene).on
    crowned = dataclasses.replace(GEAR, modification=FlankModification(helix_crowning=5e-6))
    for beyond in (
        dataclasses.replace(scene, pair=GearPair(crowned, GEAR, 80e-3)),
        dataclasses.replace(scene, misalignment=np.array([0.0, 10e-6])),
    ):
        verdict = FiniteWidth().called_for(beyond)
        assert not verdict.on
        assert FaceLoadDistribution().called_for(beyond).reason in verdict.reason


@pytest.mark.parametrize(
    ("options", "across", "corrected"),
    [
        ({}, False, True),
        ({"effects": {"finite_width": "off"}}, False, False),
        ({"model": "plane_strain"}, False, False),
        ({"model": "plane_stress"}, False, False),
        ({"model": "plane_strain", "effects": {"finite_width": "on"}}, False, False),
        ({"model": "3d"}, True, False),
        ({"effects": {"face_load_distribution": "on"}}, True, False),
        ({"misalignments": [0.0, 1e-5]}, True, False),
    ],
)
def test_an_explicit_model_decides(options, across, corrected):
    checked = model(**options)
    assert (checked.model.across_face, checked.model.finite_width) == (across, corrected)
    on = {entry.name: entry.on for entry in checked.ledger}
    assert (on["face_load_distribution"], on["finite_width"]) == (across, corrected)
    plan = make_plan(PAIR, checked.request.load, checked.request.options, checked.model)
    assert plan.discretization.corrected is corrected
    assert ("finite_width" in plan.to_json()) is corrected


def test_the_estimate_falls_with_width_and_vanishes_with_poissons_ratio():
    def excess(width, ratio):
        gear = dataclasses.replace(GEAR, face_width=width, material=Material(210e9, ratio))
        return finite_width_excess(GearPair(gear, gear, 80e-3))[0]

    assert excess(25e-3, 0.0) == 0.0
    assert excess(5e-3, 0.3) > excess(25e-3, 0.3) > excess(80e-3, 0.3) > 0.0
    # the computed correction of these pairs: 5.4, 2.8 and 1.1 % (6.8 % with a ratio of 0.45)
    for width, ratio, computed in (
        (5e-3, 0.3, 0.054),
        (25e-3, 0.3, 0.028),
        (80e-3, 0.3, 0.0112),
        (25e-3, 0.45, 0.068),
    ):
        assert 1.0 / 1.2 < excess(width, ratio) / computed < 1.2
