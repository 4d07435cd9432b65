"""Modified helical pairs that are quiet: per cent of their ripple, below 0.3 um in most, measure nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from fe_contact import FlankModification, Gear, GearPair

UM = 1e-6
LOADS = (0.4, 1.0)
"""Loads over the nominal torque."""


@dataclass(frozen=True)
class QuietPair:
    """One pair with its nominal torque."""

    name: str
    pair: GearPair
    torque: float
    """Torque on the driving gear, N m."""
    misalignment: float = 0.0
    """Misalignment, m."""
    unseen: bool = False
    """Whether nothing about the estimates was decided on this pair: it assesses them."""

    @property
    def torques(self) -> list[float]:
        """The torques that are solved, N m."""
        return [load * self.torque for load in LOADS]


def quiet_pairs() -> list[QuietPair]:
    """Return the pairs, those that assess the estimates last."""
    return [*_seen(), *_unseen()]


def _seen() -> list[QuietPair]:
    plain: dict[str, Any] = {}
    rounded = {"profile_crowning": 3 * UM}
    return [
        QuietPair("23/67, 22 deg", _pair(1.8, (23, 67), 22, 30, _relief(15), crown=6), 50),
        QuietPair("23/67, misaligned", _pair(1.8, (23, 67), 22, 30, _relief(8), crown=3), 50, 8 * UM),
        QuietPair("23/67, plain profile", _pair(1.8, (23, 67), 22, 30, plain, crown=5), 40),
        QuietPair("25/52, 28 deg", _pair(2.5, (25, 52), 28, 25, _relief(10), crown=5), 120),
        QuietPair("25/52, helix slope", _pair(2.5, (25, 52), 28, 25, _relief(10), slope=6), 100),
        QuietPair("21/59, 24 deg", _pair(1.75, (21, 59), 24, 26, _relief(12), crown=5), 45),
        QuietPair("27/61, 27 deg, end relief", _pair(2.25, (27, 61), 27, 32, _relief(9), ends=6), 90),
        QuietPair("28/45, 23 deg", _pair(2.0, (28, 45), 23, 26, _relief(7, 0.4), crown=3), 70),
        QuietPair("31/47, 18 deg, plain profile", _pair(2.0, (31, 47), 18, 20.3, plain, crown=4), 60),
        QuietPair("20/37, 15 deg", _pair(4.0, (20, 37), 15, 48.5, _relief(15), crown=6), 250),
        QuietPair("39/40, 26 deg", _pair(2.0, (39, 40), 26, 28.7, _relief(8, 0.35), crown=4), 60),
        QuietPair("24/29, 20 deg, profile crowning", _pair(3.0, (24, 29), 20, 27.6, rounded, crown=4), 100),
    ]


def _unseen() -> list[QuietPair]:
    parabolic = _relief(9, 0.6, "parabolic")
    made = [
        QuietPair("26/57, 25 deg", _pair(2.0, (26, 57), 25, 29.7, _relief(10), crown=4), 70),
        QuietPair("22/63, 20 deg, plain profile", _pair(1.8, (22, 63), 20, 24.8, {}, crown=5), 40),
        QuietPair("34/43, misaligned", _pair(2.25, (34, 43), 23, 27, parabolic, crown=4), 90, 5 * UM),
        QuietPair("27/49, 30 deg, end relief", _pair(2.0, (27, 49), 30, 25, _relief(8), ends=5), 80),
        QuietPair("19/42, 16 deg", _pair(3.0, (19, 42), 16, 34.2, _relief(12), crown=5), 150),
    ]
    return [QuietPair(one.name, one.pair, one.torque, one.misalignment, unseen=True) for one in made]


def _relief(amount_um: float, modules: float = 0.5, shape: str = "linear") -> dict[str, Any]:
    """Return a tip relief; its length in modules."""
    return {"tip_relief": amount_um * UM, "tip_relief_length": modules, "tip_relief_shape": shape}


def _pair(
    module_mm: float,
    teeth: tuple[int, int],
    helix_deg: float,
    face_mm: float,
    profile: dict[str, Any],
    *,
    crown: float = 0.0,
    ends: float = 0.0,
    slope: float = 0.0,
) -> GearPair:
    """Return a pair whose gears have the same profile and whose pinion has the modified lead (um)."""
    module, helix = 1e-3 * module_mm, math.radians(helix_deg)
    if "tip_relief_length" in profile:
        profile = profile | {"tip_relief_length": profile["tip_relief_length"] * module}
    lead = {"helix_crowning": crown * UM, "helix_slope": slope * UM, "end_relief": ends * UM}
    lead["end_relief_length"] = 0.15e-3 * face_mm if ends else 0.0

    def gear(number: int, hand: float, along: dict[str, float]) -> Gear:
        return Gear(
            teeth=number,
            normal_module=module,
            face_width=1e-3 * face_mm,
            bore_diameter=0.45 * number * module,
            helix_angle=hand * helix,
            modification=FlankModification(**profile, **along),
        )

    pinion, wheel = gear(teeth[0], 1.0, lead), gear(teeth[1], -1.0, {})
    return GearPair(pinion, wheel, 0.5 * sum(teeth) * module / math.cos(helix))
