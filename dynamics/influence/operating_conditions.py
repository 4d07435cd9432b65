"""The operating conditions of a run: its speeds and loads.

A law sets the speed of a shaft over time: a drive, or the free rotation of a train without a drive. The
leading law is the first that turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dynamics.loads import BySpeed, TimeLaw
from dynamics.scene import Scene
from dynamics.types import FloatArray

MOMENTS = 24
"""Number of moments of a run at which its speeds and loads are taken."""


MIN_SPEED = 1e-9
"""Speed over the largest speed, below which a shaft is at rest."""


ORDERS = 24
"""Mesh orders that make the peak-to-peak value."""


LOADS = 6
"""Loads at which a system is linearized where they vary along the run."""

SPEEDS, FEWER = 32, 10
"""Numbers of speeds and mesh orders at which a response is computed, the same with and without an effect;
levels of runs have as many orders.
"""


@dataclass(frozen=True)
class OperatingCondition:
    """Speeds (S,) of the leading law, rad/s, > 0, rising, under the loads at a `time`, s.

    `rate` (S,) is how fast they change, rad/s^2, >= 0, `weight` (S,) the part of the run at each; all
    conditions together have 1. Between the speeds of its `span` (2,) the run passes all of them. Solved for
    are the mesh `orders` from 1 on.
    """

    time: float
    speed: FloatArray
    rate: FloatArray
    weight: FloatArray
    span: FloatArray
    orders: int = ORDERS

    def passing(self, speed: FloatArray) -> OperatingCondition:
        """Return the condition with the speeds (k,) within its span added, with weight 0."""
        inside = speed[(speed > self.span[0]) & (speed < self.span[1])]
        speeds = np.concatenate([self.speed, inside])
        order = np.argsort(speeds)
        rate = np.concatenate([self.rate, np.interp(inside, self.speed, self.rate)])
        weight = np.concatenate([self.weight, np.zeros(inside.size)])
        return replace(self, speed=speeds[order], rate=rate[order], weight=weight[order])


def operating_conditions(scene: Scene, law: int, settled: float = 0.0) -> tuple[OperatingCondition, ...]:
    """Return the conditions of the run of `scene` from the part `settled` (0..1) of its duration on.

    `law` is the leading law. At rest nothing vibrates: such moments are
    left out.
    """
    share = np.arange(2 * MOMENTS + 1) / (2 * MOMENTS)  # moments and the ends of their parts in turn
    time = scene.duration * (settled + (1.0 - settled) * share)
    speed = np.broadcast_to(np.abs(scene.references[law].speed(time)), time.shape)
    ends = np.sort(np.stack([speed[:-2:2], speed[2::2]]), axis=0)
    time, speed = time[1::2], speed[1::2]
    rate = np.abs(np.gradient(speed, time)) if scene.duration > 0.0 else np.zeros(time.size)
    moving = speed > MIN_SPEED * np.max(speed, initial=0.0)
    time, speed, rate, ends = time[moving], speed[moving], rate[moving], ends[:, moving]
    if not time.size:
        return ()
    parts = [np.arange(time.size)]
    if _loads_vary(scene, time):
        parts = np.array_split(np.arange(time.size), min(LOADS, time.size))
    conditions = []
    for part in parts:  # moments together, their loads taken at the middle one
        once, first, times = np.unique(speed[part], return_index=True, return_counts=True)
        middle = float(time[part][part.size // 2])
        span = np.array([ends[0, part].min(), ends[1, part].max()])
        conditions.append(OperatingCondition(middle, once, rate[part][first], times / time.size, span))
    return tuple(conditions)


def conditions_at(speed: FloatArray, time: float) -> tuple[OperatingCondition, ...]:
    """Return the conditions of a linear response at speeds (S,) > 0, rad/s: at most `SPEEDS` of them."""
    rising = np.unique(speed)
    chosen = rising[np.unique(np.linspace(0, rising.size - 1, min(SPEEDS, rising.size)).round().astype(int))]
    still, alike = np.zeros(chosen.size), np.full(chosen.size, 1.0 / chosen.size)
    return (OperatingCondition(time, chosen, still, alike, chosen[[0, -1]], FEWER),)


def _loads_vary(scene: Scene, time: FloatArray) -> bool:
    """Whether torques change along the run."""
    courses = [force.course for force in scene.forces]
    laws: Sequence[object] = [
        *(load.torque(time) for load in scene.loads),
        *(course(time) for course in courses if isinstance(course, TimeLaw)),
    ]
    by_speed = bool(scene.speed_torques) or any(isinstance(course, BySpeed) for course in courses)
    return by_speed or any(np.ptp(np.asarray(law)) > 0.0 for law in laws)
