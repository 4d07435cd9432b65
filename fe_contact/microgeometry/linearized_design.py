"""A design with its derivatives by the variables: curves and limits to first order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_contact.contact import CarryingStrips, ContactProblem, ContactSolution, adjoint, force_changes
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.curve_derivatives import opened_by
from fe_contact.microgeometry.evaluator import (
    Evaluation,
    Evaluator,
    LoadFigures,
    carried,
    edges,
    figures,
    on_edges,
    over_face,
)
from fe_contact.microgeometry.linear_merit import Rows
from fe_contact.microgeometry.objective import Limits
from fe_contact.types import FloatArray

NEAR = 0.8
"""Pressures from this part of the largest on are followed."""
_POINT = 1e-9
"""Half length in m of the strip of an edge that is not in contact."""


@dataclass(frozen=True)
class LinearizedDesign:
    """One design at S nodes of the scatter and L loads, to first order in d variables.

    Attributes
    ----------
    evaluation : Evaluation
    curves : ndarray, shape (S, P, L, d)
        dSTE/dvariable, m/m.
    limits : tuple of Rows
        Of each limit that is set: in parts of it less 1 (the load on edges: less its limit), at all places
        at which it may come to count.
    """

    evaluation: Evaluation
    curves: FloatArray
    limits: tuple[Rows, ...]


@dataclass(frozen=True)
class _Solved:
    """L loads of one misalignment at one node of the scatter with their derivatives by d variables.

    Attributes
    ----------
    pair, problem, solution, figures
    names : tuple of str
        Of the variables.
    strips : CarryingStrips
    opened : ndarray, shape (d, k)
        Normal approach that each variable takes away from them, m/m.
    """

    pair: ParallelAxes
    problem: ContactProblem
    solution: ContactSolution
    figures: LoadFigures
    names: tuple[str, ...]
    strips: CarryingStrips
    opened: FloatArray

    @cached_property
    def ste(self) -> FloatArray:
        """Derivatives of the transmission error (d, P, L), m/m."""
        return np.stack([self.strips.change(each) for each in self.opened])

    @cached_property
    def force(self) -> FloatArray:
        """Derivatives of the forces (d, P, L, m), N/m; solved only where a limit asks."""
        apart = np.zeros((len(self.names), *self.strips.shape))
        apart.reshape(len(self.names), -1)[:, self.strips.index] = self.opened
        return force_changes(self.problem, self.solution, apart)


def linearized(
    evaluator: Evaluator, values: Mapping[str, float], names: Sequence[str], limits: Limits
) -> LinearizedDesign:
    """Solve a design, ``gear.quantity`` to m, and differentiate it by the variables named."""
    parts = [_differentiated(*solved, tuple(names)) for solved in evaluator.solved(values)]
    rows = [_limit_rows(part, limits) for part in parts]
    joined = tuple(
        (np.concatenate([part[0] for part in each]), np.concatenate([part[1] for part in each]))
        for each in zip(*rows, strict=True)
    )
    curves = np.ascontiguousarray(np.moveaxis(evaluator.gathered([part.ste for part in parts]), 1, -1))
    return LinearizedDesign(evaluator.evaluation(part.figures for part in parts), curves, joined)


def _differentiated(
    pair: ParallelAxes, problem: ContactProblem, solution: ContactSolution, names: tuple[str, ...]
) -> _Solved:
    strips = CarryingStrips.of(pair, problem.candidates, adjoint(problem, solution))
    opened = np.stack([opened_by(strips, pair, name) for name in names])
    return _Solved(pair, problem, solution, figures(problem, solution), names, strips, opened)


def _limit_rows(solved: _Solved, limits: Limits) -> list[Rows]:
    rows: list[Rows] = []
    if limits.max_pressure is not None:
        rows.append(_pressure(solved, limits.max_pressure))
    if limits.face_load_factor is not None:
        rows.append(_face_load(solved, limits.face_load_factor))
    if limits.edge_load_share is not None:
        rows.append(_edge_load(solved, limits.edge_load_share))
    return rows


def _pressure(solved: _Solved, limit: float) -> Rows:
    """Return how far pressures exceed their limit; they grow as the root of the load."""
    pressure = solved.figures.pressure
    near = pressure >= NEAR * pressure.max()
    part = pressure[near] / limit
    by = [0.5 * part * each[near] / solved.solution.force[near] for each in solved.force]
    return part - 1.0, np.stack(by, axis=-1)


def _face_load(solved: _Solved, limit: float) -> Rows:
    mean = over_face(solved.problem, solved.solution.force).mean(axis=1, keepdims=True) * limit
    by = [(over_face(solved.problem, each) / mean).ravel() for each in solved.force]
    return solved.figures.face_load.ravel() / limit - 1.0, np.stack(by, axis=-1)


def _edge_load(solved: _Solved, limit: float) -> Rows:
    """Return how far the load on tip edges exceeds its limit at each position and load.

    Where none is in contact it is below zero by what the nearest one would carry, had the gear to lag by
    its clearance more.
    """
    problem, solution, c = solved.problem, solved.solution, solved.problem.candidates
    load = carried(problem, solution.force).sum(axis=2)
    share = solved.figures.edge_load_share.copy()
    by = [on_edges(problem, each) / load for each in solved.force]
    clear = c.motion_arm[:, None] * (c.gap[:, None] - solution.deflection[..., None])
    clear = np.where(edges(problem)[:, None], clear + problem.moved(solution.force), np.inf)
    nearest = clear.argmin(axis=2)
    p, k = np.nonzero((share == 0.0) & np.isfinite(clear.min(axis=2)))
    m = nearest[p, k]
    per_gap = 1.0 / (c.motion_arm[p, m] * solution.tangent[p, k] * load[p, k])
    share[p, k] = -clear[p, k, m] * per_gap
    zero = np.zeros(p.size)
    points = CarryingStrips.at(solved.pair, c, load.shape[1], (p, k, m), zero, zero + _POINT, zero)
    for a, name in enumerate(solved.names):
        moved = problem.moved(solved.force[a])[p, k, m] - c.motion_arm[p, m] * solved.ste[a, p, k]
        by[a][p, k] = -(opened_by(points, solved.pair, name) + moved) * per_gap
    return share.ravel() - limit, np.stack([each.ravel() for each in by], axis=-1)
