"""A scene without what an effect models holds nothing for it, and everything for the others."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.effects.effect import across_face
from fe_contact.geometry import FlankModification, Gear, GearPair, PitchDeviation, Shaft

GEAR = Gear(
    teeth=20,
    normal_module=4e-3,
    face_width=25e-3,
    bore_diameter=40e-3,
    pitch_deviation=PitchDeviation((0.0, *19 * (3e-6,))),
    modification=FlankModification(tip_relief=20e-6, tip_relief_length=2e-3, helix_crowning=5e-6),
)
SHAFT = Shaft(length=0.2, diameter=0.04, position=0.06)
SCENE = ContactScene(
    GearPair(GEAR, GEAR, 80e-3, shafts=(SHAFT, SHAFT)), np.array([50.0, 100.0]), EFFECTS, np.array([10e-6])
)
OWN = ("profile_modification", "lead_modification", "misalignment", "pitch_error", "shaft_deflection")


def test_these_have_something_of_their_own_in_the_scene():
    rest = {effect.name: effect.without(SCENE) for effect in EFFECTS}
    assert tuple(name for name, scene in rest.items() if scene is not None and scene is not SCENE) == OWN


@pytest.mark.parametrize("name", OWN)
def test_nothing_is_left_of_it_and_all_of_the_others(name):
    effect = SCENE.effect(name)
    rest = effect.without(SCENE)
    assert rest is not None
    assert (effect.called_for(SCENE).neutral, effect.called_for(rest).neutral) == (False, True)
    assert effect.across_face(rest) is None
    assert len(across_face(rest)) == len(across_face(SCENE)) - (effect.across_face(SCENE) is not None)
    for other in OWN:
        if other != name:
            assert SCENE.effect(other).called_for(rest).on


@pytest.mark.parametrize("name", OWN)
def test_off_is_the_model_of_the_scene_without_it(name):
    rest = SCENE.effect(name).without(SCENE)
    assert rest is not None
    choices = {"corner_contact": "on", "face_load_distribution": "on", "finite_width": "off"}
    off, _ = compose(SCENE, {**choices, name: "off"})
    assert repr(off) == repr(compose(rest, choices)[0])
