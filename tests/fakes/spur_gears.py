"""The gears of most tests of contact analysis: module 4 mm, 25 mm wide."""

from __future__ import annotations

from typing import Any

from fe_contact.geometry import Gear, GearPair, RingGear

SIZE: dict[str, Any] = {"normal_module": 4e-3, "face_width": 25e-3}


def gear(teeth: int = 20, **changes: Any) -> Gear:
    """Return a gear with a bore of 40 mm."""
    return Gear(teeth=teeth, **(SIZE | {"bore_diameter": 40e-3} | changes))


def make_gear(teeth: int = 20, **changes: Any) -> Gear:
    return gear(teeth, **({"bore_diameter": 2e-3} | changes))


def make_ring(teeth: int = 60, **changes: Any) -> RingGear:
    return RingGear(teeth=teeth, **(SIZE | {"rim_diameter": 5e-3 * teeth} | changes))


GEAR = gear()
PAIR = GearPair(GEAR, GEAR, 80e-3)
