"""Assessment of designs of one pair on one compliance: contact is solved under the gaps of each design.

A design is a set of values of the design variables, figures of the flanks. Arrays run over S nodes of the
scatter, P positions, L loads and m contact candidates.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import groupby

import numpy as np

from fe_contact.analysis.pairs.pair_contact import PairContact
from fe_contact.contact import ContactProblem, ContactSolution, contact_pressure, in_pitches, solve_contact
from fe_contact.contact.plain_touch import Touch
from fe_contact.contact.touch import modified_touch
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.objective import Limits
from fe_contact.microgeometry.root_influence import RootInfluence
from fe_contact.microgeometry.scatter import MISALIGNMENT, ScatterNodes
from fe_contact.microgeometry.variables import LENGTHS, SLOPES, figure, modified
from fe_contact.types import BoolArray, FloatArray, IntArray, Status
from model_studies import in_unit


@dataclass(frozen=True)
class Evaluation:
    """One design at S nodes of the scatter and L loads."""

    ste: FloatArray = field(metadata=in_unit("m", "node", "position", "torque"))
    """Transmission error, m; P rows over the period. NaN where the contact was not solved. Shape (S, P, L).
    """
    pressure: FloatArray = field(metadata=in_unit("pa", "node", "torque"))
    """Largest Hertzian pressure over positions, Pa. Shape (S, L)."""
    face_load_factor: FloatArray
    """K_Hbeta of the face load averaged over positions. Shape (S, L)."""
    edge_load_share: FloatArray
    """Largest part of the load on tip edges over positions. Shape (S, L)."""
    root_stress: FloatArray = field(
        default_factory=lambda: np.full((1, 1), np.nan), metadata=in_unit("pa", "node", "torque")
    )
    """Largest principal stress in the tension roots of both gears, Pa; NaN: not followed. Shape (S, L)."""
    root_stress_error: FloatArray = field(
        default_factory=lambda: np.full((1, 1), np.nan), metadata=in_unit("pa", "node", "torque")
    )
    pressure_error: FloatArray = field(
        default_factory=lambda: np.full((1, 1), np.nan), metadata=in_unit("pa", "node", "torque")
    )
    face_load_factor_error: FloatArray = field(default_factory=lambda: np.full((1, 1), np.nan))
    """`root_stress_error`, `pressure_error`, `face_load_factor_error`: Errors of these figures by the
    discretization; NaN where not estimated. Shape (S, L) each.
    """

    def at_loads(self, loads: BoolArray | IntArray) -> Evaluation:
        """Return the evaluation at some of the loads."""
        return Evaluation(**{name: values[..., loads] for name, values in vars(self).items()})

    @property
    def peak_to_peak(self) -> FloatArray:
        """Peak-to-peak over the positions (S, L), m; NaN where one of them was not solved."""
        return np.asarray(np.ptp(self.ste, axis=1))

    def violation(self, limits: Limits) -> float:
        """Return the sum of excesses over the limits, each over its limit (edges: over the load); 0: none."""
        excess = 0.0
        for value, limit in (
            (self.pressure, limits.max_pressure),
            (self.face_load_factor, limits.face_load_factor),
            (self.peak_to_peak, limits.peak_to_peak),
            (self.root_stress, limits.root_stress),
        ):
            excess += 0.0 if limit is None else max(0.0, float(value.max()) / limit - 1.0)
        if limits.edge_load_share is not None:
            excess += max(0.0, float(self.edge_load_share.max()) - limits.edge_load_share)
        return excess


@dataclass(frozen=True)
class Evaluator:
    """A pair with its compliance, positions, loads and scatter; only the modification varies.

    Loads of one misalignment are solved together, each from the one below it.
    """

    contact: PairContact
    """Contact of the pair. Its compliance does not depend on the modification."""
    choices: Mapping[str, str]
    """Choice of every effect, "on" or "off"."""
    position: FloatArray
    """Positions in one base pitch. Shape (P,)."""
    load: FloatArray
    """Normal forces, N. Shape (L,)."""
    misalignment: FloatArray
    """Mean misalignment at each load, m. Shape (L,)."""
    nodes: ScatterNodes
    roots: RootInfluence | None = None
    """Unit-load stress of the roots; None where root stress is not followed."""

    @property
    def misalignments(self) -> FloatArray:
        """Misalignment at every node and load (S, L), m."""
        return np.asarray(self.misalignment + self.nodes.misalignment[:, None])

    @cached_property
    def groups(self) -> tuple[IntArray, ...]:
        """The loads of each misalignment, by rising force."""
        order = np.argsort(self.load, kind="stable")
        return tuple(order[self.misalignment[order] == skew] for skew in np.unique(self.misalignment))

    def evaluate(self, values: Mapping[str, float]) -> Evaluation:
        """Solve the contact of one design, ``gear.quantity`` to m, at every node and load."""
        solved = self.solved(values, range(self.nodes.weight.size))
        return self.evaluation(
            LoadFigures.of(problem, solution, self.roots) for _, problem, solution in solved
        )

    @cached_property
    def runs(self) -> tuple[tuple[int, ...], ...]:
        """All nodes in their order, grouped where successive ones have the same flanks."""

        def flanks(node: int) -> tuple[float, ...]:
            return tuple(self.nodes.modification(node).values())

        return tuple(tuple(run) for _, run in groupby(range(self.nodes.weight.size), flanks))

    def solved(
        self, values: Mapping[str, float], nodes: Iterable[int]
    ) -> Iterator[tuple[ParallelAxes, ContactProblem, ContactSolution]]:
        """Yield the pair with its deviations at some nodes, and its contact solved at each group of loads."""
        touches: dict[tuple[float, ...], Touch] = {}
        for node in nodes:
            for group in self.groups:
                yield self._at_node(values, node, group, touches)

    def evaluation(self, solved: Iterable[LoadFigures]) -> Evaluation:
        """Join the figures of all nodes and groups of loads, in the order of `solved`."""
        figures = []
        for f in solved:  # maxima at once: the pressures of all nodes would fill the memory
            edge_load_share = f.edge_load_share.max(axis=0)
            figures.append(
                (f.ste, f.pressure.max(axis=(0, 2)), f.face_load.max(axis=1), edge_load_share, f.root_stress)
            )
        parts = [self.gathered(figure) for figure in zip(*figures, strict=True)]
        ste, pressure, face_load_factor, edge_load_share, root_stress = parts
        unknown = np.full(root_stress.shape, np.nan)
        return Evaluation(
            ste, pressure, face_load_factor, edge_load_share, root_stress, unknown, unknown, unknown
        )

    def gathered(self, solved: Sequence[FloatArray]) -> FloatArray:
        """Join arrays (..., l) of all nodes and groups of loads, in the order of `solved`, to (S, ..., L)."""
        count, order = len(self.groups), np.argsort(np.concatenate(self.groups))
        nodes = [solved[k : k + count] for k in range(0, len(solved), count)]
        return np.stack([np.concatenate(parts, axis=-1)[..., order] for parts in nodes])

    def at(self, position: FloatArray) -> Evaluator:
        """Return the evaluator at other positions (P,), of which those in the first base pitch count."""
        return replace(self, position=position[position < 1.0])

    def expected(self, evaluation: Evaluation) -> FloatArray:
        """Return the expected peak-to-peak (L,), m."""
        return np.asarray(self.nodes.weight @ evaluation.peak_to_peak)

    def scattered(self, values: Mapping[str, float], node: int) -> ParallelAxes:
        """Return the pair with a design and the deviations of a node."""
        return deviating(modified(self.contact.pair, values), self.nodes.modification(node))

    def _at_node(
        self, values: Mapping[str, float], node: int, group: IntArray, touches: dict[tuple[float, ...], Touch]
    ) -> tuple[ParallelAxes, ContactProblem, ContactSolution]:
        """Solve a group of loads at one node; nodes of one modification share its touching points."""
        pair, load = self.scattered(values, node), self.load[group]
        scene = ContactScene(pair, pair.torque(load), EFFECTS, self.misalignments[node, group[:1]])
        model, _ = compose(scene, self.choices)
        bodies = self.contact.problem(replace(model, gaps=(), tooth_gaps=()), self.position)
        moving = tuple(term for term in model.gaps if term.along_profile)
        steady = tuple(term for term in model.gaps if not term.along_profile)
        key = tuple(self.nodes.modification(node).values())
        face = bodies.candidates.face_position
        if key not in touches:
            touch = modified_touch(pair, bodies.candidates.touch, face, moving)
            if bodies.tilt.size:  # load patches follow the touching points
                touch = bodies.candidates.following(touch).touch
            touches[key] = touch
        touch = modified_touch(pair, touches[key], face, steady) if steady else touches[key]
        problem = bodies.touching(bodies.candidates.touching(touch))
        if model.period > 1:
            rows = np.repeat(np.arange(model.period), self.position.size)
            problem = in_pitches(pair, problem, model, rows)
        return pair, problem, solve_contact(problem, load)


def deviating(pair: ParallelAxes, deviation: Mapping[str, float]) -> ParallelAxes:
    """Return a pair whose figures deviate by `deviation`, m, as far as material and lengths are left."""
    figures = {}
    for name, amount in deviation.items():
        designed = figure(pair, name)
        figures[name] = designed + max(amount, least_deviation(designed, name))
    return modified(pair, figures)


def least_deviation(designed: float, name: str) -> float:
    """Return the least deviation of a figure, `designed` in m, that leaves material and lengths."""
    quantity = name.rpartition(".")[2]
    if quantity in (*SLOPES, MISALIGNMENT):
        return -math.inf
    return -(0.9 if quantity in LENGTHS else 1.0) * designed  # a tenth of a length is left


@dataclass(frozen=True)
class LoadFigures:
    """The figures of L loads of one misalignment at one node of the scatter."""

    ste: FloatArray
    """Transmission error, m; NaN where the contact was not solved. Shape (P, L)."""
    pressure: FloatArray
    """Pressure of every candidate, Pa. Shape (P, L, m)."""
    face_load: FloatArray
    """Mean over the positions at the points of the face, over its mean over the face. Shape (L, Z)."""
    edge_load_share: FloatArray
    """Part of the load on tip edges. Shape (P, L)."""
    root_stress: FloatArray
    """Largest of both gears over the positions, Pa; NaN: not followed. Shape (L,)."""

    @classmethod
    def of(
        cls, problem: ContactProblem, solution: ContactSolution, roots: RootInfluence | None
    ) -> LoadFigures:
        """Return the figures of a solution."""
        ste = np.where(solution.status == Status.CONVERGED, solution.deflection, np.nan)
        face_load = over_face(problem, solution.force)
        at_edges = on_edges(problem, solution.force) / carried(problem, solution.force).sum(axis=2)
        pressure, _ = contact_pressure(problem, solution.force)
        stress = np.full(ste.shape[1], np.nan)
        if roots is not None:
            stress = roots.stress(problem, solution.force).max(axis=(0, 1))
        return cls(ste, pressure, face_load / face_load.mean(axis=1, keepdims=True), at_edges, stress)


def over_face(problem: ContactProblem, force: FloatArray) -> FloatArray:
    """Return forces (P, L, m) at the points of the face, their mean over the positions (L, Z), N."""
    pairs = np.unique(problem.candidates.pair).size
    return np.asarray(force.reshape(*force.shape[:2], pairs, -1).sum(axis=2).mean(axis=0))


def carried(problem: ContactProblem, force: FloatArray) -> FloatArray:
    """Return the share of each of the forces (P, L, m) in the load, N."""
    return np.asarray(force * problem.candidates.torque_share[:, None, :])


def edges(problem: ContactProblem) -> BoolArray:
    """Return which candidates (P, m) touch at a tip edge, if they do."""
    touch = problem.candidates.touch
    return np.asarray((touch.low >= 0.0) | (touch.high <= 0.0))


def on_edges(problem: ContactProblem, force: FloatArray) -> FloatArray:
    """Return the share of forces (P, L, m) on tip edges in the load (P, L), N."""
    return np.asarray((carried(problem, force) * edges(problem)[:, None, :]).sum(axis=2))
