"""The exact transverse tooth profile of a gear: `FlankProfile` says what it can do."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from fe_contact.geometry.flank_profile import FlankProfile
from fe_contact.geometry.toothing import Toothing


@dataclass(frozen=True)
class ToothProfile(FlankProfile):
    """Right flank of one tooth; a ring gear's points towards the center. Make it by `tooth_profile`."""

    gear: Toothing


@lru_cache(maxsize=256)
def tooth_profile(gear: Toothing) -> ToothProfile:
    """Return the tooth profile of a `Gear` or a `RingGear`."""
    return ToothProfile(gear)
