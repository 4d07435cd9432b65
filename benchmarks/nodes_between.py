"""Do the errors that a table states between its nodes cover the solutions there? Drawn tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.drawn_pairs import drawn_pairs
from benchmarks.figures import Figure
from benchmarks.pair_cases import PairCase
from fe_contact import SteDatabase, analyze
from fe_contact.types import FloatArray

SUBJECT = "tables between their nodes"
SEED, TABLES = 73, 30
POINTS = 5
"""Points between nodes of each table."""
TOLERANCE = 0.01
_COVERAGE = 95.0
_ALIGNMENT = "misalignment", "center_distance_change"
UM = 1e-6


@dataclass(frozen=True)
class BetweenNodes:
    """A table at points between its nodes, compared with a table that is solved there."""

    name: str
    met: bool
    """Whether the table states that it meets its tolerance."""
    inserted: int
    """Number of inserted loads, misalignments and center distances."""
    mean: FloatArray
    ripple: FloatArray
    """`mean`, `ripple`: Mean and peak-to-peak: value, stated error without the part that the solution at the
    point shares, true difference, and allowed error, m. Shape (Q, 4) each.
    """
    outside: FloatArray
    """Part of the positions at which the difference is beyond the band. Shape (Q,)."""


def drawn_tables(
    seed: int = SEED, count: int = TABLES
) -> Iterator[tuple[PairCase, dict[str, Any], FloatArray]]:
    """Yield pairs, the axes of their tables, and points between the nodes (3, 5).

    These are loads in N, misalignments and changes of the center distance in m. A fifth of the tables has two
    misalignments, a tenth, spur pairs in the plane, two center distances.
    """
    draw, apart = np.random.default_rng(seed), np.random.default_rng([seed, 1])
    for k, case in enumerate(drawn_pairs(seed, count)):
        rated = case.forces[1]
        steps = draw.uniform(1.8, 5.0, int(draw.integers(1, 3)))
        force = rated * draw.uniform(0.15, 0.5) * np.cumprod([1.0, *steps])
        low = draw.integers(0, force.size - 1, POINTS)
        part = draw.uniform(0.08, 0.92, POINTS)
        load = np.sort(force[low] ** (1.0 - part) * force[low + 1] ** part)
        skews = np.array(case.options.get("misalignments", (0.0,)))
        axes: dict[str, Any] = {"normal_forces": force, "misalignments": tuple(skews)}
        where = np.full(POINTS, skews[0])
        if k % 5 == 2:
            axes["misalignments"] = (0.0, float(draw.uniform(8.0, 25.0)) * UM)
            where = draw.uniform(0.1, 0.9, POINTS) * axes["misalignments"][1]
        change = np.zeros(POINTS)
        if k % 10 == 5:
            axes["center_distance_changes"] = (0.0, float(apart.uniform(50.0, 200.0)) * UM)
            change = apart.uniform(0.1, 0.9, POINTS) * axes["center_distance_changes"][1]
        yield case, axes, np.stack([load, where, change])


def between_nodes(
    case: PairCase, axes: dict[str, Any], at: FloatArray, cache_dir: Path | None
) -> BetweenNodes:
    """Compare one table with a solution at each of its points."""
    options = {"tolerance": TOLERANCE, "cache": cache_dir}
    table = analyze(case.pair, **axes, **options)
    rows = []
    for point in at.T:
        alignment = dict(zip(_ALIGNMENT, point[1:].tolist(), strict=True))
        truth = _solved(case, table, float(point[0]), alignment, options)
        rows.append(_row(table, truth, {"force": float(point[0])} | alignment))
    mean, ripple, outside = (np.array(each) for each in zip(*rows, strict=True))
    held_out = table.metadata.receipt["held_out"]
    inserted = sum(len(axis["inserted"]) for axis in held_out.values())
    return BetweenNodes(
        case.name, table.metadata.receipt["tolerance"]["met"], inserted, mean, ripple, outside
    )


def _solved(
    case: PairCase, table: SteDatabase, load: float, alignment: dict[str, float], options: dict[str, Any]
) -> SteDatabase:
    """Return the table of a load and the highest one of `table`, on the same mesh."""
    return analyze(
        case.pair,
        normal_forces=[load, float(table.force[-1])],  # the highest load decides on the load patches
        misalignments=[alignment["misalignment"]],
        center_distance_changes=[alignment["center_distance_change"]],
        **options,
    )


def _row(table: SteDatabase, truth: SteDatabase, point: dict[str, float]) -> tuple[Any, Any, float]:
    curve = table.curve(**point, at=truth.position)
    own, exact = table.curve(**point), truth.curve(**point)
    pairs = ((own.mean, exact.mean), (own.peak_to_peak, exact.peak_to_peak))
    figures = [
        (ours.value, ours.error, abs(ours.value - true.value), TOLERANCE * max(true.value, 20e-9 / TOLERANCE))
        for ours, true in pairs
    ]
    outside = float(np.mean(np.abs(curve.ste - exact.ste) > curve.error))
    return figures[0], figures[1], outside


@cache
def assessed() -> tuple[BetweenNodes, ...]:
    """Hold all drawn tables against solutions between their nodes."""
    return tuple(between_nodes(*drawn, None) for drawn in drawn_tables())


def figures() -> list[Figure]:
    """Return the coverage, and the part of the points within the tolerance where it is said to be met."""
    found = assessed()
    ripple = np.concatenate([one.ripple for one in found])
    mean = np.concatenate([one.mean for one in found])
    met = np.concatenate([one.ripple for one in found if one.met] or [np.empty((0, 4))])
    return [
        Figure(SUBJECT, "means covered", 100.0 * covered(mean), "%", _COVERAGE),
        Figure(SUBJECT, "peak-to-peaks covered", 100.0 * covered(ripple), "%", _COVERAGE),
        Figure(
            SUBJECT, "peak-to-peaks within a tolerance said to be met", 100.0 * within(met), "%", _COVERAGE
        ),
        Figure(
            SUBJECT,
            "positions in the band",
            100.0 * (1.0 - np.mean([o.outside for o in found])),
            "%",
            _COVERAGE,
        ),
    ]


def covered(rows: FloatArray) -> float:
    """Return the part of the rows whose difference is within the stated error."""
    return float(np.mean(rows[:, 2] <= rows[:, 1]))


def within(rows: FloatArray) -> float:
    """Return the part of the rows whose difference is within the allowed error."""
    return float(np.mean(rows[:, 2] <= rows[:, 3]))
