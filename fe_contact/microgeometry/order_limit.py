"""A limit on an order of the transmission error: the pairs above it, the causes, and the cheapest cure.

An order is a frequency in periods per base pitch. Mesh orders are whole numbers. Other orders are named by a
mesh order and a number of turns of one gear.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from fe_contact.errors import InputError, integer, positive
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.microgeometry.tangent_model import TangentModel, highest_order, order_amplitude
from fe_contact.types import BoolArray, FloatArray
from host.optional_modules import special
from model_studies import in_unit

TIGHTENED = 1.0 / math.sqrt(2.0)
"""Tolerance of a class over that of the next coarser one (ISO 1328-1:2013, 5.2.2)."""
BASE_PAIRS = 1024
"""Base sample of the Sobol' indices. The model is evaluated for it d + 2 times, d the number of deviations.
"""


@dataclass(frozen=True)
class OrderLimit:
    """Limit of the amplitude of an order: a mesh order, or a mesh order shifted by turns of a gear."""

    order: int
    """Mesh order; 1: the mesh frequency. 0 with a gear: the order is one of its shaft."""
    amplitude: float
    """Largest amplitude, m."""
    gear: str = ""
    """Name of the gear whose teeth make the order; empty for a mesh order."""
    turns: int = 0
    """Turns of the gear between the order and the mesh order, of either sign, at most half its teeth."""

    def __post_init__(self) -> None:
        integer("limit.order", self.order, 0 if self.gear else 1, 10_000)
        positive("limit.amplitude", self.amplitude)

    @property
    def name(self) -> str:
        """Name of the order, as in spectra: "mesh 1", "mesh 1 - pinion 1", "wheel 1"."""
        if not self.gear:
            return f"mesh {self.order}"
        if not self.order:
            return f"{self.gear} {self.turns}"
        return f"mesh {self.order} {'-' if self.turns < 0 else '+'} {self.gear} {abs(self.turns)}"

    def teeth(self, pair: ParallelAxes) -> int:
        """Return the base pitches in which the order is a whole number: those of a turn of its gear."""
        return int(getattr(pair, self.gear).teeth) if self.gear else 1

    def line(self, pair: ParallelAxes) -> int:
        """Return the order in that many base pitches."""
        return self.order * self.teeth(pair) + self.turns

    def check(self, pair: ParallelAxes, positions: int) -> None:
        """Refuse an order that the positions of a base pitch do not resolve, or teeth that differ already."""
        if self.order > (maximum := highest_order(positions)):
            remedy = f"The {positions} positions of a base pitch resolve the mesh orders 1 to {maximum}."
            raise InputError(
                "limit.order", self.order, f"a mesh order of the spectrum, 1 to {maximum}", remedy
            )
        if not self.gear:
            return
        maximum = self.teeth(pair) // 2
        if self.turns == 0 or abs(self.turns) > maximum or self.line(pair) <= 0:
            bound = f"from 1 to {maximum} turns of the {self.gear}, upwards where the mesh order is 0"
            raise InputError("limit.turns", self.turns, bound, "Half its teeth lead to the next mesh order.")
        for name in ("pinion", "wheel"):
            toothing: Toothing = getattr(pair, name)
            if toothing.deviates or not toothing.pitch_deviation.neutral:
                remedy = "The teeth are drawn: leave run-out, waves, pitches and flanks of teeth out."
                raise InputError(
                    "limit.gear", self.name, f"a mesh order where teeth of the {name} differ", remedy
                )


@dataclass(frozen=True)
class PairsAbove:
    """Pairs above a limit at L torques, and the causes of d deviations at the torque with most such pairs."""

    limit: OrderLimit
    names: tuple[str, ...]
    """Names of the deviations."""
    amplitude: FloatArray = field(metadata=in_unit("m", "sample", "torque"))
    """Amplitude of the order, m. Shape (N, L)."""
    nominal: FloatArray = field(metadata=in_unit("m", "torque"))
    """Amplitude of the pair as designed, m. Shape (L,)."""
    share: FloatArray
    low: FloatArray
    high: FloatArray
    """`share`, `low`, `high`: Share of all pairs above, and its bounds: Wilson's interval, widened by the
    error of the model for solved pairs. Shape (L,) each.
    """
    load: int
    """Index of the torque at which most pairs are above, the last of equal ones."""
    first_order: FloatArray
    total: FloatArray
    """`first_order`, `total`: Sobol' indices of the level in dB at that torque: the part of its variance that
    a deviation causes alone, and together with others. Shape (d,) each.
    """
    cured: FloatArray
    """Share of pairs above at that torque if the tolerance of one deviation is tightened by a class. Shape
    (d,).
    """
    missed: FloatArray = field(metadata=in_unit("m", "torque"))
    """Root mean square error of the model for the amplitude of solved pairs that it does not know, m. Shape
    (L,).
    """
    beyond: FloatArray
    """Part of the solved pairs that the model puts on the other side of the limit. Shape (L,)."""

    @property
    def decides(self) -> int:
        """Index of the deviation with the largest total index."""
        return int(np.argmax(self.total))

    @property
    def cure(self) -> int | None:
        """Index of the deviation whose tolerance, tightened by a class, lowers the share most; None: none."""
        best = int(np.argmin(self.cured))
        return best if self.cured[best] < self.share[self.load] else None


@dataclass(frozen=True)
class DrawnPairs:
    """N drawn pairs with deviations (N, d), m; the first n were solved: ste (n, P, L), m."""

    names: tuple[str, ...]
    """Names of the deviations."""
    deviation: FloatArray
    ste: FloatArray
    first_unknown: int
    """Index of the first solved pair that the model does not know."""
    model: TangentModel
    of_pair: Sequence[Any]
    """Distribution of each deviation."""
    period: int
    seed: int


class Causes(NamedTuple):
    """Effect of d deviations on an order at one load, by a model."""

    first_order: FloatArray
    total: FloatArray
    """`first_order`, `total`: Sobol' indices of the level in dB. Shape (d,) each."""
    share: float
    """Share of pairs above the limit."""
    tightened: FloatArray
    """Share of pairs above the limit if the tolerance of one deviation is tightened by a class. Shape (d,).
    """


@dataclass(frozen=True)
class ModeledPairs:
    """Amplitudes of one order of pairs that a model knows all of: modeled (N, L), and solved (n, L), m."""

    names: tuple[str, ...]
    """Names of the deviations."""
    nominal: FloatArray
    """Amplitude of the pair as designed, m. Shape (L,)."""
    solved: FloatArray
    modeled: FloatArray
    first_unknown: int = 0
    """Index of the first solved pair that the model does not know."""

    def above(self, limit: OrderLimit, confidence: float, causes: Callable[[int], Causes]) -> PairsAbove:
        """Count the pairs above a limit; `causes` says why at one of the loads."""
        known, predicted = (
            self.solved[self.first_unknown :],
            self.modeled[self.first_unknown : len(self.solved)],
        )
        scaled = as_spread(predicted, predicted, known)
        further = as_spread(self.modeled[len(self.solved) :], predicted, known)
        amplitude = np.concatenate([self.solved, further])
        share, low, high = _shares(limit, amplitude, confidence)
        beyond = (scaled > limit.amplitude) != (known > limit.amplitude)
        wider = len(further) / len(amplitude) * _share_error(beyond, confidence)
        load = int(len(share) - 1 - np.argmax(share[::-1]))
        why = causes(load)
        return PairsAbove(
            limit=limit,
            names=self.names,
            amplitude=amplitude,
            nominal=self.nominal,
            share=share,
            low=np.maximum(share - np.hypot(share - low, wider), 0.0),
            high=np.minimum(share + np.hypot(high - share, wider), 1.0),
            load=load,
            first_order=why.first_order,
            total=why.total,
            cured=np.clip(share[load] + (why.tightened - why.share), 0.0, 1.0),
            missed=np.sqrt(np.mean((scaled - known) ** 2, axis=0)),
            beyond=beyond.mean(axis=0),
        )


def _share_error(beyond: BoolArray, confidence: float) -> FloatArray:
    """Return by how much the share of a model may be off (L,), by which of n pairs it puts on the other side.

    The difference of two shares has at most the variance of a part of the pairs, by the rule of succession.
    """
    count = len(beyond)
    part = (beyond.sum(axis=0) + 1.0) / (count + 2.0)
    return np.asarray(special.ndtri(0.5 + 0.5 * confidence) * np.sqrt(part / count))


def mesh_order_above(
    limit: OrderLimit, pairs: DrawnPairs, nominal: FloatArray, confidence: float
) -> PairsAbove:
    """Count the pairs above a limit of a mesh order and look for the cause.

    `nominal` (P, L) is the curve as designed, m.
    """
    designed = order_amplitude(nominal[None], limit.order, pairs.period)[0]
    solved = order_amplitude(pairs.ste, limit.order, pairs.period)
    modeled = pairs.model.amplitude(pairs.deviation, limit.order, pairs.period)

    def causes(load: int) -> Causes:
        share = float((modeled[:, load] > limit.amplitude).mean())
        return Causes(*_indices(limit, pairs, load), share, _tightened(limit, pairs, load))

    return ModeledPairs(pairs.names, designed, solved, modeled, pairs.first_unknown).above(
        limit, confidence, causes
    )


def as_spread(values: FloatArray, predicted: FloatArray, known: FloatArray) -> FloatArray:
    """Return values (N, L) as those told (n, L) become in mean and standard deviation those known, >= 0."""
    spread = predicted.std(axis=0)
    scale = np.where(spread > 0.0, known.std(axis=0) / np.where(spread > 0.0, spread, 1.0), 1.0)
    return np.asarray(np.maximum(known.mean(axis=0) + scale * (values - predicted.mean(axis=0)), 0.0))


def _shares(
    limit: OrderLimit, amplitude: FloatArray, confidence: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the share of pairs (N, L) above a limit, and its bounds, (L,) each."""
    from scipy.stats import binomtest  # noqa: PLC0415 (start-up time)

    above = amplitude > limit.amplitude
    bounds = [
        binomtest(int(count), len(above)).proportion_ci(confidence, method="wilson")
        for count in above.sum(axis=0)
    ]
    low, high = (np.array([getattr(interval, end) for interval in bounds]) for end in ("low", "high"))
    return above.mean(axis=0), low, high


def _level(limit: OrderLimit, pairs: DrawnPairs, load: int) -> Callable[[FloatArray], FloatArray]:
    """Return the level of the order in dB by the deviations (d, n), re the limit."""
    model = pairs.model.at_load(load)

    def level(deviation: FloatArray) -> FloatArray:
        amplitude = model.amplitude(deviation.T, limit.order, pairs.period)[:, 0]
        return np.asarray(20.0 * np.log10(np.maximum(amplitude, 1e-15) / limit.amplitude))

    return level


def _indices(limit: OrderLimit, pairs: DrawnPairs, load: int) -> tuple[FloatArray, FloatArray]:
    """Return the first-order and total Sobol' indices of the level, (d,) each."""
    from scipy.stats import sobol_indices  # noqa: PLC0415 (start-up time)

    level = _level(limit, pairs, load)
    indices = sobol_indices(
        func=lambda deviation: level(deviation)[None], n=BASE_PAIRS, dists=list(pairs.of_pair), rng=pairs.seed
    )
    return np.asarray(indices.first_order).reshape(-1), np.asarray(indices.total_order).reshape(-1)


def _tightened(limit: OrderLimit, pairs: DrawnPairs, load: int) -> FloatArray:
    """Return the share above by the model with each tolerance tightened by a class, (d,)."""
    level = _level(limit, pairs, load)
    shares = []
    for k in range(pairs.deviation.shape[1]):
        narrow = pairs.deviation.copy()
        narrow[:, k] *= TIGHTENED
        shares.append(float(np.mean(level(narrow.T) > 0.0)))
    return np.array(shares)
