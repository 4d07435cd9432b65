"""Face load distribution: three dimensions instead of the transverse plane."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Verdict
from fe_contact.geometry import CLAMPED
from fe_contact.geometry.finite_width import finite_width_excess


@dataclass(frozen=True)
class FaceLoadDistribution:
    """Finite face width with free ends, contact in slices, load distributed among them."""

    name: ClassVar[str] = "face_load_distribution"
    needs: ClassVar[tuple[str, ...]] = ("face position", "load")
    adds: ClassVar[tuple[str, ...]] = ("compliance", "candidates")
    cost: ClassVar[str] = "1 to 5 CPU s of finite elements instead of about 0.5; 31 times the candidates"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects/face_load_distribution.md",)
    valid_for: ClassVar[str] = "every pair"

    def called_for(self, scene: ContactScene) -> Verdict:
        """On where anything acts across the face."""
        reasons = across_face(scene)
        if reasons:
            return Verdict(True, "; ".join(reasons), "the plane model cannot hold it")
        worth = f"mean STE about {100 * finite_width_excess(scene.pair):.2g} % above plane strain"
        return Verdict(False, "a spur pair with nothing acting across the face", worth)

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Ask for three dimensions."""
        return replace(model, across_face=True)


def across_face(scene: ContactScene) -> list[str]:
    """List what in the scene acts across the face."""
    pair = scene.pair
    reasons = []
    if pair.pinion.helix_angle != 0.0:
        reasons.append(f"helix angle {np.degrees(pair.pinion.helix_angle):.4g} deg")
    if any(gear.modification.varies_along_face for gear in (pair.pinion, pair.wheel)):
        reasons.append("lead modification")
    if np.any(scene.misalignment != 0.0):
        reasons.append("misalignment")
    if any(pair.shafts):
        reasons.append("shafts that bend")
    if pair.pinion.web or pair.wheel.web:
        reasons.append("a web narrower than the face")
    if pair.pinion.seat != CLAMPED or pair.wheel.seat != CLAMPED:
        reasons.append("a seat of the bore")
    if pair.pinion.face_width != pair.wheel.face_width or pair.axial_offset != 0.0:
        reasons.append("faces that do not cover each other")
    return reasons
