"""Force waves over speed and torque: the table of a machine, and its interpolation."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from dynamics.checks import increasing, not_negative, within
from dynamics.force_waves.waves import ForceWaves, check_orders, check_pressures
from dynamics.results.array_file import ArrayFile, stored
from dynamics.types import ComplexArray, FloatArray, IntArray

_OUTSIDE = "The table is not extended. Compute the machine there and add the rows."


@dataclass(frozen=True, eq=False)
class ForceWaveTable(ArrayFile):
    """Complex amplitudes of W waves at S speeds and M torques; signs and phases as in `ForceWaves`.

    Raises `InputError`: orders that are none or stand there twice, axes that do not increase, a negative
    speed, pressures of another shape or not finite.
    """

    SCHEMA: ClassVar[str] = "lineofaction force waves 1"

    temporal_order: IntArray = field(metadata=stored("1", "periods per revolution of the rotor", "wave"))
    """Temporal order k >= 0. Shape (W,)."""
    spatial_order: IntArray = field(
        metadata=stored("1", "periods around the bore, > 0 with the rotor", "wave")
    )
    """Spatial order r. Shape (W,)."""
    speed: FloatArray = field(metadata=stored("rad s-1", "speed of the rotor", "speed"))
    """Speeds, rad/s, increasing, >= 0. Shape (S,)."""
    torque: FloatArray = field(metadata=stored("N m", "torque of the machine", "torque"))
    """Torques, N m, increasing. Shape (M,)."""
    radial: ComplexArray = field(
        metadata=stored("Pa", "radial pressure on the rotor", "wave", "speed", "torque")
    )
    """Amplitudes A exp(i psi) of the radial pressure, Pa. Shape (W, S, M)."""
    tangential: ComplexArray = field(
        metadata=stored("Pa", "tangential pressure on the rotor", "wave", "speed", "torque")
    )
    """Amplitudes A exp(i psi) of the tangential pressure, Pa. Shape (W, S, M)."""

    def __post_init__(self) -> None:
        check_orders(self.temporal_order, self.spatial_order)
        axes = {name: increasing(name, getattr(self, name)) for name in ("speed", "torque")}
        not_negative("speed[0]", axes["speed"][0])
        shape = (len(self.temporal_order), len(axes["speed"]), len(axes["torque"]))
        for name in ("radial", "tangential"):
            check_pressures(name, np.asarray(getattr(self, name), dtype=complex), shape)
        for name, declared in self.arrays().items():
            kind = {"1": int, "Pa": complex}.get(declared.units, float)
            values: np.ndarray = np.array(getattr(self, name), dtype=kind)
            values.flags.writeable = False
            object.__setattr__(self, name, values)

    def at(self, speed: float, torque: float) -> ForceWaves:
        """Return the waves at a speed (rad/s) and a torque (N m).

        Complex amplitudes are interpolated linearly along both axes, so that phases need no unwrapping.
        Between two nodes whose phases differ, the amplitude is smaller than theirs. Raises `InputError`: a
        speed or a torque outside the table, which is not extended.
        """
        speed = within("speed", speed, self.speed[0], self.speed[-1], _OUTSIDE)
        torque = within("torque", torque, self.torque[0], self.torque[-1], _OUTSIDE)
        weight = np.multiply.outer(_weights(self.speed, speed), _weights(self.torque, torque))
        return ForceWaves(
            self.temporal_order,
            self.spatial_order,
            np.einsum("wsm,sm->w", self.radial, weight),
            np.einsum("wsm,sm->w", self.tangential, weight),
            speed,
            torque,
        )


def _weights(axis: FloatArray, value: float) -> FloatArray:
    """Return the shares (n,) of the nodes of an axis in the linear interpolation at a value."""
    return np.array([np.interp(value, axis, node) for node in np.eye(axis.size)])
