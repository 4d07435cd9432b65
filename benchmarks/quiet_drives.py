"""Quiet helical pairs of electric drives, drawn by a seed, on which errors of their meshes are assessed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fe_contact import FlankModification, Gear, GearPair
from fe_contact.errors import FeContactError
from fe_contact.geometry.backlash import reference_center_distance
from fe_contact.types import FloatArray

UM = 1e-6
FLANKS = 3
"""Sets of flanks of each pair of bodies; the last is misaligned."""
SEED = 8
Draw = np.random.Generator


@dataclass(frozen=True)
class QuietDrive:
    """A pair of bodies with some sets of flanks."""

    name: str
    pairs: tuple[GearPair, ...]
    """The same bodies with other flanks."""
    misalignments: tuple[float, ...]
    """Misalignment of each pair, m."""
    loads: FloatArray
    """Normal forces up to the rated one, N. Shape (3,)."""


def quiet_drive(number: int, seed: int = SEED) -> QuietDrive:
    """Draw one; a draw that is no gear pair is drawn again."""
    draw = np.random.default_rng([seed, number])
    while True:
        try:
            return _drawn(draw, f"{seed}.{number}")
        except FeContactError:
            continue


def _drawn(draw: Draw, number: str) -> QuietDrive:
    module = 1e-3 * draw.uniform(1.5, 2.5)
    teeth = int(draw.integers(19, 30)), int(draw.integers(50, 91))
    helix, face = math.radians(draw.uniform(18.0, 30.0)), draw.uniform(10.0, 16.0) * module
    shifts, bore = (draw.uniform(0.0, 0.35), draw.uniform(-0.2, 0.2)), draw.uniform(0.4, 0.6)
    rated = draw.uniform(60.0, 150.0) * 1e6 * module * face
    loads = rated * np.array([draw.uniform(0.1, 0.35), draw.uniform(0.45, 0.75), 1.0])
    flanks = [_flanks(draw, module) for _ in range(FLANKS)]

    def gear(k: int, modification: dict[str, Any]) -> Gear:
        return Gear(
            teeth[k],
            module,
            face,
            bore_diameter=bore * teeth[k] * module,
            helix_angle=helix if k == 0 else -helix,
            profile_shift_coefficient=shifts[k],
            modification=FlankModification(**modification),
        )

    def pair(pinion: dict[str, Any], wheel: dict[str, Any]) -> GearPair:
        gears = gear(0, pinion), gear(1, wheel)
        return GearPair(*gears, reference_center_distance(*gears))

    pairs = tuple(pair(*both) for both in flanks)
    skews = (*[0.0] * (FLANKS - 1), draw.uniform(4.0, 15.0) * UM)
    words = f"{number} {teeth[0]}/{teeth[1]}, {1e3 * module:.2g} mm, {math.degrees(helix):.0f} deg"
    return QuietDrive(words, pairs, skews, loads)


def _flanks(draw: Draw, module: float) -> tuple[dict[str, Any], dict[str, Any]]:
    """Draw the flanks of both gears: tips relieved, in one half of the draws alike; the pinion is crowned."""
    pinion = _relief(draw, module)
    lead = {"helix_crowning": draw.uniform(2.0, 8.0) * UM}
    wheel = _relief(draw, module) if draw.random() < 0.5 else pinion
    return pinion | lead, wheel


def _relief(draw: Draw, module: float) -> dict[str, Any]:
    shape = ("linear", "parabolic")[int(draw.integers(2))]
    amount, length = draw.uniform(4.0, 16.0) * UM, draw.uniform(0.3, 0.65) * module
    return {"tip_relief": amount, "tip_relief_length": length, "tip_relief_shape": shape}
