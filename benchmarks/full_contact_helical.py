"""Do the stated errors over the face cover the truth? 3-D standard against full contact along the helix.

Six helical pairs, and two misaligned spur pairs.

`python -m benchmarks.full_contact_helical` solves the peer anew and writes its reference: some three CPU
minutes a pair.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from benchmarks.assessed import Assessed, assessed_at_positions, table_against_peer
from benchmarks.drawn_pairs import LOADS, drawn_pairs
from benchmarks.figures import Figure
from benchmarks.marked_section import MEASURED, replace_section
from benchmarks.pair_cases import PairCase
from benchmarks.recorded_peer import record, recorded
from fe_contact import FlankModification, Gear, GearPair, analyze
from fe_contact.geometry.backlash import reference_center_distance
from fe_contact.types import FloatArray
from verification.full_contact import solve_full_contact_helical

REFERENCE = "full_contact_helical.csv"
PAGE, SECTION = MEASURED / "accuracy.md", "helical full contact"
SUBJECT = "3-D standard against helical full contact"
AXES = ("load", "position_driver")
NUMBERS = ("43.2", "43.5", "43.10", "43.15", "43.90", "43.145", "43.7")
"""Numbers of drawn pairs, "seed.place"; the last is a spur pair."""
POSITIONS = np.arange(16) / 16.0
"""Positions, base pitches."""


@cache
def helical_cases() -> tuple[PairCase, ...]:
    """Return the pairs; none sets a constant."""
    places = [tuple(map(int, number.split("."))) for number in NUMBERS]
    return (*(drawn_pairs(seed, place)[-1] for seed, place in places), _unlike_spur())


def _unlike_spur() -> PairCase:
    """Return a misaligned spur pair of a ratio of 2.7, crowned and relieved on its pinion alone."""
    modification = FlankModification(tip_relief=9e-6, tip_relief_length=0.9e-3, helix_crowning=5e-6)
    pinion = Gear(19, 2e-3, 16e-3, 18e-3, profile_shift_coefficient=0.3, modification=modification)
    wheel = Gear(52, 2e-3, 16e-3, 50e-3)
    pair = GearPair(pinion, wheel, reference_center_distance(pinion, wheel))
    name = "spur 19/52, 2 mm, pinion relieved, misaligned"
    return PairCase(name, pair, LOADS, {"misalignments": (12e-6,)})


def figures() -> list[Figure]:
    """Return for each pair how far the mean and peak-to-peak are off at worst, over what is stated."""
    return [
        Figure(SUBJECT, f"{one.name}: {name}, true over stated", float(part.max()), "times", 1.0)
        for one in assessed()
        for name, part in zip(("mean", "peak-to-peak"), (one.true - one.own) / one.stated, strict=True)
    ]


@cache
def assessed() -> tuple[Assessed, ...]:
    """Hold the tables of all pairs against the peer."""
    return tuple(assess(case) for case in helical_cases())


def assess(case: PairCase, level: str = "standard") -> Assessed:
    """Hold mean and peak-to-peak of a table at the positions of the peer against it, (2, loads) m."""
    exact, error = reference(case)
    table = analyze(case.pair, *case.request(level=level))
    (skew,) = case.options.get("misalignments", (0.0,))
    curves = [table.curve(force=force, misalignment=skew, at=POSITIONS.tolist()) for force in case.forces]
    return assessed_at_positions(case.name, level, curves, exact, error)


def reference(case: PairCase) -> tuple[FloatArray, FloatArray]:
    """Return STE of the peer and how far a coarser mesh is from it (positions, loads), m."""
    values = recorded(REFERENCE, case.name, AXES)
    found = np.array([[values[load, at] for load in case.loads] for at in POSITIONS.tolist()])
    ste, error = np.moveaxis(found, 2, 0)
    return ste, error


def publish() -> None:
    """Write the section of the page between its marks."""
    loads = [case.loads for case in helical_cases()]
    replace_section(PAGE, SECTION, table_against_peer(assessed(), loads, "load"))


def solved_rows() -> Iterator[tuple[str, tuple[float, ...], float, float]]:
    """Solve the peer for all cases and give the rows of its reference."""
    for case in helical_cases():
        arm = case.pair.pinion.base_radius * np.cos(case.pair.base_helix_angle)
        torques = [float(arm * force) for force in case.forces]
        skews = case.options.get("misalignments", (0.0,))
        (table,) = solve_full_contact_helical(
            case.pair, torques, POSITIONS.tolist(), skews, estimate_error=True
        )
        for at, row in zip(POSITIONS.tolist(), table.points, strict=True):
            for load, point in zip(case.loads, row, strict=True):
                yield case.name, (load, at), point.transmission_error, point.error_estimate


if __name__ == "__main__":
    record(REFERENCE, AXES, solved_rows())
