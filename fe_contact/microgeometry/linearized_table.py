"""STE tables of a design at its loads, with the derivatives of their curves by the design's variables.

A node is a point of the manufacturing scatter at which the design is assessed. Shapes: d variables, K
designs, P positions, F loads.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.table_fields import table_of_solution
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.evaluator import Evaluator, LoadFigures
from fe_contact.microgeometry.linearized_design import differentiated, limit_rows
from fe_contact.microgeometry.objective import NO_LIMITS, Limits, Rows
from fe_contact.microgeometry.root_influence import RootInfluence
from fe_contact.ste import ForceTable, SteDatabase
from fe_contact.ste.extraction import force_table
from fe_contact.ste.table_repair import AXIS
from fe_contact.types import FloatArray, IntArray

LOAD = "force"
SPACING = 1e-9
"""Distance of the misalignments of tables of perturbed designs, m. Any number serves: it only tells the
tables apart.
"""


@dataclass(frozen=True)
class TabledLoads:
    """Loads of one misalignment at one node of the scatter: their figures, and their table."""

    figures: LoadFigures
    table: SteDatabase
    by: Mapping[str, FloatArray]
    """Derivatives (d, P, F) of fields of the table by the variables, per m, by the name of the field.

    Empty without variables. The derivative of the tangent compliance is a finite difference between loads.
    """
    limits: tuple[Rows, ...]
    """Rows of the limits, as in `LinearizedNode`."""

    def at_loads(self, loads: IntArray) -> TabledLoads:
        """Return the table of some loads, by their rising indices; figures and limits stay those of all."""
        along = {name: axes.index(LOAD) for name, axes in self.table.stored.items() if LOAD in axes}
        arrays = {name: getattr(self.table, name).take(loads, axis) for name, axis in along.items()}
        by = {name: derivatives[:, :, loads] for name, derivatives in self.by.items()}
        return replace(self, table=replace(self.table, **arrays), by=by)

    def force_tables(self, steps: FloatArray) -> list[ForceTable]:
        """Return the mesh forces, to first order, of designs that differ by steps (K, d), m.

        All designs are made at once, as one table in which each design is a misalignment: so all of them have
        the same grid of force levels.
        """
        table, count = self.table, len(steps)
        along = {name: axes.index(AXIS) for name, axes in table.stored.items() if AXIS in axes}
        stacked = {name: np.repeat(getattr(table, name), count, axis) for name, axis in along.items()}
        for name, by in self.by.items():
            change = np.moveaxis(np.tensordot(steps, by, 1), 0, 2)  # (K, P, F) as (P, F, K)
            stacked[name] = stacked[name] + change[..., None]
        stacked_table = force_table(replace(table, **stacked | {AXIS: SPACING * np.arange(count)}))
        return [stacked_table.at_misalignment(k, table.misalignment) for k in range(count)]


def tabled_loads(
    evaluator: Evaluator,
    values: Mapping[str, float],
    nodes: Iterable[int],
    names: Sequence[str] = (),
    limits: Limits = NO_LIMITS,
) -> Iterator[TabledLoads]:
    """Solve a design, ``gear.quantity`` to m, at some nodes; yield a table for each misalignment.

    `names`: variables by which the tables and the limits are differentiated.
    """
    for node in nodes:
        solved = evaluator.solved(values, (node,))
        for group, (pair, problem, solution) in zip(evaluator.groups, solved, strict=True):
            skew = float(evaluator.misalignments[node, group[0]])  # one misalignment for all loads of a group
            table = table_of_solution(pair, problem, solution, evaluator.position, skew)
            yield _tabled_loads(pair, problem, solution, table, names, limits, evaluator.roots)


def _tabled_loads(
    pair: ParallelAxes,
    problem: ContactProblem,
    solution: ContactSolution,
    table: SteDatabase,
    names: Sequence[str],
    limits: Limits,
    roots: RootInfluence | None,
) -> TabledLoads:
    if not names:
        return TabledLoads(figures=LoadFigures.of(problem, solution, roots), table=table, by={}, limits=())
    design = differentiated(pair, problem, solution, names, roots)
    arm = np.stack([design.strips.arm_change(gap) for gap in design.opened])
    by = {
        "static_transmission_error": design.ste,
        "tangent_compliance": np.gradient(design.ste, solution.load, axis=2),
        "load_arm": arm,
    }
    return TabledLoads(figures=design.figures, table=table, by=by, limits=limit_rows(design, limits))
