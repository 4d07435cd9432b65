"""What in a scene acts across the face, so that a plane cannot hold it."""

from __future__ import annotations

import numpy as np

from fe_contact.effects.effect import ContactScene
from fe_contact.geometry import CLAMPED


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
