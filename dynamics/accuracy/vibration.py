"""The vibration that fidelities are compared by: transmission errors and bearing forces, rms and orders."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.errors import InputError
from dynamics.motion.observation import observe
from dynamics.results.order_fit import order_amplitudes, orders_seen, unwrapped
from dynamics.types import FloatArray, IntArray

MOST_BLOCKS, ORDERS = 6, 5
LEAST_SAMPLES = 32
LEAST_PITCHES = 2.0


@dataclass(frozen=True)
class Vibration:
    """In B blocks of a run: m meshes, b bearings, n mesh orders (of the first mesh for bearings).

    Attributes
    ----------
    rms : (B, m) array
        Of the transmission error about its mean, m.
    error_orders : (B, m, n) array
        Amplitudes of the transmission errors, m.
    force_orders : (B, b, n) array
        Amplitudes of the bearing forces in their own frames, N: the norm over three directions. NaN where a
        model has none.
    """

    rms: FloatArray
    error_orders: FloatArray
    force_orders: FloatArray


@dataclass(frozen=True)
class Blocks:
    """The output grid that a run is compared on.

    Attributes
    ----------
    time : (T,) array
        Output grid, s.
    position : (m, T) array
        Of the meshes in the kinematic motion, unwrapped base pitches.
    bounds : (B, 2) int array
        First sample of each block, and the one behind its last.
    orders : int
    """

    time: FloatArray
    position: FloatArray
    bounds: IntArray
    orders: int

    @property
    def middle(self) -> FloatArray:
        """Time in the middle of each block, s."""
        return np.asarray(self.time[self.bounds.mean(axis=1).astype(int)])


def blocks_of(system: System) -> Blocks:
    """Cut the run of `system` into blocks of equal time.

    Raises
    ------
    InputError
        The run turns its first mesh by less than `LEAST_PITCHES`, or has too few samples a period.
    """
    rate, scene = system.sampling.rate, system.scene
    samples = math.floor(scene.duration * rate * (1.0 + 1e-12)) + 1
    time = np.arange(samples) / rate
    rest = np.zeros((samples, system.arrays.mass.shape[0]))
    position = unwrapped(observe(system.arrays, time, rest, rest).position[: len(scene.meshes)])
    ends = np.linspace(0, samples, MOST_BLOCKS + 1).astype(np.int64)
    bounds = np.stack([ends[:-1], ends[1:]], axis=1)
    turned = [abs(position[0, stop - 1] - position[0, first]) for first, stop in bounds]
    bounds = bounds[(np.array(turned) >= LEAST_PITCHES) & (np.diff(bounds, axis=1)[:, 0] >= LEAST_SAMPLES)]
    if bounds.size == 0:
        bounds = np.array([[0, samples]])
        if samples < LEAST_SAMPLES or abs(position[0, -1] - position[0, 0]) < LEAST_PITCHES:
            bound = f"long enough for {LEAST_PITCHES:g} base pitches and {LEAST_SAMPLES} samples"
            raise InputError("duration", scene.duration, bound, "Lengthen the run or raise its speed.")
    orders = min(orders_seen(line[bounds[0, 0] :], ORDERS) for line in position)
    if orders < 1:
        bound = "at least four samples a base pitch"
        raise InputError("outputs.sample_rate", rate, bound, "Raise it.")
    return Blocks(time, position, bounds, orders)


def vibration_of(blocks: Blocks, error: FloatArray, force: FloatArray) -> Vibration:
    """Return the vibration in transmission errors (m, T), m, and bearing forces (b, 3, T), N."""
    rms, by_error, by_force = [], [], []
    for first, stop in blocks.bounds:
        part = slice(int(first), int(stop))
        position, series = blocks.position[:, part], error[:, part]
        rms.append(series.std(axis=1))
        by_error.append(
            [order_amplitudes(at, line, blocks.orders) for at, line in zip(position, series, strict=True)]
        )
        by_force.append(
            np.linalg.norm(order_amplitudes(position[0], force[..., part], blocks.orders), axis=1)
        )
    return Vibration(np.array(rms), np.array(by_error), np.array(by_force))
