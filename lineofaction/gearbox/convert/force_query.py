"""Batches of force queries between boundary units and the compiled force of an STE database."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fe_contact.types import FloatArray
from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import BadInput, JobFailed
from lineofaction.gearbox.schemas.query import LIMITS, MAX_POINTS, QueryInput
from lineofaction.gearbox.units import N_PER_UM, factor

if TYPE_CHECKING:
    from fe_contact.ste.compiled_force import CompiledForce
    from fe_contact.ste.fields import SteFields

force_error = on_demand("fe_contact.ste.node_errors:force_error")
_ROW = {"position": 0, "misalignment_um": 1, "center_distance_change_mm": 2, "deflection_um": 3}
_FACTOR = {name: factor(name) for name in _ROW}
_REQUIRED = ("position", "deflection_um")


class ForceAnswer(NamedTuple):
    """Force in N, tangent stiffness in N/um, sums of validity flags, each (n,)."""

    force_n: FloatArray
    stiffness_n_per_um: FloatArray
    validity: NDArray[np.int8]

    def error_n(self, table: SteFields, points: FloatArray) -> list[float | None]:
        """Return the error of the force at the points of a query (4, n) in N; None: not estimated."""
        errors = force_error(table, points, self.force_n, self.stiffness_n_per_um * N_PER_UM)
        return [
            error if known else None
            for error, known in zip(errors.tolist(), np.isfinite(errors), strict=True)
        ]

    @staticmethod
    def of(law: CompiledForce, points: FloatArray) -> ForceAnswer:
        """Return force, tangent stiffness and validity at points (4, n).

        Raises `JobFailed`: the table gives no number somewhere.
        """
        forces = law.force_at(points)
        if not (np.isfinite(forces.force).all() and np.isfinite(forces.stiffness).all()):
            raise JobFailed("The table has no value at some of these points. Compute it again.")
        return ForceAnswer(forces.force, forces.stiffness / N_PER_UM, forces.validity)


def points_of_model(query: QueryInput) -> FloatArray:
    """Return the points of a query in SI units, (4, n) as `CompiledForce.force_at` takes them."""
    columns = {name: np.array(getattr(query, name), dtype=float, ndmin=1) for name in LIMITS}
    return _points(columns, max(column.size for column in columns.values()))


def points_of_columns(values: FloatArray, names: Sequence[str]) -> FloatArray:
    """Return points given as columns (k, n) in the units of their names, which `check_columns` has passed.

    Raises `BadInput`: there are too many points; a value is not finite or out of bounds.
    """
    if values.shape[1] > MAX_POINTS:
        remedy = "Ask in several requests."
        raise BadInput.of("position", f"{values.shape[1]} values", f"a list of at most {MAX_POINTS}", remedy)
    for name, column in zip(names, values, strict=True):
        wrong = np.flatnonzero(~(np.abs(column) <= LIMITS[name]))
        if wrong.size:
            bound = f"a finite number from {-LIMITS[name]:g} to {LIMITS[name]:g}"
            raise BadInput.of(f"{name}[{wrong[0]}]", float(column[wrong[0]]), bound, "Correct the value.")
    return _points(dict(zip(names, values, strict=True)), values.shape[1])


def check_columns(names: Sequence[str]) -> None:
    """Refuse columns that make no query: unknown ones, doubles, no position or no deflection."""
    if len(set(names)) == len(names) and set(_REQUIRED) <= set(names) <= set(LIMITS):
        return
    bound = f"{', '.join(_REQUIRED)} and, if wanted, the others of {', '.join(LIMITS)}, each once"
    raise BadInput.of("columns", ",".join(names), bound, "Name the columns of the body in their order.")


def _points(columns: dict[str, FloatArray], size: int) -> FloatArray:
    """Put columns in SI units into the rows of an array; a missing column is 0."""
    points = np.zeros((len(_ROW), size))
    for name, column in columns.items():
        np.multiply(column, _FACTOR[name], out=points[_ROW[name]])
    return points
