"""The high-pass of sounds: a Butterworth filter that runs forwards and backwards over series.

It is a direct part and a recursion s' = p s + u for each pair of poles p, p*, which counts by its residue. A
block of samples u is filtered by products of matrices; the states s alone go from block to block.

Axis letters: P pairs of poles, B samples of a block, K blocks.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dynamics.types import ComplexArray, FloatArray

BLOCK = 48  # samples of a block: products of this size cost less than the recursion they replace


def high_passed(values: FloatArray, order: int, lowest: float, sample_rate: float, beyond: int) -> FloatArray:
    """Return series (..., T) without trend and without what is slower than `lowest` in Hz, and phase shift.

    The filter of this even `order` runs forwards and backwards. `beyond`: samples reflected at both ends.
    """
    rows = np.reshape(values, (-1, np.shape(values)[-1]))
    time = np.arange(rows.shape[1]) - 0.5 * (rows.shape[1] - 1)
    level = rows.mean(axis=1, keepdims=True) + np.outer(rows @ time / (time @ time), time)
    extended = np.pad(rows - level, ((0, 0), (beyond, beyond)), mode="reflect")
    high_pass = _block_filter(order, lowest / sample_rate)
    for _ in range(2):  # each turns the series round
        extended = np.array([_forwards(row, high_pass) for row in extended])[:, ::-1]
    return np.reshape(extended[:, beyond : beyond + rows.shape[1]], np.shape(values))


class _BlockFilter(NamedTuple):
    """A filter by blocks; two columns or rows of real numbers stand for the complex state of a pair."""

    rest: ComplexArray
    """States after a constant 1 for ever, (P,)."""
    decay: ComplexArray
    """States after a block over those before it, (P,)."""
    drive: FloatArray
    """States after a block by its samples, (B, 2 P)."""
    free: FloatArray
    """Filtered samples by the states before the block, (2 P, B)."""
    forced: FloatArray
    """Filtered samples by the samples of the block, (B, B)."""


def _block_filter(order: int, frequency: float) -> _BlockFilter:
    """Return the Butterworth high-pass of an edge `frequency` in cycles a sample."""
    angles = math.pi * (2 * np.arange(order // 2) + 1 + order) / (2 * order)
    analog = math.tan(math.pi * frequency) * np.exp(-1j * angles)  # poles in 2 / (time step)
    poles = (1.0 + analog) / (1.0 - analog)  # by the bilinear transform
    direct = float(np.prod(1.0 / np.abs(1.0 - analog) ** 2))
    every = np.concatenate([poles, poles.conj()])
    distances = poles[:, None] - every + np.eye(order // 2, order)  # a pole's own distance counts as 1
    residues = direct * (poles - 1.0) ** order / np.prod(distances, axis=1)
    powers = poles[:, None] ** np.arange(BLOCK + 1.0)
    free = 2.0 * residues[:, None] * powers[:, :BLOCK]
    impulse = np.concatenate([[direct], free.real.sum(axis=0)[: BLOCK - 1]])
    samples = np.arange(BLOCK)
    return _BlockFilter(
        rest=1.0 / (1.0 - poles),
        decay=powers[:, BLOCK],
        drive=np.ascontiguousarray(powers[:, BLOCK - 1 :: -1].T).view(float),
        free=np.stack([free.real, -free.imag], axis=1).reshape(order, BLOCK),
        forced=np.tril(impulse[np.abs(samples[:, None] - samples)]),
    )


def _forwards(series: FloatArray, high_pass: _BlockFilter) -> FloatArray:
    """Return a series (T,) after the filter, which begins at rest under the first sample."""
    blocks = np.concatenate([series, np.zeros(-series.size % BLOCK)]).reshape(-1, BLOCK)
    driven = (blocks @ high_pass.drive).view(complex)
    states = _states(high_pass.decay, driven, high_pass.rest * series[0])
    filtered = blocks @ high_pass.forced.T + states.view(float) @ high_pass.free
    return np.asarray(filtered.ravel()[: series.size])


def _states(decay: ComplexArray, driven: ComplexArray, first: ComplexArray) -> ComplexArray:
    """Return the states (K, P) before every block, by what each block adds, (K, P), from the first ones.

    Groups of blocks run side by side from zero; then the states before them follow from group to group.
    """
    count, pairs = driven.shape
    size = math.isqrt(count - 1) + 1  # blocks of a group
    added = np.concatenate([driven, np.zeros((-count % size, pairs))]).reshape(-1, size, pairs)
    states = np.zeros((added.shape[0], size + 1, pairs), dtype=complex)
    for block in range(size):
        states[:, block + 1] = decay * states[:, block] + added[:, block]
    before, decays = first, decay ** np.arange(size + 1.0)[:, None]
    for group in range(len(states)):
        states[group] += decays * before
        before = states[group, size]
    return np.ascontiguousarray(states[:, :size].reshape(-1, pairs)[:count])
