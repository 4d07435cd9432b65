"""Do the stated errors of helical tables cover the truth? 3-D standard against helical full contact.

`python -m benchmarks.full_contact_helical` solves the peer anew and writes its reference: some three CPU
minutes a pair.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.assessed import Assessed, error_cell
from benchmarks.drawn_pairs import drawn_pairs
from benchmarks.figures import Figure
from benchmarks.marked_section import replace_section
from benchmarks.pair_cases import PairCase
from benchmarks.recorded_peer import record, recorded
from fe_contact import ste_database
from fe_contact.full_contact import solve_full_contact_helical
from fe_contact.types import FloatArray

ROOT = Path(__file__).parents[1]
REFERENCE = "full_contact_helical.csv"
PAGE, SECTION = ROOT / "docs" / "lab" / "accuracy.md", "helical full contact"
SUBJECT = "3-D standard against helical full contact"
AXES = ("load", "position_driver")
NUMBERS = ("43.2", "43.5", "43.10", "43.15", "43.90", "43.145")
"""Of drawn pairs: seed and place."""
POSITIONS = np.arange(16) / 16.0
"""Base pitches."""


@cache
def helical_cases() -> tuple[PairCase, ...]:
    """Return the pairs; none sets a constant."""
    places = [tuple(map(int, number.split("."))) for number in NUMBERS]
    return tuple(drawn_pairs(seed, place)[-1] for seed, place in places)


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
    table = ste_database(case.pair, *case.request(level=level))
    (skew,) = case.options.get("misalignments", (0.0,))
    curves = [table.curve(force=force, misalignment=skew, at=POSITIONS.tolist()) for force in case.forces]
    found = np.array([curve.ste for curve in curves]).T
    stated = np.array([[curve.mean.error, curve.peak_to_peak.error] for curve in curves]).T
    value, true = quantities(found), np.abs(quantities(found) - quantities(exact))
    ends = np.stack([exact.argmax(axis=0), exact.argmin(axis=0)])
    own = np.stack([np.mean(error, axis=0), np.take_along_axis(error, ends, axis=0).sum(axis=0)])
    return Assessed(case.name, level, value, stated, true, own)


def quantities(ste: FloatArray) -> FloatArray:
    """Return mean and peak-to-peak (2, loads) of STE (positions, loads)."""
    return np.stack([ste.mean(axis=0), np.ptp(ste, axis=0)])


def reference(case: PairCase) -> tuple[FloatArray, FloatArray]:
    """Return STE of the peer and how far a coarser mesh is from it (positions, loads), m."""
    values = recorded(REFERENCE, case.name, AXES)
    found = np.array([[values[load, at] for load in case.loads] for at in POSITIONS.tolist()])
    ste, error = np.moveaxis(found, 2, 0)
    return ste, error


def markdown(found: Sequence[Assessed]) -> str:
    """Return the section of docs/lab/accuracy.md: a row for each pair and load."""
    lines = [
        "| pair | load | mean, um | off, % (stated) | peer's own, % | peak-to-peak, um | off, % (stated) "
        "| peer's own, % |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for one, case in zip(found, helical_cases(), strict=True):
        own = 100.0 * np.asarray(one.own) / one.value
        for k, load in enumerate(case.loads):
            cells = [one.name, f"{load:g}"]
            for q in range(2):
                cells += [f"{1e6 * one.value[q, k]:.3g}", error_cell(one, q, k), f"{own[q, k]:.2g}"]
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def publish() -> None:
    """Write the section of the page between its marks."""
    replace_section(PAGE, SECTION, markdown(assessed()))


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
