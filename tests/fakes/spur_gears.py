"""The gears of most tests of contact analysis: module 4 mm, 25 mm wide."""

import math
from dataclasses import replace
from typing import Any

from fe_contact.geometry import FlankModification, Gear, GearPair, RingGear

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


def _with_long_reliefs() -> GearPair:
    path = PAIR.path_of_contact
    single = math.hypot(GEAR.base_radius, path.start + path.base_pitch)
    room = replace(GEAR, modification=FlankModification(tip_relief_length=GEAR.tip_radius - single))
    return replace(PAIR, pinion=room, wheel=room)


LONG_RELIEFS = _with_long_reliefs()
"""The pair with room for tip reliefs down to where a single pair of teeth carries."""
