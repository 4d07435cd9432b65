"""Gear pairs with their loads, and those that benchmarks share."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from fe_contact import FlankModification, Gear, GearPair
from fe_contact.geometry import GearBlank, InternalGearPair, ParallelAxes
from fe_contact.geometry.ring_gear import RingGear
from fe_contact.options import AnalysisOptions, TableAxes

M = 3e-3
"""Normal module, m."""
RATED = 50.0
"""Normal force over face width and module, N/mm2: about the rated load of the pairs."""


@dataclass(frozen=True)
class PairCase:
    """One pair with its loads over the rated one."""

    name: str
    pair: ParallelAxes
    loads: tuple[float, ...] = (0.2, 1.0, 2.5)
    options: Mapping[str, Any] = field(default_factory=dict)
    """Further arguments of `analyze`."""

    @property
    def forces(self) -> list[float]:
        """Normal forces in N."""
        module = self.pair.pinion.normal_module
        return [load * RATED * 1e6 * module * self.pair.face_width for load in self.loads]

    def request(self, **others: Any) -> tuple[TableAxes, AnalysisOptions]:
        """Return the axes of the case, and its options with others."""
        options = {**self.options, **others}
        skews = options.pop("misalignments", (0.0,))
        return TableAxes(normal_forces=self.forces, misalignments=skews), AnalysisOptions(**options)


def gear_of(teeth: int, face: float = 6.0, **more: Any) -> Gear:
    """Return a gear of `face` modules."""
    return Gear(teeth=teeth, normal_module=M, face_width=face * M, bore_diameter=0.5 * teeth * M, **more)


def spur_pair(one: Gear, two: Gear, apart: float = 0.0) -> GearPair:
    """Return a pair at its reference distance, moved by `apart` modules."""
    helix = math.cos(one.helix_angle)
    return GearPair(one, two, (0.5 * (one.teeth + two.teeth) / helix + apart) * M)


def helical_pair(one: int, two: int, angle: float, face: float = 6.0, **more: Any) -> GearPair:
    """Return a helical pair; `more` belongs to the pinion."""
    beta = math.radians(angle)
    return spur_pair(gear_of(one, face, helix_angle=beta, **more), gear_of(two, face, helix_angle=-beta))


def plane_cases() -> list[PairCase]:
    """Return spur pairs with nothing acting across the face."""
    relieved = FlankModification(tip_relief=12e-6, tip_relief_length=2e-3)
    crowned = FlankModification(profile_crowning=8e-6)
    ring = RingGear(60, M, 6.0 * M, rim_diameter=72.0 * M, tip_diameter=58.5 * M)
    spread = {"profile_shift_coefficient": 0.3}
    return [
        PairCase("spur 20/20", spur_pair(gear_of(20), gear_of(20))),
        PairCase("spur 17/43, shifted", spur_pair(gear_of(17, **spread), gear_of(43), 0.295)),
        PairCase("spur 30/60, tip relief", spur_pair(gear_of(30, modification=relieved), gear_of(60))),
        PairCase("spur 25/31, profile crowning", spur_pair(gear_of(25, modification=crowned), gear_of(31))),
        PairCase("spur 24/37, center distance + 0.1 modules", spur_pair(gear_of(24), gear_of(37), 0.1)),
        PairCase("spur 20/20, face of 1.2 modules", spur_pair(gear_of(20, 1.2), gear_of(20, 1.2))),
        PairCase(
            "spur 20/40, thin rim",
            spur_pair(gear_of(20), gear_of(40, blank=GearBlank(2.0 * M, 1.5 * M, 25.0 * M))),
        ),
        PairCase("internal 20/60", InternalGearPair(gear_of(20), ring, 20.0 * M)),
    ]


def face_cases() -> list[PairCase]:
    """Return pairs that need three dimensions."""
    loads = (0.5, 1.5)
    small, even = helical_pair(18, 23, 20.0), {"positions": 64}
    lead = FlankModification(helix_crowning=6e-6)
    relieved = FlankModification(tip_relief=10e-6, tip_relief_length=2e-3)
    spur = spur_pair(gear_of(18), gear_of(18))

    def with_pinion(pair: GearPair, modification: FlankModification) -> GearPair:
        return replace(pair, pinion=replace(pair.pinion, modification=modification))

    skew = even | {"misalignments": (15e-6,)}
    made = {
        "helical 18/23": (small, even),
        "helical 18/23, lead crowning": (with_pinion(small, lead), even),
        "helical 18/23, tip relief": (with_pinion(small, relieved), even),
        "helical 18/23, misaligned": (small, skew),
        "spur 18/18, misaligned": (spur, skew),
        "spur 18/18, lead crowning": (with_pinion(spur, lead), even),
        "helical 18/23, crowned and misaligned": (with_pinion(small, lead), skew),
    }
    return [
        PairCase(name, pair, loads=loads, options=load_options) for name, (pair, load_options) in made.items()
    ]
