"""Do the stated errors cover the truth? Tables in plane strain against full finite-element contact."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.assessed import QUANTITIES, STATED, Assessed, coverage_figures, coverage_table, error_cell
from benchmarks.figures import Figure
from benchmarks.full_contact_cases import FullContactCase, full_contact_cases
from benchmarks.marked_section import MEASURED, replace_section
from fe_contact import SteDatabase, analyze
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.model_error import in_small_displacements
from fe_contact.ste.curve_errors import AT_NODES, METHOD, PLANE, all_sources
from fe_contact.ste.curve_quantities import OFF_MESH
from fe_contact.types import FloatArray
from lineofaction.report.drawing import figure as drawn
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.image import png
from verification.full_contact import solve_full_contact

ROOT = Path(__file__).parents[1]
REFERENCE = ROOT / "tests" / "reference" / "full_contact_curves.csv"
PAGE, SECTION = MEASURED / "accuracy.md", "full contact"
SUBJECT = "stated errors against full contact"
LEVELS = ("standard", "fine")
PICTURE = ROOT / "docs" / "images" / "accuracy.png"
CASES = ("20/20", "20/20, 30 um over 3.5 mm", "24/72, ring", "35/42, tall teeth")
DRAWN_LEVELS = ("draft", *LEVELS)
TIMED = (0.0, 0.3)
"""Positions at which full contact is timed."""
_COVERAGE = 90.0
_FITTED = 8
"""Harmonics of a fit: positions at which the reference has no solution are left out of both curves."""


@dataclass(frozen=True)
class AssessedCase(Assessed):
    """The curves of one case, and its regime, loads and whether it set a constant."""

    case: FullContactCase = field(kw_only=True)


def figures() -> list[Figure]:
    """Return the coverage of pairs that set no constant."""
    held_out = [one for one in assessed() if one.case.held_out]
    pairs = Figure(SUBJECT, "pairs not used for any constant", len(held_out) / len(LEVELS), "-", 6.0)
    return [pairs, *coverage_figures(held_out, SUBJECT, _COVERAGE)]


@cache
def assessed() -> tuple[AssessedCase, ...]:
    """Hold every pair at every level against full contact."""
    return tuple(assess(case, level) for case in full_contact_cases() for level in LEVELS)


def assess(case: FullContactCase, level: str) -> AssessedCase:
    """Hold one table against full contact at the same positions."""
    position, exact, error = reference(case.name)
    table = analyze(case.pair, normal_forces=case.forces, model="plane_strain", level=level)
    found = np.array([table.curve(force=force, at=position).ste for force in table.force]).T
    value = quantities(position, found)
    true = np.abs(value - quantities(position, exact))
    own = np.stack([np.mean(error, axis=0)] * len(QUANTITIES))
    return AssessedCase(case.name, level, value, stated(table, case.pair), true, own, case=case)


def stated(table: SteDatabase, pair: ParallelAxes) -> FloatArray:
    """Return the stated errors (5, loads) in m, without those that the reference shares.

    It is in plane strain, and its displacements are small.
    """
    curves = [table.curve(force=force) for force in table.force]
    found = [[curve.mean, curve.peak_to_peak, *curve.harmonics] for curve in curves]
    own = np.array([[quantity.value for quantity in row] for row in found]).T
    own = np.insert(own, OFF_MESH, 0.0, axis=0)
    sources = table.curve_error[: len(AT_NODES), :, :, 0, 0].copy()
    sources[AT_NODES.index(METHOD)] = in_small_displacements(pair, table.force, own, over_face=False)
    sources[AT_NODES.index(PLANE)] = 0.0
    return all_sources(sources)[list(STATED)]


def reference(name: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return positions (P,), STE and its error by a coarser mesh (P, loads) of a pair, m."""
    with REFERENCE.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["case"] == name]
    loads = sorted({float(row["torque_n_m"]) for row in rows})
    position = sorted({float(row["position_driver"]) for row in rows})
    columns = {
        (float(row["position_driver"]), float(row["torque_n_m"])): (row["ste_um"], row["error_um"])
        for row in rows
    }
    values = 1e-6 * np.array([[columns[at, load] for load in loads] for at in position], dtype=float)
    return np.array(position), values[..., 0], values[..., 1]


def quantities(position: FloatArray, ste: FloatArray) -> FloatArray:
    """Return mean, peak-to-peak and three harmonics (5, loads) of STE (P, loads) at positions (P,)."""
    turns = 2.0 * np.pi * np.outer(position, np.arange(1, _FITTED + 1))
    waves = np.hstack([np.ones((len(position), 1)), np.cos(turns), np.sin(turns)])
    fitted = np.linalg.lstsq(waves, ste, rcond=None)[0]
    amplitude = np.hypot(fitted[1 : _FITTED + 1], fitted[_FITTED + 1 :])
    return np.stack([fitted[0], np.ptp(ste, axis=0), *amplitude[:3]])


def markdown(found: Sequence[AssessedCase]) -> str:
    """Return the section of accuracy.md."""
    groups = {"all": list(found), "set no constant": [one for one in found if one.case.held_out]}
    return coverage_table(groups) + "\n" + _cases(found)


def _cases(found: Sequence[AssessedCase]) -> str:
    """Every pair and load at the level standard: true error, stated in brackets, of mean and peak-to-peak."""
    lines = [
        "| regime | pair | load | mean, um | off, % (stated) | peak-to-peak, um | off, % (stated) |",
        "|---|---|---:|---:|---:|---:|---:|",
    ]
    for one in (one for one in found if one.level == LEVELS[0]):
        mark = "*" if one.case.held_out else ""
        for k, load in enumerate(one.case.loads):
            cells = []
            for q in range(2):
                cells += [f"{1e6 * one.value[q, k]:.3g}", error_cell(one, q, k)]
            head = [one.case.regime, f"{one.case.name}{mark}", f"{load:.2g}"]
            lines.append("| " + " | ".join(head + cells) + " |")
    return "\n".join(lines) + "\n"


def publish(found: Sequence[AssessedCase], machine: dict[str, str]) -> None:
    """Write the section of the page between its marks."""
    versions = ", ".join(f"{name} {machine[name]}" for name in ("lineofaction", "numpy", "scipy"))
    replace_section(PAGE, SECTION, f"{markdown(found)}\nMeasured with {versions}.\n")
    _draw()


def _draw() -> None:
    """Measure four pairs and write the picture."""
    cases = [case for case in full_contact_cases() if case.name in CASES]
    lines = [_lines(case, palette.category(i)) for i, case in enumerate(cases)]
    panels = tuple(
        drawn.Panel(
            drawn.Axis("CPU time, s, of curves under three loads", "log"),
            drawn.Axis(f"error of {name}, % of the mean", "log"),
            tuple(line for pair in lines for line in pair[q]),
            title=name.capitalize(),
        )
        for q, name in enumerate(("the mean", "peak-to-peak"))
    )
    words = "Tables of 0.6 to 10 CPU s are within 0.2 % of full contact, which takes 50 to 150 CPU s."
    PICTURE.write_bytes(
        png(drawn.Figure("accuracy", "Error against CPU time, plane strain", words, words, panels, None))
    )


def _lines(case: FullContactCase, color: str) -> list[list[drawn.Line]]:
    """Return the lines of mean and of peak-to-peak: three levels, and full contact's own error."""
    position, exact, error = reference(case.name)
    truth = quantities(position, exact)
    seconds, off = [], []
    for level in DRAWN_LEVELS:
        table = analyze(case.pair, normal_forces=case.forces, model="plane_strain", level=level)
        found = np.array([table.curve(force=force, at=position).ste for force in table.force]).T
        off.append(np.max(np.abs(quantities(position, found) - truth)[:2] / truth[0], axis=1))
        seconds.append(float(table.metadata.receipt["cpu_seconds"]))
    timed = solve_full_contact(case.pair, [float(t) for t in table.torque], list(TIMED), estimate_error=True)
    peer = float(np.mean(timed.cpu_seconds)) * position.size
    own = float(np.max(error.mean(axis=0) / truth[0]))
    return [_pair_of_lines(case.name, color, seconds, np.array(off)[:, q], peer, own) for q in range(2)]


def _pair_of_lines(
    name: str, color: str, seconds: list[float], off: FloatArray, peer: float, own: float
) -> list[drawn.Line]:
    """Return one pair's levels as a line and full contact as a point."""
    levels = drawn.Line(f"{name}: draft, standard, fine", np.array(seconds), 100.0 * off, color, markers=True)
    at = np.array([peer]), np.array([100.0 * own])
    return [levels, drawn.Line(f"{name}: full contact", *at, color, width=0.0, markers=True)]
