"""Gear pairs that no constant was fitted to: on them error estimates and error models are judged."""

from __future__ import annotations

import math
from dataclasses import replace

from benchmarks.honesty_cases import HonestyCase, M, gear_of, helical_pair, spur_pair
from fe_contact import FlankModification, GearPair
from fe_contact.geometry import GearBlank, InternalGearPair
from fe_contact.geometry.ring_gear import RingGear

LOADS = (0.5, 1.5)


def held_out_plane_cases() -> list[HonestyCase]:
    """Return spur pairs with nothing acting across the face."""
    both = FlankModification(tip_relief=8e-6, tip_relief_length=1.5e-3)
    ring = RingGear(72, M, 8.0 * M, rim_diameter=86.0 * M, tip_diameter=70.5 * M)
    rim = GearBlank(1.6 * M, 2.5 * M, 16.0 * M)
    shifted = {"profile_shift_coefficient": 0.4}, {"profile_shift_coefficient": -0.4}
    return [
        HonestyCase("spur 22/35, wide", spur_pair(gear_of(22, 12.0), gear_of(35, 12.0))),
        HonestyCase(
            "spur 27/27, relief on both",
            spur_pair(gear_of(27, modification=both), gear_of(27, modification=both)),
        ),
        HonestyCase(
            "spur 16/29, long and short addendum",
            spur_pair(gear_of(16, **shifted[0]), gear_of(29, **shifted[1])),
        ),
        HonestyCase(
            "spur 30/30, thin rims", spur_pair(gear_of(30, 8.0, blank=rim), gear_of(30, 8.0, blank=rim))
        ),
        HonestyCase("internal 18/72", InternalGearPair(gear_of(18, 8.0), ring, 27.0 * M)),
    ]


def held_out_face_cases() -> list[HonestyCase]:
    """Return pairs that need three dimensions."""
    crown = FlankModification(helix_crowning=10e-6)
    relief = FlankModification(tip_relief=15e-6, tip_relief_length=2e-3)
    wide = helical_pair(21, 34, 15.0, face=9.0)
    steep, narrow = helical_pair(25, 27, 30.0, face=7.0), helical_pair(19, 46, 10.0, face=4.0)
    rim = GearBlank(2.0 * M, 2.5 * M, 22.0 * M)
    body = helical_pair(20, 36, 18.0)
    rimmed = replace(body, wheel=replace(body.wheel, blank=rim))
    beta = math.radians(22.0)
    shifted = spur_pair(
        gear_of(17, helix_angle=beta, profile_shift_coefficient=0.35), gear_of(33, helix_angle=-beta), 0.345
    )

    def case(name: str, pair: GearPair, skew: float = 0.0) -> HonestyCase:
        options = {"misalignments": (skew,)} if skew else {}
        return HonestyCase(name, pair, loads=LOADS, options=options)

    def with_pinion(pair: GearPair, modification: FlankModification) -> GearPair:
        return replace(pair, pinion=replace(pair.pinion, modification=modification))

    return [
        case("helical 21/34, wide", wide),
        case("helical 25/27, 30 degrees", steep),
        case("helical 19/46, narrow, tip relief", with_pinion(narrow, relief)),
        case("helical 21/34, wide, misaligned", wide, 20e-6),
        case("helical 25/27, 30 degrees, crowned", with_pinion(steep, crown)),
        case("helical 17/33, shifted", shifted),
        case("helical 20/36, thin rim", rimmed),
        case("spur 23/31, misaligned", spur_pair(gear_of(23), gear_of(31)), 12e-6),
        case(
            "spur 26/26, wide, crowned, misaligned",
            with_pinion(spur_pair(gear_of(26, 10.0), gear_of(26, 10.0)), crown),
            10e-6,
        ),
    ]
