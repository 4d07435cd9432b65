"""A planetary stage from few arguments, its data by rule."""

from __future__ import annotations

import math
from dataclasses import dataclass

from lineofaction.cli.options import PairWishes
from lineofaction.cli.pair_sketch import (
    GearSketch,
    PairSketch,
    blank_table,
    bore_diameter,
    face_width,
    ring_pair,
)
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import DEGREE

PLANETS = 3

_MIN_TEETH = 18
"""Least number of teeth of a planet: with fewer, teeth without profile shift are undercut."""


def planetary_stage(wishes: PairWishes) -> StageSketch:
    """Return a stage of three planets; its ring has the teeth of the sun plus twice the planet's.

    Raises `BadInput`: no planets fit a ratio that small.
    """
    module, teeth, helix = wishes.module or 2.0, wishes.teeth or 24, wishes.helix or 0.0
    wished = 0.5 * teeth * ((wishes.ratio or 5.0) - 2.0)
    # equal spacing: PLANETS divides sun plus planet; up to one spacing above the wished number
    fitting = [count for count in range(_MIN_TEETH, int(wished) + 4) if (teeth + count) % PLANETS == 0]
    if not fitting or wished < _MIN_TEETH:
        minimum = 2.0 + 2.0 * _MIN_TEETH / teeth
        bound = f"at least {minimum:.3g} with {teeth} teeth of the sun"
        raise BadInput.of("--ratio", wishes.ratio, bound, "Or leave it out.")
    planet = min(fitting, key=lambda count: abs(count - wished))
    width = wishes.width or face_width(module, helix)
    ring = ring_pair(module, helix, width, planet, teeth + 2 * planet)
    transverse = module / math.cos(helix * DEGREE)
    sun = GearSketch(
        teeth, 0.0, bore_diameter(blank_table(teeth, module, helix, width)), ring.wheel.allowance
    )
    torque = tuple(float(f"{value * teeth / planet:.2g}") for value in ring.torque)
    pair = PairSketch(module, helix, width, 0.5 * transverse * (teeth + planet), sun, ring.pinion, torque)
    return StageSketch(pair, ring, 2.0 + 2.0 * planet / teeth)


@dataclass(frozen=True)
class StageSketch:
    """Both meshes of a stage with a held ring, and its ratio of sun to carrier."""

    sun: PairSketch
    ring: PairSketch
    ratio: float
