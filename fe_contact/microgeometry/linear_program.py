"""The merit of designs near one design to first order: its least value is a linear program."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.microgeometry.objective import Rows
from fe_contact.types import FloatArray, IntArray
from host.optional_modules import scipy, sparse


@dataclass(frozen=True)
class LinearMerit:
    """Merit of designs to first order in d variables."""

    curves: FloatArray
    """Transmission error at S nodes of the scatter, P positions and L loads, over the merit's scale. Shape
    (S, P, L).
    """
    by: FloatArray
    """Derivatives of the curves by the variables. Shape (S, P, L, d)."""
    node_weight: FloatArray
    """Weights of the nodes. Shape (S,)."""
    load_weight: FloatArray
    """Weights of the loads in each row of the objective; the largest row counts. Shape (R, L)."""
    limits: tuple[Rows, ...]
    """Rows of each limit: its excess at all points; the largest counts if it is above 0."""
    penalty: float
    """Merit per unit of the excess over a limit."""

    def minimum(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, float]:
        """Return the step (d,) between two ends (d,) at which the merit is least, and that merit."""
        program = LinearProgram(self.by.shape[-1])
        nodes, loads = self.by.shape[0], self.by.shape[2]
        reach = np.maximum(np.abs(low), np.abs(high))
        # bounds of every curve: their sum is its peak-to-peak
        top, bottom = program.columns(nodes * loads), program.columns(nodes * loads)
        for s in range(nodes):
            for k in range(loads):
                value, by = self.curves[s, :, k], self.by[s, :, k]
                middle = 0.5 * (value.max() + value.min())  # numbers near 1, whatever the mean is
                program.below(value - middle, by, reach, top[s * loads + k])
                program.below(middle - value, -by, reach, bottom[s * loads + k])
        (objective,) = program.columns(1)
        weight = self.node_weight[:, None, None] * self.load_weight.T  # S, L, R
        program.sums(weight.reshape(nodes * loads, -1).T, (top, bottom), objective)
        exceeded = program.columns(len(self.limits), minimum=0.0)
        for column, (value, by) in zip(exceeded, self.limits, strict=True):
            program.below(value, by, reach, column)
        return program.solve(low, high, objective, exceeded, self.penalty)


class LinearProgram:
    """A linear program, built row by row; its unknowns (columns) are `count` entries of a step and others."""

    def __init__(self, count: int) -> None:
        self._count, self._minimum = count, [-np.inf] * count
        self._row: list[IntArray] = []
        self._column: list[IntArray] = []
        self._value: list[FloatArray] = []
        self._right: list[FloatArray] = []
        self._rows = 0

    def columns(self, count: int, minimum: float = -np.inf) -> list[int]:
        """Return so many new columns, each at least `minimum`."""
        first = len(self._minimum)
        self._minimum += [minimum] * count
        return list(range(first, first + count))

    def below(self, value: FloatArray, by: FloatArray, reach: FloatArray, column: int) -> None:
        """Have value (R,) + by (R, d) step stay below a column, for steps up to `reach` (d,)."""
        swing = np.abs(by) @ reach
        may = value + swing >= (value - swing).max(initial=-np.inf)  # else another row is above it anyway
        count = int(may.sum())
        at = self._rows + np.arange(count)
        self._add(np.repeat(at, self._count), np.tile(np.arange(self._count), count), by[may].ravel())
        self._add(at, np.full(count, column), np.full(count, -1.0))
        self._end(-value[may])

    def sums(self, weight: FloatArray, groups: tuple[list[int], ...], column: int) -> None:
        """Have the weighted sums (R, n) of groups of n columns stay below a column."""
        rows = self._rows + np.arange(len(weight))
        for group in groups:
            self._add(np.repeat(rows, len(group)), np.tile(group, len(weight)), weight.ravel())
        self._add(rows, np.full(rows.size, column), np.full(rows.size, -1.0))
        self._end(np.zeros(rows.size))

    def solve(
        self, low: FloatArray, high: FloatArray, objective: int, exceeded: list[int], penalty: float
    ) -> tuple[FloatArray, float]:
        """Return the step of least merit and the merit; zero and infinity where no solution is found."""
        cost = np.zeros(len(self._minimum))
        cost[objective], cost[exceeded] = 1.0, penalty
        value, row, column = (np.concatenate(parts) for parts in (self._value, self._row, self._column))
        matrix = sparse.coo_array((value, (row, column)), shape=(self._rows, cost.size)).tocsr()
        minimum, maximum = np.array(self._minimum), np.full(cost.size, np.inf)
        minimum[: low.size], maximum[: high.size] = low, high
        rows = scipy.optimize.LinearConstraint(matrix, ub=np.concatenate(self._right))
        bounds = scipy.optimize.Bounds(minimum, maximum)
        solution = scipy.optimize.milp(cost, constraints=rows, bounds=bounds)  # no column is an integer
        if solution.x is None:
            return np.zeros(low.size), np.inf
        return np.asarray(solution.x[: low.size]), float(solution.fun)

    def _add(self, row: IntArray, column: IntArray, value: FloatArray) -> None:
        self._row.append(row)
        self._column.append(column)
        self._value.append(value)

    def _end(self, right: FloatArray) -> None:
        self._right.append(right)
        self._rows += right.size
