"""Motion of a unit in a result: its shafts along their axes and the surface of its housing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dynamics.types import ComplexArray, FloatArray, IntArray

if TYPE_CHECKING:
    from dynamics.vibration import SurfaceShape


@dataclass(frozen=True)
class UnitMotion:
    """Complex amplitudes of the motion of a unit about where it stands: their real part at phase 0."""

    shafts: tuple[str, ...]
    shaft: IntArray
    """Index of the shaft of each point of an axis. Shape (P,)."""
    position: FloatArray
    """Position of each point along its shaft, m, increasing within a shaft. Shape (P,)."""
    motion: ComplexArray
    """x, y, z (m), tilt_x, tilt_y, rotation (rad). Shape (P, 6)."""
    oscillates: bool
    """Whether the phase runs; a deflection rests."""
    surface: SurfaceShape | None = None
    """Motion of the surface of a housing, m; None: no housing has a surface."""
    is_velocity: bool = False
    """Whether the surface's motion is its velocity, m/s, which has levels; else a shape without a size."""

    @staticmethod
    def of_surface(surface: SurfaceShape, *, is_velocity: bool) -> UnitMotion:
        """Return the motion of a surface alone."""
        no_shafts = np.empty(0, dtype=np.int64), np.empty(0), np.empty((0, 6), dtype=complex)
        return UnitMotion((), *no_shafts, oscillates=True, surface=surface, is_velocity=is_velocity)

    def at_stations(self, count: int) -> dict[str, tuple[FloatArray, ComplexArray]]:
        """Return stations evenly spaced along each shaft, m, and the motion there, (count, 6)."""
        sampled = {}
        for index, name in enumerate(self.shafts):
            of_shaft = self.shaft == index
            known, motion = self.position[of_shaft], self.motion[of_shaft]
            along = np.linspace(known[0], known[-1], count)
            columns = [np.interp(along, known, column) for column in motion.T]
            sampled[name] = along, np.stack(columns, axis=-1)
        return sampled


@dataclass(frozen=True)
class OfferedMotion:
    """A motion of a result: its group, its name, and the function that makes it."""

    group: str
    name: str
    made: Callable[[], UnitMotion]


def chosen_rows(count: int, maximum: int) -> Sequence[int]:
    """Return at most `maximum` of `count` rows, evenly spread, the first and the last among them."""
    return sorted(set(np.linspace(0, count - 1, min(count, maximum)).round().astype(int).tolist()))
