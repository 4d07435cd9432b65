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

    Those of `order_phasors` over all samples of `position` (T,), unwrapped base pitches.
    """
    cycles = np.outer(position - position[0], np.arange(1, orders + 1))
    return np.asarray(np.abs(order_phasors(cycles, values)[0]))


def order_phasors(
    cycles: FloatArray, values: FloatArray, weight: FloatArray | None = None
) -> tuple[ComplexArray, FloatArray]:
    """Return complex peak amplitudes A (..., K) of orders in `values` (..., T), and what they leave (..., T).

    An order is Re(A exp(2 pi i c)) with c its column of `cycles` (T, K). Least squares over all samples:
    mean, drift and all orders together. What is periodic in position is found exactly however the speed
    changes; mean and drift are no part of what is left.

    Parameters
    ----------
    weight : (T,) array, optional
        Of the squares; default: all alike.
    """
    samples, orders = cycles.shape
    angle, drift = 2.0 * np.pi * cycles, np.linspace(-1.0, 1.0, samples)
    columns = np.column_stack([np.ones(samples), drift, np.cos(angle), np.sin(angle)])
    flat = values.reshape(-1, samples)
    root = np.ones(samples) if weight is None else np.sqrt(weight)
    solved = np.linalg.lstsq(columns * root[:, None], (flat * root).T, rcond=None)[0]
    left = flat - (columns @ solved).T
    coefficients = solved[2:].T
    phasors = coefficients[:, :orders] - 1j * coefficients[:, orders:]
    return phasors.reshape(*values.shape[:-1], orders), left.reshape(values.shape)


def orders_seen(position: FloatArray, most: int) -> int:
    """Return how many orders, at most `most`, four samples a period or more resolve over `position` (T,)."""
    fastest = float(np.max(np.abs(np.diff(position)), initial=0.0))
    return max(min(most, int(0.25 / fastest)) if fastest > 0.0 else 0, 0)
