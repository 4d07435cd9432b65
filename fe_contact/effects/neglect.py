"""A scene without what an effect models, for effects that are too small for their cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from fe_contact.effects.corner_contact import CornerContact
from fe_contact.effects.effect import ContactScene
from fe_contact.effects.finite_width import FiniteWidth
from fe_contact.effects.lead_modification import LeadModification
from fe_contact.effects.misalignment import Misalignment
from fe_contact.effects.pitch_error import PitchError
from fe_contact.effects.profile_modification import ProfileModification
from fe_contact.effects.shaft_deflection import ShaftDeflection
from fe_contact.geometry import PitchDeviation, Toothing


def _same(scene: ContactScene) -> ContactScene:
    """Nothing in the scene stands for the effect alone."""
    return scene


def _aligned(scene: ContactScene) -> ContactScene:
    return replace(scene, misalignment=np.zeros_like(scene.misalignment))


def _rigid_shafts(scene: ContactScene) -> ContactScene:
    return replace(scene, pair=replace(scene.pair, shafts=(None, None)))  # type: ignore[call-arg]


def _each_gear(change: Callable[[Toothing], Toothing]) -> Callable[[ContactScene], ContactScene]:
    """Return a function that changes both gears."""

    def without(scene: ContactScene) -> ContactScene:
        gears = {name: change(getattr(scene.pair, name)) for name in ("pinion", "wheel")}
        return replace(scene, pair=replace(scene.pair, **gears))

    return without


def _plain_profile(gear: Toothing) -> Toothing:
    return replace(gear, modification=gear.modification.along_face)  # type: ignore[call-arg]


def _plain_lead(gear: Toothing) -> Toothing:
    return replace(gear, modification=gear.modification.along_profile)  # type: ignore[call-arg]


def _teeth_in_place(gear: Toothing) -> Toothing:
    return replace(gear, pitch_deviation=PitchDeviation())  # type: ignore[call-arg]


WITHOUT: dict[str, Callable[[ContactScene], ContactScene]] = {
    CornerContact.name: _same,
    FiniteWidth.name: _same,
    Misalignment.name: _aligned,
    ShaftDeflection.name: _rigid_shafts,
    ProfileModification.name: _each_gear(_plain_profile),
    LeadModification.name: _each_gear(_plain_lead),
    PitchError.name: _each_gear(_teeth_in_place),
}
"""Effects that cost something and whose influence is estimated well, with the scene as if there were
nothing for them. Tooth coupling costs nothing; three dimensions follow from the other effects; of rims and
seats the estimate is coarse."""
