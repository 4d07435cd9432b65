"""The STE database: stored arrays, with curves, spectra and forces by interpolation."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike

from bounds.brief import Row, brief
from bounds.plottable import Plottable
from fe_contact.ste import extraction, netcdf
from fe_contact.ste.curve import Curve, curve
from fe_contact.ste.fields import SteFields
from fe_contact.ste.force_table import ForceTable
from fe_contact.ste.headlines import headlines
from fe_contact.ste.level_grid import LevelGrid
from fe_contact.ste.mesh_force import ForceSample, MeshForce
from fe_contact.ste.operating_point import default_value, operating_point
from fe_contact.ste.spectrum import Spectrum
from fe_contact.ste.table_repair import Repair, monotone_table, without_failed_rows
from fe_contact.ste.tooth_loads import ToothLoads, tooth_loads
from fe_contact.types import Estimate, FloatArray

if TYPE_CHECKING:
    import xarray


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
    """Return the values and derivatives of a grid as one array, (2, 2, 2, M, D, P, L).

    The first three axes are the orders of differentiation by misalignment, center distance and position, 0 or
    1. The others are the knots of these coordinates (M, D, P) and the levels (L).
    """
    shape = np.moveaxis(grid.nodal[(0, 0, 0)], 0, 2).shape
    numbers = np.zeros((2, 2, 2, *shape))
    for (position, misalignment, distance), entry in grid.nodal.items():
        numbers[misalignment, distance, position] = np.moveaxis(entry, 0, 2)
    return numbers


def _of_fields(kind: type[SteDatabase], values: dict[str, Any]) -> SteDatabase:
    return kind(**values)


class _StoredPoint(TypedDict, total=False):
    """The arguments of `SteDatabase.curve` by which a curve is chosen."""

    torque: float | None
    force: float | None
    misalignment: float | None
    center_distance_change: float | None


@brief
class SteDatabase(SteFields, Plottable):
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
        """Return the lines of a Python prompt: title, and rows of loads, figures, effects and cost."""
        return headlines(self, self.curve)

    def force_table(self, *, allow_failed: bool = False) -> ForceTable:
        """Return the table of plain arrays for dynamics; raises as `extraction.force_table`."""
        if not allow_failed:
            return self._force_table
        return _with_axis_derivatives(MeshForce(extraction.force_table(without_failed_rows(self))))

    def monotone_repaired(self) -> tuple[SteDatabase, Repair]:
        """Return a table whose transmission error increases with load, and the changes."""
        return monotone_table(self)

    def to_netcdf(self, path: str | Path) -> None:
        """Write one netCDF-4 file atomically."""
        netcdf.content(self).write(Path(path))

    @classmethod
    def from_netcdf(cls, path: str | Path) -> SteDatabase:
        """Read a file that `to_netcdf` wrote; `DatabaseError` says why a file is no database."""
        return cls(**netcdf.read(Path(path)))

    def to_xarray(self) -> xarray.Dataset:
        """Return the same content with names, units and coordinates."""
        return netcdf.content(self).to_xarray()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle and copy by the fields, whose arrays stay read-only; what follows from them is made anew."""
        return _of_fields, (type(self), {item.name: getattr(self, item.name) for item in fields(self)})

    @cached_property
    def _mesh_force(self) -> MeshForce:
        return MeshForce(extraction.force_table(self))

    @cached_property
    def _force_table(self) -> ForceTable:
        return _with_axis_derivatives(self._mesh_force)

    @property
    def _to_transverse(self) -> float:
        return math.cos(self.geometry.base_helix_angle)

    def _alignment(
        self, misalignment: ArrayLike | None, center_distance_change: ArrayLike | None
    ) -> tuple[ArrayLike, ArrayLike]:
        return (
            default_value(None, self.misalignment) if misalignment is None else misalignment,
            default_value(None, self.center_distance_change)
            if center_distance_change is None
            else center_distance_change,
        )
