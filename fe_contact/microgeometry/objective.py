"""The objective of a design: expected peak-to-peak over the loads, and limits it has to keep."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy
from scipy.sparse import coo_array

from bounds import Bound, SiNote, above, at_least
from fe_contact.errors import InputError, finite, positive
from fe_contact.types import FloatArray, IntArray, Json

Rows = tuple[FloatArray, FloatArray]
"""Values (R,) and their derivatives (R, d)."""


class Objective(Protocol):
    """One number of the expected peak-to-peak STE at all loads."""

    def check(self, loads: int) -> None:
        """Raise `InputError` if it is not for that many loads."""

    def of(self, expected: FloatArray) -> float:
        """Return the number in m of the expectations (L,) in m."""

    def rows(self, loads: int) -> FloatArray:
        """Return weights (R, L) of that many loads: the number is the largest of the R weighted sums."""

    def to_json(self) -> Json:
        """Return plain JSON."""


@dataclass(frozen=True)
class WeightedMean:
    """Mean over the loads; `weights` (L,) >= 0 need not sum to 1, none are equal ones."""

    weights: tuple[float, ...] = ()

    def check(self, loads: int) -> None:
        """Refuse another number of weights, negative ones, and nothing but zeros."""
        if not self.weights:
            return
        for index, weight in enumerate(self.weights):
            if finite(f"objective.weights[{index}]", weight) < 0.0:
                raise InputError(f"objective.weights[{index}]", weight, at_least(0.0))
        if len(self.weights) != loads or sum(self.weights) == 0.0:
            bound = f"{loads} numbers, one for each torque, not all 0"
            raise InputError("objective.weights", list(self.weights), bound)

    def of(self, expected: FloatArray) -> float:
        """Return the mean."""
        return float(np.average(expected, weights=self.weights or None))

    def rows(self, loads: int) -> FloatArray:
        """Return one row."""
        weights = np.array(self.weights or (1.0,) * loads)
        return np.asarray(weights[None] / weights.sum())

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"objective": "weighted_mean", "weights": list(self.weights)}


@dataclass(frozen=True)
class Worst:
    """The load with the largest expectation."""

    def check(self, loads: int) -> None:
        """Every number of loads will do."""

    def of(self, expected: FloatArray) -> float:
        """Return the largest."""
        return float(expected.max())

    def rows(self, loads: int) -> FloatArray:
        """Return a row for each load."""
        return np.eye(loads)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"objective": "worst"}


@dataclass(frozen=True)
class Limits:
    """Limits of a design at every load and every node of the scatter; None: no limit."""

    max_pressure: float | None = None
    """Largest Hertzian pressure, Pa."""
    face_load_factor: float | None = None
    """K_Hbeta of the mean over a mesh cycle, > 1 (ISO 6336-1)."""
    edge_load_share: float | None = None
    """Largest part of the load that tip edges carry at any position; 0 forbids their contact."""
    peak_to_peak: float | None = None
    """Largest peak-to-peak of the transmission error, m."""
    root_stress: float | None = None
    """Largest principal stress in the tension roots of both gears, Pa."""

    def __post_init__(self) -> None:
        if self.max_pressure is not None:
            positive("limits.max_pressure", self.max_pressure, SiNote("In Pa: 1500 MPa is 1.5e9."))
        if (
            self.face_load_factor is not None
            and finite("limits.face_load_factor", self.face_load_factor) <= 1
        ):
            raise InputError("limits.face_load_factor", self.face_load_factor, above(1.0))
        if (
            self.edge_load_share is not None
            and not 0.0 <= finite("limits.edge_load_share", self.edge_load_share) < 1.0
        ):
            bound = Bound(0.0, 1.0, high_open=True)
            raise InputError("limits.edge_load_share", self.edge_load_share, bound)
        if self.peak_to_peak is not None:
            positive("limits.peak_to_peak", self.peak_to_peak, SiNote("In m: 1 µm is 1e-6."))
        if self.root_stress is not None:
            positive("limits.root_stress", self.root_stress, SiNote("In Pa: 400 MPa is 4e8."))

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "max_pressure_pa": self.max_pressure,
            "face_load_factor": self.face_load_factor,
            "edge_load_share": self.edge_load_share,
            "peak_to_peak_m": self.peak_to_peak,
            "root_stress_pa": self.root_stress,
        }


NO_LIMITS = Limits()


# The merit of designs about one of them, its curves to first order: where it is least is a linear program.
#
# Peak-to-peak is the difference of two maxima, and so has kinks at every optimum; over curves that are linear
# in the variables it is exact [1]_.
#
# References
# ----------
# .. [1] K. Madsen, H. Schjaer-Jacobsen, Linearly constrained minimax optimization, Math. Programming 14
#    (1978) 208-223.


@dataclass(frozen=True)
class LinearMerit:
    """Merit of designs to first order in d variables."""

    curves: FloatArray
    """Transmission error at S nodes of the scatter, in parts of the scale of the merit. Shape (S, P, L)."""
    by: FloatArray
    """Its derivatives. Shape (S, P, L, d)."""
    node_weight: FloatArray
    """Shape (S,)."""
    load_weight: FloatArray
    """Rows of the objective: the largest counts. Shape (R, L)."""
    limits: tuple[Rows, ...]
    """Of each limit: by how much it is exceeded; the largest counts, if it is above 0."""
    penalty: float
    """Of exceeding them."""

    def least(self, low: FloatArray, high: FloatArray) -> tuple[FloatArray, float]:
        """Return the step (d,) between two ends (d,) at which the merit is least, and that merit."""
        made = LinearProgram(self.by.shape[-1])
        nodes, loads = self.by.shape[0], self.by.shape[2]
        reach = np.maximum(np.abs(low), np.abs(high))
        top, bottom = made.columns(nodes * loads), made.columns(nodes * loads)
        for s in range(nodes):
            for k in range(loads):
                value, by = self.curves[s, :, k], self.by[s, :, k]
                middle = 0.5 * (value.max() + value.min())  # numbers near 1, whatever the mean is
                made.below(value - middle, by, reach, top[s * loads + k])
                made.below(middle - value, -by, reach, bottom[s * loads + k])
        (objective,) = made.columns(1)
        spread = self.node_weight[:, None, None] * self.load_weight.T  # S, L, R
        made.sums(spread.reshape(nodes * loads, -1).T, (top, bottom), objective)
        exceeded = made.columns(len(self.limits), least=0.0)
        for column, (value, by) in zip(exceeded, self.limits, strict=True):
            made.below(value, by, reach, column)
        return made.solve(low, high, objective, exceeded, self.penalty)


class LinearProgram:
    """A linear program in `count` steps and further columns, row by row."""

    def __init__(self, count: int) -> None:
        self._count, self._least = count, [-np.inf] * count
        self._row: list[IntArray] = []
        self._column: list[IntArray] = []
        self._value: list[FloatArray] = []
        self._right: list[FloatArray] = []
        self._rows = 0

    def columns(self, count: int, least: float = -np.inf) -> list[int]:
        """Return so many new columns, each at least `least`."""
        first = len(self._least)
        self._least += [least] * count
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
        """Return the step of least merit and the merit; no step where none is found."""
        cost = np.zeros(len(self._least))
        cost[objective], cost[exceeded] = 1.0, penalty
        value, row, column = (np.concatenate(each) for each in (self._value, self._row, self._column))
        matrix = coo_array((value, (row, column)), shape=(self._rows, cost.size)).tocsr()
        least, most = np.array(self._least), np.full(cost.size, np.inf)
        least[: low.size], most[: high.size] = low, high
        rows = scipy.optimize.LinearConstraint(matrix, ub=np.concatenate(self._right))
        bounds = scipy.optimize.Bounds(least, most)
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
