"""Corner contact: loaded teeth bend until tip edges touch off the line of action, before A and after E."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Effect, Verdict
from fe_contact.flank.extent import Extent
from fe_contact.geometry import ParallelAxes, Toothing, blank_factor
from fe_contact.geometry.iso6336_stiffness import STEEL_STIFFNESS, modulus_ratio
from fe_contact.hertz import relative_radius

_ALONG_EDGE = 33
_ALONG_FLANK = 401


@dataclass(frozen=True)
class CornerContact(Effect):
    """Tip edges on the mating flanks, with exact rigid gaps and as soft as a wedge (`wedge_softness`)."""

    name: ClassVar[str] = "corner_contact"
    brings: ClassVar[str] = "corner_contact"
    needs: ClassVar[tuple[str, ...]] = ("position", "load", "curvature")
    adds: ClassVar[tuple[str, ...]] = ("candidates", "gap")
    cost: ClassVar[str] = "two more candidates a position; no finite-element work"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects.md#corner_contact",)
    valid_for: ClassVar[str] = "sharp, rounded and chamfered tip edges"

    def called_for(self, scene: ContactScene) -> Verdict:
        """Call for the effect unless tip relief keeps the edges and the flanks next to them apart."""
        pair = scene.pair
        deflection = _largest_deflection(scene)
        relief = _least_tip_gap(pair)
        clear = relief > 2.0 * deflection
        sharp = all(gear.tip_form_radius == gear.tip_radius for gear in (pair.pinion, pair.wheel))
        missing = "tip relief" if sharp else "relief, rounding or chamfer of the tips"
        reason = (
            f"{missing} leaves {1e6 * relief:.1f} µm, over twice the bending of {1e6 * deflection:.1f} µm"
            if clear
            else f"deflections up to {1e6 * deflection:.1f} µm close the gap at the tip edges"
        )
        return Verdict(not clear, reason)

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Let tip edges touch."""
        return replace(model, corner_contact=True)

    def extent(self, scene: ContactScene) -> Extent:
        """Return bounds of the change: from 0 to the excess of deflections over the gaps at the tip edges."""
        return Extent(0.0, max(_largest_deflection(scene) - _least_tip_gap(scene.pair), 0.0))

    def without(self, scene: ContactScene) -> ContactScene:
        """Return the scene itself: nothing in it stands for the effect alone."""
        return scene


def _least_tip_gap(pair: ParallelAxes) -> float:
    """Least gap in m between flanks whose plain involutes end contact at a tip edge.

    A relief that falls off steeply only moves the touching point away from the edge, to where the gap of the
    curved flanks and the relief together are least. The edges must be clear all over the face.
    """
    path = pair.path_of_contact
    ends = [(end, pair.wheel.sign * float(pair.mating_roll_length(end))) for end in (path.end, path.start)]
    radii = [float(relative_radius(*rolls)) for rolls in ends]
    return min(
        _gap_at_tip(gear, radius) for gear, radius in zip((pair.pinion, pair.wheel), radii, strict=True)
    )


@lru_cache(maxsize=16)
def _gap_at_tip(gear: Toothing, radius: float) -> float:
    """Return the least sum of material removed and gap of plain flanks near the tip edge of one gear, m."""
    if gear.modification.neutral:
        return 0.0
    face = np.linspace(-0.5, 0.5, _ALONG_EDGE) * gear.face_width
    roll = np.linspace(gear.tip_roll_length, gear.form_roll_length, _ALONG_FLANK)[:, None]
    distance = np.abs(gear.tip_roll_length**2 - roll**2) / (2.0 * gear.base_radius)
    removed = gear.modification.material_removed(gear, roll, face)
    return float(np.min(removed + distance**2 / (2.0 * radius)))


def _largest_deflection(scene: ContactScene) -> float:
    """Return the deflection in m of one pair under the whole load, by the stiffness after ISO 6336.

    That of the pair's moduli, and of its bodies where they are rims on webs.
    """
    pair = scene.pair
    body = 0.5 * (blank_factor(pair.pinion) + blank_factor(pair.wheel))
    stiffness = STEEL_STIFFNESS * body * modulus_ratio(pair)
    width = min(pair.pinion.face_width, pair.wheel.face_width)
    return float(scene.torque.max()) / pair.pinion.base_radius / width / stiffness
