"""Order tracking: series over equal steps of position, and the amplitudes of mesh orders over a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.checks import integer
from dynamics.errors import InputError
from dynamics.orders.spectrum import spectrum
from dynamics.results import RunResult
from dynamics.types import FloatArray


@dataclass(frozen=True)
class OrderTrack:
    """Amplitudes of mesh orders along a run.

    Attributes
    ----------
    order : (K,) array
        Multiples of the mesh frequency, from 0.
    time, mesh_frequency : (B,) arrays
        Middle of each block, s and Hz.
    amplitude : (..., B, K) array
        Peak amplitude in the series' unit.
    """

    order: FloatArray
    time: FloatArray
    mesh_frequency: FloatArray
    amplitude: FloatArray


def resample_to_position(
    result: RunResult, values: FloatArray, per_pitch: int = 64, mesh: int = 0
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return unwrapped position (N,), time (N,) and `values` (..., N) in equal steps of a base pitch.

    Linear in time between the samples of the result, so `values` should hold nothing above about a tenth of
    the sample rate.

    Raises
    ------
    InputError
        If a mesh moves by half a base pitch or more between two samples, or less than one pitch in all.
    """
    integer("per_pitch", per_pitch, 2, 4096)
    wrapped = result.position[mesh]
    step = np.diff(wrapped)
    step -= np.round(step)  # whatever whole number of pitches the table's period has
    if np.any(step < 0.0):
        suggestion = "Raise outputs.sample_rate."
        raise InputError("sample_rate", result.sample_rate, "above twice the mesh frequency", suggestion)
    position = wrapped[0] + np.concatenate([[0.0], np.cumsum(step)])
    grid = np.arange(np.ceil(position[0] * per_pitch), np.floor(position[-1] * per_pitch) + 1.0) / per_pitch
    if grid.size <= per_pitch:
        raise InputError(
            "result", f"{position[-1] - position[0]:.3g} base pitches", "longer than one base pitch"
        )
    time = np.interp(grid, position, result.time)
    index = np.clip(np.searchsorted(result.time, time, side="right") - 1, 0, result.time.size - 2)
    part = (time - result.time[index]) / (result.time[index + 1] - result.time[index])
    values = np.asarray(values, dtype=float)
    return grid, time, values[..., index] + part * (values[..., index + 1] - values[..., index])


def order_track(
    result: RunResult, series: str, pitches: int = 16, highest: int = 10, mesh: int = 0
) -> OrderTrack:
    """Return the amplitudes of the mesh orders 0 to `highest` in blocks of `pitches` base pitches.

    Raises
    ------
    InputError
        If the run is shorter than one block.
    """
    per_pitch = max(64, 8 * highest)
    _, time, values = resample_to_position(result, getattr(result, series), per_pitch, mesh)
    length = pitches * per_pitch
    blocks = time.size // length
    if blocks == 0:
        raise InputError("pitches", pitches, f"at most {time.size // per_pitch}, the run's length")
    cut = values[..., : blocks * length].reshape(*values.shape[:-1], blocks, length)
    lines = spectrum(cut, float(per_pitch))
    middle = time[: blocks * length].reshape(blocks, length).mean(axis=1)
    frequency = np.interp(middle, result.time, result.mesh_frequency[mesh])
    wanted = np.arange(highest + 1)
    return OrderTrack(wanted.astype(float), middle, frequency, lines.amplitude[..., wanted * pitches])
