"""Interpolation error of a table between the nodes of its axes, measured at held-out points.

A held-out point is solved, but is no node of the table. Arrays run over I intervals of an axis, L loads and
23 quantities: mean, peak-to-peak and harmonics of the transmission error.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fe_contact.analysis.estimates.interval_goal import GoalOf
from fe_contact.analysis.estimates.validation_alignments import ValidationAlignments, first_pitch
from fe_contact.analysis.estimates.validation_loads import ValidationLoads
from fe_contact.analysis.tables import SolvedTable
from fe_contact.errors import DatabaseError
from fe_contact.sampled import sampled_positions
from fe_contact.ste.curve_errors import BETWEEN_NODES
from fe_contact.ste.fields import CENTER_DISTANCE, MISALIGNMENT
from fe_contact.ste.support_loads import SupportLoads
from fe_contact.types import FloatArray, Json


@dataclass(frozen=True)
class AxisError:
    """Error of STE between the nodes of one axis."""

    at: FloatArray
    """The middle of every interval: of loads the geometric mean in N, of misalignments or changes of the
    center distance in m. Shape (I,).
    """
    error: FloatArray
    """Largest difference between interpolant and solution in the interval in m, at each load of the table; of
    the held-out loads themselves for the axis of loads. NaN where a solution did not converge. Ndarray, shape
    (I, L) or (I, 1).
    """
    change: FloatArray
    """Change of mean, peak-to-peak and harmonics by the difference at the held-out point, m. Ndarray, shape
    (23, I, L) or (23, I, 1).
    """
    inserted: FloatArray
    """Values that were inserted between the requested ones. Shape (n,)."""
    limit: str = ""
    """Reason why intervals that miss a tolerance got no further value; empty where all meet it."""

    def to_json(self) -> Json:
        """Return plain JSON; intervals without a solution hold null."""
        rows = [[float(e) if np.isfinite(e) else None for e in row] for row in self.error]
        limit = {"limit": self.limit} if self.limit else {}
        return {"at": self.at.tolist(), "error_m": rows, "inserted": self.inserted.tolist()} | limit


@dataclass(frozen=True)
class AxisValidation:
    """A table with its inserted nodes, and its errors between all nodes."""

    solved_table: SolvedTable
    """Solved table with its inserted alignments."""
    axes: Mapping[str, AxisError] = field(default_factory=dict)
    """Errors of the axes, by the name of the axis."""
    loads: SupportLoads | None = None
    """Solutions at the inserted loads."""


def validation_axes(solved_table: SolvedTable, goal_of: GoalOf | None = None) -> AxisValidation:
    """Solve held-out points in every interval of every axis that has one.

    A held-out point is solved at positions of the table, so that the table is interpolated along the axis
    alone; the error between positions is measured by `table_nodes`. On the other axes the point stands at the
    node nearest to zero. Where teeth differ, the first base pitch of the period is assessed.

    Parameters
    ----------
    solved_table : SolvedTable
        Solved table without inserted nodes.
    goal_of : callable, optional
        Goal of a table; nodes are inserted until all intervals meet it. No node is inserted where some base
        pitches of a period are derived from others instead of solved.

    Returns
    -------
    AxisValidation
        It has no axes where the table cannot be interpolated: a point failed, or the transmission error does
        not rise with load everywhere.
    """
    table = solved_table.table
    several = [name for name in BETWEEN_NODES if getattr(table, name).size > 1]
    if table.n_failed or not several:
        return AxisValidation(solved_table)
    try:  # raises where the transmission error does not rise with load
        table.ste(table.position[0], table.force[0])
    except DatabaseError:
        return AxisValidation(solved_table)
    if any(point.derived is not None for point in solved_table.places.places):
        goal_of = None
    axes: dict[str, AxisError] = {}
    for name in (MISALIGNMENT, CENTER_DISTANCE):
        if name in several:
            errors = ValidationAlignments(name, goal_of).errors(solved_table)
            solved_table, inserted = (
                errors.solved_table,
                getattr(errors.solved_table.table, f"inserted_{name}"),
            )
            middles = _middles(getattr(solved_table.table, name))
            axes[name] = AxisError(middles, errors.error, errors.change, inserted, errors.limit)
    if "force" not in several:
        return AxisValidation(solved_table, axes)
    pitch = first_pitch(solved_table.table)
    goal = None if goal_of is None else goal_of(solved_table.table)
    rows = sampled_positions(pitch.position.size)
    loads = ValidationLoads(pitch, rows, solved_table.places, solved_table.solved).errors(goal)
    middles = np.sqrt(table.force[1:] * table.force[:-1])
    inserted = np.empty(0) if loads.inserted is None else loads.inserted.force
    of_loads = AxisError(middles, loads.error[:, None], loads.change[..., None], inserted, loads.limit)
    return AxisValidation(solved_table, {"force": of_loads} | axes, loads.inserted)


def _middles(nodes: FloatArray) -> FloatArray:
    return np.asarray(0.5 * (nodes[:-1] + nodes[1:]))
