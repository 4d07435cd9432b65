"""Everything in a scene that acts across the face, so that a plane cannot hold it."""

from __future__ import annotations

import numpy as np

from fe_contact.effects.effect import ContactScene


def across_face(scene: ContactScene) -> list[str]:
    """List what in the scene acts across the face."""
    pair = scene.pair
    reasons = []
    if pair.pinion.helix_angle != 0.0:
        reasons.append(f"helix angle {np.degrees(pair.pinion.helix_angle):.4g} deg")
    reasons += [reason for effect in scene.registry if (reason := effect.across_face(scene))]
    if pair.pinion.face_width != pair.wheel.face_width or pair.axial_offset != 0.0:
        reasons.append("unequal or offset faces")
    return reasons
