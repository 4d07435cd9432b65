"""A design with its derivatives by the variables: curves and limits to first order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_contact.contact import CarryingStrips, ContactProblem, ContactSolution, force_changes
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.curve_derivatives import NEAR, Difference
from fe_contact.microgeometry.evaluator import (
    Evaluation,
    Evaluator,
    LoadFigures,
    carried,
    edges,
    on_edges,
    over_face,
)
from fe_contact.microgeometry.objective import Limits, Rows
from fe_contact.microgeometry.root_influence import RootInfluence
from fe_contact.types import FloatArray

FOLLOWED = 16
"""Highest and lowest positions that are followed."""
_POINT = 1e-9
"""Half length in m of the strip of an edge that is not in contact."""


@dataclass(frozen=True)
class _LinearizedDesign:
    """One design at S nodes of the scatter and L loads, to first order in d variables."""

    evaluation: Evaluation
    curves: FloatArray
    """Derivatives of the transmission error by the variables, m/m. Shape (S, P, L, d)."""
    limits: tuple[Rows, ...]
    """Rows of each limit that is set: figure over limit less 1 (load on edges: figure less limit), at all
    points that may become decisive.
    """


@dataclass(frozen=True)
class _Solved:
    """L loads of one misalignment at one node of the scatter with their derivatives by d variables."""

    pair: ParallelAxes
    problem: ContactProblem
    solution: ContactSolution
    figures: LoadFigures
    steps: tuple[Difference, ...]
    """Differences of the variables."""
    strips: CarryingStrips
    opened: FloatArray
    """Normal approach that each variable takes away from the strips, m/m. Shape (d, k)."""
    roots: RootInfluence | None

    @cached_property
    def ste(self) -> FloatArray:
        """Derivatives of the transmission error (d, P, L), m/m."""
        return np.stack([self.strips.change(gap) for gap in self.opened])

    @cached_property
    def force(self) -> FloatArray:
        """Derivatives of the forces (d, P, L, m), N/m; solved only where a limit asks."""
        separation = np.zeros((len(self.steps), *self.strips.shape))
        separation.reshape(len(self.steps), -1)[:, self.strips.index] = self.opened
        return force_changes(self.problem, self.solution, separation)


@dataclass(frozen=True)
class LinearizedNode:
    """The loads of one misalignment at one node: their figures, dSTE/dvariable (d, P, L), rows of limits."""

    figures: LoadFigures
    ste: FloatArray
    limits: tuple[Rows, ...]


def linearized_nodes(
    evaluator: Evaluator,
    values: Mapping[str, float],
    names: Sequence[str],
    limits: Limits,
    nodes: Sequence[int],
) -> list[LinearizedNode]:
    """Solve a design, ``gear.quantity`` to m, at some nodes, and differentiate it by the variables named."""
    parts = (differentiated(*solved, names, evaluator.roots) for solved in evaluator.solved(values, nodes))
    return [LinearizedNode(part.figures, part.ste, limit_rows(part, limits)) for part in parts]


def joined(evaluator: Evaluator, parts: Sequence[LinearizedNode]) -> _LinearizedDesign:
    """Return the design that was linearized at every node, in their order."""
    limits = tuple(
        (np.concatenate([part[0] for part in rows]), np.concatenate([part[1] for part in rows]))
        for rows in zip(*(part.limits for part in parts), strict=True)
    )
    curves = np.ascontiguousarray(np.moveaxis(evaluator.gathered([part.ste for part in parts]), 1, -1))
    return _LinearizedDesign(evaluator.evaluation(part.figures for part in parts), curves, limits)


def linearized(
    evaluator: Evaluator, values: Mapping[str, float], names: Sequence[str], limits: Limits
) -> _LinearizedDesign:
    """Solve a design, ``gear.quantity`` to m, and differentiate it by the variables named."""
    nodes = range(evaluator.nodes.weight.size)
    return joined(evaluator, linearized_nodes(evaluator, values, names, limits, nodes))


def differentiated(
    pair: ParallelAxes,
    problem: ContactProblem,
    solution: ContactSolution,
    names: Sequence[str],
    roots: RootInfluence | None,
) -> _Solved:
    """Return a solution of some loads with its derivatives by the variables named."""
    strips = CarryingStrips.of(pair, problem, solution)
    steps = tuple(Difference.of(pair, name) for name in names)
    opened = np.stack([step.opened(strips) for step in steps])
    figures = LoadFigures.of(problem, solution, roots)
    return _Solved(pair, problem, solution, figures, steps, strips, opened, roots)


def limit_rows(solved: _Solved, limits: Limits) -> tuple[Rows, ...]:
    """Return by how much each limit that is set is exceeded, with derivatives."""
    rows: list[Rows] = []
    if limits.max_pressure is not None:
        rows.append(_pressure(solved, limits.max_pressure))
    if limits.face_load_factor is not None:
        rows.append(_face_load(solved, limits.face_load_factor))
    if limits.edge_load_share is not None:
        rows.append(_edge_load(solved, limits.edge_load_share))
    if limits.peak_to_peak is not None:
        rows.append(_ripple(solved, limits.peak_to_peak))
    if limits.root_stress is not None and solved.roots is not None:
        stress, by = solved.roots.rows(solved.problem, solved.solution.force, solved.force)
        rows.append((stress / limits.root_stress - 1.0, by / limits.root_stress))
    return tuple(rows)


def _ripple(solved: _Solved, limit: float) -> Rows:
    """Return how far the peak-to-peak exceeds its limit: each high position above each low one."""
    ste, loads = solved.figures.ste, np.arange(solved.figures.ste.shape[1])
    order = np.argsort(ste, axis=0)
    high, low = order[-FOLLOWED:], order[:FOLLOWED]
    above = ste[high, loads][:, None] - ste[low, loads]
    by = solved.ste[:, high, loads][:, :, None] - solved.ste[:, low, loads][:, None]
    return above.ravel() / limit - 1.0, by.reshape(len(by), -1).T / limit


def _pressure(solved: _Solved, limit: float) -> Rows:
    """Return how far pressures exceed their limit; they grow as the root of the load."""
    pressure = solved.figures.pressure
    near = pressure >= NEAR * pressure.max()
    part = pressure[near] / limit
    by = [0.5 * part * force[near] / solved.solution.force[near] for force in solved.force]
    return part - 1.0, np.stack(by, axis=-1)


def _face_load(solved: _Solved, limit: float) -> Rows:
    mean = over_face(solved.problem, solved.solution.force).mean(axis=1, keepdims=True) * limit
    by = [(over_face(solved.problem, force) / mean).ravel() for force in solved.force]
    return solved.figures.face_load.ravel() / limit - 1.0, np.stack(by, axis=-1)


def _edge_load(solved: _Solved, limit: float) -> Rows:
    """Return how far the load on tip edges exceeds its limit at each position and load.

    Where none is in contact it is below zero by what the nearest one would carry, had the gear to lag by
    its clearance more.
    """
    problem, solution, c = solved.problem, solved.solution, solved.problem.candidates
    load = carried(problem, solution.force).sum(axis=2)
    share = solved.figures.edge_load_share.copy()
    by = [on_edges(problem, force) / load for force in solved.force]
    clear = c.motion_arm[:, None] * (c.gap[:, None] - solution.deflection[..., None])
    clear = np.where(edges(problem)[:, None], clear + problem.displacement(solution.force), np.inf)
    nearest = clear.argmin(axis=2)
    p, k = np.nonzero((share == 0.0) & np.isfinite(clear.min(axis=2)))
    m = nearest[p, k]
    per_gap = 1.0 / (c.motion_arm[p, m] * solution.tangent[p, k] * load[p, k])
    share[p, k] = -clear[p, k, m] * per_gap
    points = solved.strips.at_edges(c, (p, k, m), _POINT)
    for a, step in enumerate(solved.steps):
        closing = problem.displacement(solved.force[a])[p, k, m] - c.motion_arm[p, m] * solved.ste[a, p, k]
        by[a][p, k] = -(step.opened(points) + closing) * per_gap
    return share.ravel() - limit, np.stack([force.ravel() for force in by], axis=-1)
