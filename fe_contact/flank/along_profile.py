"""Modifications along the profile (ISO 21771-1): crowning, slope, reliefs and the edge of the tip.

A `Polynomial` removes ``weight depth (u^m v^n - mean)`` with the exponents `powers` = (m, n); u runs from -1
at the form point to 1 at the tip over the roll length, v from -1 to 1 over the face. A `ProfileRelief`
removes its amount over a length from the tip (`_at_tip`) or from the form circle into the flank.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bounds import Direction
from fe_contact.flank.part import Polynomial
from fe_contact.flank.relief import ProfileRelief, amount, length, shape, slope
from fe_contact.flank.relief_shape import Shape
from fe_contact.flank.tip_edge import CutTip

_PROFILE = Direction.PROFILE


@dataclass(frozen=True, kw_only=True)
class _ProfileCrowning(Polynomial):
    """Parabola with its highest point in the middle of the roll length."""

    profile_crowning: float = amount(_PROFILE, "Profile crowning at both ends of the profile", 5e-6)
    powers: ClassVar[tuple[int, int]] = (2, 0)


@dataclass(frozen=True, kw_only=True)
class _ProfileCrowningTip(ProfileRelief):
    """Parabola from the highest point of the profile to the tip circle."""

    _at_tip: ClassVar[bool] = True

    profile_crowning_tip: float = amount(
        _PROFILE, "Profile crowning at the tip alone, besides that at both ends", 5e-6, omit_default=True
    )
    profile_crowning_tip_length: float = length(
        _PROFILE,
        "Length of the crowning to the tip along the radius, from its highest point",
        4e-3,
        omit_default=True,
    )


@dataclass(frozen=True, kw_only=True)
class _ProfileCrowningRoot(ProfileRelief):
    """Parabola from the highest point of the profile to the form circle."""

    _at_tip: ClassVar[bool] = False

    profile_crowning_root: float = amount(
        _PROFILE, "Profile crowning at the root alone, besides that at both ends", 5e-6, omit_default=True
    )
    profile_crowning_root_length: float = length(
        _PROFILE,
        "Length of the crowning to the root along the radius, from its highest point",
        3e-3,
        omit_default=True,
    )


@dataclass(frozen=True, kw_only=True)
class _ProfileSlope(Polynomial):
    """Straight line over the roll length; the figure is its difference from end to end."""

    profile_slope: float = slope(
        _PROFILE,
        "Profile slope, linear over the roll length; > 0 removes half at the tip, adds half at the root",
        5e-6,
    )
    powers: ClassVar[tuple[int, int]] = (1, 0)
    weight: ClassVar[float] = 0.5  # u goes from -1 to 1: half the figure at either end


@dataclass(frozen=True, kw_only=True)
class _ProfileForm(Polynomial):
    """Form deviation f_falpha that all teeth share: a parabola whose mean line over the profile is zero."""

    profile_form: float = slope(
        _PROFILE,
        "Profile form of all teeth, a parabola of this height; > 0 removes two thirds at both ends of the "
        "profile, adds a third in its middle; < 0: hollow",
        2e-6,
        omit_default=True,
    )
    powers: ClassVar[tuple[int, int]] = (2, 0)
    mean: ClassVar[float] = 1.0 / 3.0  # mean of u^2 from -1 to 1


@dataclass(frozen=True, kw_only=True)
class _TipRelief(ProfileRelief):
    _at_tip: ClassVar[bool] = True

    tip_relief: float = amount(_PROFILE, "Tip relief at the tip diameter", 20e-6)
    tip_relief_length: float = length(_PROFILE, "Length of the tip relief along the radius", 1.5e-3)
    tip_relief_shape: Shape = shape(_PROFILE, "Tip relief over its length")


@dataclass(frozen=True, kw_only=True)
class _RootRelief(ProfileRelief):
    _at_tip: ClassVar[bool] = False

    root_relief: float = amount(_PROFILE, "Root relief at the start of the involute", 10e-6)
    root_relief_length: float = length(_PROFILE, "Length of the root relief along the radius", 1e-3)
    root_relief_shape: Shape = shape(_PROFILE, "Root relief over its length")


class AlongProfile(
    _ProfileCrowning,
    _ProfileCrowningTip,
    _ProfileCrowningRoot,
    _ProfileSlope,
    _ProfileForm,
    _TipRelief,
    _RootRelief,
    CutTip,
):
    """All modifications along the profile. The order of the bases is the order of their fields."""
