"""When the plane is corrected for a finite width, and who decides."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair
from fe_contact.analysis.request.request_check import check_request
from fe_contact.effects import EFFECTS, ContactScene
from fe_contact.effects.face_load_distribution import FaceLoadDistribution
from fe_contact.effects.finite_width import FiniteWidth
from fe_contact.geometry.web_compliance import finite_width_excess
from fe_contact.material import Material
from fe_contact.planning.plan import make_plan

GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
PAIR = GearPair(GEAR, GEAR, 80e-3)


def model(**options: object):
    asked = {"torques": [100.0], "level": "draft"} | options
    return check_request(PAIR, *table_request(**asked))  # type: ignore[arg-type]


def test_an_aligned_spur_pair_is_corrected_and_nothing_else() -> None:
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
def test_an_explicit_model_decides(options: dict[str, object], across: bool, corrected: bool) -> None:
    checked = model(**options)
    assert (checked.model.across_face, checked.model.finite_width) == (across, corrected)
    on = {entry.name: entry.on for entry in checked.ledger}
    assert (on["face_load_distribution"], on["finite_width"]) == (across, corrected)
    plan = make_plan(PAIR, checked.request.load, checked.request.options, checked.model)
    assert plan.discretization.corrected is corrected
    assert ("finite_width" in plan.to_json()) is corrected


def test_the_estimate_falls_with_width_and_vanishes_with_poissons_ratio() -> None:
    def excess(width: float, ratio: float) -> float:
        gear = dataclasses.replace(GEAR, face_width=width, material=Material(210e9, ratio))
        return finite_width_excess(GearPair(gear, gear, 80e-3))

    assert excess(25e-3, 0.0) == 0.0
    assert excess(5e-3, 0.3) > excess(25e-3, 0.3) > excess(80e-3, 0.3) > 0.0
    # the computed correction of these pairs: 5.4, 2.8 and 1.1 % (6.8 % with a ratio of 0.45)
    for width, ratio, computed in (
        (5e-3, 0.3, 0.054),
        (25e-3, 0.3, 0.028),
        (80e-3, 0.3, 0.0112),
        (25e-3, 0.45, 0.068),
    ):
        assert 1.0 / 1.5 < excess(width, ratio) / computed < 1.5
