"""The mean square of an order over a range of speeds, less the noise that lies under it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.orders.third_octaves import Waterfall
from dynamics.types import FloatArray, IntArray

MAIN_LOBE = 3
"""Lines on either side of an order that its own line reaches under a Hann window, plus one for margin."""
NEIGHBORHOOD = 0.5
"""Distance from an order up to which its noise is measured, in orders."""
MEDIAN = math.log(2.0)
"""Median over mean of the power of a line of Gaussian noise: side lines of orders do not move a median."""
NEIGHBORS = 3
"""Number of blocks on either side, by speed, whose lines count to the noise of a block."""
ONE_SPEED = 0.02
"""Relative difference of mesh frequencies up to which two signals are at one speed."""


@dataclass(frozen=True)
class OrderPower:
    """The mean power of an order over a range of mesh frequencies."""

    power: float
    """Mean of half the squared amplitude, the noise removed, square of the unit; < 0: none is seen."""
    noise: float
    """Mean power of the noise on its line."""
    deviation: float
    """Standard deviation of `power` by the noise, and by blocks that pass the frequencies in steps."""
    frequency: FloatArray
    clean: FloatArray
    """`frequency`, `clean`: Mesh frequencies of the blocks, Hz, rising; their powers without the noise. Shape
    (B,) each.
    """

    @property
    def is_seen(self) -> bool:
        """Whether the order stands out by more than two standard deviations."""
        return self.power > 2.0 * self.deviation


def shared_frequencies(one: Waterfall, other: Waterfall) -> tuple[float, float] | None:
    """Return the lowest and highest mesh frequency that two signals pass, Hz; None if they share none.

    Two signals at one speed within 2 % of each other share it.
    """
    low = max(float(blocks.mesh_frequency.min()) for blocks in (one, other))
    high = min(float(blocks.mesh_frequency.max()) for blocks in (one, other))
    if high < low * (1.0 - ONE_SPEED):
        return None
    return min(low, high), max(low, high)


def order_power(blocks: Waterfall, order: int, span: tuple[float, float], overlap: float) -> OrderPower:
    """Return the power of an order of one signal over the mesh frequencies of a `span`, Hz.

    A line holds |s + n|^2 of an order s and noise n: its mean is |s|^2 + |n|^2, its variance over independent
    blocks 2 |s|^2 |n|^2 + |n|^4. Blocks that overlap are counted by what is new in them. Powers are
    integrated over the frequency by the trapezoidal rule; half of what every other block changes is the error
    of that.
    """
    rank = np.argsort(blocks.mesh_frequency, kind="stable")
    frequency = blocks.mesh_frequency[rank]
    lines = 0.5 * blocks.amplitude[rank] ** 2
    noise = _noise(lines[:, _neighbors(blocks, order)])
    clean = lines[:, round(order / float(blocks.line[1]))] - noise
    weight = _weights(frequency, span)
    power = float(weight @ clean)
    variance = weight**2 @ (2.0 * np.maximum(clean, 0.0) * noise + noise**2) / (1.0 - overlap)
    coarse = float(_weights(frequency[::2], span) @ clean[::2])
    deviation = math.hypot(math.sqrt(float(variance)), 0.5 * (power - coarse))
    return OrderPower(power, float(weight @ noise), deviation, frequency, clean)


def _neighbors(blocks: Waterfall, order: int) -> IntArray:
    """Return the lines about an order that hold no more than noise and side lines."""
    distance = np.abs(blocks.line - order)
    near = (distance <= NEIGHBORHOOD) & (distance > (MAIN_LOBE - 0.5) * blocks.line[1])
    return np.flatnonzero(near)


def _noise(lines: FloatArray) -> FloatArray:
    """Return the power of the noise on one line of each block, (B,), from lines (B, n) that hold no order."""
    count = len(lines)
    spans = (slice(max(block - NEIGHBORS, 0), block + NEIGHBORS + 1) for block in range(count))
    return np.array([np.median(lines[span]) / MEDIAN for span in spans])


def _weights(frequency: FloatArray, span: tuple[float, float]) -> FloatArray:
    """Return the weights (B,) of values at rising frequencies (B,) in their mean over a span.

    Between two of them it runs straight, beyond the first and the last it is constant.
    """
    low, high = span
    if frequency.size == 1:
        return np.ones(1)
    weight = np.zeros(frequency.size)
    if high - low <= ONE_SPEED * high:
        near = np.abs(frequency - 0.5 * (low + high)) <= ONE_SPEED * high
        weight[near if near.any() else [int(np.argmin(np.abs(frequency - low)))]] = 1.0
        return np.asarray(weight / weight.sum())
    nodes = np.unique(np.concatenate([[low, high], frequency[(frequency > low) & (frequency < high)]]))
    share = np.zeros(nodes.size)
    share[:-1] += 0.5 * np.diff(nodes)
    share[1:] += 0.5 * np.diff(nodes)
    after = np.clip(np.searchsorted(frequency, nodes), 1, frequency.size - 1)
    spacing = frequency[after] - frequency[after - 1]
    part = np.clip((nodes - frequency[after - 1]) / np.where(spacing > 0.0, spacing, 1.0), 0.0, 1.0)
    np.add.at(weight, after - 1, share * (1.0 - part))
    np.add.at(weight, after, share * part)
    return np.asarray(weight / (high - low))
