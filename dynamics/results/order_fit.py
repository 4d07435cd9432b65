"""Amplitudes of mesh orders in a stretch of a run, at constant or changing speed."""

from __future__ import annotations

import numpy as np

from dynamics.types import ComplexArray, FloatArray


def unwrapped(position: FloatArray) -> FloatArray:
    """Return wrapped positions (..., T) in base pitches as they run on from the first sample.

    Between two samples a mesh must move by less than half a base pitch.
    """
    step = np.diff(position, axis=-1)
    step -= np.round(step)
    return np.asarray(
        np.concatenate([position[..., :1], position[..., :1] + np.cumsum(step, axis=-1)], axis=-1)
    )


def order_amplitudes(position: FloatArray, values: FloatArray, orders: int) -> FloatArray:
    """Return the amplitudes (..., orders) of the multiples of the mesh order in `values` (..., T).

    The amplitudes are those of `order_phasors` over all samples of `position` (T,), unwrapped base pitches.
    """
    cycles = np.outer(position - position[0], np.arange(1, orders + 1))
    _, solved = _fit(cycles, values.reshape(-1, position.size), None)
    return np.asarray(np.abs(_phasors(solved, (*values.shape[:-1], orders))))


def order_phasors(
    cycles: FloatArray, values: FloatArray, weight: FloatArray | None = None
) -> tuple[ComplexArray, FloatArray]:
    """Return complex peak amplitudes A (..., K) of orders in `values` (..., T), and what they leave (..., T).

    An order is Re(A exp(2 pi i c)) with c its column of `cycles` (T, K). Least squares over all samples:
    mean, drift and all orders together. What is periodic in position is found exactly however the speed
    changes; mean and drift are no part of what is left. `weight` (T,): of the squares; default: all alike.
    """
    samples, orders = cycles.shape
    flat = values.reshape(-1, samples)
    columns, solved = _fit(cycles, flat, weight)
    left = flat - (columns @ solved).T
    return _phasors(solved, (*values.shape[:-1], orders)), left.reshape(values.shape)


def _fit(cycles: FloatArray, values: FloatArray, weight: FloatArray | None) -> tuple[FloatArray, FloatArray]:
    """Return the columns (T, 2 + 2 K) of the fit and the coefficients (2 + 2 K, N) of `values` (N, T)."""
    angle, drift = 2.0 * np.pi * cycles, np.linspace(-1.0, 1.0, cycles.shape[0])
    columns = np.column_stack([np.ones(drift.size), drift, np.cos(angle), np.sin(angle)])
    if weight is None:
        return columns, np.linalg.lstsq(columns, values.T, rcond=None)[0]
    root = np.sqrt(weight)
    return columns, np.linalg.lstsq(columns * root[:, None], (values * root).T, rcond=None)[0]


def _phasors(solved: FloatArray, shape: tuple[int, ...]) -> ComplexArray:
    coefficients, orders = solved[2:].T, shape[-1]
    return np.asarray((coefficients[:, :orders] - 1j * coefficients[:, orders:]).reshape(shape))


def orders_seen(position: FloatArray, maximum: int) -> int:
    """Return the number of orders that four samples a period resolve over `position`, at most `maximum`."""
    fastest = float(np.max(np.abs(np.diff(position)), initial=0.0))
    return max(min(maximum, int(0.25 / fastest)) if fastest > 0.0 else 0, 0)
