"""Composition of effects: order, neutrality, refusals and the ledger."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest

from fe_contact.contact.model import ContactModel
from fe_contact.effects import EFFECTS, ContactScene, Effect, Verdict, compose
from fe_contact.errors import InputError
from fe_contact.geometry import FlankModification, Gear, GearPair

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


def test_everything_off_is_the_neutral_model():
    model, ledger = compose(scene(), EVERYTHING_OFF)
    assert model == ContactModel()
    assert not any(entry.on for entry in ledger)


def test_a_new_effect_needs_nothing_but_its_place_in_the_registry():
    wider = replace(scene(), registry=(*EFFECTS, Lapping()))
    model, ledger = compose(wider, {})
    assert lapped in model.gaps
    assert [entry.name for entry in ledger] == [*NAMES, "lapping"]
    assert compose(wider, {"lapping": "off"})[0] == compose(scene(), {})[0]


@pytest.mark.parametrize("registry", [(Lapping(), *EFFECTS), (*EFFECTS, Lapping())], ids=["first", "last"])
def test_gaps_add_up_whoever_comes_first(registry):
    model, _ = compose(replace(scene(), registry=registry), {"profile_modification": "on"})
    assert lapped in model.gaps
    assert len(model.gaps) == 2


@pytest.mark.parametrize("choice", ["on", "off"])
@pytest.mark.parametrize("name", NAMES)
def test_explicit_choices_are_obeyed(name, choice):
    _, ledger = compose(scene(), {name: choice})
    entry = next(e for e in ledger if e.name == name)
    assert entry.on == (choice == "on")
    assert entry.choice == choice


@pytest.mark.parametrize("name", NAMES)
def test_auto_follows_the_verdict(name):
    for case in (scene(), scene(tip_relief=300e-6, tip_relief_length=1e-3)):
        _, ledger = compose(case, {})
        entry = next(e for e in ledger if e.name == name)
        assert entry.on == entry.verdict.on
        assert entry.choice == "auto"


@pytest.mark.parametrize("choices", [{"corner_contacts": "on"}, {"": "off"}])
def test_unknown_effects_are_refused(choices):
    with pytest.raises(InputError) as refusal:
        compose(scene(), choices)
    assert refusal.value.field == f"effects.{next(iter(choices))}"
    assert all(name in str(refusal.value) for name in NAMES)


@pytest.mark.parametrize("choice", ["yes", "ON", "", True])
def test_unknown_choices_are_refused(choice):
    with pytest.raises(InputError) as refusal:
        compose(scene(), {"corner_contact": choice})
    assert refusal.value.field == "effects.corner_contact"
    assert '"auto"' in str(refusal.value)


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
        assert page["reason"]
        assert page["decision"]


@pytest.mark.parametrize("effect", EFFECTS, ids=NAMES)
def test_effects_declare_themselves(effect):
    assert effect.name.isidentifier()
    assert effect.needs
    assert effect.adds
    assert effect.cost
    assert effect.valid_for
    assert f"docs/effects.md#{effect.name}" in effect.sources


def test_names_are_unique():
    assert len(set(NAMES)) == len(NAMES)
