"""The transmission error of a contact model without finite elements, in milliseconds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    PatchRule,
    Slices,
    Start,
    contact_candidates,
    in_pitches,
    solve_contact,
    with_compliances,
    with_flanks,
)
from fe_contact.effects.influence.slice_compliance import slice_compliance
from fe_contact.effects.influence.tooth_bending import half_plane
from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus
from fe_contact.types import FloatArray, IntArray

PLANE_POSITIONS, FACE_POSITIONS = 64, 32

FACE_SLICES = 11

MAX_PITCHES = 32
"""Number of base pitches that an estimate solves where teeth differ."""

_PATCH, _EDGE = 0.15, 0.0125
"""Half-width of the load patches and their length at an edge, modules."""

_MAX_STEPS = 512
"""Number of steps that `spread_pitches` tries."""
_EVEN = 3
"""Number of orders of each gear's rotation that `spread_pitches` makes even."""

UNEVEN_PITCHES = 4
"""Number of further base pitches that an estimate solves: those of the teeth that deviate most."""

Both = tuple[FloatArray, FloatArray]
"""Values of the pinion and of the wheel."""


@dataclass(frozen=True)
class EstimatedCurve:
    """Mean and peak-to-peak of the transmission error at each load (L,), m."""

    mean: FloatArray
    peak_to_peak: FloatArray


@dataclass(frozen=True)
class Springs:
    """Slice models of one pair, whose candidates and compliances are assembled once for all models."""

    pair: ParallelAxes
    _known: dict[tuple[object, ...], ContactProblem] = field(default_factory=dict, repr=False)
    _plain: dict[tuple[bool, bool], Candidates] = field(default_factory=dict, repr=False)
    _last: dict[tuple[object, ...], Start] = field(default_factory=dict, repr=False)
    """Last solution for the same gaps, from which the next one starts."""

    def curve(self, model: ContactModel, load: FloatArray) -> EstimatedCurve:
        """Solve the contact of springs at normal forces (L,) in N, increasing.

        Everything but the compliance is that of the contact analysis: candidates, gaps, shafts, local
        approach.
        """
        problem, count = self.problem(model), _positions(model)
        if model.tooth_gaps:
            spread = spread_pitches([term.period for term in model.tooth_gaps])
            pitches = np.union1d(spread, _uneven_pitches(self.pair, model))
            problem = in_pitches(self.pair, problem, model, np.repeat(pitches, count))
        key = repr(model.gaps), problem.candidates.position.size, load.size
        solution = solve_contact(problem, load, self._last.get(key))
        self._last[key] = Start(problem.candidates, solution.force)
        curve = solution.deflection  # (P, L), m
        return EstimatedCurve(np.nanmean(curve, axis=0), np.nanmax(curve, axis=0) - np.nanmin(curve, axis=0))

    def problem(self, model: ContactModel) -> ContactProblem:
        """Return the contact problem of one base pitch with the gaps and compliances of a model."""
        problem = with_compliances(self.pair, self._springs(model), model)
        return with_flanks(self.pair, problem, model)

    def _springs(self, model: ContactModel) -> ContactProblem:
        """Return the springs of a model in one base pitch, flanks as plain involutes."""
        bodies = (model.couple_teeth, model.finite_width, model.parts)
        key = (model.corner_contact, model.across_face, *bodies)
        if key not in self._known:
            plain = self._candidates(model)
            compliance = slice_compliance(self.pair, plain.slices, model)
            modulus = contact_modulus(self.pair.pinion.material, self.pair.wheel.material)
            planes = half_plane(self.pair.pinion), half_plane(self.pair.wheel)
            self._known[key] = ContactProblem(plain, compliance, modulus, *planes)
        return self._known[key]

    def _candidates(self, model: ContactModel) -> Candidates:
        key = model.corner_contact, model.across_face
        if key not in self._plain:
            module, count = self.pair.pinion.normal_module, _positions(model)
            rule = PatchRule(_PATCH * module, _EDGE * module)
            slices = Slices.of_pair(self.pair, FACE_SLICES if model.across_face else 1)
            self._plain[key] = contact_candidates(self.pair, model, np.arange(count) / count, rule, slices)
        return self._plain[key]


def spread_pitches(periods: Sequence[int]) -> IntArray:
    """Return at most `MAX_PITCHES` base pitches, at equal steps, of gears that repeat after `periods`.

    The step spreads the angles of both gears, and their differences, most evenly. An order of a gear, or a
    sum or difference of orders, leaves a mean over the pitches; the largest of these means is least. Orders
    go up to `_EVEN`.
    """
    common_period = math.lcm(*periods)
    if common_period <= MAX_PITCHES:
        return np.arange(common_period)
    rates = np.zeros(1)  # turns per base pitch of the orders and their combinations
    for period in {*periods} - {1}:
        rates = np.add.outer(rates, np.arange(-_EVEN, _EVEN + 1) / period).ravel()
    rates = rates[np.abs(rates) > 1e-12]
    step, index = np.arange(1, min(common_period, _MAX_STEPS)), np.arange(MAX_PITCHES)
    angle = 2.0 * np.pi * step[:, None, None] * rates[:, None] * index
    largest_mean = np.abs(np.exp(1j * angle).mean(axis=-1)).max(axis=1)
    return np.sort(index * step[int(largest_mean.argmin())] % common_period)


def _uneven_pitches(pair: ParallelAxes, model: ContactModel) -> IntArray:
    """Return the base pitches in which pair 0 deviates most from the nominal flanks."""
    extent = model.extent(pair, np.arange(model.period))
    reach = np.maximum(np.asarray(extent.high), -np.asarray(extent.low))
    return np.argsort(-reach, kind="stable")[:UNEVEN_PITCHES]


def _positions(model: ContactModel) -> int:
    return FACE_POSITIONS if model.across_face else PLANE_POSITIONS
