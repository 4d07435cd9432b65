"""The step error of a whole run, measured against a run at a tenth of its tolerance.

Usually short windows of a run are run again. They start from the state of the run, so they see no error that
this state carries. It carries those of all impacts, and of the whole past where vibration decays slowly. A
motion in which such an error grows to a tenth of the vibration and stays there is chaotic: its trace is one
random sample of many, so that errors are stated for its levels and peaks instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from bounds import engineering
from dynamics.assembly.assemble import System
from dynamics.integrators.march import Ending
from dynamics.integrators.method_choice import MethodChoice
from dynamics.integrators.state_sink import blocks
from dynamics.motion.sampled_states import States
from dynamics.results.order_fit import order_amplitudes, orders_seen
from dynamics.scene import Integration
from dynamics.simulation.documents import with_longest_step
from dynamics.simulation.error_by_source import CAP, observed_signals, window_seconds
from dynamics.types import FloatArray, Json

StatesOf = Callable[[int, int], States]

TOLERANCE_SHARE, STEP_SHARE = 0.1, 0.5
"""Tolerance and stated step of the finer run, over those of the run."""
REST = {True: 1.0 / (1.0 - TOLERANCE_SHARE**0.75), False: 1.0 / (1.0 - STEP_SHARE**2)}
"""Error over the difference to the finer run, by whether steps are adaptive.

The error falls as the tolerance^(3/4), or as the step^2 where forces jump. Measured over 12 scenes with
impacts or light damping, adaptive: 0.7 to 1.1."""
PARTS, PART_SAMPLES, ORDERS = 6, 4096, 5
"""Number of equal parts of a run, most samples at the end of each that orders are fitted to, and number of
these orders.
"""
CHAOTIC, GROWTH = 0.1, 100.0
"""Difference over the vibration and over the tolerance, in half of the parts, where a motion is chaotic.

In units of the vibration it is 0.12 to 0.3 in all parts of five rattles that are chaotic, and below 0.002 in
three others; chaos that dies out has 0.26 in the first part alone, forty undamped impacts 0.1 in the last."""
SPREAD = 2.45
"""Standard errors that cover 95 % of means over 6 parts (Student's t)."""


def blind_windows(system: System, choice: MethodChoice, states_of: StatesOf, end: Ending) -> str:
    """Return why windows of a run cannot see the error of its steps; empty: they can, or none is wanted."""
    scene = system.scene
    if not scene.meshes:
        return ""
    if scene.integration.estimate_error:
        return "requested"
    if scene.outputs.receipt != "full":
        return ""
    for block in blocks(end.samples):
        if np.any(states_of(*block).minimum[:, system.driving_rows] <= 0.0):
            return "flanks part"
    if outlives_windows(system, choice):
        decay = engineering(choice.slowest_decay, 2)
        return f"vibration decays at {decay} 1/s, slower than windows can see"
    return ""


def outlives_windows(system: System, choice: MethodChoice) -> bool:
    """Whether a lightly damped motion that meshes excite decays more slowly than a window of a run lasts."""
    return choice.slowest_decay * window_seconds(system) < 1.0


def finer_run(integration: Integration, end: Ending) -> Integration:
    """Return the settings of the run that the error of a run is measured against."""
    if integration.fixed_step is not None:
        return replace(integration, fixed_step=STEP_SHARE * integration.fixed_step)
    finer = replace(integration, tolerance=TOLERANCE_SHARE * integration.tolerance)
    longest = float(end.step_range[1])
    return with_longest_step(finer, CAP * longest) if longest > 0.0 else finer


@dataclass(frozen=True)
class _Traces:
    """A part of two runs; m meshes, both runs along the first axis of pairs."""

    square: FloatArray
    """Mean square of the difference of the transmission errors, m^2. Shape (m,)."""
    power: FloatArray
    """Mean square of the transmission errors about their means, m^2. Shape (2, m)."""
    peak: FloatArray
    """Largest forces of the driving flanks, N. Shape (2, m)."""


@dataclass(frozen=True)
class _Orders:
    """Amplitudes at K orders of the first mesh at the end of a part of two runs; m meshes, b bearings."""

    error: FloatArray
    error_difference: FloatArray
    """`error`, `error_difference`: Amplitudes of the transmission errors, and of their difference, m.
    (2, m, K) and (m, K) arrays.
    """
    force: FloatArray
    force_difference: FloatArray
    """`force`, `force_difference`: Amplitudes of the bearing forces, and of their difference, norms over
    three directions, N. (2, b, K) and (b, K) arrays.
    """


@dataclass(frozen=True)
class RunPair:
    """The samples of a run and of a finer one of the same system."""

    system: System
    run: StatesOf
    finer: StatesOf
    samples: int

    def error(self, reason: str) -> Json:
        """Return the error of the steps: of the traces of the run, or of its levels where it is chaotic."""
        integration = self.system.scene.integration
        traces = [self._traces(*part) for part in self._parts()]
        orders = [self._orders(*part) for part in self._parts()]
        adaptive = integration.fixed_step is None
        error = _trace_errors(traces, orders, REST[adaptive])
        compared = f"a run at {TOLERANCE_SHARE:g} of the tolerance" if adaptive else "a run at half the step"
        source = f"difference from {compared}"
        if _is_chaotic(traces, integration):
            error = {"trace_rms": error["rms"], **_level_errors(traces, orders)}
            source = f"chaotic motion: levels of {PARTS} parts against those of {compared}"
        chaotic = "trace_rms" in error
        units = {"unit": "m", "bearing_force_unit": "N"}
        return {**error, **units, "source": source, "reason": reason, "chaotic": chaotic}

    def _parts(self) -> Iterator[tuple[int, int]]:
        count = max(min(PARTS, self.samples), 1)
        bounds = np.linspace(0, self.samples, count + 1).astype(int).tolist()
        return pairwise(bounds)

    def _traces(self, first: int, stop: int) -> _Traces:
        rows = self.system.driving_rows
        square, mean, power = np.zeros(rows.size), np.zeros((2, rows.size)), np.zeros((2, rows.size))
        peak = np.zeros((2, rows.size))
        for start, end in blocks(stop - first):
            pair = [of(first + start, first + end) for of in (self.run, self.finer)]
            trace = np.array([self._transmission_error(states.q) for states in pair])
            square += np.sum((trace[0] - trace[1]) ** 2, axis=0)
            mean += np.sum(trace, axis=1)
            power += np.sum(trace**2, axis=1)
            highest = [np.max(states.largest[:, rows], axis=0, initial=0.0) for states in pair]
            peak = np.maximum(peak, highest)
        count = max(stop - first, 1)
        return _Traces(square / count, np.maximum(power / count - (mean / count) ** 2, 0.0), peak)

    def _transmission_error(self, q: FloatArray) -> FloatArray:
        """Return deviations (T, m), m, of `q` (T, n), whose end may lack the amplitudes of housings."""
        return np.asarray(q @ self.system.arrays.direction[self.system.driving_rows, : q.shape[1]].T)

    def _orders(self, first: int, stop: int) -> _Orders:
        first = max(first, stop - PART_SAMPLES)
        time = np.arange(first, stop) / self.system.sampling.rate
        position, error, force = observed_signals(self.system, time, self.run(first, stop))
        _, finer_error, finer_force = observed_signals(self.system, time, self.finer(first, stop))
        count = min((orders_seen(at, ORDERS) for at in position), default=0)
        if stop - first < 2 or np.ptp(position[0]) < 1.0:
            count = 0
        traces = np.array([error, finer_error, error - finer_error])
        by_mesh = [order_amplitudes(at, traces[:, m], count) for m, at in enumerate(position)]
        by_error = np.stack(by_mesh, axis=1)
        forces = np.array([force, finer_force, force - finer_force])
        by_force = np.linalg.norm(order_amplitudes(position[0], forces, count), axis=2)
        return _Orders(by_error[:2], by_error[2], by_force[:2], by_force[2])


def _is_chaotic(traces: Sequence[_Traces], integration: Integration) -> bool:
    """Whether errors within the tolerance grow far beyond it, to a part of the vibration, and stay there."""
    if integration.fixed_step is not None:
        return False
    square = np.array([part.square for part in traces])
    power = np.array([part.power[0] for part in traces])
    large = square >= np.maximum(CHAOTIC**2 * power, (GROWTH * integration.tolerance) ** 2)
    return bool(np.any(np.mean(large, axis=0) >= 0.5))


def _trace_errors(traces: Sequence[_Traces], orders: Sequence[_Orders], rest: float) -> Json:
    """Return `rest` times the rms of the differences, and times their worst amplitudes at orders."""
    square = float(np.mean([part.square for part in traces]))
    return {
        "rms": rest * math.sqrt(square),
        "transmission_error_orders": _worst([rest * part.error_difference for part in orders]),
        "bearing_force_orders": _worst([rest * part.force_difference for part in orders]),
    }


def _worst(amplitudes: Sequence[FloatArray]) -> list[float]:
    """Return the largest of the amplitudes (m, K) at each order that all parts have."""
    count = min(part.shape[1] for part in amplitudes)
    if not amplitudes[0].shape[0]:
        return [0.0] * count
    return [float(value) for value in np.max([part[:, :count] for part in amplitudes], axis=(0, 1))]


def _level_errors(traces: Sequence[_Traces], orders: Sequence[_Orders]) -> Json:
    """Return the errors of mean squares over the run, as amplitudes and in dB, and of the largest forces."""
    count = min(part.error.shape[2] for part in orders)
    rms, rms_level = level_error(np.array([part.power for part in traces]))
    by_error, error_level = level_error(np.array([part.error[..., :count] ** 2 for part in orders]))
    by_force, force_level = level_error(np.array([part.force[..., :count] ** 2 for part in orders]))
    peak = np.array([part.peak for part in traces])
    spread = SPREAD * np.std(peak, axis=(0, 1))
    highest = np.max(peak[:, 0], axis=0, initial=0.0)
    peak_level = 20.0 * np.log10(1.0 + spread / np.where(highest > 0.0, highest, 1.0))
    return {
        "rms": float(np.max(rms)),
        "transmission_error_orders": np.max(by_error, axis=0).tolist(),
        "bearing_force_orders": np.max(by_force, axis=0, initial=0.0).tolist(),
        "levels": {
            "unit": "dB",
            "rms": float(np.max(rms_level)),
            "peak_force": float(np.max(peak_level)),
            "transmission_error_orders": np.max(error_level, axis=0).tolist(),
            "bearing_force_orders": np.max(force_level, axis=0, initial=0.0).tolist(),
        },
    }


def level_error(power: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the errors of the mean of `power` (B, 2, ...) over B parts, as amplitudes and as levels in dB.

    Two runs of a chaotic motion are two random samples of it: their difference in a part has twice the
    variance of the power there. The difference of the run from the truth, a third sample, has the same.
    """
    mean = np.mean(power[:, 0], axis=0)
    spread = SPREAD * np.sqrt(np.mean((power[:, 0] - power[:, 1]) ** 2, axis=0) / len(power))
    amplitude = np.sqrt(mean + spread) - np.sqrt(mean)
    return amplitude, 10.0 * np.log10(1.0 + spread / np.where(mean > 0.0, mean, np.inf))
