"""Sound power of a housing over the time of a run, in third octaves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bounds import at_least, from_to
from dynamics.acoustics import a_weighting, sound_power_level
from dynamics.acoustics.recording import LOWEST
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.noise.housing_radiation import HousingRadiation
from dynamics.orders import band_sums, leading_shaft, nominal_center
from dynamics.results import RunResult
from dynamics.types import BoolArray, FloatArray, IntArray
from dynamics.vibration import finer_seat_forces, motion_pieces

FINER = 2
"""Factor on the sample rate of the run. A cubic spline takes the forces to this rate, with amplitudes that
are low by at most 0.6 %, 0.05 dB.
"""
BLOCK = 0.1
"""Length of a block, s: its lines are 10 Hz apart."""
LEAKAGE = 3
"""Number of the lowest lines into which a mean and a drift leak under Hann's window."""
MIN_SAMPLES = 4 * LEAKAGE
"""Least samples of a block: half of its lines, those below the Nyquist frequency, are then twice `LEAKAGE`.
"""


@dataclass(frozen=True)
class SoundOverTime:
    """Sound power in B blocks of a run, J third octaves."""

    time: FloatArray
    speed: FloatArray
    """`time`, `speed`: Middle of each block, s, and speed of the leading shaft at that time, rad/s, without
    sign. Shape (B,) each.
    """
    band: IntArray
    """Numbers of the bands, 0 at 1 kHz. Shape (J,)."""
    power: FloatArray
    """Sound power in each band, W. Shape (B, J)."""
    total: FloatArray
    weighted: FloatArray
    """`total`, `weighted`: Sound power of all lines between `lowest` and `highest`, W, and the same
    A-weighted line by line. Shape (B,) each.
    """
    lowest: float
    highest: float
    """`lowest`, `highest`: Frequencies of the lowest and highest line, Hz."""

    @classmethod
    def of_all(cls, sounds: Sequence[SoundOverTime]) -> SoundOverTime:
        """Return the sound of several housings in one run: powers add up.

        Raises `InputError`: there is none, or their times and bands differ.
        """
        if not sounds:
            raise InputError("sounds", len(sounds), at_least(1))
        first = sounds[0]
        for index, sound in enumerate(sounds):
            if not (np.array_equal(sound.time, first.time) and np.array_equal(sound.band, first.band)):
                raise InputError(f"sounds[{index}]", "other times or bands", "those of the first")
        power, total, weighted = (
            np.asarray(np.sum([getattr(sound, name) for sound in sounds], axis=0))
            for name in ("power", "total", "weighted")
        )
        return replace(first, power=power, total=total, weighted=weighted)

    @property
    def nominal(self) -> FloatArray:
        """Nominal centers of the bands, (J,), Hz."""
        return nominal_center(self.band)

    @property
    def total_level(self) -> FloatArray:
        """Level of all lines, dB re 1e-12 W, (B,)."""
        return sound_power_level(self.total)

    @property
    def total_weighted_level(self) -> FloatArray:
        """The same A-weighted, dB(A) re 1e-12 W, (B,)."""
        return sound_power_level(self.weighted)


def sound_over_time(
    result: RunResult,
    housing: ReducedHousing,
    bearings: Sequence[str] | None,
    radiation: HousingRadiation,
    block: float = BLOCK,
) -> SoundOverTime:
    """Return the sound power of a housing over a run: orders, impacts, sidebands, free vibration.

    The modes of the housing follow the forces exactly in time. Their velocities are cut into blocks that
    overlap by half. The spectrum of a block, under a Hann window, radiates line by line as a steady vibration
    does: the power of a block is the mean over its time, weighted by the squared window. Shorter blocks
    follow a fast run-up, longer ones have lower bands. Raises `InputError`: the run is shorter than a block,
    no band lies in the range, or as `run_seat_forces` and `motion_pieces`.

    Parameters
    ----------
    result : RunResult
        Run with bearing forces, in the frame of the housing's mesh.
    housing : ReducedHousing
        Housing with mass and a surface.
    bearings : sequence of str or None
        Bearings in the order of the seats; None: those with the names of the seats.
    radiation : HousingRadiation
        Radiation of this housing. Lines outside of its range of frequencies are left out. So are lines below
        20 Hz, the lowest `LEAKAGE` lines, and lines above the pass frequency of the run's output.
    block : float
        Length of a block, s.
    """
    samples, rate = round(block * result.sample_rate), result.sample_rate
    if not MIN_SAMPLES <= samples <= result.time.size:
        bound = from_to(MIN_SAMPLES / rate, result.time.size / rate, "s", "the run's")
        raise InputError("block", block, bound)
    time, force = finer_seat_forces(result, housing, bearings, FINER)
    pieces = motion_pieces(housing, time, force, np.eye(len(housing.stiffness)))
    # back at the rate of the run; pieces have even numbers of samples, so that each begins with one of the
    # run's
    velocities = _blocks((piece[::FINER] for piece in pieces), samples)
    starts = np.arange(0, result.time.size - samples + 1, samples // 2)
    width = rate / samples
    line = np.arange(1.0, samples // 2) * width
    lowest = max(LOWEST, LEAKAGE * width, float(radiation.frequency[0]))
    highest = min(float(result.receipt["sampling"]["pass_frequency"]), float(radiation.frequency[-1]))
    inside = (line >= lowest) & (line <= highest)
    power = np.zeros((starts.size, line.size))
    for row, velocity in zip(power, velocities, strict=True):
        row[inside] = _line_powers(velocity, line, inside, radiation)
    band, _, within = band_sums(width, power, highest, lowest)
    middle = starts + samples // 2
    speed = result.speed[result.shaft.index(leading_shaft(result))]
    weighted = power @ 10.0 ** (a_weighting(line) / 10.0)
    total = power.sum(axis=1)
    return SoundOverTime(
        result.time[middle], np.abs(speed[middle]), band, within, total, weighted, lowest, highest
    )


def _blocks(pieces: Iterable[FloatArray], samples: int) -> Iterator[FloatArray]:
    """Yield blocks of `samples` that overlap by half, of a series in pieces.

    Only the samples of unfinished blocks stay in memory.
    """
    pending: list[FloatArray] = []
    for piece in pieces:
        pending.append(piece)
        if sum(map(len, pending)) < samples:
            continue
        series = np.concatenate(pending)
        starts = range(0, len(series) - samples + 1, samples // 2)
        for start in starts:
            yield series[start : start + samples]
        pending = [series[starts[-1] + samples // 2 :]]


def _line_powers(
    velocity: FloatArray, line: FloatArray, inside: BoolArray, radiation: HousingRadiation
) -> FloatArray:
    """Return the power of the lines inside the range, W.

    Their sum is the mean power of the block, weighted by the squared window.
    """
    samples = len(velocity)
    weight = np.sin(np.pi * np.arange(samples) / samples) ** 2
    spectrum = np.fft.rfft((velocity - velocity.mean(axis=0)) * weight[:, None], axis=0)
    scale = 2.0 / np.sqrt(samples * np.sum(weight**2))
    amplitude = scale * spectrum[1 : line.size + 1][inside]
    return np.maximum(radiation.power(line[inside], amplitude), 0.0)  # rounding may make it negative
