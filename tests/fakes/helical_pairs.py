"""A small helical pair of either hand, for tests over the face."""

from __future__ import annotations

import math
from typing import Any

from fe_contact import Gear, GearPair


def helical(hand: int) -> GearPair:
    """Overlap ratio 0.87, the pinion right-handed if `hand` is 1."""
    sizes: dict[str, Any] = {"normal_module": 3e-3, "face_width": 24e-3, "bore_diameter": 30e-3}
    angle = hand * math.radians(20.0)
    pinion, wheel = (Gear(teeth=20, helix_angle=beta, **sizes) for beta in (angle, -angle))
    return GearPair(pinion, wheel, 2.0 * pinion.reference_radius)
