"""Order spectra of a signal over time and the position of a mesh: of a recording as of a run.

`order_waterfall` takes a run, whose output holds no more than its highest order. A recording holds whatever
its sensor sees: at low speed the top of its band lies hundreds of orders up, and samples at equal steps of
position would fold it onto the first ones. Each block has as many samples a pitch as its slowest part needs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds import at_least, at_most
from dynamics.checks import integer
from dynamics.errors import InputError
from dynamics.orders.resampling import FINER, HALF_LENGTH, cubic_between, interpolated
from dynamics.orders.spectrum import Spectrum, spectrum
from dynamics.orders.third_octaves import Waterfall
from dynamics.types import FloatArray

PASSED = 0.42
"""Highest frequency over the sample rate that keeps its amplitude in the interpolation between samples."""
MIN_PER_PITCH, MAX_IN_BLOCK = 64, 1 << 22  # least samples of a base pitch, and most samples of a block
SLOWEST = 0.02
"""Least mesh frequency of a block over the highest one: slower blocks last too long to hold one speed."""


@dataclass(frozen=True)
class PositionedSignal:
    """A signal (T,) on a uniform grid of time, with the position (T,) of a mesh."""

    time: FloatArray
    """Times, s, uniform. Shape (T,)."""
    position: FloatArray
    """Position of the mesh, base pitches, not wrapped, rising. Shape (T,)."""
    values: FloatArray
    """Values of the signal, in `unit`. Shape (T,)."""
    unit: str

    def __post_init__(self) -> None:
        if not self.time.shape == self.position.shape == self.values.shape:
            raise InputError("values", self.values.size, f"as many as times ({self.time.size})")
        if self.time.size < 2 or np.any(np.diff(self.position) < 0.0):
            raise InputError("position", "falling", "rising all along", "Cut the recording at the turn.")

    @property
    def sample_rate(self) -> float:
        """Sample rate, Hz."""
        return (self.time.size - 1) / float(self.time[-1] - self.time[0])

    @property
    def travel(self) -> float:
        """Base pitches from the first sample to the last."""
        return float(self.position[-1] - self.position[0])

    @property
    def highest_order(self) -> int:
        """The highest multiple of the mesh frequency that the samples hold at the highest speed."""
        highest_frequency = float(np.max(np.diff(self.position))) * self.sample_rate  # of the mesh, Hz
        return math.floor(PASSED * self.sample_rate / highest_frequency) if highest_frequency > 0.0 else 0


def recorded_waterfall(
    signal: PositionedSignal, pitches: int, highest: int, window: str = "hann", overlap: float = 0.0
) -> Waterfall:
    """Return the spectra over mesh orders, up to `highest`, of blocks of `pitches` base pitches.

    Blocks overlap by the share `overlap` of their length; orders are 1/`pitches` apart. Interpolation is that
    of `resample_to_position`. Blocks below `SLOWEST` of the highest speed are left out. Raises `InputError`:
    the signal is shorter than one block, or its samples do not hold the order.
    """
    integer("pitches", pitches, 1, 1_000_000)
    integer("highest", highest, 1, 1000)
    if highest > signal.highest_order:
        suggestion = "Record at a higher rate, or name lower orders."
        raise InputError("highest", highest, at_most(signal.highest_order), suggestion)
    fine = interpolated(signal.values, FINER, HALF_LENGTH)
    highest_frequency = float(np.max(np.diff(signal.position))) * signal.sample_rate
    blocks = [
        _Block.of(signal, fine, start, pitches, highest, window)
        for start in _starts(signal, pitches, overlap)
        if pitches >= SLOWEST * highest_frequency * _duration(signal, start, pitches)
    ]
    if not blocks:
        raise InputError(
            "signal", signal.travel, at_least(pitches, name="base pitches,"), "Record for longer."
        )
    lines = highest * pitches + 1
    return Waterfall(
        blocks[0].spectrum.frequency[:lines],
        np.array([block.time for block in blocks]),
        np.array([block.mesh_frequency for block in blocks]),
        np.stack([block.spectrum.amplitude[:lines] for block in blocks]),
        np.array([block.rms for block in blocks]),
        signal.unit,
        blocks[0].spectrum.noise_bandwidth,
    )


def _starts(signal: PositionedSignal, pitches: int, overlap: float) -> FloatArray:
    """Return the positions at which blocks start."""
    step = pitches * (1.0 - overlap)
    count = math.floor((signal.travel - pitches) / step) + 1
    return np.asarray(signal.position[0] + step * np.arange(max(count, 0)))


def _duration(signal: PositionedSignal, start: float, pitches: int) -> float:
    """Return the duration of a block, s."""
    first, last = np.interp([start, start + pitches], signal.position, signal.time)
    return float(last - first)


@dataclass(frozen=True)
class _Block:
    """The spectrum over orders of one block, and its mean time, mesh frequency and rms about the mean."""

    spectrum: Spectrum
    time: float
    mesh_frequency: float
    rms: float

    @classmethod
    def of(
        cls, signal: PositionedSignal, fine: FloatArray, start: float, pitches: int, highest: int, window: str
    ) -> _Block:
        """Sample a block at equal steps of position; `fine` are the values at `FINER` times their rate."""
        per_pitch = _samples_per_pitch(signal, start, pitches, highest)
        grid = start + np.arange(pitches * per_pitch) / per_pitch
        time = np.interp(grid, signal.position, signal.time)
        coordinate = FINER * signal.sample_rate * (time - signal.time[0])
        index = np.clip(coordinate.astype(int), 0, fine.size - 2)
        values = cubic_between(fine, index, coordinate - index)
        return cls(
            spectrum(values, float(per_pitch), signal.unit, window),
            float(time.mean()),
            float(np.mean(1.0 / (per_pitch * np.diff(time)))),  # pitches per second
            float(values.std()),
        )


def _samples_per_pitch(signal: PositionedSignal, start: float, pitches: int, highest: int) -> int:
    """Return the samples in a pitch, a power of two: at least those of the recording at its slowest."""
    first, last = np.searchsorted(signal.position, [start, start + pitches])
    slowest = float(np.min(np.diff(signal.position[max(first - 1, 0) : last + 1])))
    needed = max(MIN_PER_PITCH, 8 * highest, math.ceil(1.0 / max(slowest, 1e-9)))
    maximum = 1 << int(math.log2(MAX_IN_BLOCK / pitches))
    return min(1 << math.ceil(math.log2(needed)), maximum)
