"""Shaft orders and sidebands by the teeth of one gear: the pairs above a limit, and the causes.

Pairs are solved over one revolution of the gear, whose tooth deviations are drawn at random; the teeth of its
mate are alike. Further pairs, and the causes, follow to first order in the deviations of single teeth, about
the flanks as designed: the amplitude of an order is the Fourier sum of a deviation over the teeth, times the
contribution of one tooth as it passes through the mesh. Shifts of the touching point by slopes and forms are
neglected. Wobble is the tilt of a gear against its axis. Sizes: P positions, L loads, m candidates, N drawn
gears, d deviations.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from fe_contact.contact import Candidates
from fe_contact.contact.flank_slope import rolls_at
from fe_contact.contact.load_weights import load_weights
from fe_contact.effects import EFFECTS
from fe_contact.errors import SolveError
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.geometry.tooth_flank import tooth_shapes
from fe_contact.microgeometry.drawn_teeth import (
    FLANK,
    OF_AXIS,
    PITCH,
    RUN_OUT,
    WOBBLE,
    DrawnTeeth,
    ToothTolerances,
)
from fe_contact.microgeometry.evaluator import Evaluator
from fe_contact.microgeometry.order_limit import (
    BASE_PAIRS,
    TIGHTENED,
    Causes,
    ModeledPairs,
    OrderLimit,
    PairsAbove,
)
from fe_contact.microgeometry.scatter import ScatterNodes
from fe_contact.options import Run
from fe_contact.types import ComplexArray, FloatArray

IN_A_TASK = 4
"""Number of pairs in a task of a worker."""
_MIN = 1e-15
"""Amplitude in m below which there is no level."""


@dataclass(frozen=True)
class ToothPassing:
    """First-order contribution of the teeth of a gear to one order at L loads."""

    line: int
    """The order, in periods per revolution of the gear."""
    turns: int
    """The order less the mesh order, in periods per revolution of the gear."""
    by_tooth: Mapping[str, ComplexArray]
    """Complex amplitude per Fourier sum of a deviation over the teeth, m/m, by the name of the deviation.
    Mapping of str to ndarray, shape (L,).
    """
    by_wobble: ComplexArray
    """Complex amplitude per amount of wobble at the angle 0, m/m. Wobble acts where the load is off mid-face
    as a tooth passes. Shape (L,).
    """

    @classmethod
    def of(cls, evaluator: Evaluator, limit: OrderLimit, names: Sequence[str]) -> ToothPassing:
        """Return the contribution about the flanks as designed."""
        pair, problem, solution = next(iter(evaluator.solved({}, range(1))))
        c, teeth = problem.candidates, limit.teeth(pair)
        weight, _ = load_weights(problem, solution, np.empty((0, *c.gap.shape)))
        line = limit.line(pair)
        arm, turn = weight * c.motion_arm[:, None], -2j * math.pi / teeth
        # (P, L, m): a tooth is in the candidates of its pair at the place position + pair
        passing = arm * np.exp(turn * line * (c.position[:, None] + c.pair))[:, None]
        wobbling = arm * np.exp(turn * (line - limit.turns) * c.position)[:, None, None]
        shapes = _shapes(pair, c, limit.gear)
        rows, once = passing.shape[0], abs(limit.turns) == 1

        def added(passing: ComplexArray, name: str) -> ComplexArray:
            return np.asarray(np.einsum("plm,pm->l", passing, shapes[name]) / rows)

        by_tooth = {name: -2.0 / teeth * added(passing, name) for name in names}
        return cls(line, limit.turns, by_tooth, -once * added(wobbling, WOBBLE))

    def lines(self, drawn: DrawnTeeth) -> ComplexArray:
        """Return the contributions of each deviation to the order of N gears, (d, N, L), m.

        Deviations of the axis, run-out and wobble, come first.
        """
        loads = len(self.by_wobble)
        # run-out acts once per revolution only
        once = {RUN_OUT: np.full(loads, -1.0 * (self.line == 1)), WOBBLE: self.by_wobble}
        parts = []
        for name, amount in drawn.by_axis.items():
            sense = amount if self.turns < 0 else amount.conj()
            parts.append(np.outer(sense, once[name]))
        for name, values in drawn.made.items():
            teeth = values.shape[1]
            wave = np.exp(-2j * math.pi * self.line / teeth * np.arange(teeth))
            parts.append(np.outer(values @ wave, self.by_tooth[name]))
        return np.stack(parts)

    def amplitude(self, drawn: DrawnTeeth) -> FloatArray:
        """Return the amplitude of the order of N gears, (N, L), m."""
        return np.asarray(np.abs(self.lines(drawn).sum(axis=0)))


def _shapes(pair: ParallelAxes, c: Candidates, gear: str) -> dict[str, FloatArray]:
    """Return the gap by a unit of each deviation of a tooth at the candidates, (P, m)."""
    toothing: Toothing = getattr(pair, gear)
    can_touch = np.isfinite(c.gap)  # elsewhere any point of the flanks, whose shape is set to 0 below
    rolls = rolls_at(
        pair, np.where(can_touch, c.touch.s_1, 1.0), np.where(can_touch, c.touch.s_2, toothing.sign)
    )
    wheel = gear == "wheel"
    face = c.face_position - (pair.axial_offset if wheel else 0.0)
    shapes = {FLANK + name: shape for name, shape in tooth_shapes(toothing, rolls[int(wheel)], face).items()}
    shapes[WOBBLE] = face / toothing.face_width + np.zeros(can_touch.shape)
    shapes[PITCH] = np.full(can_touch.shape, math.cos(toothing.transverse_pressure_angle))
    return {name: np.where(can_touch, shape, 0.0) for name, shape in shapes.items()}


@dataclass(frozen=True)
class MadePairs:
    """The n pairs to solve: their flanks, and the teeth of one gear."""

    evaluator: Evaluator
    """Evaluator of the pair as designed."""
    names: tuple[str, ...]
    """Names of the deviations of all teeth alike."""
    deviation: FloatArray
    """Deviations of all teeth alike, m. Shape (n, d)."""
    gear: str
    """The gear whose teeth differ."""
    drawn: DrawnTeeth
    """Deviations of its teeth, for n gears or more."""

    def evaluator_of(self, index: int) -> Evaluator:
        """Return the evaluator of the drawn gear `index`."""
        contact = self.evaluator.contact
        gear: Toothing = getattr(contact.pair, self.gear)
        made: dict[str, Any] = {self.gear: replace(gear, **self.drawn.fields(index))}
        nodes = ScatterNodes(self.names, self.deviation[index : index + 1], np.ones(1))
        # effects that make teeth differ
        on = {effect.name: "on" for effect in EFFECTS if "period" in effect.adds}
        pair = replace(contact.pair, **made)
        choices = {**self.evaluator.choices, **on}
        return replace(self.evaluator, contact=replace(contact, pair=pair), nodes=nodes, choices=choices)


def lines_of_pairs(made: MadePairs, task: tuple[int, Sequence[int]]) -> ComplexArray:
    """Return the complex amplitude of one order in the pairs of a task, (n, L), m.

    A task is the order, in periods per revolution, and the indices of n pairs.
    """
    line, pairs = task
    lines = []
    for index in pairs:
        ((_, problem, solution),) = made.evaluator_of(index).solved({}, range(1))
        if not solution.converged:
            raise SolveError(f"the contact of pair {index} cannot be solved", solution)
        rows = len(problem.candidates.position)
        turn = np.exp(-2j * math.pi * line * np.arange(rows) / rows)
        lines.append((2.0 / rows) * (turn @ solution.deflection))
    return np.array(lines)


def sidebands_above(
    limit: OrderLimit,
    pairs: MadePairs,
    designed: Evaluator,
    teeth: ToothTolerances,
    seed: int,
    confidence: float,
    run: Run,
) -> PairsAbove:
    """Solve pairs over a revolution of one gear; return the pairs above a limit, and the causes.

    Parameters
    ----------
    designed : Evaluator
        The pair as designed, about which further pairs and the causes are expanded.
    teeth : ToothTolerances
        Tolerances by which the teeth of the pairs were drawn.
    """
    passing = ToothPassing.of(designed, limit, [name for name in teeth.widths if name not in OF_AXIS])
    numbers = range(len(pairs.deviation))
    tasks = [(passing.line, numbers[k : k + IN_A_TASK]) for k in range(0, len(numbers), IN_A_TASK)]
    solved = []
    for count, lines in enumerate(run.workers.run(lines_of_pairs, pairs, tasks)):
        solved.append(lines)
        run.progress("sidebands", (count + 1) / len(tasks))
    modeled = passing.amplitude(pairs.drawn)

    def causes(load: int) -> Causes:
        share = float(np.mean(modeled[:, load] > limit.amplitude))
        indices = _indices(limit, passing, teeth, load, seed)
        return Causes(*indices, share, _tightened(limit, passing, teeth, pairs.drawn, load))

    alike = np.zeros(modeled.shape[1])  # teeth as designed make no sidebands
    made = ModeledPairs(teeth.names, alike, np.abs(np.concatenate(solved)), modeled)
    return made.above(limit, confidence, causes)


def _indices(
    limit: OrderLimit, passing: ToothPassing, teeth: ToothTolerances, load: int, seed: int
) -> tuple[FloatArray, FloatArray]:
    """Return the first-order and total Sobol' indices of the level, (d,) each."""
    from scipy.stats import sobol_indices  # noqa: PLC0415 (start-up time)

    base_gears = teeth.drawn(BASE_PAIRS, seed + 1)
    other_gears = teeth.drawn(BASE_PAIRS, seed + 1, after=teeth.dimensions)

    def level(gears: DrawnTeeth) -> FloatArray:
        amplitude = np.maximum(passing.amplitude(gears)[:, load], _MIN)
        return np.asarray(20.0 * np.log10(amplitude / limit.amplitude))[None]

    mixed = np.stack([level(base_gears.changed(name, other_gears.amount(name))) for name in teeth.widths])
    values: Mapping[Literal["f_A", "f_B", "f_AB"], FloatArray]
    values = {"f_A": level(base_gears), "f_B": level(other_gears), "f_AB": mixed}
    indices = sobol_indices(func=values, n=BASE_PAIRS)
    first, total = (np.ravel(getattr(indices, name)) for name in ("first_order", "total_order"))
    # what adds nothing has no part in it
    acting = np.any(passing.lines(base_gears)[..., load] != 0.0, axis=1)
    return np.where(acting, first, 0.0), np.where(acting, total, 0.0)


def _tightened(
    limit: OrderLimit, passing: ToothPassing, teeth: ToothTolerances, drawn: DrawnTeeth, load: int
) -> FloatArray:
    """Return the share above the limit, to first order, with each tolerance tightened by a class, (d,)."""
    narrow = (drawn.changed(name, TIGHTENED * drawn.amount(name)) for name in teeth.widths)
    return np.array([np.mean(passing.amplitude(gears)[:, load] > limit.amplitude) for gears in narrow])
