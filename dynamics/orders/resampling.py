"""Series at other samples: another rate, uniform mesh positions, and up to which mesh order that holds."""

from __future__ import annotations

import math

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bounds import at_most
from dynamics.checks import integer, one_of
from dynamics.errors import InputError
from dynamics.results import RunResult
from dynamics.results.run_result import OVER_TIME
from dynamics.types import FloatArray, IntArray

USUAL = 10  # usual highest order
ROUNDING = 1e-9  # relative, for an order on the edge of the pass band
KAISER = 12.0  # shape of the filter's window: 118 dB
NYQUIST = 0.5  # cycles a sample
REMOVED, TRANSITION = 80.0, 0.1
"""Attenuation of a low-pass above its transition, dB, and width of the transition, over the highest frequency
that it passes.
"""
FINER, HALF_LENGTH = 4, 24  # times the result's rate; of the filter, in samples of the result


def order_frequency(result: RunResult, mesh: int = 0) -> FloatArray:
    """Return the mesh frequency, without meshes the rotations per second of the leading shaft, (T,)."""
    if result.mesh:
        return np.asarray(result.mesh_frequency[mesh])
    speed = result.speed[result.shaft.index(leading_shaft(result))]
    return np.asarray(np.abs(speed) / (2.0 * math.pi))


def leading_shaft(result: RunResult) -> str:
    """Return the shaft of the first drive or free rotation."""
    return str([*result.case["drives"], *result.case["free_rotations"]][0]["shaft"])


def driving_shaft(result: RunResult, mesh: int = 0) -> str:
    """Return the shaft of the driving gear of a mesh; without meshes the leading one."""
    if not result.mesh:
        return leading_shaft(result)
    driver = result.case["meshes"][mesh]["driver"]
    return str(next(gear["shaft"] for gear in result.case["gears"] if gear["name"] == driver))


def driving_speed(result: RunResult) -> FloatArray:
    """Return the speed of the `driving_shaft` of the first mesh, rad/s without sign, (n,)."""
    return np.asarray(np.abs(result.speed[result.shaft.index(driving_shaft(result))]))


def highest_valid_order(result: RunResult, mesh: int = 0) -> int:
    """Return the highest multiple of a mesh's frequency below the pass frequency at its highest speed.

    In a run without meshes, orders are multiples of the leading shaft's rotation.
    """
    top = float(np.max(order_frequency(result, mesh), initial=0.0))
    if top == 0.0:
        return 0
    passed = float(result.receipt["sampling"]["pass_frequency"])
    return math.floor(passed / top * (1.0 + ROUNDING))


def checked_order(result: RunResult, field: str, value: int | None, mesh: int = 0, usual: int = USUAL) -> int:
    """Return the order `value`, or the valid part of the usual orders.

    Raises `InputError`: the run's output does not hold that order at its highest speed.
    """
    valid = highest_valid_order(result, mesh)
    if value is None:
        return max(min(usual, valid), 1)
    integer(field, value, 1, 1000)
    if value > valid:
        sampling, top = result.receipt["sampling"], float(np.max(result.mesh_frequency[mesh]))
        rate = value * top * sampling["rate"] / sampling["pass_frequency"]
        passed = f"the output passes {sampling['pass_frequency']:.4g} Hz"
        bound = at_most(valid, note=f": {passed}, and the mesh frequency reaches {top:.4g} Hz")
        suggestion = f"Run with outputs.mesh_orders = {value}"
        if value * top > sampling.get("band", math.inf):
            suggestion += f" and outputs.band of {value * top:.4g} Hz"
        suggestion += f", or outputs.sample_rate of {rate:.4g} Hz or more."
        raise InputError(field, value, bound, suggestion)
    return value


def resampled(values: FloatArray, up: int, down: int, half_length: int) -> FloatArray:
    """Return a series (T,) at `up` / `down` times its rate, without phase shift; it is 0 before and after.

    Contents that lie by 1.9 / `half_length` of the lower rate or more below half of it keep their amplitude
    within 3e-6; those as far above it are removed by 112 dB. `half_length`: of the filter, in samples of the
    lower rate.
    """
    if up == down:
        return np.array(values, dtype=float)
    taps = _low_pass(max(up, down), half_length)
    count = -(-taps.size // up)  # taps of a phase
    weights = np.zeros(count * up)
    weights[: taps.size] = taps * (up / taps.sum())
    phases = weights.reshape(count, up)[::-1].T  # the newest sample of a window is its last
    windows = sliding_window_view(np.concatenate([np.zeros(count), values, np.zeros(count + 1)]), count)
    result = np.empty(-(-values.size * up // down))
    for first in range(min(up, result.size)):  # samples `up` apart have one phase
        newest, phase = divmod(first * down + taps.size // 2, up)
        samples = result[first::up]
        samples[:] = windows[newest + 1 :: down][: samples.size] @ phases[phase]
    return result


def _low_pass(steps: int, half_length: int) -> FloatArray:
    """Return the taps of a low-pass at a `steps`-th of half its rate, `half_length` steps to each side."""
    place = np.arange(half_length * steps + 1.0) / steps
    half = np.i0(KAISER * np.sqrt(1.0 - (place / half_length) ** 2)) * np.sinc(place)
    return np.concatenate([half[:0:-1], half])


def interpolated(values: FloatArray, factor: int, half_length: int) -> FloatArray:
    """Return a series (T,) with `factor` - 1 values between its samples, (`factor` (T - 1) + 1,).

    The series is extended at both ends by its odd reflection, so that a mean and a slope leave no ripple
    there.
    """
    extension = min(half_length, values.size - 1)
    head = 2.0 * values[0] - values[extension:0:-1]
    tail = 2.0 * values[-1] - values[-2 : -extension - 2 : -1]
    extended = resampled(np.concatenate([head, values, tail]), factor, 1, half_length)
    return extended[factor * extension : factor * (extension + values.size - 1) + 1]


def low_passed(values: FloatArray, frequency: float) -> FloatArray:
    """Return a series (T,) without content above a frequency, without phase shift; it is 0 before and after.

    Contents up to the frequency keep their amplitude within 0.01 %; those 10 % above it are removed by 80 dB.
    `frequency`: cycles a sample; a series that holds no more is returned as it is.
    """
    from scipy.signal import fftconvolve, firwin, kaiser_beta  # noqa: PLC0415 (start-up time)

    middle = frequency * (1.0 + 0.5 * TRANSITION)
    if frequency * (1.0 + TRANSITION) >= NYQUIST:
        return np.array(values, dtype=float)
    # Kaiser's estimate of the length of a filter by attenuation and width of its transition
    half = int(np.ceil((REMOVED - 7.95) / (2.285 * 2.0 * np.pi * TRANSITION * frequency) / 2.0))
    taps = firwin(2 * half + 1, middle, window=("kaiser", kaiser_beta(REMOVED)), fs=1.0)
    return np.asarray(fftconvolve(values, taps)[half : half + np.size(values)])


def resample_to_position(
    result: RunResult, values: FloatArray, per_pitch: int = 64, mesh: int = 0
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return unwrapped position (N,), time (N,) and `values` (..., N) in equal steps of a base pitch.

    Interpolated to four times the result's rate by a filter that passes what is below 0.42 of that rate
    (outputs hold 0.39), then cubic between the four nearest values: the error of a sinusoid is at most 0.4 %
    of its amplitude at 2.56 samples per period and 2e-5 at 10. Raises `InputError`: a mesh moves by half a
    base pitch or more between two samples, or less than one pitch in all.
    """
    integer("per_pitch", per_pitch, 2, 4096)
    wrapped = result.position[mesh]
    step = np.diff(wrapped)
    step -= np.round(step)  # the table's period is a whole number of pitches
    if np.any(step < 0.0):
        suggestion = "Raise outputs.sample_rate."
        raise InputError("sample_rate", result.sample_rate, "above twice the mesh frequency", suggestion)
    position = wrapped[0] + np.concatenate([[0.0], np.cumsum(step)])
    grid = np.arange(np.ceil(position[0] * per_pitch), np.floor(position[-1] * per_pitch) + 1.0) / per_pitch
    if grid.size <= per_pitch:
        length = f"{position[-1] - position[0]:.3g} base pitches"
        raise InputError("result", length, "longer than one base pitch")
    time = np.interp(grid, position, result.time)
    index = np.clip(np.searchsorted(result.time, time, side="right") - 1, 0, result.time.size - 2)
    part = (time - result.time[index]) / (result.time[index + 1] - result.time[index])
    return grid, time, _interpolated_at(np.asarray(values, dtype=float), index, part)


def _interpolated_at(values: FloatArray, index: IntArray, part: FloatArray) -> FloatArray:
    """Interpolate `values` (..., T) of a uniform grid at (N,) places, `part` of the way after `index`."""
    rows = values.reshape(-1, values.shape[-1])  # one at a time: the finer grid is four times as long
    coordinate = FINER * (index + part)
    fine = np.minimum(coordinate.astype(int), FINER * (rows.shape[1] - 1) - 1)
    sampled = [cubic_between(interpolated(row, FINER, HALF_LENGTH), fine, coordinate - fine) for row in rows]
    return np.reshape(sampled, (*values.shape[:-1], index.size))


def cubic_between(values: FloatArray, index: IntArray, part: FloatArray) -> FloatArray:
    """Interpolate by Lagrange between four samples of a uniform grid, `part` of the way after `index`."""
    maximum = values.shape[-1] - 4
    if maximum < 0:
        return np.asarray(values[..., index] + part * (values[..., index + 1] - values[..., index]))
    first = np.clip(index - 1, 0, maximum)
    u = index + part - first  # 0..3
    interpolated = values[..., first] * (-(u - 1.0) * (u - 2.0) * (u - 3.0) / 6.0)
    interpolated += values[..., first + 1] * (u * (u - 2.0) * (u - 3.0) / 2.0)
    interpolated += values[..., first + 2] * (-u * (u - 1.0) * (u - 3.0) / 2.0)
    interpolated += values[..., first + 3] * (u * (u - 1.0) * (u - 2.0) / 6.0)
    return np.asarray(interpolated)


def unit_of(series: str) -> str:
    """Return the unit of a series over time; raises `InputError`: there is no such series."""
    return OVER_TIME[one_of("series", series, OVER_TIME)].units
