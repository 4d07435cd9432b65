"""The problem that a search solves: the merit of points of the unit cube.

Each of d variables of a design has a range that is one side of the cube. The objective is to be least; the
violation is the largest relative excess over a limit; the merit is the objective over its scale plus a
penalty on the violation.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Protocol, Self

import numpy as np

from fe_contact.microgeometry.evaluator import Evaluation, Evaluator
from fe_contact.microgeometry.linear_program import LinearMerit
from fe_contact.microgeometry.linearized_design import LinearizedNode, joined, linearized_nodes
from fe_contact.microgeometry.objective import Limits, Objective
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.types import FloatArray
from model_studies.workers import InProcess, Workers

PENALTY = 10.0
"""Merit per violation: an excess of 1 % over a limit costs a tenth of the objective's scale."""

SLACK = 0.005
"""Largest relative excess over a limit that counts as kept. A full analysis has more positions than a search.
"""

USUAL_DESIGNS = 100
"""Designs of all walks of a usual search, over which the cost of starting workers is divided."""


@dataclass(frozen=True)
class Assessed:
    """One design: its objective, by how much it exceeds the limits, and the merit that is minimized."""

    objective: float
    violation: float
    merit: float

    @property
    def order(self) -> tuple[float, float]:
        """Sort key of designs: first those that keep the limits, then by the objective."""
        return self.violation, self.objective


class Merit(Protocol):
    """The merit of designs near one design."""

    def minimum(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, float]:
        """Return the step (d,) between two ends (d,) at which the merit is least, and that merit."""


class _Memory(Protocol):
    """Objective and violation of designs (d,) at positions (P,)."""

    def find(self, values: FloatArray, position: FloatArray) -> tuple[float, float] | None:
        """Return the stored evaluation of a design at positions; None if there is none."""

    def add(self, values: FloatArray, position: FloatArray, figures: tuple[float, float]) -> None:
        """Store objective and violation of a design."""


@dataclass(frozen=True)
class SearchProblem(ABC):
    """The problem of a search: variables, evaluator and limits of the designs."""

    evaluator: Evaluator
    variables: tuple[DesignVariable, ...]
    limits: Limits
    scale: float
    """Objective of the start design; merits are relative to it."""
    memory: _Memory | None = None
    """Memory of designs that were assessed before; None without such a memory."""

    def __getstate__(self) -> dict[str, object]:
        """Return the fields without the memory, which is a file of this machine for one writer."""
        return vars(self) | {"memory": None}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the variables."""
        return tuple(variable.name for variable in self.variables)

    @property
    def ranges(self) -> FloatArray:
        """Widths of the variables' ranges (d,), m."""
        return np.array([variable.high - variable.low for variable in self.variables])

    def values(self, point: FloatArray) -> dict[str, float]:
        """Return the design at a point (d,) of the unit cube, ``gear.quantity`` to m."""
        inside = np.clip(point, 0.0, 1.0).tolist()
        return {v.name: v.low + x * (v.high - v.low) for v, x in zip(self.variables, inside, strict=True)}

    def unit_point(self, values: tuple[float, ...]) -> FloatArray:
        """Return the nearest point of the unit cube to a design."""
        ends = [(v.low, v.high) for v in self.variables]
        fractions = [(x - low) / (high - low) for x, (low, high) in zip(values, ends, strict=True)]
        return np.asarray(np.clip(np.array(fractions), 0.0, 1.0))

    def rough(self, positions: int) -> Self:
        """Return the problem at fewer positions, equally spaced in a base pitch; itself if it has no more."""
        if positions >= self.evaluator.position.size:
            return self
        return replace(self, evaluator=self.evaluator.at(np.arange(positions) / positions))

    def assess(self, point: FloatArray) -> Assessed:
        """Evaluate the design at a point; one whose contact cannot be solved has an infinite merit."""
        return self._with_merit(*self._figures(self.values(point)))

    def keep(self, point: FloatArray, assessed: Assessed) -> None:
        """Store an assessed design in the memory, which a worker's copy of the problem does not have."""
        key, position = np.array(list(self.values(point).values())), self.evaluator.position
        if self.memory is not None and self.memory.find(key, position) is None:
            self.memory.add(key, position, (assessed.objective, assessed.violation))

    @abstractmethod
    def linearize(self, point: FloatArray, workers: Workers) -> tuple[Assessed, Merit]:
        """Evaluate the design at a point (d,), and its merit to first order about it.

        Workers share the nodes of the scatter. The merit has NaN where the contact cannot be solved.
        """

    @abstractmethod
    def evaluated(self, values: dict[str, float]) -> tuple[float, float]:
        """Return objective and violation of a design, ``gear.quantity`` to m."""

    @abstractmethod
    def relative(self, objective: float) -> float:
        """Return the merit of an objective: 1 for that of the start design."""

    def _with_merit(self, objective: float, violation: float) -> Assessed:
        if not math.isfinite(objective):
            return Assessed(math.inf, math.inf, math.inf)
        return Assessed(objective, violation, self.relative(objective) + PENALTY * violation)

    def _figures(self, values: dict[str, float]) -> tuple[float, float]:
        """Return objective and violation of a design, from the memory if it has them."""
        key, position = np.array(list(values.values())), self.evaluator.position
        known = None if self.memory is None else self.memory.find(key, position)
        return self.evaluated(values) if known is None else known


@dataclass(frozen=True)
class DesignProblem(SearchProblem):
    """The search for the least ripple: the objective is made of the expected peak-to-peak, m."""

    objective: Objective = field(kw_only=True)

    def linearize(self, point: FloatArray, workers: Workers) -> tuple[Assessed, LinearMerit]:
        """Evaluate the design at a point (d,), and its merit over curves that are linear in the variables."""
        values = self.values(point)
        tasks = [(values, nodes) for nodes in self.evaluator.runs]
        executor = workers if len(tasks) > 1 else InProcess()
        design = joined(self.evaluator, [*chain(*executor.run(_linearized_nodes, self, tasks))])
        objective, violation = self._assessed(design.evaluation)
        position = self.evaluator.position
        merit = LinearMerit(
            curves=self.objective.counted(design.evaluation.ste, position) / self.scale,
            by=self.objective.counted(design.curves, position) * (self.ranges / self.scale),
            node_weight=self.evaluator.nodes.weight,
            load_weight=self.objective.rows(self.evaluator.load.size),
            limits=tuple((value, by * self.ranges) for value, by in design.limits),
            penalty=PENALTY,
        )
        return self._with_merit(objective, violation), merit

    def evaluated(self, values: dict[str, float]) -> tuple[float, float]:
        """Return objective in m and violation of a design."""
        return self._assessed(self.evaluator.evaluate(values))

    def relative(self, objective: float) -> float:
        """Return the objective over the scale."""
        return objective / self.scale

    def objective_of(self, evaluation: Evaluation, evaluator: Evaluator | None = None) -> float:
        """Return the objective in m of a design that an evaluator, by default that of the problem, solved."""
        solver = evaluator or self.evaluator
        counted = self.objective.counted(evaluation.ste, solver.position)
        return self.objective.of(solver.nodes.weight @ np.ptp(counted, axis=1))

    def _assessed(self, evaluation: Evaluation) -> tuple[float, float]:
        """Return objective in m and violation of an evaluated design."""
        objective = self.objective_of(evaluation)
        return objective, evaluation.violation(self.limits) if math.isfinite(objective) else math.inf


def _linearized_nodes(
    problem: DesignProblem, task: tuple[dict[str, float], tuple[int, ...]]
) -> list[LinearizedNode]:
    """Linearize a design at some nodes: one task."""
    values, nodes = task
    return linearized_nodes(problem.evaluator, values, problem.names, problem.limits, nodes)
