"""The turns of a shaft over time, from a channel of its speed, from pulses of a tacho, or from one speed."""

from __future__ import annotations

import numpy as np

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.signals.channel import Channel, FloatArray
from lineofaction.gearbox.signals.units import SPEED

_TURN = 2.0 * np.pi
HYSTERESIS = 0.25
"""Share of the span of a tacho's signal: the signal is low below the middle less this share, high above the
middle plus this share."""
FEWEST_PULSES = 8
_UNEVEN = 3.0
"""Ratio of a time between pulses to the time before. A larger ratio means that a pulse was lost or the shaft
stood still."""


def turns_of_speed(field: str, channel: Channel, unit: str, time: FloatArray) -> FloatArray:
    """Return the turns (T,) of a shaft at times (T,), s, from 0 at the first; the speed counts without sign.

    Raises `BadInput`: the channel measures no speed, does not cover the times, or changes its sign.
    """
    measured, speed = channel.measured(field, SPEED, unit)
    step = (time[-1] - time[0]) / (time.size - 1)
    if measured[0] > time[0] + step or measured[-1] < time[-1] - step:
        stretch = f"{measured[0]:.6g} to {measured[-1]:.6g} s"
        raise BadInput.of(
            field, f"{channel.name}: {stretch}", f"{time[0]:.6g} to {time[-1]:.6g} s, all of it"
        )
    if speed.min() < 0.0 < speed.max():
        bound = "a speed of one sign"
        raise BadInput.of(field, channel.name, bound, "Cut the recording where the shaft turns round.")
    grid = np.union1d(measured, time)
    frequency = np.abs(np.interp(grid, measured, speed)) / _TURN
    steps = 0.5 * np.diff(grid) * (frequency[1:] + frequency[:-1])
    turned = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(np.interp(time, grid, turned) - np.interp(time[0], grid, turned))


def turns_of_pulses(field: str, channel: Channel, per_turn: float, time: FloatArray) -> FloatArray:
    """Return the turns (T,) of a shaft at times (T,), s; NaN before the first pulse and after the last.

    A pulse is a rise through the middle of the signal, timed between samples. Raises `BadInput`: there are
    fewer than 8, or one is lost.
    """
    from scipy.interpolate import PchipInterpolator  # noqa: PLC0415 (start-up time)

    pulses = _rises(*channel.series(field))
    if pulses.size < FEWEST_PULSES:
        bound = f"a channel of at least {FEWEST_PULSES} pulses; it has {pulses.size}"
        raise BadInput.of(field, channel.name, bound, "Leave --pulses-per-turn out of a channel of speed.")
    between = np.diff(pulses)
    jumps = np.maximum(between[1:] / between[:-1], between[:-1] / between[1:])
    if jumps.max() > _UNEVEN:
        pulse = float(pulses[int(np.argmax(jumps)) + 1])
        bound = f"a channel of even pulses; near {pulse:.6g} s one is lost, or one too many"
        raise BadInput.of(field, channel.name, bound, "Cut the recording there.")
    turned = PchipInterpolator(pulses, np.arange(pulses.size) / per_turn, extrapolate=False)
    return np.asarray(turned(time), dtype=np.float64)


def _rises(time: FloatArray, values: FloatArray) -> FloatArray:
    """Return the times at which a signal rises through the middle, each after it was low."""
    low, high = float(values.min()), float(values.max())
    middle, margin = 0.5 * (low + high), HYSTERESIS * (high - low)
    state = np.where(values > middle + margin, 1, np.where(values < middle - margin, -1, 0))
    known = np.flatnonzero(state)
    turned = known[1:][(state[known[1:]] == 1) & (state[known[:-1]] == -1)]
    rises = []
    for last in turned:  # the sample that is high; the crossing lies in front of it
        first = last
        while values[first - 1] >= middle:
            first -= 1
        share = (middle - values[first - 1]) / (values[first] - values[first - 1])
        rises.append(time[first - 1] + share * (time[first] - time[first - 1]))
    return np.asarray(rises, dtype=np.float64)
