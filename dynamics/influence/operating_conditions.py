"""The operating conditions of a run: its speeds and loads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.bodies import BySpeed, TimeLaw
from dynamics.scene import Scene
from dynamics.types import FloatArray

MOMENTS = 24
"""At which a run is looked at."""
LEAST_SPEED = 1e-9
"""Of the largest: what is slower is at rest."""
LOADS = 6
"""Loads at which a system is linearized where they vary along the run."""


@dataclass(frozen=True)
class OperatingCondition:
    """Speeds under one load.

    Attributes
    ----------
    time : float
        When the loads act, s.
    speed : (S,) array
        Of the leading law, rad/s, > 0, rising.
    rate : (S,) array
        How fast it changes, rad/s^2, >= 0.
    weight : (S,) array
        Part of the run at each, all conditions together 1.
    """

    time: float
    speed: FloatArray
    rate: FloatArray
    weight: FloatArray

    def passing(self, speed: FloatArray) -> OperatingCondition:
        """Return the condition with those of the speeds (k,) added that it passes, of no weight."""
        inside = speed[(speed > self.speed[0]) & (speed < self.speed[-1])]
        whole = np.concatenate([self.speed, inside])
        order = np.argsort(whole)
        rate = np.concatenate([self.rate, np.interp(inside, self.speed, self.rate)])
        weight = np.concatenate([self.weight, np.zeros(inside.size)])
        return OperatingCondition(self.time, whole[order], rate[order], weight[order])


def operating_conditions(scene: Scene, law: int, settled: float = 0.0) -> tuple[OperatingCondition, ...]:
    """Return what the run of `scene` passes from the part `settled` (0..1) of its duration on.

    `law` is the leading law. At rest nothing vibrates: such moments are
    left out.
    """
    share = (np.arange(MOMENTS) + 0.5) / MOMENTS
    time = scene.duration * (settled + (1.0 - settled) * share)
    speed = np.broadcast_to(np.abs(scene.references[law].speed(time)), time.shape)
    rate = np.abs(np.gradient(speed, time)) if scene.duration > 0.0 else np.zeros(time.size)
    moving = speed > LEAST_SPEED * np.max(speed, initial=0.0)
    time, speed, rate = time[moving], speed[moving], rate[moving]
    if not time.size:
        return ()
    parts = [np.arange(time.size)]
    if _loads_vary(scene, time):
        parts = np.array_split(np.arange(time.size), min(LOADS, time.size))
    return tuple(_condition(time[part], speed[part], rate[part], time.size) for part in parts)


def _condition(time: FloatArray, speed: FloatArray, rate: FloatArray, count: int) -> OperatingCondition:
    """Look at some moments of `count` together, their loads taken at the middle one."""
    once, first, times = np.unique(speed, return_index=True, return_counts=True)
    return OperatingCondition(float(time[time.size // 2]), once, rate[first], times / count)


def _loads_vary(scene: Scene, time: FloatArray) -> bool:
    """Whether torques change along the run."""
    courses = [force.course for force in scene.forces]
    laws: Sequence[object] = [
        *(load.torque(time) for load in scene.loads),
        *(course(time) for course in courses if isinstance(course, TimeLaw)),
    ]
    by_speed = bool(scene.speed_torques) or any(isinstance(course, BySpeed) for course in courses)
    return by_speed or any(np.ptp(np.asarray(law)) > 0.0 for law in laws)
