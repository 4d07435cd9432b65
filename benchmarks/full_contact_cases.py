"""Spur pairs whose tables are compared with full contact, by regime; half of them set no constant."""

from __future__ import annotations

from dataclasses import dataclass, replace

from benchmarks.pair_cases import M, PairCase, gear_of, spur_pair
from fe_contact import FlankModification, GearPair
from fe_contact.geometry import InternalGearPair
from fe_contact.geometry.ring_gear import RingGear
from fe_contact.material import Material

LOADS = (0.2, 1.0, 2.5)
_POLYMER, _ALUMINIUM = Material(9e9, 0.35), Material(70e9, 0.33)


@dataclass(frozen=True)
class FullContactCase(PairCase):
    """A pair, its loads over the rated one, its regime, and whether no constant was set on it."""

    regime: str = ""
    held_out: bool = False


def full_contact_cases() -> list[FullContactCase]:
    """Return two pairs of every regime, the second held out."""
    found = []
    for regime, pairs in _pairs().items():
        scale = 0.2 if regime == "soft gear" else 1.0
        loads = tuple(scale * load for load in LOADS)
        found += [
            FullContactCase(name, pair, loads, regime=regime, held_out=bool(i))
            for i, (name, pair) in enumerate(pairs.items())
        ]
    return found


def _pairs() -> dict[str, dict[str, GearPair | InternalGearPair]]:
    """Return the pairs by regime and name."""
    tall = {"addendum_coefficient": 1.3, "dedendum_coefficient": 1.5, "root_radius_coefficient": 0.3}
    long, short = _relief(30e-6, 3.5e-3), _relief(12e-6, 1.2e-3)
    return {
        "ordinary": {
            "20/20": spur_pair(gear_of(20), gear_of(20)),
            "17/43, shifted": spur_pair(gear_of(17, profile_shift_coefficient=0.3), gear_of(43), 0.295),
        },
        "long relief": {
            "20/20, 30 um over 3.5 mm": _both(spur_pair(gear_of(20), gear_of(20)), long),
            "26/39, 20 um over 3 mm": _both(spur_pair(gear_of(26), gear_of(39)), _relief(20e-6, 3e-3)),
        },
        "short relief": {
            "24/31, 12 um over 1.2 mm": _both(spur_pair(gear_of(24), gear_of(31)), short),
            "30/47, 8 um over 1 mm": _both(spur_pair(gear_of(30), gear_of(47)), _relief(8e-6, 1e-3)),
        },
        "internal": {
            "24/72, ring": InternalGearPair(gear_of(24), _ring(72), 24.0 * M),
            "31/90, ring": InternalGearPair(gear_of(31), _ring(90), 29.5 * M),
        },
        "high contact ratio": {
            "35/42, tall teeth": spur_pair(gear_of(35, **tall), gear_of(42, **tall)),
            "44/44, tall teeth": spur_pair(gear_of(44, **tall), gear_of(44, **tall)),
        },
        "soft gear": {
            "24/36, polymer on steel": spur_pair(gear_of(24), gear_of(36, material=_POLYMER)),
            "29/38, aluminium on steel": spur_pair(gear_of(29), gear_of(38, material=_ALUMINIUM)),
        },
    }


def _relief(amount: float, length: float) -> FlankModification:
    """Return a linear tip relief, m over m of roll."""
    return FlankModification(tip_relief=amount, tip_relief_length=length)


def _both(pair: GearPair, modification: FlankModification) -> GearPair:
    """Return a pair whose gears both have a modification."""
    gears = (replace(gear, modification=modification) for gear in (pair.pinion, pair.wheel))
    return GearPair(*gears, pair.center_distance)


def _ring(teeth: int) -> RingGear:
    """Return a ring gear with a rim of six modules outside its reference circle."""
    return RingGear(teeth, M, 6.0 * M, rim_diameter=(teeth + 12) * M, tip_diameter=(teeth - 1.5) * M)
