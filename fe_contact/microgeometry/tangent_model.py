"""Curves of pairs within tolerances, estimated by tangents about some solved pairs.

At a given load the transmission error is concave in the gaps: where teeth or slices part, others take over.
Gaps are linear in the deviations of flanks and alignment. So every tangent is an upper bound, and the minimum
of several tangents is the estimate. Its mean excess over the solution is measured on further solved pairs and
subtracted (`correction`); the same pairs show the error that remains.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.ste.curve_quantities import HARMONICS
from fe_contact.types import FloatArray

AT_ONCE = 4_000_000
"""Most numbers of curves that are computed in one batch: bounds the memory."""


@dataclass(frozen=True)
class TangentModel:
    """Tangents about T pairs at P positions and L loads, by d deviations."""

    minimum: FloatArray
    """Least deviations, m: no material is removed below zero. Deviations are clipped to them. Shape (d,)."""
    state: FloatArray
    """Deviations of the pairs, m. Shape (T, d)."""
    value: FloatArray
    """Transmission error of the pairs, m. Shape (T, P, L)."""
    by: FloatArray
    """Derivatives of the transmission error by the deviations, m/m. Shape (T, P, L, d)."""
    correction: FloatArray
    """Mean excess of the least tangent over the solution, m. Shape (P, L)."""

    @classmethod
    def of(cls, minimum: FloatArray, state: FloatArray, value: FloatArray, by: FloatArray) -> TangentModel:
        """Return the minimum of tangents, without a correction."""
        return cls(minimum, np.maximum(state, minimum), value, by, np.zeros(value.shape[1:]))

    def with_further(self, other: TangentModel) -> TangentModel:
        """Return the minimum of these tangents and others."""
        state, value, by = (
            np.concatenate([getattr(self, name), getattr(other, name)]) for name in ("state", "value", "by")
        )
        return TangentModel(minimum=self.minimum, state=state, value=value, by=by, correction=self.correction)

    def corrected(self, deviation: FloatArray, ste: FloatArray) -> TangentModel:
        """Subtract the mean error over pairs (n, d) whose curves (n, P, L) were solved."""
        error = np.concatenate(list(self.curves(deviation))) - ste
        return replace(self, correction=self.correction + error.mean(axis=0))

    def at_load(self, load: int) -> TangentModel:
        """Return the model at one of the loads."""
        one_load = slice(load, load + 1)
        arrays = self.value[..., one_load], self.by[:, :, one_load], self.correction[:, one_load]
        return TangentModel(self.minimum, self.state, *arrays)

    def curves(self, deviation: FloatArray) -> Iterator[FloatArray]:
        """Yield the transmission error of pairs (n, d), some at a time, (m, P, L) in m."""
        bounded = np.maximum(deviation, self.minimum)
        shape = self.value.shape[1:]
        slopes = self.by.reshape(len(self.state), -1, self.state.shape[1])
        at_zero = self.value.reshape(len(self.state), -1) - np.einsum("tqd,td->tq", slopes, self.state)
        batch = max(1, AT_ONCE // self.correction.size)
        for part in (bounded[k : k + batch] for k in range(0, len(bounded), batch)):
            ste = part @ slopes[0].T + at_zero[0]
            for value, by in zip(at_zero[1:], slopes[1:], strict=True):
                np.minimum(ste, part @ by.T + value, out=ste)
            yield ste.reshape(-1, *shape) - self.correction

    def peak_to_peak(self, deviation: FloatArray) -> FloatArray:
        """Return peak-to-peak of pairs (n, d), (n, L) in m."""
        return np.concatenate([np.ptp(ste, axis=1) for ste in self.curves(deviation)])

    def amplitude(self, deviation: FloatArray, order: int, period: int) -> FloatArray:
        """Return the amplitude of a mesh order of pairs (n, d), (n, L) in m; see `order_amplitude`."""
        return np.concatenate([order_amplitude(ste, order, period) for ste in self.curves(deviation)])


def order_amplitude(ste: FloatArray, order: int, period: int) -> FloatArray:
    """Return the amplitude of a mesh order of curves (n, P, L) at even positions over the period, (n, L)."""
    positions = ste.shape[1]
    angle = 2.0 * np.pi * order * period * np.arange(positions) / positions
    return np.asarray(np.abs(np.tensordot(ste, np.exp(-1j * angle), (1, 0))) * (2.0 / positions))


def highest_order(positions: int) -> int:
    """Return the highest mesh order that so many positions of a base pitch resolve."""
    return min(HARMONICS, (positions - 1) // 2)
