"""Stated errors against true ones: how often they cover them, and by how much they exceed them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.figures import Figure
from fe_contact.ste import Curve
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, MEAN, PEAK_TO_PEAK
from fe_contact.types import FloatArray

HARMONICS = 3
QUANTITIES = ("mean", "peak-to-peak", *(f"harmonic {k + 1}" for k in range(HARMONICS)))
STATED = (MEAN, PEAK_TO_PEAK, *range(FIRST_HARMONIC, FIRST_HARMONIC + HARMONICS))
"""Indices of these quantities among the errors that a table states."""
LARGEST_MEDIAN = 3.0
"""Largest median of the stated errors over the true ones."""


@dataclass(frozen=True)
class Assessed:
    """The curves of one table under some loads."""

    name: str
    level: str
    """`name`, `level`: Name of the pair, and level of its mesh."""
    value: FloatArray
    stated: FloatArray
    true: FloatArray
    """`value`, `stated`, `true`: `QUANTITIES`, and their stated and true errors, m. Shape (5, loads) each."""
    own: FloatArray | float = 0.0
    """Error of the reference that the true errors are against, m; it is forgiven."""

    @property
    def covered(self) -> FloatArray:
        """Whether stated errors and that of the reference reach the true ones (5, loads)."""
        return np.asarray(self.true <= self.stated + self.own)

    @property
    def ratio(self) -> FloatArray:
        """Stated over true errors (5, loads).

        A true error counts as that of the reference at least, and as 1e-5 of the mean.
        """
        return np.asarray(self.stated / np.maximum(self.true, np.maximum(self.own, 1e-5 * self.value[0])))


def assessed_at_positions(
    name: str, level: str, curves: Sequence[Curve], exact: FloatArray, error: FloatArray
) -> Assessed:
    """Hold mean and peak-to-peak (2, loads) of curves at the positions of a reference against it.

    The reference and its own error are (positions, loads) in m; that of its peak-to-peak is the sum of those
    at both extremes.
    """
    found = np.array([curve.ste for curve in curves]).T
    stated = np.array([[curve.mean.error, curve.peak_to_peak.error] for curve in curves]).T
    value, truth = (np.stack([ste.mean(axis=0), np.ptp(ste, axis=0)]) for ste in (found, exact))
    ends = np.stack([exact.argmax(axis=0), exact.argmin(axis=0)])
    own = np.stack([error.mean(axis=0), np.take_along_axis(error, ends, axis=0).sum(axis=0)])
    return Assessed(name, level, value, stated, np.abs(value - truth), own)


def coverage_figures(found: Sequence[Assessed], subject: str, target: float) -> list[Figure]:
    """Return by quantity how many per cent are not covered, and the median of stated over true errors."""
    rows = []
    for name, covered, ratio in _by_quantity(found):
        missed = 100.0 * float(np.mean(np.logical_not(covered)))
        rows += [
            Figure(subject, f"{name}: not covered", missed, "%", 100.0 - target),
            Figure(
                subject, f"{name}: median stated over true", float(np.median(ratio)), "times", LARGEST_MEDIAN
            ),
        ]
    return rows


def coverage_table(groups: Mapping[str, Sequence[Assessed]]) -> str:
    """Return coverage and median ratio by group and quantity, as a table of Markdown."""
    head = " | ".join(f"{name}: covered, stated / true" for name in QUANTITIES)
    lines = [f"| | curves | {head} |", "|---|---:|" + "---:|" * len(QUANTITIES)]
    for name, group in groups.items():
        if group:
            cells = [
                f"{100.0 * np.mean(yes):.0f} %, {np.median(part):.2g}" for _, yes, part in _by_quantity(group)
            ]
            curves = sum(one.value.shape[1] for one in group)
            lines.append(f"| {name} | {curves} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def table_against_peer(found: Sequence[Assessed], loads: Sequence[Sequence[float]], head: str) -> str:
    """Return a row of Markdown for each pair and load: errors of mean and peak-to-peak, the peer's beside."""
    lines = [
        f"| pair | {head} | mean, um | off, % (stated) | peer's own, % | peak-to-peak, um | off, % (stated) "
        "| peer's own, % |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for one, of_one in zip(found, loads, strict=True):
        own = 100.0 * np.asarray(one.own) / one.value
        for k, load in enumerate(of_one):
            cells = [one.name, f"{load:g}"]
            for q in range(2):
                cells += [f"{1e6 * one.value[q, k]:.3g}", error_cell(one, q, k), f"{own[q, k]:.2g}"]
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def error_cell(one: Assessed, quantity: int, load: int) -> str:
    """Return true and, in brackets, stated error in per cent of the value; bold where it is not covered."""
    true, stated = (
        100.0 * error[quantity, load] / one.value[quantity, load] for error in (one.true, one.stated)
    )
    text = f"{true:.2g} ({stated:.2g})"
    return text if one.covered[quantity, load] else f"**{text}**"


def _by_quantity(found: Sequence[Assessed]) -> list[tuple[str, FloatArray, FloatArray]]:
    """Return name, coverage and ratios of all curves by quantity, of as many as they hold."""
    covered = np.concatenate([one.covered for one in found], axis=1)
    ratio = np.concatenate([one.ratio for one in found], axis=1)
    return list(zip(QUANTITIES[: len(covered)], covered, ratio, strict=True))
