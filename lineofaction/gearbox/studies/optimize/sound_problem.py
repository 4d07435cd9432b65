"""The search for the quietest flanks of a scene: levels by the tables of a design, and their merit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import NamedTuple, Self

import numpy as np

from dynamics.errors import DynamicsError
from dynamics.types import FloatArray
from fe_contact.errors import FeContactError
from fe_contact.microgeometry.design_problem import PENALTY, Assessed, SearchProblem
from fe_contact.microgeometry.evaluator import LoadFigures
from fe_contact.microgeometry.linear_program import LinearProgram
from fe_contact.microgeometry.linearized_table import TabledLoads, tabled_loads
from fe_contact.microgeometry.objective import Rows
from fe_contact.microgeometry.scatter import ONE_NODE
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.studies.change.sound_flanks import HeardLoad
from model_studies.spread import quantiles
from model_studies.workers import InProcess, Workers, divided

LOAD_FACTORS = np.array([1.0 - 1e-3, 1.0, 1.0 + 1e-3])
"""Loads of a table over the load of a load case. The neighbors give the change of load arm and stiffness with
load."""
STEP = 2e-9
"""Largest change of a transmission error, m, over which the derivative of an excitation is a difference."""
CUTS, CLOSE = 40, 1e-3
"""Most linear programs of a step, and relative change of the merit at which they end."""
FOLLOWED = 12
"""Number of rows, the largest ones, of which each linear program takes cuts."""

_Node = tuple[list[LoadFigures], FloatArray]


class Powers(NamedTuple):
    """Powers or mean squares P(x) = c + g x + x Q x of designs a step x (d,) away, at S speeds.

    `constant` (..., S), `slope` (..., S, d), `bend` (..., S, d, d), which is positive semidefinite.
    """

    constant: FloatArray
    slope: FloatArray
    bend: FloatArray


@dataclass(frozen=True)
class HeardAt:
    """A load case of the scene, with the excitation of its other flanks."""

    case: HeardLoad
    counted: FloatArray
    """1 for each harmonic of the common period that counts, else 0. Shape (H,)."""
    share: float
    """Share of the duration; the shares of all load cases add up to 1."""

    def power(self, table: SteDatabase) -> FloatArray:
        """Return the counted power of a table at each speed (S,)."""
        return np.asarray(self.case.power(self.case.with_table(table).excitation) @ self.counted)

    def powers(self, loads: TabledLoads) -> Powers:
        """Return the counted powers of designs about a table, to first order of the excitation."""
        transfer, form = self.case.transfer, self.case.form
        largest = np.abs(loads.by["static_transmission_error"]).max(axis=(1, 2))
        steps = STEP / np.where(largest > 0.0, largest, 1.0)
        nominal, *shifted = loads.force_tables(np.vstack([np.zeros(steps.size), np.diag(steps)]))
        flanks = self.case.others.with_table(nominal)
        excitation = flanks.excitation
        inputs = transfer.inputs(excitation)
        changes = transfer.input_changes(excitation, inputs, flanks.changes(shifted)) / steps
        adjoint = np.swapaxes(changes.conj(), 2, 3)
        weight = form.weighting * self.counted
        along = (adjoint @ (form.matrix @ inputs[..., None]))[..., 0].real
        across = (adjoint @ form.matrix @ changes).real
        return Powers(
            np.asarray(form.weighted(inputs) @ self.counted),
            np.asarray(2.0 * np.einsum("sh,sha->sa", weight, along)),
            np.asarray(np.einsum("sh,shab->sab", weight, across)),
        )


@dataclass(frozen=True)
class HeardObjective:
    """One level over speeds and load cases.

    `worst_speed`, `worst_load`: whether the largest power counts, or the mean.
    """

    at: tuple[HeardAt, ...] = field(repr=False)
    worst_speed: bool
    worst_load: bool

    def rows(self, values: FloatArray) -> FloatArray:
        """Return the rows (R, ...) whose largest counts, from values (L, S, ...) by load case and speed."""
        if not self.worst_load:
            share = np.array([load.share for load in self.at])
            values = np.tensordot(share, values, 1)[None]
        if not self.worst_speed:
            values = values.mean(axis=1, keepdims=True)
        return values.reshape(-1, *values.shape[2:])

    def level(self, power: FloatArray) -> float:
        """Return the level of powers (L, S), dB."""
        return float(self.at[0].case.form.decibels(self.rows(power).max()))


@dataclass(frozen=True)
class HeardMerit:
    """Amplitude of designs a step away over that of the start: convex in the step, powers are quadratic."""

    powers: Powers
    """R rows, of which the largest counts, over the power of the start."""
    limits: tuple[Rows, ...]
    """Amount by which each limit is exceeded."""
    penalty: float

    def minimum(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, float]:
        """Return the step (d,) between two ends (d,) at which the merit is least, and that merit.

        By cutting planes: tangents of the largest rows, where the last program ended.
        """
        reach = np.maximum(np.abs(low), np.abs(high))
        best = np.zeros(low.size)
        least = self._merit(best)
        cuts = [self._cuts(best)]
        for _ in range(CUTS):
            program = LinearProgram(low.size)
            (objective,) = program.columns(1, minimum=0.0)
            for value, by in cuts:
                program.below(value, by, reach, objective)
            exceeded = program.columns(len(self.limits), minimum=0.0)
            for column, (value, by) in zip(exceeded, self.limits, strict=True):
                program.below(value, by, reach, column)
            step, bound = program.solve(low, high, objective, exceeded, self.penalty)
            merit = self._merit(step)
            if merit < least:
                best, least = step, merit
            if not least - bound > CLOSE * least:
                break
            cuts.append(self._cuts(step))
        return best, least

    def amplitudes(self, step: FloatArray) -> FloatArray:
        """Return the amplitudes of the rows (R,) after a step (d,)."""
        constant, slope, bend = self.powers
        return np.sqrt(np.maximum(constant + slope @ step + (bend @ step) @ step, 0.0))

    def _cuts(self, step: FloatArray) -> Rows:
        """Return tangents of the largest rows: values at no step, and derivatives."""
        amplitude = self.amplitudes(step)
        largest = np.argsort(-amplitude)[:FOLLOWED]
        largest = largest[amplitude[largest] > 0.0]
        by = (self.powers.slope + 2.0 * self.powers.bend @ step)[largest] / (2.0 * amplitude[largest, None])
        return amplitude[largest] - by @ step, by

    def _merit(self, step: FloatArray) -> float:
        excess = sum(max(0.0, float(np.max(value + by @ step))) for value, by in self.limits)
        return float(self.amplitudes(step).max()) + self.penalty * excess


@dataclass(frozen=True)
class HeardProblem(SearchProblem):
    """The search for the lowest level: the objective is in dB, the merit the amplitude over the start's.

    The evaluator has three loads for each load case: a little below it, its own, and a little above.
    `quantile`: share of the nodes that are no louder than the objective; None: it is that of their mean
    power.
    """

    sound: HeardObjective = field(kw_only=True)
    quantile: float | None = field(default=None, kw_only=True)

    @property
    def is_nominal(self) -> bool:
        """Whether the flanks have no scatter."""
        return self.quantile is None and self.evaluator.nodes.weight.size == 1

    @property
    def nominal(self) -> Self:
        """The problem without scatter."""
        return replace(self, evaluator=replace(self.evaluator, nodes=ONE_NODE), quantile=None)

    def at(self, positions: int) -> Self:
        """Return the problem at a number of positions, equally spaced in a base pitch."""
        return replace(self, evaluator=self.evaluator.at(np.arange(positions) / positions))

    def rough(self, positions: int) -> Self:
        """Return the problem without scatter, at no more than a number of positions."""
        return self.at(min(positions, self.evaluator.position.size)).nominal

    def linearize(self, point: FloatArray, workers: Workers) -> tuple[Assessed, HeardMerit]:
        """Evaluate the design at a point (d,) with the derivatives of the excitation."""
        values = self.values(point)
        tasks = [(values, nodes) for nodes in self.evaluator.runs]
        by = workers if len(tasks) > 1 else InProcess()
        try:
            parts = [*chain(*by.run(_linearized_nodes, self, tasks))]
        except (FeContactError, DynamicsError):
            d = point.size
            still = Powers(np.zeros(1), np.zeros((1, d)), np.zeros((1, d, d)))  # no step leads away from here
            return self._with_merit(math.inf, math.inf), HeardMerit(still, (), PENALTY)
        powers = _stacked_powers([part.powers for part in parts])
        objective, weight = self._over_nodes(powers.constant)
        expected = Powers(*(np.tensordot(weight, power, 1) for power in powers))
        violation = self._violation([figures for part in parts for figures in part.figures])
        level = self.sound.level(expected.constant) - objective + self.scale  # of the start, on its scale
        start = self.sound.at[0].case.form.reference * 10.0 ** (level / 10.0)
        rows = Powers(*(self.sound.rows(power) / start for power in expected))
        ranges = self.ranges
        limits = _joined_rows([part.limits for part in parts])
        scaled = Powers(rows.constant, rows.slope * ranges, rows.bend * ranges[:, None] * ranges)
        merit = HeardMerit(scaled, tuple((value, by * ranges) for value, by in limits), PENALTY)
        return self._with_merit(objective, violation), merit

    def evaluated(self, values: dict[str, float]) -> tuple[float, float]:
        """Return level in dB and violation of a design; infinite where it cannot be solved."""
        try:
            parts = [_node(self, values, node) for node in range(self.evaluator.nodes.weight.size)]
        except (FeContactError, DynamicsError):
            return math.inf, math.inf
        level, _ = self._over_nodes(np.stack([part[1] for part in parts]))
        return level, self._violation([figures for part in parts for figures in part[0]])

    def levels(self, values: dict[str, float], workers: Workers) -> FloatArray:
        """Return the levels of a design at each node (N,), dB; NaN where one cannot be solved."""
        nodes = range(self.evaluator.nodes.weight.size)
        return np.array([*divided(workers, _level_at, (self, values), nodes)])

    def _over_nodes(self, power: FloatArray) -> tuple[float, FloatArray]:
        """Return the level of powers (N, L, S) at the nodes, dB, and the weights (N,) of its derivatives.

        The derivatives of a quantile are those of the mean power of the nodes that are at least as loud.
        """
        if self.quantile is None:
            weight = self.evaluator.nodes.weight
            return self.sound.level(np.tensordot(weight, power, 1)), weight
        levels = np.array([self.sound.level(node_power) for node_power in power])
        level = float(quantiles(levels, self.quantile))
        loud = levels >= min(level, levels.max())
        return level, loud / loud.sum()

    def relative(self, objective: float) -> float:
        """Return the amplitude over the start's amplitude."""
        return float(10.0 ** ((objective - self.scale) / 20.0))

    def _violation(self, figures: Sequence[LoadFigures]) -> float:
        return self.evaluator.evaluation(figures).violation(self.limits)

    def tables_of(self, tabled: Sequence[TabledLoads]) -> list[TabledLoads]:
        """Return the table of each load case at its load and the neighbors, from the tables of a node."""
        tables = []
        for case in range(len(self.sound.at)):
            # the loads of a case are in one group of the evaluator
            of_case = [np.flatnonzero(group // LOAD_FACTORS.size == case) for group in self.evaluator.groups]
            (at,) = (k for k, loads in enumerate(of_case) if loads.size)
            tables.append(tabled[at].at_loads(of_case[at]))
        return tables


def _node(problem: HeardProblem, values: dict[str, float], node: int) -> _Node:
    """Return figures of a design at a node of its scatter, and its powers (L, S)."""
    tabled = list(tabled_loads(problem.evaluator, values, (node,)))
    at = zip(problem.sound.at, problem.tables_of(tabled), strict=True)
    return [part.figures for part in tabled], np.stack([load.power(case.table) for load, case in at])


def _level_at(shared: tuple[HeardProblem, dict[str, float]], node: int) -> float:
    """Return the level of a design at a node, dB: one task."""
    problem, values = shared
    try:
        return problem.sound.level(_node(problem, values, node)[1])
    except (FeContactError, DynamicsError):
        return math.nan


class _LinearizedNode(NamedTuple):
    """Figures, powers by load case and limits of a design at a node of its scatter."""

    figures: list[LoadFigures]
    powers: Powers
    limits: tuple[Rows, ...]


def _linearized_nodes(
    problem: HeardProblem, task: tuple[dict[str, float], tuple[int, ...]]
) -> list[_LinearizedNode]:
    """Linearize a design at some nodes: one task."""
    values, nodes = task
    parts = []
    for node in nodes:
        tabled = list(tabled_loads(problem.evaluator, values, (node,), problem.names, problem.limits))
        at = zip(problem.sound.at, problem.tables_of(tabled), strict=True)
        powers = _stacked_powers([load.powers(case) for load, case in at])
        limits = _joined_rows([case.limits for case in tabled])
        parts.append(_LinearizedNode([part.figures for part in tabled], powers, limits))
    return parts


def _stacked_powers(powers: Sequence[Powers]) -> Powers:
    """Return several powers as one, along a new first axis."""
    return Powers(*(np.stack(part) for part in zip(*powers, strict=True)))


def _joined_rows(limits: Sequence[tuple[Rows, ...]]) -> tuple[Rows, ...]:
    """Return the rows of each limit of several tables, in one."""
    return tuple(
        (np.concatenate([part[0] for part in rows]), np.concatenate([part[1] for part in rows]))
        for rows in zip(*limits, strict=True)
    )


def with_neighbor_loads(load: FloatArray, misalignment: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return loads (3 L,) and misalignments of an evaluator: each load case's, and its two neighbors."""
    return np.outer(load, LOAD_FACTORS).ravel(), np.repeat(misalignment, LOAD_FACTORS.size)
