"""A limit on an order of the transmission error: which pairs are above it, why, and the cheapest cure."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.stats import binomtest, sobol_indices

from fe_contact.errors import InputError, integer, positive
from fe_contact.microgeometry.tangent_model import TangentModel, highest_order, order_amplitude
from fe_contact.types import FloatArray
from model_studies import in_unit

TIGHTENED = 1.0 / math.sqrt(2.0)
"""Tolerance of a class over that of the next coarser one (ISO 1328-1:2013, 5.2.2)."""
BASE_PAIRS = 1024
"""Of the indices: as many times the number of deviations and two more are taken from the model."""


@dataclass(frozen=True)
class OrderLimit:
    """What the amplitude of a mesh order is to stay below.

    Attributes
    ----------
    order : int
        1: the mesh frequency.
    amplitude : float
        m.
    """

    order: int
    amplitude: float

    def __post_init__(self) -> None:
        integer("limit.order", self.order, 1, 10_000)
        positive("limit.amplitude", self.amplitude)

    def check(self, positions: int) -> None:
        """Refuse an order that the positions do not resolve."""
        if self.order > (most := highest_order(positions)):
            advice = f"The {positions} positions of a base pitch resolve the mesh orders 1 to {most}."
            raise InputError("limit.order", self.order, f"a mesh order of the spectrum, 1 to {most}", advice)


@dataclass(frozen=True)
class PairsAbove:
    """Pairs above a limit at L torques, and what of d deviations decides at the one with most of them.

    Attributes
    ----------
    limit : OrderLimit
    amplitude : ndarray, shape (N, L)
        Of the order, m.
    nominal : ndarray, shape (L,)
        As designed, m.
    share, low, high : ndarray, shape (L,)
        Part of all pairs above, and its bounds by Wilson.
    load : int
        Index of the torque at which most are above, the last of equal ones.
    first_order, total : ndarray, shape (d,)
        Sobol' indices of the level in dB there: the part of its variance that a deviation makes alone, and
        with others.
    cured : ndarray, shape (d,)
        Share there if the tolerance of one deviation is tightened by a class.
    missed : ndarray, shape (L,)
        Root of the mean square by which the model misses the amplitude of pairs it is held against, m.
    beyond : ndarray, shape (L,)
        Part of those pairs that it puts on the other side of the limit.
    """

    limit: OrderLimit
    amplitude: FloatArray = field(metadata=in_unit("m", "sample", "torque"))
    nominal: FloatArray = field(metadata=in_unit("m", "torque"))
    share: FloatArray
    low: FloatArray
    high: FloatArray
    load: int
    first_order: FloatArray
    total: FloatArray
    cured: FloatArray
    missed: FloatArray = field(metadata=in_unit("m", "torque"))
    beyond: FloatArray

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
    """N pairs that deviate by (N, d) in m, the first n of which were solved: ste (n, P, L) in m.

    Attributes
    ----------
    held : int
        From which of the solved pairs on the model does not know them.
    of_pair : sequence
        Distribution of each deviation.
    """

    deviation: FloatArray
    ste: FloatArray
    held: int
    model: TangentModel
    of_pair: Sequence[Any]
    period: int
    seed: int


def pairs_above(limit: OrderLimit, drawn: DrawnPairs, nominal: FloatArray, confidence: float) -> PairsAbove:
    """Count the pairs above a limit and look for the cause; `nominal` (P, L) is the curve as designed, m."""
    solved = order_amplitude(drawn.ste, limit.order, drawn.period)
    modeled = drawn.model.amplitude(drawn.deviation, limit.order, drawn.period)
    amplitude = np.concatenate([solved, modeled[len(solved) :]])
    above = amplitude > limit.amplitude
    bounds = [
        binomtest(int(count), len(above)).proportion_ci(confidence, method="wilson")
        for count in above.sum(axis=0)
    ]
    share = above.mean(axis=0)
    load = int(len(share) - 1 - np.argmax(share[::-1]))
    known, held = solved[drawn.held :], modeled[drawn.held : len(solved)]
    at_load = (modeled > limit.amplitude).mean(axis=0)[load]
    first, total = _indices(limit, drawn, load)
    return PairsAbove(
        limit,
        amplitude,
        order_amplitude(nominal[None], limit.order, drawn.period)[0],
        share,
        np.array([each.low for each in bounds]),
        np.array([each.high for each in bounds]),
        load,
        first,
        total,
        np.clip(share[load] + _tightened(limit, drawn, load) - at_load, 0.0, 1.0),
        np.sqrt(np.mean((held - known) ** 2, axis=0)),
        np.mean((held > limit.amplitude) != (known > limit.amplitude), axis=0),
    )


def _level(limit: OrderLimit, drawn: DrawnPairs, load: int) -> Callable[[FloatArray], FloatArray]:
    """Return the level of the order in dB by the deviations (d, n), re the limit."""
    model = drawn.model.at_load(load)

    def level(deviation: FloatArray) -> FloatArray:
        amplitude = model.amplitude(deviation.T, limit.order, drawn.period)[:, 0]
        return np.asarray(20.0 * np.log10(np.maximum(amplitude, 1e-15) / limit.amplitude))

    return level


def _indices(limit: OrderLimit, drawn: DrawnPairs, load: int) -> tuple[FloatArray, FloatArray]:
    """Return the first-order and total Sobol' indices of the level, (d,) each."""
    level = _level(limit, drawn, load)
    indices = sobol_indices(
        func=lambda deviation: level(deviation)[None], n=BASE_PAIRS, dists=list(drawn.of_pair), rng=drawn.seed
    )
    return np.asarray(indices.first_order).reshape(-1), np.asarray(indices.total_order).reshape(-1)


def _tightened(limit: OrderLimit, drawn: DrawnPairs, load: int) -> FloatArray:
    """Return the share above by the model with each tolerance tightened by a class, (d,)."""
    level = _level(limit, drawn, load)
    shares = []
    for k in range(drawn.deviation.shape[1]):
        narrow = drawn.deviation.copy()
        narrow[:, k] *= TIGHTENED
        shares.append(float(np.mean(level(narrow.T) > 0.0)))
    return np.array(shares)
