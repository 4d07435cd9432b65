"""Do the stated errors cover the truth over the face? Tables in 3-D against full finite-element contact.

`python -m benchmarks.full_contact_over_face` solves the peer anew and writes its reference: some 11 CPU
minutes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from benchmarks.assessed import Assessed, assessed_at_positions, table_against_peer
from benchmarks.figures import Figure
from benchmarks.marked_section import MEASURED, replace_section
from benchmarks.recorded_peer import record, recorded
from fe_contact import FlankModification, Gear, GearPair, InternalGearPair, RingGear, analyze
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray
from verification.full_contact import Resolution, solve_full_contact_over_face
from verification.full_contact.over_face.solve import USUAL

REFERENCE = "full_contact_over_face.csv"
PAGE, SECTION = MEASURED / "accuracy.md", "full contact over the face"
CURVES = "curves over the face"
SUBJECT = "3-D standard against full contact over the face"
AXES = ("misalignment_um", "torque_n_m", "position_driver")
POSITIONS = (0.05, 0.4)
"""Positions with one pair in contact, and with two, base pitches."""


@dataclass(frozen=True)
class FaceCase:
    """A spur pair, crowned, aligned and misaligned: m and N m; and the mesh of its peer."""

    name: str
    pair: ParallelAxes
    torques: tuple[float, ...]
    misalignments: tuple[float, ...]
    mesh: Resolution = USUAL


@dataclass(frozen=True)
class AssessedFace:
    """One pair under one misalignment: ours less the peer, stated, and the peer's own error (n, loads), m.

    `level` is the mean of the peer over the positions at each load, m; `curves` has that of the table and the
    difference of the positions, which is most of peak-to-peak.
    """

    case: FaceCase
    misalignment: float
    difference: FloatArray
    stated: FloatArray
    own: FloatArray
    level: FloatArray
    curves: Assessed

    @property
    def covered(self) -> float:
        """Part of the points whose stated error and that of the peer reach the difference."""
        return float(np.mean(np.abs(self.difference) <= self.stated + self.own))


def face_cases() -> tuple[FaceCase, ...]:
    """Return two external and two internal pairs; none sets a constant."""
    return (*_external_pairs(), *_internal_pairs())


def _external_pairs() -> tuple[FaceCase, ...]:
    plain = Gear(20, 4e-3, 25e-3, bore_diameter=40e-3)
    first = replace(plain, modification=FlankModification(helix_crowning=8e-6))
    second = Gear(23, 3e-3, 20e-3, 34e-3, modification=FlankModification(helix_crowning=6e-6))
    pairs = GearPair(first, plain, 80e-3), GearPair(second, Gear(31, 3e-3, 20e-3, 46e-3), 81e-3)
    return (
        FaceCase("20/20, crowned 8 um", pairs[0], (50.0, 100.0, 250.0), (0.0, 30e-6)),
        FaceCase("23/31, crowned 6 um", pairs[1], (30.0, 75.0, 180.0), (0.0, 20e-6)),
    )


def _internal_pairs() -> tuple[FaceCase, ...]:
    """Return one whose pinion is relieved, and one whose ring is; fewer layers halve the cost."""
    both = FlankModification(helix_crowning=6e-6, tip_relief=8e-6, tip_relief_length=1.5e-3)
    first = InternalGearPair(
        Gear(24, 3e-3, 18e-3, 36e-3, modification=both),
        RingGear(72, 3e-3, 18e-3, rim_diameter=252e-3, tip_diameter=211.5e-3),
        72e-3,
    )
    crowned = FlankModification(helix_crowning=4e-6)
    relieved = FlankModification(tip_relief=6e-6, tip_relief_length=1.2e-3)
    second = InternalGearPair(
        Gear(31, 2e-3, 20e-3, 31e-3, modification=crowned),
        RingGear(85, 2e-3, 20e-3, rim_diameter=194e-3, tip_diameter=167e-3, modification=relieved),
        54e-3,
    )
    mesh = replace(USUAL, layers=5)
    return (
        FaceCase("24/72, crowned 6 um, pinion relieved", first, (36.0, 90.0, 180.0), (0.0, 10e-6), mesh),
        FaceCase("31/85, crowned 4 um, ring relieved", second, (25.0, 60.0, 120.0), (0.0, 8e-6), mesh),
    )


def figures() -> list[Figure]:
    """Return the worst difference, and how many points are not covered."""
    rows = []
    for one in assessed():
        name = f"{one.case.name}, misaligned {1e6 * one.misalignment:g} um"
        worst = 1e6 * float(np.max(np.abs(one.difference)))
        rows += [
            Figure(SUBJECT, f"{name}: worst point", worst, "um"),
            Figure(SUBJECT, f"{name}: points not covered", 100.0 * (1.0 - one.covered), "%", 10.0),
        ]
    return rows


@cache
def assessed() -> tuple[AssessedFace, ...]:
    """Hold the tables of all cases against the peer."""
    return tuple(one for case in face_cases() for one in assess(case))


def assess(case: FaceCase) -> tuple[AssessedFace, ...]:
    """Hold one table against the peer, misalignment by misalignment."""
    table = analyze(
        case.pair, torques=case.torques, misalignments=case.misalignments, model="3d", level="standard"
    )
    found = []
    for misalignment in case.misalignments:
        exact, own = reference(case, misalignment)
        curves = [
            table.curve(torque=torque, misalignment=misalignment, at=POSITIONS) for torque in case.torques
        ]
        ours, stated = (
            np.array([getattr(curve, name) for curve in curves], dtype=float).T for name in ("ste", "error")
        )
        level = np.mean(exact, axis=0)
        name = f"{case.name}, misaligned {1e6 * misalignment:g} um" if misalignment else case.name
        compared = assessed_at_positions(name, "standard", curves, exact, own)
        found.append(AssessedFace(case, misalignment, ours - exact, stated, own, level, compared))
    return tuple(found)


def reference(case: FaceCase, misalignment: float) -> tuple[FloatArray, FloatArray]:
    """Return STE of the peer and its own error (positions, loads), m."""
    values, skew = recorded(REFERENCE, case.name, AXES), round(1e6 * misalignment, 6)
    found = [[values[skew, torque, at] for torque in case.torques] for at in POSITIONS]
    ste, error = np.moveaxis(np.array(found), 2, 0)
    return ste, error


def markdown(found: Sequence[AssessedFace]) -> str:
    """Return the section of accuracy.md: a row for each pair and misalignment."""
    lines = [
        "| pair | misaligned, um | loads, N m | peer's mean, um | its own error, um | worst point off, um "
        "| stated there, um | covered |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for one in found:
        worst = np.unravel_index(np.argmax(np.abs(one.difference)), one.difference.shape)
        loads, level = (
            ", ".join(f"{value:.3g}" for value in values) for values in (one.case.torques, 1e6 * one.level)
        )
        numbers = [1e6 * values[worst] for values in (one.own, one.difference, one.stated)]
        cells = [one.case.name, f"{1e6 * one.misalignment:g}", loads, level, *(f"{n:.2g}" for n in numbers)]
        count = round(one.covered * one.difference.size)
        lines.append("| " + " | ".join([*cells, f"{count} of {one.difference.size}"]) + " |")
    return "\n".join(lines) + "\n"


def publish() -> None:
    """Write the sections of the page between their marks."""
    replace_section(PAGE, SECTION, markdown(assessed()))
    loads = [one.case.torques for one in assessed()]
    table = table_against_peer([one.curves for one in assessed()], loads, "load, N m")
    replace_section(PAGE, CURVES, table)


def solved_rows() -> Iterator[tuple[str, tuple[float, ...], float, float]]:
    """Solve the peer for all cases, position by position, and give the rows of its reference."""
    for case in face_cases():
        for position in POSITIONS:
            tables = solve_full_contact_over_face(
                case.pair, case.torques, [position], case.misalignments, case.mesh, estimate_error=True
            )
            for misalignment, table in zip(case.misalignments, tables, strict=True):
                for point in table.points[0]:
                    at = (1e6 * misalignment, point.torque, point.position)
                    yield case.name, at, point.transmission_error, point.error_estimate


if __name__ == "__main__":
    record(REFERENCE, AXES, solved_rows())
