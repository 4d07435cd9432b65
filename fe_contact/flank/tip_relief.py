"""Tip relief, root relief and one-sided crowning (ISO 21771-1): removed towards either end of the profile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bounds import Direction
from fe_contact.flank.relief import ProfileRelief, Shape, amount, length, shape

_PROFILE = Direction.PROFILE


@dataclass(frozen=True, kw_only=True)
class TipRelief(ProfileRelief):
    """Relief from a radius to the tip circle."""

    _at_tip: ClassVar[bool] = True

    tip_relief: float = amount(_PROFILE, "Tip relief at the tip diameter", 20e-6)
    tip_relief_length: float = length(_PROFILE, "Length of the tip relief along the radius", 1.5e-3)
    tip_relief_shape: Shape = shape(_PROFILE, "Tip relief over its length")


@dataclass(frozen=True, kw_only=True)
class RootRelief(ProfileRelief):
    """Relief from a radius to the form circle."""

    _at_tip: ClassVar[bool] = False

    root_relief: float = amount(_PROFILE, "Root relief at the start of the involute", 10e-6)
    root_relief_length: float = length(_PROFILE, "Length of the root relief along the radius", 1e-3)
    root_relief_shape: Shape = shape(_PROFILE, "Root relief over its length")


@dataclass(frozen=True, kw_only=True)
class ProfileCrowningTip(ProfileRelief):
    """Parabola from the highest point of the profile to the tip circle."""

    _at_tip: ClassVar[bool] = True

    profile_crowning_tip: float = amount(
        _PROFILE, "Profile crowning at the tip alone, besides that at both ends", 5e-6, later=True
    )
    profile_crowning_tip_length: float = length(
        _PROFILE,
        "Length of the crowning to the tip along the radius, from its highest point",
        4e-3,
        later=True,
    )


@dataclass(frozen=True, kw_only=True)
class ProfileCrowningRoot(ProfileRelief):
    """Parabola from the highest point of the profile to the form circle."""

    _at_tip: ClassVar[bool] = False

    profile_crowning_root: float = amount(
        _PROFILE, "Profile crowning at the root alone, besides that at both ends", 5e-6, later=True
    )
    profile_crowning_root_length: float = length(
        _PROFILE,
        "Length of the crowning to the root along the radius, from its highest point",
        3e-3,
        later=True,
    )
