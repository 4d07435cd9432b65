"""Interpolation error between the loads of a table, and the loads that bring it down.

Held-out loads are solved at some positions of one or two alignments of the table. Where the table misses one
of an interval by more than a goal allows, the middle one becomes a node, and both halves are measured again.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise

import numpy as np

from fe_contact.analysis.estimates.interval_goal import IntervalGoal
from fe_contact.analysis.estimates.interval_halving import curve_differences, halved
from fe_contact.analysis.pairs.contact_fields import carrying_pairs
from fe_contact.analysis.pairs.contact_lines import solve_operating_points
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.request.solved_run import Solved
from fe_contact.analysis.table_fields import table_support
from fe_contact.contact import Start
from fe_contact.sampled import WIDE_INTERVALS, WIDE_PROBES
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK, mean_of_curves
from fe_contact.ste.support_loads import SupportLoads, with_support_loads
from fe_contact.types import BoolArray, FloatArray, IntArray

LOAD_PROBES = np.arange(1, WIDE_PROBES + 1) / (WIDE_PROBES + 1)
"""Places of the held-out loads in an interval, on a logarithmic scale: a kink may lie anywhere in it."""
MIDDLE = np.array([0.5])
"""The same of tables with more than four intervals, which are short."""
AWAY = 1.4
"""Error anywhere in an interval over the largest at its held-out loads and the positions of the table: a kink
lies at another position for every load. Set on drawn tables (docs/decisions/0012)."""
MAX_HALVINGS = 8
"""Halvings of an interval of requested loads: a factor of five becomes one of 1.006. The error at a kink
falls in proportion to the interval that holds it."""


@dataclass(frozen=True)
class LoadErrors:
    """Error between the requested loads."""

    error: FloatArray
    """Largest difference of interpolant and solution in the interval after each load, m. Shape (F - 1,)."""
    change: FloatArray
    """Change of mean, peak-to-peak and harmonics at the held-out load, m. Shape (23, F - 1)."""
    inserted: SupportLoads | None
    """Solutions at further loads, with which the table has these errors, in all its base pitches."""
    limit: str
    """Reason why intervals that miss the goal got no further load; empty where all meet it."""


@dataclass(frozen=True)
class ValidationLoads:
    """The first pitch of a table at some positions, compared with solutions between its loads."""

    table: SteDatabase
    """Table of the first base pitch."""
    rows: IntArray
    """Positions that are solved. Shape (R,)."""
    places: OperatingPoints
    """Operating points of the table."""
    solved: Solved
    """Solutions of all operating points. The contact at held-out loads starts from them."""

    def errors(self, goal: IntervalGoal | None = None) -> LoadErrors:
        """Measure the error of every interval; with a goal insert loads until it is met or halved enough."""
        force = self.table.force.tolist()
        requested = _Loads(self.table, self._solved(self._missing(force, np.empty(0))))
        loads, limit = halved(
            requested,
            partial(self._middles, goal=goal),
            self._with_nodes,
            MAX_HALVINGS,
            "a load between them has no solution",
        )
        error, change = self._errors(loads.table, loads.probes)
        within = [_inside(loads.probes.force, low, high) for low, high in pairwise(force)]
        return LoadErrors(
            np.array([error[inside].max() for inside in within]),
            np.stack([change[:, inside].max(axis=1) for inside in within], axis=1),
            loads.inserted,
            limit,
        )

    def _with_nodes(self, loads: _Loads, middles: FloatArray) -> _Loads | None:
        """Return loads with further ones, N, and their held-out loads; None: one has no solution."""
        further = self._everywhere(middles)
        if further is None:
            return None
        inserted = further if loads.inserted is None else _joined_loads(loads.inserted, further)
        table = with_support_loads(self.table, self._first_pitch(inserted))
        missing = self._missing(_ends(table), loads.probes.force)
        probes = _joined_loads(loads.probes, self._solved(missing)) if missing.size else loads.probes
        return _Loads(table, probes, inserted)

    def _middles(self, loads: _Loads, goal: IntervalGoal | None) -> list[float]:
        """Return the middle held-out loads of the intervals of a table that miss the goal."""
        if goal is None:
            return []
        table, probes = loads.table, loads.probes
        allowed, middles = goal.shares("force"), []
        _, change = self._errors(table, probes)
        share = self._shares(probes, change, goal)
        for low, high in pairwise(_ends(table)):
            requested = np.searchsorted(table.force, low, side="right") - 1  # the interval around this one
            if not np.all(share[_inside(probes.force, low, high)] <= allowed[requested]):
                middle = int(np.argmin(np.abs(np.log(probes.force / np.sqrt(low * high)))))
                middles.append(float(probes.force[middle]))
        return middles

    def _everywhere(self, load: FloatArray) -> SupportLoads | None:
        """Solve loads at all operating points and positions; None: one load has no solution somewhere."""
        points, position = self.places, self.table.position
        (contacts,), _ = solve_operating_points(points, position, (load,), conditioned=False, edges=False)
        solved = table_support(points, contacts)
        if solved["support_force"].size < load.size:
            return None
        return SupportLoads(
            solved["support_force"],
            solved["support_transmission_error"],
            solved["support_tangent_compliance"],
            solved["support_pairs_in_contact"],
        )

    def _first_pitch(self, loads: SupportLoads) -> SupportLoads:
        count = self.table.position.size
        return SupportLoads(loads.force, loads.deflection[:count], loads.tangent[:count], loads.pairs[:count])

    def _missing(self, ends: list[float], known: FloatArray) -> FloatArray:
        """Return the held-out loads of intervals that are not known yet."""
        probes = LOAD_PROBES if self.table.force.size <= WIDE_INTERVALS + 1 else MIDDLE
        probed = [low ** (1.0 - probes) * high**probes for low, high in pairwise(ends)]
        loads = np.concatenate([known, ends])
        return np.array([x for x in np.concatenate(probed) if not np.isclose(x, loads, rtol=1e-9).any()])

    def _errors(self, table: SteDatabase, probes: SupportLoads) -> tuple[FloatArray, FloatArray]:
        """Return the largest difference (L,) of a table, and changes of the quantities (23, L), m."""
        position, misalignment = self._at_rows.position, self._at_rows.misalignment
        change = float(self._at_rows.center_distance_change[0])
        curves = table.ste(position[:, None, None], probes.force[:, None], misalignment, change)
        truth = probes.deflection[..., 0]
        error, changes = curve_differences(position, curves, truth)
        # a kink passes the extremes of the curve at a load between those that are held out
        changes[PEAK_TO_PEAK] = np.maximum(changes[PEAK_TO_PEAK], error)
        return AWAY * error.max(axis=1), AWAY * changes.max(axis=2)

    def _shares(self, probes: SupportLoads, change: FloatArray, goal: IntervalGoal) -> FloatArray:
        """Return the larger part of the tolerance that the changes of mean and peak-to-peak take, (L,).

        All points of an interval state its largest error, so the least error allowed in the interval counts.
        """
        at_nodes = self._at_rows.static_transmission_error[..., 0]
        ste = np.concatenate([at_nodes, probes.deflection[..., 0]], axis=1)
        force = np.concatenate([self.table.force, probes.force])
        values = np.stack([mean_of_curves(self._at_rows.position, ste, 1), np.ptp(ste, axis=0)])
        allowed = goal.tolerance.of(values).min(axis=2)
        shares = np.zeros(probes.force.size)
        for low, high in pairwise(self.table.force.tolist()):
            inside = _inside(probes.force, low, high)
            minimum = allowed[:, (force >= low) & (force <= high)].min(axis=1)
            shares[inside] = (change[[MEAN, PEAK_TO_PEAK]][:, inside] / minimum[:, None]).max(axis=0)
        return shares

    @cached_property
    def _alignments(self) -> tuple[IntArray, int]:
        """Misalignments nearest to and farthest from zero, and the nearest center distance, as indices."""
        sizes, changes = np.abs(self.table.misalignment), np.abs(self.table.center_distance_change)
        return np.unique([np.argmin(sizes), np.argmax(sizes)]), int(np.argmin(changes))

    @cached_property
    def _at_rows(self) -> SteDatabase:
        """The table at the rows and alignments that are solved."""
        skews, change = self._alignments
        nodes = {"position": self.rows, "misalignment": skews, "center_distance_change": np.array([change])}
        arrays = {}
        for name, dimensions in self.table.stored.items():
            arrays[name] = getattr(self.table, name)
            for axis, dimension in enumerate(dimensions):
                if dimension in nodes:
                    arrays[name] = np.take(arrays[name], nodes[dimension], axis=axis)
        return replace(self.table, **arrays)

    def _solved(self, load: FloatArray) -> SupportLoads:
        """Solve loads in N at the rows, each started between the table's solutions around it."""
        load, position, solutions = np.sort(load), self.table.position, []
        skews, change = self._alignments
        for m in skews.tolist():
            point_index = m * self.table.center_distance_change.size + change
            point = self.places.places[point_index]
            point.contact.keep_rows(point.model, position, self.rows)
            problem, solution = point.solve(position[self.rows], load, start=self._start(load, point_index))
            pairs = carrying_pairs(solution.force, problem.candidates)
            solutions.append((solution.deflection, solution.tangent, pairs))
        deflection, tangent, carrying = (
            np.stack(arrays, axis=2)[..., None] for arrays in zip(*solutions, strict=True)
        )
        return SupportLoads(load, deflection, tangent, carrying)

    def _start(self, load: FloatArray, point_index: int) -> Start:
        force, (problem, solution) = self.table.force, self.solved[point_index]
        above = np.clip(np.searchsorted(force, load), 1, force.size - 1)
        part = (load - force[above - 1]) / (force[above] - force[above - 1])
        lower, upper = (solution.force[np.ix_(self.rows, loads)] for loads in (above - 1, above))
        return Start(problem.candidates, lower + part[:, None] * (upper - lower))


@dataclass(frozen=True)
class _Loads:
    """Loads of the first base pitch of a table, with solutions held out between them."""

    table: SteDatabase
    probes: SupportLoads
    inserted: SupportLoads | None = None
    """Solutions at inserted loads, in all base pitches."""


def _ends(table: SteDatabase) -> list[float]:
    """Return the ends of the intervals of a table: its loads and those inserted between them, N."""
    return sorted([*table.force.tolist(), *table.inserted_force.tolist()])


def _joined_loads(first: SupportLoads, second: SupportLoads) -> SupportLoads:
    """Return the solutions of both, in order of load."""
    force = np.concatenate([first.force, second.force])
    order = np.argsort(force)
    return SupportLoads(
        force[order],
        np.concatenate([first.deflection, second.deflection], axis=1)[:, order],
        np.concatenate([first.tangent, second.tangent], axis=1)[:, order],
        np.concatenate([first.pairs, second.pairs], axis=1)[:, order],
    )


def _inside(load: FloatArray, low: float, high: float) -> BoolArray:
    return (load > low * (1.0 + 1e-9)) & (load < high * (1.0 - 1e-9))
