"""Do the stated errors of derivatives cover whole exact hunting cycles? Thirty drawn pairs of gears."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

import numpy as np

from benchmarks.figures import Figure
from benchmarks.quiet_helical_cases import quiet_pairs
from fe_contact import (
    AnalysisOptions,
    Gear,
    GearPair,
    PitchDeviation,
    Run,
    RunOut,
    TableAxes,
    ToothFlank,
    Wave,
)
from fe_contact.analysis.deviating_cycle import cycle_contact, deviating_cycle
from fe_contact.geometry.flank_tolerances import (
    cumulative_pitch_tolerance,
    helix_slope_tolerance,
    profile_slope_tolerance,
    single_pitch_tolerance,
)
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, MEAN, OFF_MESH, PEAK_TO_PEAK, quantity_changes
from fe_contact.types import FloatArray
from host.directories import cache_home

SUBJECT = "hunting cycles by derivatives against exact ones"
CLASSES = (4, 5, 6, 7, 8)
OPTIONS = AnalysisOptions(level="draft")
HUNTING = "23/67, 22 deg"
ASSESSED = [MEAN, PEAK_TO_PEAK, OFF_MESH, *range(FIRST_HARMONIC, FIRST_HARMONIC + 5)]
"""Assessed quantities: mean, peak-to-peak, the order of the largest error that is no mesh order, five mesh
harmonics.
"""
T = TypeVar("T")


class AssessedCycle(NamedTuple):
    """One cycle by derivatives: stated and true errors, and CPU seconds."""

    name: str
    ripple: float
    solved: int
    pitches: int
    stated: FloatArray
    true: FloatArray
    """`stated`, `true`: Stated and true errors of `ASSESSED`, m. Shape (8,) each."""
    points: float
    """Part of the positions of pitches not solved that are beyond the error stated of a position."""
    seconds: float
    exact_seconds: float
    """`seconds`, `exact_seconds`: Condensed bodies at hand."""


def figures() -> list[Figure]:
    """Return the coverage and the cost."""
    cycles = [assessed(name, pair, torque) for name, pair, torque in drawn_gears()]
    beyond = np.mean([each.true > each.stated for each in cycles])
    parts = [each.seconds / each.exact_seconds for each in cycles]
    outside = [each.points for each in cycles]
    hunting = [each.seconds for each in cycles if each.name.startswith(HUNTING)]
    return [
        Figure(SUBJECT, "pairs of gears", len(cycles), "-"),
        Figure(SUBJECT, "quantities beyond the stated error", 100.0 * float(beyond), "%", 5.0),
        Figure(SUBJECT, "positions beyond it, median", 100.0 * float(np.median(outside)), "%", 5.0),
        Figure(SUBJECT, "positions beyond it, worst pair", 100.0 * max(outside), "%"),
        Figure(SUBJECT, "CPU time over exact, median", float(np.median(parts)), "-", 0.1),
        Figure(SUBJECT, "CPU time over exact, at most", max(parts), "-"),
        Figure(SUBJECT, "cycle of 23/67, median", float(np.median(hunting)), "CPU s", 5.0),
        Figure(SUBJECT, "cycle of 23/67, at most", max(hunting), "CPU s"),
    ]


def assessed(name: str, pair: GearPair, torque: float) -> AssessedCycle:
    """Hold one cycle against all its pitches solved."""
    wish = TableAxes(torques=[torque]), OPTIONS, Run(cache=cache_home())
    contact, _ = cycle_contact(pair, *wish)
    contact.exact(np.arange(2))
    exact, exact_seconds = _timed(lambda: contact.exact(np.arange(contact.pitches)))
    _, bodies = _timed(lambda: cycle_contact(pair, *wish))
    found, seconds = _timed(lambda: deviating_cycle(pair, *wish))
    missed = np.abs(found.ste - exact)[~found.solved, :, 0]
    own, all_solved = (each.reshape(-1, 1) for each in (found.ste, exact))
    position = np.arange(exact.shape[0] * exact.shape[1]) / exact.shape[1]
    true = quantity_changes(position, own, all_solved, contact.pitches, position)[ASSESSED, 0]
    points = float(np.mean(missed > found.error)) if missed.size else 0.0
    return AssessedCycle(
        name,
        float(np.ptp(exact)),
        int(found.solved.sum()),
        contact.pitches,
        found.quantity_error[ASSESSED, 0],
        true,
        points,
        seconds - bodies,
        exact_seconds,
    )


def _timed(work: Callable[[], T]) -> tuple[T, float]:
    before = time.process_time()
    return work(), time.process_time() - before


def drawn_gears() -> list[tuple[str, GearPair, float]]:
    """Return thirty pairs as made, with their torques: one of each class helical 23/67, five spur 29/37."""
    draw = np.random.default_rng(45)
    helical = next(case for case in quiet_pairs() if case.name == HUNTING)
    pinion, wheel = (Gear(teeth, 2e-3, 20e-3, 0.25 * teeth * 2e-3) for teeth in (29, 37))
    spur = "29/37, spur", GearPair(pinion, wheel), 100.0
    kinds = [(HUNTING, helical.pair, helical.torque)] + [spur] * 5
    return [
        (f"{name}, class {quality}", _as_made(pair, quality, draw), torque)
        for name, pair, torque in kinds
        for quality in CLASSES
    ]


def _as_made(pair: GearPair, quality: int, draw: np.random.Generator) -> GearPair:
    return replace(
        pair,
        pinion=replace(pair.pinion, **_deviations(pair.pinion, quality, draw)),
        wheel=replace(pair.wheel, **_deviations(pair.wheel, quality, draw)),
    )


def _deviations(gear: Gear, quality: int, draw: np.random.Generator) -> dict[str, Any]:
    """Draw a gear within a class of ISO 1328-1:2013, helix deviations of helical gears alone."""
    single, total = (each(gear, quality) for each in (single_pitch_tolerance, cumulative_pitch_tolerance))
    profile, helix = profile_slope_tolerance(gear, quality), helix_slope_tolerance(gear, quality)
    helix = helix if gear.helix_angle else 0.0

    def within(limit: float, parts: float) -> float:
        return float(np.clip(draw.normal(0.0, limit / parts), -limit, limit))

    pitches = np.cumsum([within(single, 2.5) for _ in range(gear.teeth)])
    pitches -= np.linspace(0.0, pitches[-1], gear.teeth)
    angles = draw.uniform(-3.0, 3.0, 3).tolist()
    wobble = 0.15 * total if gear.helix_angle else 0.0
    flanks = (
        ToothFlank(
            tooth,
            profile_slope=within(profile, 3.0),
            profile_form=within(profile, 4.0),
            helix_slope=within(helix, 3.0) if helix else 0.0,
            helix_form=within(helix, 4.0) if helix else 0.0,
        )
        for tooth in range(1, gear.teeth + 1)
    )
    return {
        "pitch_deviation": PitchDeviation(tuple(pitches.tolist())),
        "run_out": RunOut(0.3 * total * draw.uniform(0.3, 1.0), angles[0], wobble, angles[1]),
        "waves": (Wave(int(draw.integers(7, 40)), 0.05 * profile * draw.uniform(0.5, 2.0), angles[2]),),
        "tooth_flanks": tuple(flanks),
    }
