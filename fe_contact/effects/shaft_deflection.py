"""Shaft deflection: tooth forces bend the shafts, and the gears tilt in the plane of action."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.effects.shaft_compliance import SeatCompliance, ShaftCompliance


@dataclass(frozen=True)
class ShaftDeflection(Effect):
    """Misalignment in proportion to the load, and the mean deflection that goes with it."""

    name: ClassVar[str] = "shaft_deflection"
    needs: ClassVar[tuple[str, ...]] = ("face position", "load")
    adds: ClassVar[tuple[str, ...]] = ("compliance",)
    cost: ClassVar[str] = "none beside the three-dimensional model it needs"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#shaft_deflection", "Cowper 1966")
    valid_for: ClassVar[str] = "round shafts on two bearings, the gear rigid on its seat"

    def called_for(self, scene: ContactScene) -> Verdict:
        """Call for the effect where either gear has a shaft."""
        carried = [name for name, shaft in zip(("pinion", "wheel"), scene.pair.shafts, strict=True) if shaft]
        if not carried:
            return Verdict(False, "the gears are on rigid shafts", neutral=True)
        skew = f"{1e6 * _skew(scene):.3g} µm of misalignment at the largest load"
        return Verdict(True, f"{' and '.join(carried)} on a flexible shaft: {skew}")

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Add the compliance of both seats."""
        if not any(scene.pair.shafts):
            return model
        return replace(model, compliances=(*model.compliances, _term(scene)))

    def across_face(self, scene: ContactScene) -> str | None:
        """Return the reason for a model over the face, a flexible shaft; None: there is none."""
        return "shafts that bend" if any(scene.pair.shafts) else None

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene on rigid shafts."""
        return replace(scene, pair=replace(scene.pair, shafts=(None, None)))


def _term(scene: ContactScene) -> ShaftCompliance:
    seats = (None if shaft is None else SeatCompliance.of_shaft(shaft) for shaft in scene.pair.shafts)
    return ShaftCompliance(*seats)


def _skew(scene: ContactScene) -> float:
    """Return the growth of the gap over the face in m, for an even load at the pitch point."""
    pair = scene.pair
    half = 0.5 * pair.face_width
    face = pair.common_face_center + np.array([-half, 0.0, half])
    roll_1, roll_2 = (np.full((1, 3), float(roll)) for roll in pair.roll_lengths(0.0))
    force = float(pair.normal_force(scene.torque.max())) / math.cos(pair.base_helix_angle)
    # at both ends and the middle of the face, by the force in the middle
    deflection = force * _term(scene)(pair, roll_1, roll_2, face)[0, :, 1]
    return float(deflection[2] - deflection[0])
