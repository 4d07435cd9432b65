"""The STE database: stored arrays with the questions they answer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar, Unpack

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from bounds.brief import Row, brief
from fe_contact.errors import SolveError
from fe_contact.ste import extraction, netcdf
from fe_contact.ste.curve import Curve, curve, default_value, operating_point
from fe_contact.ste.curve_quantities import Spectrum
from fe_contact.ste.fields import GRID, SteFields
from fe_contact.ste.force_table import ForceTable, LevelGrid
from fe_contact.ste.headlines import headlines
from fe_contact.ste.mesh_force import ForceSample, MeshForce
from fe_contact.ste.tooth_loads import ToothLoads, tooth_loads
from fe_contact.types import BoolArray, Estimate, FloatArray, IntArray

if TYPE_CHECKING:
    import xarray


# Repair of a table with failed points or with noise.


Table = TypeVar("Table", bound=SteFields)

# the lift-off level is closed-form geometry, so it outweighs any solve
_LIFT_OFF_WEIGHT = 1e6
# repaired neighbors stay apart by at least this part of the smallest stored tangent compliance
_LEAST_COMPLIANCE = 0.1
AXIS = "misalignment"


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
    """`position`, `force`, `misalignment`, `center_distance_change`: Where that is (base pitches, N, m, m).
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


def _monotone_repaired(table: Table) -> tuple[Table, Repair]:
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
    least = _LEAST_COMPLIANCE * float(table.tangent_compliance.min())
    mended = levels.copy()
    for index in map(tuple, falling):
        mended[index] = _isotonic(levels[index], table.force, least)
    change = np.moveaxis(np.abs(mended - levels)[..., 1:], -1, 1)
    worst = np.unravel_index(int(np.argmax(change)), change.shape)
    where = {name: float(getattr(table, name)[i]) for name, i in zip(GRID, worst, strict=True)}
    report = Repair(len(falling), float(change[worst]), **where)
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
        # among equals the longest axis gives, since it loses least
        axis = max(range(4), key=lambda i: (parts[i].max(), failed.shape[i]))
        worst = int(np.argmax(parts[axis]))
        failed, keep[axis] = np.delete(failed, worst, axis=axis), np.delete(keep[axis], worst)
    return dict(zip(GRID, keep, strict=True))


def _isotonic(levels: FloatArray, force: FloatArray, least: float) -> FloatArray:
    """Nearest levels whose compliance is at least `least` everywhere."""
    tilt = least * np.concatenate([[0.0], force])
    weights = np.ones_like(levels)
    weights[0] = _LIFT_OFF_WEIGHT
    return np.asarray(scipy.optimize.isotonic_regression(levels - tilt, weights=weights).x + tilt)


@dataclass(frozen=True)
class SupportLoads:
    """Solutions at further loads of a table."""

    force: FloatArray
    """N, increasing. Shape (S,)."""
    deflection: FloatArray
    tangent: FloatArray
    """`deflection`, `tangent`: STE in m, and its derivative in m/N. Shape (P, S, M, D) each."""
    pairs: IntArray
    """Number of pairs that carry load. (P, S, M, D) integer array."""


def with_support_loads(table: Table, loads: SupportLoads) -> Table:
    """Return a table with further support loads."""
    order = np.argsort(np.concatenate([table.support_force, loads.force]))

    def merged(stored: NDArray[Any], further: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate([stored, further], axis=1)[:, order]

    return replace(
        table,
        support_force=np.concatenate([table.support_force, loads.force])[order],
        support_transmission_error=merged(table.support_transmission_error, loads.deflection),
        support_tangent_compliance=merged(table.support_tangent_compliance, loads.tangent),
        support_pairs_in_contact=merged(table.support_pairs_in_contact, loads.pairs),
    )


# The derivatives along all axes of a mesh-force table: plain arrays that make it C1 in every coordinate.


def _with_axis_derivatives(mesh_force: MeshForce) -> ForceTable:
    """Return the table of `mesh_force` with the derivatives that its interpolant uses.

    Stiffnesses come limited over all axes jointly, so that the force never falls with deflection; a table
    with one knot of misalignment and of center distance is returned as it is.
    """
    table = mesh_force.table
    if table.misalignment.size == 1 and table.center_distance_change.size == 1:
        return table
    return replace(
        table,
        deflection_derivative=_by_order(mesh_force.levels),
        stiffness_derivative=_by_order(mesh_force.stiffnesses),
    )


def _by_order(grid: LevelGrid) -> FloatArray:
    """Numbers of a grid over position, misalignment, center distance as (2, 2, 2, M, D, P, L)."""
    shape = np.moveaxis(grid.nodal[(0, 0, 0)], 0, 2).shape
    numbers = np.zeros((2, 2, 2, *shape))
    for (position, misalignment, distance), entry in grid.nodal.items():
        numbers[misalignment, distance, position] = np.moveaxis(entry, 0, 2)
    return numbers


class _StoredPoint(TypedDict, total=False):
    """The arguments of `SteDatabase.curve` by which a curve is chosen."""

    torque: float | None
    force: float | None
    misalignment: float | None
    center_distance_change: float | None


@brief
class SteDatabase(SteFields):
    """Static transmission error over position, load, misalignment and center distance.

    The attributes are those of `SteFields`. Arguments left at None mean: perfect alignment, or the only
    stored value of an axis of length 1. A table with failed points answers only with ``allow_failed=True``,
    from the rows that are complete.
    """

    def ste(
        self,
        position: ArrayLike,
        force: ArrayLike,
        misalignment: ArrayLike | None = None,
        center_distance_change: ArrayLike | None = None,
    ) -> FloatArray:
        """Transmission error in m at normal forces F_bn in N: the exact inverse of `force_at`.

        The arguments broadcast. Stored loads give the stored values at the knots. Below the smallest load the
        law of the first interval holds, above the highest the curve goes on straight; misalignment and
        center-distance change are held at the ends of their axes (`force_at` flags all three). Raises
        `InputError`: an argument is not finite, or a force is below zero; `SolveError`: any stored point
        failed.
        """
        return self._mesh_force.deflection_at(
            position,
            force,
            *self._alignment(misalignment, center_distance_change),
            to_transverse=self._to_transverse,
        )[0]

    def force_at(
        self,
        position: ArrayLike,
        deflection: ArrayLike,
        misalignment: ArrayLike | None = None,
        center_distance_change: ArrayLike | None = None,
    ) -> ForceSample:
        """Transverse mesh force F_bt with its tangent at a transmission error `deflection` in m.

        Raises `InputError`: an argument is not finite; `SolveError`: any stored point failed.
        """
        return self._mesh_force.force_at(
            position, deflection, *self._alignment(misalignment, center_distance_change)
        )

    def curve(
        self,
        *,
        torque: float | None = None,
        force: float | None = None,
        at: ArrayLike | None = None,
        misalignment: float | None = None,
        center_distance_change: float | None = None,
        allow_failed: bool = False,
    ) -> Curve:
        """One curve at a torque on gear 1 in N m or a normal force in N.

        Raises `InputError`: the load or the alignment lies outside what is stored; `SolveError`: any stored
        point failed, unless `allow_failed`.
        """
        table = without_failed_rows(self) if allow_failed else self
        point = operating_point(table, torque, force, misalignment, center_distance_change)
        return curve(table, table._mesh_force, point, at)

    def mean(self, **point: Unpack[_StoredPoint]) -> Estimate:
        """Mean transmission error over one period, m; raises as `curve`."""
        return self.curve(**point).mean

    def peak_to_peak(self, **point: Unpack[_StoredPoint]) -> Estimate:
        """Peak-to-peak transmission error over one period, m; raises as `curve`."""
        return self.curve(**point).peak_to_peak

    def harmonics(self, **point: Unpack[_StoredPoint]) -> tuple[Estimate, ...]:
        """Amplitudes of the mesh harmonics, first one first, m; raises as `curve`."""
        return self.curve(**point).harmonics

    def spectrum(self, **point: Unpack[_StoredPoint]) -> Spectrum:
        """All orders over the table's period, m; raises as `curve`."""
        return self.curve(**point).spectrum

    def tooth_loads(
        self, *, allow_failed: bool = False, **point: Unpack[_StoredPoint]
    ) -> tuple[ToothLoads, ...]:
        """Return the loads of each tooth of the gears whose teeth differ and are told apart by the period.

        Raises as `curve`.
        """
        table = without_failed_rows(self) if allow_failed else self
        table.require_complete()
        load = point.get("torque"), point.get("force")
        at = operating_point(table, *load, point.get("misalignment"), point.get("center_distance_change"))
        return tooth_loads(table, at)

    def headlines(self) -> tuple[str, list[Row]]:
        """Return what a Python prompt shows: title, and rows of loads, figures, effects and cost."""
        return headlines(self, self.curve)

    def force_table(self, *, allow_failed: bool = False) -> ForceTable:
        """Return the table of plain arrays for dynamics; raises as `extraction.force_table`."""
        if not allow_failed:
            return self._force_table
        return _with_axis_derivatives(MeshForce(extraction.force_table(without_failed_rows(self))))

    def monotone_repaired(self) -> tuple[SteDatabase, Repair]:
        """Return a table whose transmission error increases with load, and the changes."""
        return _monotone_repaired(self)

    def to_netcdf(self, path: str | Path) -> None:
        """Write one netCDF-4 file atomically."""
        netcdf.content(self).write(Path(path))

    @classmethod
    def from_netcdf(cls, path: str | Path) -> SteDatabase:
        """Read what `to_netcdf` wrote; `DatabaseError` says why a file is not one."""
        return cls(**netcdf.read(Path(path)))

    def to_xarray(self) -> xarray.Dataset:
        """Return the same content with names, units and coordinates."""
        return netcdf.content(self).to_xarray()

    @cached_property
    def _mesh_force(self) -> MeshForce:
        return MeshForce(extraction.force_table(self))

    @cached_property
    def _force_table(self) -> ForceTable:
        return _with_axis_derivatives(self._mesh_force)

    @property
    def _to_transverse(self) -> float:
        return math.cos(self.facts.base_helix_angle)

    def _alignment(
        self, misalignment: ArrayLike | None, center_distance_change: ArrayLike | None
    ) -> tuple[ArrayLike, ArrayLike]:
        return (
            default_value(None, self.misalignment) if misalignment is None else misalignment,
            default_value(None, self.center_distance_change)
            if center_distance_change is None
            else center_distance_change,
        )


# Tables of single misalignments as one table over all of them.


def joined_over_misalignment(tables: Sequence[SteDatabase]) -> SteDatabase:
    """Return the table over the misalignments of `tables`, in their order.

    Facts and metadata are those of the first. `tables`: alike but for their misalignments, which increase
    from one to the next. Raises `DatabaseError`: their other axes have different sizes or the misalignments
    do not increase.
    """
    along = {
        name: dimensions.index(AXIS) for name, dimensions in tables[0].stored.items() if AXIS in dimensions
    }
    joined: dict[str, Any] = {
        name: np.concatenate(_of_all_sources([getattr(table, name) for table in tables], name), axis=axis)
        for name, axis in along.items()
    }
    return replace(tables[0], **joined)


def _of_all_sources(errors: list[FloatArray], name: str) -> list[FloatArray]:
    """Return arrays with as many sources of errors: one that a table lacks adds none to it."""
    if name not in ("curve_error", "load_arm_error"):
        return errors
    count = max(len(array) for array in errors)
    return [np.concatenate([array, np.zeros((count - len(array), *array.shape[1:]))]) for array in errors]
