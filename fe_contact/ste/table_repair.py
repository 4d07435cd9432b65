"""Repair of a table with failed points or with noise."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import TypeVar

import numpy as np

from fe_contact.errors import SolveError
from fe_contact.ste.fields import GRID, SteFields
from fe_contact.types import BoolArray, FloatArray, IntArray
from host.optional_modules import scipy

Table = TypeVar("Table", bound=SteFields)


# the lift-off level is closed-form geometry, so it outweighs any solve
_LIFT_OFF_WEIGHT = 1e6


# repaired neighbors stay apart by at least this part of the smallest stored tangent compliance
_MIN_COMPLIANCE = 0.1


AXIS = "misalignment"
"""Axis along which tables are joined and linearized."""


@dataclass(frozen=True)
class Repair:
    """The change by `SteDatabase.monotone_repaired`."""

    curves: int
    """Load series (one per position and alignment) that were changed."""
    largest_change: float
    """Largest change of a stored transmission error, m."""
    position: float
    force: float
    misalignment: float
    center_distance_change: float
    """`position`, `force`, `misalignment`, `center_distance_change`: Grid point of the value (base pitches,
    N, m, m).
    """


def without_failed_rows(table: Table) -> Table:
    """Leave out the fewest rows (of any axis, greedily) so that no failed point remains.

    Raises `SolveError`: nothing remains.
    """
    if not table.n_failed:
        return table
    keep = _complete_rows(table.failed)
    if any(rows.size == 0 for rows in keep.values()):
        raise SolveError(f"{table.failure_message()}. No complete row remains.", table)
    arrays = {}
    for name, dimensions in table.stored.items():
        array = getattr(table, name)
        for i, dimension in enumerate(dimensions):
            array = np.take(array, keep[dimension], axis=i) if dimension in keep else array
        arrays[name] = array
    return replace(table, **arrays)


def monotone_table(table: Table) -> tuple[Table, Repair]:
    """Make the transmission error increase with load by isotonic regression, and report the change.

    Only the load series that fall somewhere are touched. The change is added to their error bands, from which
    the errors of mean, peak-to-peak and harmonics then follow, and the report to the receipt, as
    ``monotone_repair``. Support loads are dropped: beside mended ones they might fall. Raises `SolveError`:
    any point failed.
    """
    table.require_complete()
    loaded = np.moveaxis(table.static_transmission_error, 1, -1)
    levels = np.concatenate([table.no_load_transmission_error[..., None], loaded], axis=-1)
    falling = np.argwhere(np.any(np.diff(levels, axis=-1) <= 0.0, axis=-1))
    minimum = _MIN_COMPLIANCE * float(table.tangent_compliance.min())
    mended = levels.copy()
    for index in map(tuple, falling):
        mended[index] = _isotonic(levels[index], table.force, minimum)
    change = np.moveaxis(np.abs(mended - levels)[..., 1:], -1, 1)
    worst = np.unravel_index(int(np.argmax(change)), change.shape)
    coordinates = {name: float(getattr(table, name)[i]) for name, i in zip(GRID, worst, strict=True)}
    report = Repair(len(falling), float(change[worst]), **coordinates)
    metadata = replace(table.metadata, receipt=table.metadata.receipt | {"monotone_repair": asdict(report)})
    repaired = replace(
        table,
        static_transmission_error=np.moveaxis(mended[..., 1:], -1, 1),
        no_load_transmission_error=mended[..., 0],
        error_estimate=table.error_estimate + change,
        curve_error=table.curve_error[:0],
        metadata=metadata,
        support_force=np.empty(0),
    )
    return repaired, report


def _complete_rows(failed: BoolArray) -> dict[str, IntArray]:
    """Rows of each axis to keep: the row with the largest failed part goes first."""
    keep: list[IntArray] = [np.arange(size) for size in failed.shape]
    while failed.size and failed.any():
        parts = [failed.mean(axis=tuple(set(range(4)) - {i})) for i in range(4)]
        # of axes with equal parts the longest one loses a row: a row is its smallest part
        axis = max(range(4), key=lambda i: (parts[i].max(), failed.shape[i]))
        worst = int(np.argmax(parts[axis]))
        failed, keep[axis] = np.delete(failed, worst, axis=axis), np.delete(keep[axis], worst)
    return dict(zip(GRID, keep, strict=True))


def _isotonic(levels: FloatArray, force: FloatArray, minimum: float) -> FloatArray:
    """Return the nearest levels whose compliance is at least `minimum` everywhere."""
    tilt = minimum * np.concatenate([[0.0], force])
    weights = np.ones_like(levels)
    weights[0] = _LIFT_OFF_WEIGHT
    return np.asarray(scipy.optimize.isotonic_regression(levels - tilt, weights=weights).x + tilt)
