"""Do the stated errors cover the truth over the face? Tables in 3-D against full finite-element contact.

`python -m benchmarks.full_contact_over_face` solves the peer anew and writes its reference: some seven CPU
minutes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from benchmarks.marked_section import replace_section
from benchmarks.recorded_peer import record, recorded
from fe_contact import FlankModification, Gear, GearPair, analyze
from fe_contact.full_contact import solve_full_contact_over_face
from fe_contact.types import FloatArray

ROOT = Path(__file__).parents[1]
REFERENCE = "full_contact_over_face.csv"
PAGE, SECTION = ROOT / "docs" / "lab" / "accuracy.md", "full contact over the face"
SUBJECT = "3-D standard against full contact over the face"
AXES = ("misalignment_um", "torque_n_m", "position_driver")


@dataclass(frozen=True)
class FaceCase:
    """A spur pair, crowned, aligned and misaligned, at some positions: m and N m."""

    name: str
    pair: GearPair
    torques: tuple[float, ...]
    misalignments: tuple[float, ...]
    positions: tuple[float, ...]


@dataclass(frozen=True)
class AssessedFace:
    """One pair under one misalignment: ours less the peer, stated, and the peer's own error (n, loads), m.

    `level` is the mean of the peer over the positions at each load, m.
    """

    case: FaceCase
    misalignment: float
    difference: FloatArray
    stated: FloatArray
    own: FloatArray
    level: FloatArray

    @property
    def covered(self) -> float:
        """Part of the points whose stated error and that of the peer reach the difference."""
        return float(np.mean(np.abs(self.difference) <= self.stated + self.own))


def face_cases() -> tuple[FaceCase, ...]:
    """Return two pairs; neither sets a constant."""
    plain, module = Gear(20, 4e-3, 25e-3, bore_diameter=40e-3), 3e-3
    crowned = FlankModification(helix_crowning=8e-6)
    first = Gear(20, 4e-3, 25e-3, bore_diameter=40e-3, modification=crowned)
    crowned = FlankModification(helix_crowning=6e-6)
    second = Gear(23, module, 20e-3, bore_diameter=34e-3, modification=crowned)
    wheel = Gear(31, module, 20e-3, bore_diameter=46e-3)
    positions = (0.05, 0.4)
    return (
        FaceCase(
            "20/20, crowned 8 um",
            GearPair(first, plain, 80e-3),
            (50.0, 100.0, 250.0),
            (0.0, 30e-6),
            positions,
        ),
        FaceCase(
            "23/31, crowned 6 um",
            GearPair(second, wheel, 81e-3),
            (30.0, 75.0, 180.0),
            (0.0, 20e-6),
            positions,
        ),
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
            table.curve(torque=torque, misalignment=misalignment, at=case.positions)
            for torque in case.torques
        ]
        ours, stated = (
            np.array([getattr(curve, name) for curve in curves], dtype=float).T for name in ("ste", "error")
        )
        level = np.mean(exact, axis=0)
        found.append(AssessedFace(case, misalignment, ours - exact, stated, own, level))
    return tuple(found)


def reference(case: FaceCase, misalignment: float) -> tuple[FloatArray, FloatArray]:
    """Return STE of the peer and its own error (positions, loads), m."""
    values, skew = recorded(REFERENCE, case.name, AXES), round(1e6 * misalignment, 6)
    found = [[values[skew, torque, at] for torque in case.torques] for at in case.positions]
    ste, error = np.moveaxis(np.array(found), 2, 0)
    return ste, error


def markdown(found: Sequence[AssessedFace]) -> str:
    """Return the section of docs/lab/accuracy.md: a row for each pair and misalignment."""
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
    """Write the section of the page between its marks."""
    replace_section(PAGE, SECTION, markdown(assessed()))


def solved_rows() -> Iterator[tuple[str, tuple[float, ...], float, float]]:
    """Solve the peer for all cases, position by position, and give the rows of its reference."""
    for case in face_cases():
        for position in case.positions:
            tables = solve_full_contact_over_face(
                case.pair, case.torques, [position], case.misalignments, estimate_error=True
            )
            for misalignment, table in zip(case.misalignments, tables, strict=True):
                for point in table.points[0]:
                    at = (1e6 * misalignment, point.torque, point.position)
                    yield case.name, at, point.transmission_error, point.error_estimate


if __name__ == "__main__":
    record(REFERENCE, AXES, solved_rows())
