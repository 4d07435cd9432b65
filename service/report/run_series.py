"""What the figures of a run are drawn from: one mesh, all bearings, SI and base pitches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from service.report.figure import FloatArray


@dataclass(frozen=True)
class RunSeries:
    """Time series of a run, all on one uniform grid of n samples.

    Attributes
    ----------
    time : (n,) array
        s.
    speed : (n,) array
        Speed of the driving gear in rad/s, with its sign.
    position : (n,) array
        Position of the driving gear in base pitches, not wrapped.
    transmission_error, mesh_force : (n,) arrays
        Dynamic transmission error in m; transverse mesh force in N.
    nominal_force : float
        Transverse mesh force in N that the load asks for.
    teeth : int
        Of the driving gear.
    bearings : mapping of str to (n, 3) array
        Force on each bearing in N, x, y, z in the fixed frame.
    """

    time: FloatArray
    speed: FloatArray
    position: FloatArray
    transmission_error: FloatArray
    mesh_force: FloatArray
    nominal_force: float
    teeth: int
    bearings: Mapping[str, FloatArray]

    @property
    def speed_rpm(self) -> FloatArray:
        """Speed of the driving gear in rpm, without sign."""
        return np.abs(self.speed) * 30.0 / np.pi

    @property
    def mesh_frequency(self) -> FloatArray:
        """Mesh frequency in Hz."""
        return np.abs(self.speed) * self.teeth / (2.0 * np.pi)

    @property
    def loudest_bearing(self) -> str:
        """Name of the bearing whose force varies most over the run."""
        return max(self.bearings, key=lambda name: float(np.sum(np.var(self.bearings[name], axis=0))))
