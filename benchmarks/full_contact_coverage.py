"""Do the stated errors cover the truth? Tables in plane strain against full finite-element contact."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from benchmarks.full_contact_cases import FullContactCase, full_contact_cases
from benchmarks.marked_section import replace_section
from fe_contact import SteDatabase, analyze
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.model_error import in_small_displacements
from fe_contact.ste.curve_errors import AT_NODES, all_sources
from fe_contact.types import FloatArray

ROOT = Path(__file__).parents[1]
REFERENCE = ROOT / "tests" / "reference" / "full_contact_curves.csv"
PAGE, SECTION = ROOT / "docs" / "accuracy.md", "full contact"
SUBJECT = "stated errors against full contact"
QUANTITIES = ("mean", "peak-to-peak", "harmonic 1", "harmonic 2", "harmonic 3")
LEVELS = ("standard", "fine")
_COVERAGE, _MEDIAN = 90.0, 3.0
_FITTED = 8
"""Harmonics of a fit: positions at which the reference has no solution are left out of both curves."""


@dataclass(frozen=True)
class Assessed:
    """One pair at one level: value, stated, true, and the reference's own error (5 quantities, loads), m."""

    case: FullContactCase
    level: str
    value: FloatArray
    stated: FloatArray
    true: FloatArray
    own: FloatArray

    @property
    def covered(self) -> FloatArray:
        """Whether stated errors and that of the reference reach the difference (5, loads)."""
        return np.asarray(self.true <= self.stated + self.own)

    @property
    def ratio(self) -> FloatArray:
        """Stated over true errors; a true error counts as that of the reference at least."""
        return np.asarray(self.stated / np.maximum(self.true, np.maximum(self.own, 1e-12)))


def figures() -> list[Figure]:
    """Return the coverage of pairs that set no constant."""
    held_out = [one for one in assessed() if one.case.held_out]
    rows = [Figure(SUBJECT, "pairs not used for any constant", len(held_out) / len(LEVELS), "-", 6.0)]
    for q, name in enumerate(QUANTITIES):
        covered = np.concatenate([one.covered[q] for one in held_out])
        ratio = np.concatenate([one.ratio[q] for one in held_out])
        missed = 100.0 * float(np.mean(~covered))
        rows += [
            Figure(SUBJECT, f"{name}: not covered", missed, "%", 100.0 - _COVERAGE),
            Figure(SUBJECT, f"{name}: median stated over true", float(np.median(ratio)), "times", _MEDIAN),
        ]
    return rows


@cache
def assessed() -> tuple[Assessed, ...]:
    """Hold every pair at every level against full contact."""
    return tuple(assess(case, level) for case in full_contact_cases() for level in LEVELS)


def assess(case: FullContactCase, level: str) -> Assessed:
    """Hold one table against full contact at the same positions."""
    position, exact, error = reference(case.name)
    table = analyze(case.pair, normal_forces=case.forces, model="plane_strain", level=level)
    found = np.array([table.curve(force=force, at=position).ste for force in table.force]).T
    value = quantities(position, found)
    true = np.abs(value - quantities(position, exact))
    own = np.stack([np.mean(error, axis=0)] * len(QUANTITIES))
    return Assessed(case, level, value, stated(table, case.pair), true, own)


def stated(table: SteDatabase, pair: ParallelAxes) -> FloatArray:
    """Return the stated errors (5, loads) in m, without those that the reference shares.

    It is in plane strain, and its displacements are small.
    """
    curves = [table.curve(force=force) for force in table.force]
    found = [[curve.mean, curve.peak_to_peak, *curve.harmonics] for curve in curves]
    own = np.array([[quantity.value for quantity in row] for row in found]).T
    sources = table.curve_error[: len(AT_NODES), :, :, 0, 0].copy()
    sources[AT_NODES.index("model")] = in_small_displacements(pair, table.force, own)
    sources[AT_NODES.index("finite_width")] = 0.0
    return all_sources(sources)[: len(QUANTITIES)]


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


def markdown(found: Sequence[Assessed]) -> str:
    """Return the section of docs/accuracy.md."""
    return _coverage(found) + "\n" + _cases(found)


def _coverage(found: Sequence[Assessed]) -> str:
    """Coverage by quantity: of all pairs, and of those that set no constant."""
    lines = [
        "| | curves | " + " | ".join(f"{name}: covered, stated / true" for name in QUANTITIES) + " |",
        "|---|---:|" + "---:|" * len(QUANTITIES),
    ]
    groups = {"all": list(found), "set no constant": [one for one in found if one.case.held_out]}
    for name, group in groups.items():
        covered = np.concatenate([one.covered for one in group], axis=1)
        ratio = np.concatenate([one.ratio for one in group], axis=1)
        cells = [
            f"{100.0 * np.mean(yes):.0f} %, {np.median(part):.2g}"
            for yes, part in zip(covered, ratio, strict=True)
        ]
        lines.append(f"| {name} | {covered.shape[1]} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _cases(found: Sequence[Assessed]) -> str:
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
                off, told = (100.0 * error[q, k] / one.value[q, k] for error in (one.true, one.stated))
                text = f"{off:.2g} ({told:.2g})"
                cells += [f"{1e6 * one.value[q, k]:.3g}", text if one.covered[q, k] else f"**{text}**"]
            head = [one.case.regime, f"{one.case.name}{mark}", f"{load:.2g}"]
            lines.append("| " + " | ".join(head + cells) + " |")
    return "\n".join(lines) + "\n"


def publish(found: Sequence[Assessed], machine: dict[str, str]) -> None:
    """Write the section of the page between its marks."""
    versions = ", ".join(f"{name} {machine[name]}" for name in ("lineofaction", "numpy", "scipy"))
    replace_section(PAGE, SECTION, f"{markdown(found)}\nMeasured with {versions}.\n")
