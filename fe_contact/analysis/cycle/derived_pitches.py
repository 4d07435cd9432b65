"""Base pitches of a table by derivatives about solved pitches: arrays, curves and their errors.

A period has many base pitches where teeth differ; a state is one of them that was solved, or the contact of
the nominal gears. The difference of a base pitch from a state is found to first order in transmission error,
shares of the load, its centroid and its arm. All other arrays are those of the state whose tangent counts at
the position. The largest pressure of a pair of teeth is Hertz's, as the root of its share.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fe_contact.analysis.cycle.envelope import CycleContact, Envelope, LeastTangents, chosen, in_parts
from fe_contact.analysis.cycle.load_monotonicity import rising_deflection
from fe_contact.analysis.cycle.tangents import SolvedState
from fe_contact.analysis.pairs.contact_block import curves_of_point
from fe_contact.analysis.pairs.contact_fields import OF_SUPPORT, contact_fields, largest_by_pair
from fe_contact.analysis.pairs.operating_points import OperatingPoint, OperatingPoints
from fe_contact.analysis.pairs.solved_contact import SolvedContact, solved_in_parts
from fe_contact.analysis.pairs.tip_edges import edge_depth
from fe_contact.contact import Candidates, ContactSolution, contact_pressure
from fe_contact.contact.load_weights import load_sums
from fe_contact.errors import SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions
from fe_contact.planning.cost_of_derivatives import BATCH
from fe_contact.types import FloatArray, IntArray, Json, Status

PART_OF_TOLERANCE = 0.4
"""Share of the tolerance that derivatives may take where a tolerance is requested. Plan and mesh use the
rest.
"""
MAX_GROWN = 1.25
"""Largest growth of the pressure of a pair of teeth over its pressure in the state whose tangent counts. A
larger load share spreads along the face instead.
"""
_MAX_POINTS = 0.99

_ARM, _CENTROID, _SHARES = 0, 1, 2
_EDGE_OF_PAIR = "edge pressure of pair"
_CURVES = "static_transmission_error", "load_arm"


def _arm_row(pair: ParallelAxes, c: Candidates) -> FloatArray:
    """Follow the arm of the load, m."""
    return np.asarray(pair.tilt_arm(c.touch.roll_1, c.face_position))[None]


def _table_rows(pair: ParallelAxes, c: Candidates) -> FloatArray:
    """Follow the arm of the load and its centroid, m, and the shares of the pairs."""
    of_pair = (c.pair == np.unique(c.pair)[:, None]).astype(float)
    rows = np.concatenate([c.face_position[None], of_pair])
    return np.concatenate([_arm_row(pair, c), np.broadcast_to(rows[:, None], (len(rows), *c.gap.shape))])


def _keep(point: OperatingPoint, edges: bool, state: SolvedState) -> Mapping[str, NDArray[Any]]:
    """Return the arrays of a state that a table stores, and the arrays that others follow from."""
    problem, solution = state.problem, state.solution
    pressure, edge = pressed = contact_pressure(problem, solution.force)
    depth = edge_depth(point, problem, solution) if edges else np.zeros(solution.load.size)
    return {
        **contact_fields(point.contact.pair, problem, solution, pressed),
        _EDGE_OF_PAIR: largest_by_pair(problem.candidates, np.where(edge, pressure, 0.0)),
        **_of_solution(solution),
        "edge_depth": np.broadcast_to(depth, solution.deflection.shape),
    }


def _keep_support(point: OperatingPoint, state: SolvedState) -> Mapping[str, NDArray[Any]]:
    fields = contact_fields(point.contact.pair, state.problem, state.solution)
    return {name: fields[name] for name in OF_SUPPORT} | _of_solution(state.solution)


def _of_solution(solution: ContactSolution) -> dict[str, NDArray[Any]]:
    unloaded = np.broadcast_to(solution.no_load[:, None], solution.deflection.shape)
    names = "status", "iterations", "residuals", "beyond"
    return {name: getattr(solution, name) for name in names} | {"no_load": unloaded}


class DerivedErrors(NamedTuple):
    """Errors of curves by derivatives at L loads."""

    band: FloatArray
    """Error of the transmission error at every position, m; 0 at solved positions. Shape (T P, L)."""
    curves: FloatArray
    arms: FloatArray
    """`curves`, `arms`: Errors of the curve quantities of transmission error and load arm, m. Shape (23, L)
    each.
    """
    share: float
    pressure: float
    """`share`, `pressure`: Error of the load share of a pair, and error of the largest pressure over the
    largest pressure of the table. 99 % of the drawn points have smaller errors.
    """


@dataclass(frozen=True)
class DerivedPitches:
    """The base pitches about which derivatives give all others of an operating point."""

    contact: CycleContact
    """Contact of the table."""
    pitches: IntArray
    """Solved base pitches. Shape (K,)."""
    state: IntArray
    """Index of the state whose tangent is least: 0 for the nominal gears, 1 + k for pitch k of `pitches`.
    Shape (T, P, L).
    """
    at_state: FloatArray
    """Transmission error and load arm of the states, m. Shape (1 + K, P, L, 2)."""
    curves: FloatArray
    """Transmission error and load arm of all base pitches, m. Shape (T, P, L, 2)."""

    @classmethod
    def of(cls, envelope: Envelope, ste: FloatArray) -> DerivedPitches:
        """Return the pitches of an envelope whose transmission error (T, P, L) is known."""
        states = envelope.minimum.state.copy()
        states[envelope.pitches] = 1 + np.arange(envelope.pitches.size)[:, None, None]
        exact = [envelope.arrays[name] for name in _CURVES]
        curves = np.stack([ste, envelope.sum(_ARM)], axis=-1)
        return cls(envelope.contact, envelope.pitches, states, np.stack(exact, axis=-1), curves)

    def on(self, point: OperatingPoint, position: FloatArray, load: FloatArray) -> FloatArray:
        """Return transmission error and load arm (T P, L, 2) in m at positions (P,) and loads (L,).

        At those of the table other bodies, slices and patches change every base pitch by what they change
        the state that counts there. Elsewhere derivatives begin anew.
        """
        contact = CycleContact(point, position, load, _arm_row)
        rows, loads = (np.flatnonzero(np.isin(*axis)) for axis in self._known(position, load))
        try:
            if (rows.size, loads.size) == (position.size, load.size):
                return self._changed(contact, rows, loads)
            envelope = Envelope.about_all(contact, self.pitches)
        except SolveError:
            return curves_of_point(point, position, load, np.arange(contact.pitches))
        return _flat(np.stack([envelope.ste, envelope.sum(_ARM)], axis=-1))

    def _known(self, *values: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
        return list(zip((self.contact.position, self.contact.load), values, strict=True))

    def _changed(self, contact: CycleContact, rows: IntArray, loads: IntArray) -> FloatArray:
        _, nominal = contact.nominal()
        states = [nominal, *(contact.solved(part) for part in in_parts(self.pitches))]
        solved = [np.stack([state.solution.deflection, _arms(state)], axis=-1) for state in states]
        change = contact.by_pitch(np.concatenate(solved)) - self.at_state[:, rows][:, :, loads]
        p, load = np.indices((rows.size, loads.size))
        states_of_points = self.state[:, rows][:, :, loads]
        return _flat(self.curves[:, rows][:, :, loads] + change[states_of_points, p, load])


def _arms(state: SolvedState) -> FloatArray:
    return load_sums(state.problem, state.solution, state.rows)[..., _ARM]


@dataclass(frozen=True)
class DerivedTable:
    """One operating point over a whole period, by derivatives."""

    contacts: tuple[SolvedContact, ...]
    """Contact for each set of loads. Residuals are NaN in pitches that were not solved."""
    derived: DerivedPitches
    errors: DerivedErrors


def derived_table(
    point: OperatingPoint,
    position: FloatArray,
    sets: Sequence[FloatArray],
    options: AnalysisOptions,
    *,
    edges: bool,
) -> DerivedTable | str:
    """Solve as many base pitches as it takes to give the others; parameters of `solved_in_parts`.

    Or say why all are to be solved: these are too many, a point of them has no solution, or the transmission
    error by derivatives would not rise with load.
    """
    loads, support = sets
    part = 1.0 if options.tolerance is None else PART_OF_TOLERANCE
    contact = CycleContact(point, position, loads, _table_rows)
    first = np.zeros(1, dtype=np.int64)
    try:
        envelope = chosen(contact, options.allowed, part, partial(_keep, point, edges))
        if envelope is None:
            return "derivatives about a quarter of the base pitches do not keep the tolerance"
        envelope = _with_pressed(envelope.about(np.setdiff1d(first, envelope.pitches)))
        light = CycleContact(point, position, support)
        support_envelope = Envelope.about_all(light, envelope.pitches, partial(_keep_support, point))
    except SolveError as error:
        return str(error)
    levels = rising_deflection(envelope, support_envelope)
    if levels is None:
        return "by derivatives the transmission error would not rise with load"
    initial = solved_in_parts(point, position, sets, first, edges=False)
    unloaded, ste, of_support = levels
    arrays = _arrays(envelope, ste), _support_arrays(support_envelope, of_support)
    contacts = [
        _contact(start, part_envelope, values, unloaded)
        for start, part_envelope, values in zip(initial, (envelope, support_envelope), arrays, strict=True)
    ]
    return DerivedTable(tuple(contacts), DerivedPitches.of(envelope, ste), _errors(envelope))


@dataclass(frozen=True)
class DerivedCycle:
    """Outcome of the derivatives at all operating points of a table."""

    points: OperatingPoints
    tables: tuple[DerivedTable, ...]
    """Tables of all operating points; empty where all base pitches are to be solved."""
    reason: str = ""
    """Reason why all base pitches are to be solved; empty where derivatives suffice."""

    @property
    def places(self) -> OperatingPoints:
        """Operating points of the table; each has the derivatives of its pitches."""
        pairs = zip(self.points.places, self.tables, strict=True)
        return replace(
            self.points, places=tuple(replace(point, derived=table.derived) for point, table in pairs)
        )

    @property
    def contacts(self) -> list[list[SolvedContact]]:
        """Contacts for each set of loads: for each set a list over the operating points."""
        return [list(contacts) for contacts in zip(*(table.contacts for table in self.tables), strict=True)]

    def to_json(self) -> Json:
        """Return how many base pitches were solved at every operating point, or why all were."""
        pitches = {"pitches": self.points.period}
        if self.reason:
            return pitches | {"reason": self.reason}
        errors = [table.errors for table in self.tables]
        return pitches | {
            "solved": [table.derived.pitches.size for table in self.tables],
            "share_error": max(error.share for error in errors),
            "pressure_error_relative": max(error.pressure for error in errors),
        }


def derived_cycle(
    points: OperatingPoints,
    position: FloatArray,
    sets: Sequence[FloatArray],
    options: AnalysisOptions,
    *,
    edges: bool,
) -> DerivedCycle:
    """Solve as many base pitches of all places as it takes to give the others; see `derived_table`."""
    tables = []
    for point in points.places:
        table = derived_table(point, position, sets, options, edges=edges)
        if isinstance(table, str):
            return DerivedCycle(points, (), table)
        tables.append(table)
    return DerivedCycle(points, tuple(tables))


def _errors(envelope: Envelope) -> DerivedErrors:
    band = np.where(envelope.solved[:, None, None], 0.0, envelope.drawn_errors.error)
    band = np.broadcast_to(band, envelope.minimum.ste.shape)
    return DerivedErrors(
        _flat(band), envelope.quantity_errors, envelope.sum_errors(_ARM), *_drawn_errors(envelope)
    )


def _arrays(envelope: Envelope, ste: FloatArray) -> dict[str, NDArray[Any]]:
    """Return the arrays of a table (T, P, L, ...) by name, in pitches that were solved as they are."""
    share, flank, edge = _shares_and_pressures(envelope, envelope.minimum)
    # those that may be largest were solved: none is told to be larger
    flank = np.minimum(flank, envelope.arrays["max_pressure"][1:].max(axis=(0, 1))[:, None])
    derived = {
        "static_transmission_error": ste,
        "tangent_compliance": envelope.nearest("tangent_compliance"),
        "load_share": share,
        "face_centroid": envelope.sum(_CENTROID),
        "load_arm": envelope.sum(_ARM),
        "max_pressure": flank.max(axis=3),
        "pair_pressure": flank,
        "edge_pressure": edge.max(axis=3),
        "pairs_in_contact": (share > 0.0).sum(axis=3),
    }
    return derived | _without_solution(envelope)


def _shares_and_pressures(envelope: Envelope, minimum: LeastTangents) -> tuple[FloatArray, ...]:
    """Return shares and the largest pressures on flanks and at edges, Pa, of the pairs (t, P, L, J).

    A pair that grows beyond `MAX_GROWN` of its pressure spreads along the face, as one that begins to carry.
    """
    share = np.maximum(minimum.sums[..., _SHARES:], 0.0)
    share /= share.sum(axis=3, keepdims=True)
    p, load = np.indices(minimum.state.shape[1:])
    names = "load_share", "pair_pressure", _EDGE_OF_PAIR
    before, *of_pair = (envelope.arrays[name][minimum.state, p, load] for name in names)
    growth = np.sqrt(np.divide(share, before, out=np.zeros_like(share), where=before > 0.0))
    flank, edge = (pressure * np.minimum(growth, MAX_GROWN) for pressure in of_pair)
    return share, flank, edge


def _drawn_errors(envelope: Envelope) -> tuple[float, float]:
    """Return the error of shares that 99 % of the drawn points keep, and of pressures over the largest."""
    share, flank, _ = _shares_and_pressures(envelope, envelope.without)
    drawn = slice(1, 1 + envelope.drawn.size)
    exact, pressure = (envelope.arrays[name][drawn] for name in ("load_share", "max_pressure"))
    errors = np.abs(share - exact).max(axis=3), np.abs(flank.max(axis=3) - pressure) / pressure.max()
    of_share, of_pressure = (float(np.quantile(error, _MAX_POINTS)) for error in errors)
    return of_share, of_pressure


def _with_pressed(envelope: Envelope) -> Envelope:
    """Solve also the pitches in which the pressure is largest by derivatives."""
    _, flank, edge = _shares_and_pressures(envelope, envelope.minimum)
    largest = np.maximum(flank, edge).max(axis=(1, 2, 3))
    pressed = np.argsort(-np.where(envelope.solved, 0.0, largest), kind="stable")[:BATCH]
    return envelope.about(np.sort(pressed))


def _support_arrays(envelope: Envelope, ste: FloatArray) -> dict[str, NDArray[Any]]:
    nearest = {name: envelope.nearest(name) for name in OF_SUPPORT}
    return nearest | {"static_transmission_error": ste} | _without_solution(envelope)


def _without_solution(envelope: Envelope) -> dict[str, NDArray[Any]]:
    """Return the receipt's fields of the contact in pitches that were not solved."""
    shape = envelope.minimum.ste.shape
    return {
        "status": np.full(shape, int(Status.CONVERGED)),
        "iterations": envelope.nearest("iterations"),
        "residuals": np.full((*shape, 4), np.nan),
        "beyond": envelope.nearest("beyond"),
    }


def _contact(
    first: SolvedContact, envelope: Envelope, arrays: Mapping[str, NDArray[Any]], unloaded: FloatArray
) -> SolvedContact:
    """Return the contact as a table stores it; problem and forces are those of the first pitch."""
    solved = {
        name: _flat(envelope.exact_in(values, envelope.arrays[name][1:])) for name, values in arrays.items()
    }
    solution = ContactSolution(
        load=first.solution.load,
        deflection=solved["static_transmission_error"],
        tangent=solved["tangent_compliance"],
        force=first.solution.force,
        status=solved["status"],
        iterations=solved["iterations"],
        residuals=solved["residuals"],
        beyond=solved["beyond"],
        no_load=unloaded.ravel(),
    )
    depth = (
        envelope.arrays["edge_depth"].max(axis=(0, 1))
        if "edge_depth" in envelope.arrays
        else first.edge_depth
    )
    stored = {name: solved[name] for name in first.stored}
    return SolvedContact(first.problem, solution, stored, np.asarray(depth))


def _flat(values: NDArray[Any]) -> NDArray[Any]:
    """Return arrays (T, P, ...) row by row."""
    return values.reshape(-1, *values.shape[2:])
