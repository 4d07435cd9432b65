"""Gear pairs on which the influence of effects is estimated and measured."""

from __future__ import annotations

import math
from dataclasses import replace

from benchmarks.pair_cases import M, PairCase, face_cases, plane_cases
from fe_contact import BoreSeat, FlankModification, GearBlank, GearPair, PitchDeviation, RunOut, Shaft, Wave
from fe_contact.geometry import ParallelAxes

LOADS = (0.3, 1.0)
"""Loads over the rated load: light and full."""
SKEW = 15e-6
"""Misalignment, m."""


def influence_cases() -> list[PairCase]:
    """Return pairs in which every effect has something to do, each twice or more."""
    named = {case.name: case for case in (*plane_cases(), *face_cases())}
    return [replace(case, loads=LOADS) for case in (*named.values(), *_further(named))]


def _further(named: dict[str, PairCase]) -> list[PairCase]:
    """Pitch errors, shafts, seats and webs, and small amounts that a tolerance may neglect."""
    spur, small = named["spur 20/20"].pair, named["spur 18/18, misaligned"].pair
    helical = named["helical 18/23"].pair
    even = {"positions": 64}
    eccentric = PitchDeviation(tuple(8e-6 * math.sin(2.0 * math.pi * k / 20.0) for k in range(20)))
    early = PitchDeviation((3e-6, *([0.0] * 19)))
    shaft = Shaft(diameter=0.04, length=0.2, position=0.06, bearing_stiffness=4e8)
    soft = BoreSeat(radial_foundation=1e14, tangential_foundation=1e14, axial_foundation=1e14)
    web = GearBlank(2.5 * M, 1.5 * M, 14.0 * M)
    tips = FlankModification(tip_relief=20e-6, tip_relief_length=1.5e-3)
    faint = FlankModification(tip_relief=0.3e-6, tip_relief_length=1e-3)
    ends, flat = (FlankModification(helix_crowning=amount) for amount in (12e-6, 0.1e-6))
    exact = PitchDeviation((0.02e-6, *([0.0] * 19)))
    made: dict[str, tuple[ParallelAxes, dict[str, object]]] = {
        "spur 20/20, eccentric pinion": (_with(spur, pitch_deviation=eccentric), {}),
        "spur 20/20, one tooth early": (_with(spur, pitch_deviation=early), {}),
        "spur 20/20, run-out of 16 um": (_with(spur, run_out=RunOut(eccentricity=8e-6)), {}),
        "spur 20/20, 11 waves of 1 um": (_with(spur, waves=(Wave(11, 1e-6),)), {}),
        "spur 20/20, relief of 20 um": (_with(spur, modification=tips), {}),
        "spur 20/20, relief of 0.3 um": (_with(spur, modification=faint), {}),
        "spur 18/18, pinion on a shaft": (_with(small, shaft=shaft), even),
        "helical 18/23, pinion on a shaft": (_with(helical, shaft=shaft), even),
        "spur 18/18, seat": (_with(small, seat=soft), even),
        "spur 18/36, web": (_webbed(small, web), even),
        "spur 18/18, crowning of 12 um": (_with(small, modification=ends), even),
        "spur 18/18, 0.2 um misaligned": (small, even | {"misalignments": (0.2e-6,)}),
        "helical 18/23, 40 um misaligned": (helical, even | {"misalignments": (40e-6,)}),
        "helical 18/23, 0.3 um misaligned": (helical, even | {"misalignments": (0.3e-6,)}),
        "spur 18/18, 1 um misaligned": (small, even | {"misalignments": (1e-6,)}),
        "spur 18/18, crowning of 0.1 um": (_with(small, modification=flat), even),
        "spur 20/20, pitch errors of 0.02 um": (_with(spur, pitch_deviation=exact), {}),
    }
    return [PairCase(name, pair, options=options) for name, (pair, options) in made.items()]


def _with(pair: ParallelAxes, **more: object) -> GearPair:
    """Return the pair with something more on its pinion, or its shaft."""
    assert isinstance(pair, GearPair)
    if "shaft" in more:
        return replace(pair, shafts=(more["shaft"], None))  # type: ignore[arg-type]
    return replace(pair, pinion=replace(pair.pinion, **more))  # type: ignore[arg-type]


def _webbed(pair: ParallelAxes, blank: GearBlank) -> GearPair:
    """Return the pair with a wheel of twice the teeth on a web."""
    assert isinstance(pair, GearPair)
    wheel = replace(pair.wheel, teeth=36, blank=blank)
    distance = 0.5 * (pair.pinion.teeth + wheel.teeth) * M
    return replace(pair, wheel=wheel, center_distance=distance)
