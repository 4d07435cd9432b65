"""The exact transverse tooth profiles of gears: `FlankProfile` says what they can do."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from fe_contact.geometry.flank_profile import FlankProfile
from fe_contact.geometry.gear import Gear
from fe_contact.geometry.ring_gear import RingGear


@dataclass(frozen=True)
class ToothProfile(FlankProfile):
    """Right flank of one tooth of an external gear. Make it by `tooth_profile`."""

    gear: Gear


@dataclass(frozen=True)
class RingToothProfile(FlankProfile):
    """Right flank of one tooth of a ring gear; the tooth points from +y towards the centre."""

    gear: RingGear


@lru_cache(maxsize=256)
def tooth_profile(gear: Gear) -> ToothProfile:
    """Return the tooth profile of `gear`."""
    return ToothProfile(gear)


@lru_cache(maxsize=256)
def ring_tooth_profile(gear: RingGear) -> RingToothProfile:
    """Return the tooth profile of the ring gear."""
    return RingToothProfile(gear)
