"""Composition of effects: order, neutrality, refusals, the ledger, and a scene without one of them."""

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair, PitchDeviation, RunOut, Shaft, ToothFlank, Wave
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS, ContactScene, Effect, Verdict, compose
from fe_contact.effects.effect import across_face
from fe_contact.errors import InputError

NAMES = [effect.name for effect in EFFECTS]
EVERYTHING_ON = dict.fromkeys(NAMES, "on")
EVERYTHING_OFF = dict.fromkeys(NAMES, "off")


def scene(torque: float = 100.0, **modification: float) -> ContactScene:
    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    modified = replace(gear, modification=FlankModification(**modification))
    return ContactScene(GearPair(modified, gear, center_distance=80e-3), np.array([10.0, torque]), EFFECTS)


@dataclass(frozen=True)
class Lapping(Effect):
    """A made-up effect that the composer has never heard of."""

    name = "lapping"
    needs = ("position",)
    adds = ("gap",)
    cost = "none"
    sources = ("made up",)
    valid_for = "this test"

    def called_for(self, scene: ContactScene) -> Verdict:
        return Verdict(True, "always")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        return replace(model, gaps=(*model.gaps, lapped))


def lapped(pair, roll_1, roll_2):
    return np.full_like(roll_1, 3e-6)


@pytest.mark.parametrize(
    "order",
    [turned[::way] for k in range(len(EFFECTS)) for turned in [EFFECTS[k:] + EFFECTS[:k]] for way in (1, -1)],
    ids=lambda order: "-".join(effect.name for effect in order),
)
@pytest.mark.parametrize("choices", [{}, EVERYTHING_ON])
def test_order_does_not_matter(order, choices):
    case = scene(tip_relief=10e-6, tip_relief_length=1e-3)
    assert compose(replace(case, registry=order), choices)[0] == compose(case, choices)[0]


def test_everything_off_is_neutral_and_a_new_effect_needs_only_its_place():
    model, ledger = compose(scene(), EVERYTHING_OFF)
    assert model == ContactModel()
    assert not any(entry.on for entry in ledger)
    wider = replace(scene(), registry=(*EFFECTS, Lapping()))
    model, ledger = compose(wider, {})
    assert lapped in model.gaps
    assert [entry.name for entry in ledger] == [*NAMES, "lapping"]
    assert compose(wider, {"lapping": "off"})[0] == compose(scene(), {})[0]
    assert len(set(NAMES)) == len(NAMES)


@pytest.mark.parametrize("registry", [(Lapping(), *EFFECTS), (*EFFECTS, Lapping())], ids=["first", "last"])
def test_gaps_add_up_whoever_comes_first(registry):
    model, _ = compose(replace(scene(), registry=registry), {"profile_modification": "on"})
    assert lapped in model.gaps
    assert len(model.gaps) == 2


@pytest.mark.parametrize("name", NAMES)
def test_explicit_choices_are_obeyed_and_auto_follows_the_verdict(name):
    relieved = scene(tip_relief=300e-6, tip_relief_length=1e-3)
    for case, choice in ((scene(), "on"), (scene(), "off"), (scene(), "auto"), (relieved, "auto")):
        _, ledger = compose(case, {} if choice == "auto" else {name: choice})
        entry = next(e for e in ledger if e.name == name)
        assert entry.on == (entry.verdict.on if choice == "auto" else choice == "on")
        assert entry.choice == choice


@pytest.mark.parametrize(
    ("name", "choice", "said"),
    [("corner_contacts", "on", NAMES), ("", "off", NAMES)]
    + [("corner_contact", choice, ['"auto"']) for choice in ("yes", "ON", "", True)],
)
def test_unknown_effects_and_choices_are_refused(name, choice, said):
    with pytest.raises(InputError) as refusal:
        compose(scene(), {name: choice})
    assert refusal.value.field == f"effects.{name}"
    assert all(word in str(refusal.value) for word in said)


@pytest.mark.parametrize("choices", [{}, EVERYTHING_OFF])
def test_the_ledger_says_what_was_decided_and_why(choices):
    _, ledger = compose(scene(), choices)
    for entry, effect in zip(ledger, EFFECTS, strict=True):
        page = entry.to_json()
        assert json.loads(json.dumps(page)) == page
        assert set(page) == {"name", "on", "choice", "cost", "reason", "called_for", "decision"}
        assert page["name"] == effect.name
        assert page["on"] == entry.on
        assert page["called_for"] == entry.verdict.on
        assert page["reason"] and page["decision"]


@pytest.mark.parametrize("effect", EFFECTS, ids=NAMES)
def test_effects_declare_themselves(effect):
    assert effect.name.isidentifier()
    assert effect.needs and effect.adds and effect.cost and effect.valid_for
    assert f"docs/effects.md#{effect.name}" in effect.sources


FULL = Gear(
    20,
    4e-3,
    25e-3,
    40e-3,
    pitch_deviation=PitchDeviation((0.0, *19 * (3e-6,))),
    modification=FlankModification(tip_relief=20e-6, tip_relief_length=2e-3, helix_crowning=5e-6),
    run_out=RunOut(eccentricity=5e-6),
    waves=(Wave(11, 2e-7),),
    tooth_flanks=(ToothFlank(3, profile_slope=2e-6),),
)
SHAFT = Shaft(length=0.2, diameter=0.04, position=0.06)
FULL_SCENE = ContactScene(
    GearPair(FULL, FULL, 80e-3, shafts=(SHAFT, SHAFT)), np.array([50.0, 100.0]), EFFECTS, np.array([10e-6])
)
OWN = (
    "profile_modification",
    "lead_modification",
    "misalignment",
    "pitch_error",
    "tooth_deviations",
    "shaft_deflection",
)


def test_these_have_something_of_their_own_in_the_scene():
    rest = {effect.name: effect.without(FULL_SCENE) for effect in EFFECTS}
    assert tuple(name for name, scene in rest.items() if scene is not None and scene is not FULL_SCENE) == OWN


@pytest.mark.parametrize("name", OWN)
def test_nothing_is_left_of_it_and_all_of_the_others(name):
    effect = FULL_SCENE.effect(name)
    rest = effect.without(FULL_SCENE)
    assert rest is not None
    assert (effect.called_for(FULL_SCENE).neutral, effect.called_for(rest).neutral) == (False, True)
    assert effect.across_face(rest) is None
    assert len(across_face(rest)) == len(across_face(FULL_SCENE)) - (
        effect.across_face(FULL_SCENE) is not None
    )
    for other in OWN:
        if other != name:
            assert FULL_SCENE.effect(other).called_for(rest).on
    rest = FULL_SCENE.effect(name).without(FULL_SCENE)
    assert rest is not None
    choices = {"corner_contact": "on", "face_load_distribution": "on", "finite_width": "off"}
    off, _ = compose(FULL_SCENE, {**choices, name: "off"})
    assert repr(off) == repr(compose(rest, choices)[0])
