"""Gear pairs drawn at random from one recipe, on which stated errors and tolerances are assessed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.pair_cases import PairCase
from fe_contact import FlankModification, Gear, GearPair
from fe_contact.errors import FeContactError
from fe_contact.geometry import InternalGearPair, ParallelAxes, RingGear
from fe_contact.geometry.backlash import reference_center_distance

LOADS = (0.4, 1.0, 2.0)
"""Loads over the rated load."""
UM = 1e-6
Draw = np.random.Generator


def assessed_pairs() -> list[PairCase]:
    """Return the pairs on which stated errors are assessed."""
    return drawn_pairs(41, 20)


def fresh_pairs() -> list[PairCase]:
    """Return those that besides them assess a tolerance, and nothing else."""
    return drawn_pairs(29, 10)


def in_plane(case: PairCase) -> bool:
    """Whether nothing of a drawn pair acts across its face."""
    return not case.pair.base_helix_angle and not case.options


def drawn_pairs(seed: int, count: int) -> list[PairCase]:
    """Return pairs of one seed; of ten, five are helical, three of the ten misaligned, one is internal.

    A draw that is no gear pair is drawn again.
    """
    draw = np.random.default_rng(seed)
    return [_drawn(draw, f"{seed}.{i + 1}", _KINDS[i % len(_KINDS)]) for i in range(count)]


def _drawn(draw: Draw, number: str, kind: Callable[[Draw], PairCase]) -> PairCase:
    """Draw one kind until it is feasible."""
    while True:
        try:
            case = kind(draw)
        except FeContactError:
            continue
        return replace(case, name=f"{number} {case.name}")


def _helical(draw: Draw, *, misaligned: bool = False) -> PairCase:
    """Draw a helical pair, crowned along the face, four of five relieved at the tips."""
    helix = np.radians(draw.uniform(12.0, 30.0))
    relief = _relief(draw) if draw.random() < 0.8 else {}
    return _external(draw, float(helix), relief, _crowning(draw), misaligned=misaligned)


def _spur(draw: Draw, *, misaligned: bool = False) -> PairCase:
    """Draw a spur pair; in the plane one of two has no modification."""
    relief = _relief(draw) if misaligned or draw.random() < 0.5 else {}
    return _external(draw, 0.0, relief, _crowning(draw) if misaligned else {}, misaligned=misaligned)


def _internal(draw: Draw) -> PairCase:
    """Draw a spur pinion in a ring gear."""
    teeth, module = int(draw.integers(18, 30)), _module(draw)
    ring_teeth = teeth + int(draw.integers(36, 60))
    width = draw.uniform(5.0, 10.0) * module
    pinion = Gear(teeth, module, width, 0.5 * teeth * module)
    rim, tip = (ring_teeth + 12.0) * module, (ring_teeth - 1.5) * module
    pair = InternalGearPair(
        pinion,
        RingGear(ring_teeth, module, width, rim, tip_diameter=tip),
        0.5 * (ring_teeth - teeth) * module,
    )
    return _case(pair, "internal")


def _external(
    draw: Draw, helix: float, relief: dict[str, float], lead: dict[str, float], *, misaligned: bool
) -> PairCase:
    """Draw an external pair without backlash; both gears are relieved, the pinion has the lead."""
    module, first = _module(draw), int(draw.integers(17, 33))
    second = int(first * draw.uniform(1.0, 2.8))
    width, shift = draw.uniform(5.0, 10.0) * module, draw.uniform(-0.1, 0.4)
    tips = relief | ({"tip_relief_length": relief["tip_relief_length"] * module} if relief else {})

    def gear(teeth: int, hand: float, own_shift: float, along: dict[str, float]) -> Gear:
        return Gear(
            teeth,
            module,
            width,
            bore_diameter=0.5 * teeth * module,
            helix_angle=hand * helix,
            profile_shift_coefficient=own_shift,
            modification=FlankModification(**tips, **along),  # type: ignore[arg-type]
        )

    pinion, wheel = gear(first, 1.0, shift, lead), gear(second, -1.0, draw.uniform(-0.2, 0.2), {})
    pair = GearPair(pinion, wheel, reference_center_distance(pinion, wheel))
    skew = draw.uniform(4.0, 15.0) * UM if misaligned else 0.0
    return _case(pair, "helical" if helix else "spur", skew)


def _case(pair: ParallelAxes, kind: str, misalignment: float = 0.0) -> PairCase:
    """Name a pair."""
    gears = pair.pinion, pair.wheel
    words = [f"{kind} {gears[0].teeth}/{gears[1].teeth}", f"{1e3 * gears[0].normal_module:.2g} mm"]
    if pair.pinion.helix_angle:
        words.append(f"{np.degrees(pair.pinion.helix_angle):.0f} deg")
    named = {"relieved": pair.pinion.modification.tip_relief, "misaligned": misalignment}
    words += [word for word, amount in named.items() if amount]
    options = {"misalignments": (misalignment,)} if misalignment else {}
    return PairCase(", ".join(words), pair, LOADS, options)


def _module(draw: Draw) -> float:
    """Draw a module, m."""
    return 1e-3 * float(draw.uniform(1.5, 4.0))


def _relief(draw: Draw) -> dict[str, float]:
    """Draw a linear tip relief; its length in modules."""
    return {"tip_relief": draw.uniform(4.0, 14.0) * UM, "tip_relief_length": draw.uniform(0.25, 0.6)}


def _crowning(draw: Draw) -> dict[str, float]:
    """Draw a crowning along the face."""
    return {"helix_crowning": draw.uniform(2.0, 8.0) * UM}


_KINDS: tuple[Callable[[Draw], PairCase], ...] = (
    _spur,
    _helical,
    partial(_helical, misaligned=True),
    _internal,
    _helical,
    _spur,
    partial(_spur, misaligned=True),
    partial(_helical, misaligned=True),
    _spur,
    _helical,
)
