"""Amplitudes of mesh orders in a stretch of a run, at constant or changing speed."""

from __future__ import annotations

import numpy as np

from dynamics.types import FloatArray


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

    Least squares over all samples: mean, drift and the sinusoids of `position` (T,), unwrapped base pitches,
    together. What is periodic in position is found exactly however the speed changes.
    """
    angle = 2.0 * np.pi * np.outer(position - position[0], np.arange(1, orders + 1))
    drift = np.linspace(-1.0, 1.0, position.size)
    columns = np.column_stack([np.ones(position.size), drift, np.cos(angle), np.sin(angle)])
    flat = values.reshape(-1, position.size)
    coefficients = np.linalg.lstsq(columns, flat.T, rcond=None)[0][2:].T
    size = np.hypot(coefficients[:, :orders], coefficients[:, orders:])
    return np.asarray(size.reshape(*values.shape[:-1], orders))


def orders_seen(position: FloatArray, most: int) -> int:
    """Return how many orders, at most `most`, four samples a period or more resolve over `position` (T,)."""
    fastest = float(np.max(np.abs(np.diff(position)), initial=0.0))
    return max(min(most, int(0.25 / fastest)) if fastest > 0.0 else 0, 0)
