"""Judge designs of one pair on one compliance: only the gaps are new, and the contact is solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.pair_contact import PairContact
from fe_contact.contact import (
    ContactModel,
    ContactProblem,
    ContactSolution,
    contact_pressure,
    in_pitches,
    solve_contact,
)
from fe_contact.contact.touch import Touch, modified_touch
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.objective import Limits
from fe_contact.microgeometry.scatter import ScatterNodes
from fe_contact.microgeometry.variables import LENGTHS, SLOPES, modified
from fe_contact.types import FloatArray, Status


@dataclass(frozen=True)
class Evaluation:
    """One design at S nodes of the scatter and L loads.

    Attributes
    ----------
    ste : ndarray, shape (S, P, L)
        Transmission error, m; P rows over the period. NaN where the contact was not solved.
    pressure : ndarray, shape (S, L)
        Largest Hertzian pressure over positions, Pa.
    face_load_factor : ndarray, shape (S, L)
        K_Hbeta of the face load averaged over positions.
    edge_load_share : ndarray, shape (S, L)
        Largest part of the load on tip edges over positions.
    """

    ste: FloatArray
    pressure: FloatArray
    face_load_factor: FloatArray
    edge_load_share: FloatArray

    @property
    def peak_to_peak(self) -> FloatArray:
        """Over the positions (S, L), m; NaN where one of them was not solved."""
        return np.asarray(np.ptp(self.ste, axis=1))

    def violation(self, limits: Limits) -> float:
        """How far the limits are exceeded, in parts of them (of the load for the edges); 0: they are kept."""
        found = 0.0
        for value, limit in (
            (self.pressure, limits.max_pressure),
            (self.face_load_factor, limits.face_load_factor),
        ):
            found += 0.0 if limit is None else max(0.0, float(value.max()) / limit - 1.0)
        if limits.edge_load_share is not None:
            found += max(0.0, float(self.edge_load_share.max()) - limits.edge_load_share)
        return found


@dataclass(frozen=True)
class Evaluator:
    """A pair with its compliance, positions, loads and scatter; only the modification varies.

    Attributes
    ----------
    contact : PairContact
        Its compliance does not depend on the modification.
    choices : mapping
        Every effect "on" or "off".
    position : ndarray, shape (P,)
        In one base pitch.
    load : ndarray, shape (L,)
        Normal forces, N.
    misalignment : float
        About which it scatters, m.
    nodes : ScatterNodes
    """

    contact: PairContact
    choices: Mapping[str, str]
    position: FloatArray
    load: FloatArray
    misalignment: float
    nodes: ScatterNodes

    def evaluate(self, values: Mapping[str, float]) -> Evaluation:
        """Solve the contact of one design, ``gear.quantity`` to m, at every node and load."""
        touches: dict[tuple[float, ...], Touch] = {}
        found = [self._at_node(values, node, touches) for node in range(self.nodes.weight.size)]
        return Evaluation(*(np.stack(each) for each in zip(*found, strict=True)))

    def at(self, position: FloatArray) -> Evaluator:
        """Return the same at other positions (P,), of which those in the first base pitch count."""
        return replace(self, position=position[position < 1.0])

    def expected(self, found: Evaluation) -> FloatArray:
        """Return the expected peak-to-peak (L,), m."""
        return np.asarray(self.nodes.weight @ found.peak_to_peak)

    def scattered(self, values: Mapping[str, float], node: int) -> ParallelAxes:
        """Return the pair with a design as it comes out at a node."""
        return modified(
            self.contact.pair, _deviated(self.contact.pair, values, self.nodes.modification(node))
        )

    def _at_node(
        self, values: Mapping[str, float], node: int, touches: dict[tuple[float, ...], Touch]
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Curves and figures of one node; nodes of one modification share its touching points."""
        pair, skew = self.scattered(values, node), self.misalignment + self.nodes.misalignment[node]
        scene = ContactScene(pair, pair.torque(self.load), np.array([skew]))
        model, _ = compose(scene, self.choices, EFFECTS)
        bodies = self.contact.problem(replace(model, gaps=(), tooth_gaps=()), self.position)
        moving = tuple(term for term in model.gaps if term.along_profile)
        steady = tuple(term for term in model.gaps if not term.along_profile)
        key = tuple(self.nodes.modification(node).values())
        face = bodies.candidates.face_position
        if key not in touches:
            touches[key] = modified_touch(pair, bodies.candidates.touch, face, moving)
        touch = modified_touch(pair, touches[key], face, steady) if steady else touches[key]
        problem = _in_all_pitches(bodies.touching(bodies.candidates.touching(touch)), model)
        return _figures(problem, solve_contact(problem, self.load))


def _deviated(
    pair: ParallelAxes, values: Mapping[str, float], deviation: Mapping[str, float]
) -> dict[str, float]:
    """Add deviations to a design; material removed stays at least zero, and a length above it."""
    out = dict(values)
    for name, amount in deviation.items():
        gear, _, quantity = name.partition(".")
        designed = values.get(name, getattr(getattr(pair, gear).modification, quantity))
        least = -np.inf if quantity in SLOPES else 0.1 * designed if quantity in LENGTHS else 0.0
        out[name] = max(float(designed) + amount, least)
    return out


def _in_all_pitches(problem: ContactProblem, model: ContactModel) -> ContactProblem:
    """Return the problem of the whole period where teeth differ."""
    if model.period == 1:
        return problem
    rows = np.repeat(np.arange(model.period), problem.candidates.position.size)
    return in_pitches(problem, model, rows)


def _figures(
    problem: ContactProblem, solution: ContactSolution
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return STE (P, L), and pressure, face load factor and load share of the edges (L,)."""
    candidates = problem.candidates
    ste = np.where(solution.status == Status.CONVERGED, solution.deflection, np.nan)
    pressure = contact_pressure(problem, solution.force)
    pairs = np.unique(candidates.pair).size
    face_load = solution.force.reshape(*ste.shape, pairs, -1).sum(axis=2).mean(axis=0)
    loaded = solution.force * candidates.torque_share[:, None, :]
    at_edge = (candidates.touch.low >= 0.0) | (candidates.touch.high <= 0.0)
    share = (loaded * at_edge[:, None, :]).sum(axis=2) / loaded.sum(axis=2)
    factor = face_load.max(axis=1) / face_load.mean(axis=1)
    return ste, pressure.max(axis=(0, 2)), factor, share.max(axis=0)
