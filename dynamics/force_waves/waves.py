"""Force waves at one speed and one torque.

Conventions. phi is the angle about the axis of the machine, from x to y, in a frame that does not rotate. The
rotor turns towards +phi at the speed Omega >= 0. A wave of temporal order k >= 0 and spatial order r is

    p(phi, t) = A cos(r phi - k Omega t + psi) = Re[P exp(i (r phi - k Omega t))],   P = A exp(i psi).

r > 0 travels with the rotor, r < 0 against it, r = 0 pulsates. The pressure is the traction on the rotor, as
Maxwell's stress gives it: radial > 0 outwards (the air gap pulls), tangential > 0 towards +phi. The bore of
the stator takes the opposite. W counts waves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.checks import finite, integer, not_negative
from dynamics.errors import InputError
from dynamics.types import ComplexArray, FloatArray, IntArray

MAX_ORDER = 10_000
"""Largest temporal or spatial order."""
_STATIC = "Write a static pattern (temporal order 0) with spatial order >= 0 and the opposite phase."


@dataclass(frozen=True, eq=False)
class ForceWaves:
    """The waves of a machine at one speed and one torque.

    Raises `InputError`: orders that are none or stand there twice, pressures that are not finite.
    """

    temporal_order: IntArray
    """Temporal order k: periods per revolution of the rotor. Shape (W,)."""
    spatial_order: IntArray
    """Spatial order r: periods around the bore; negative: travels against the rotor. Shape (W,)."""
    radial: ComplexArray
    """Amplitudes P of the radial pressure on the rotor, Pa. Shape (W,)."""
    tangential: ComplexArray
    """Amplitudes P of the tangential pressure on the rotor, Pa. Shape (W,)."""
    speed: float
    """Speed of the rotor, rad/s."""
    torque: float
    """Torque at which the pressures are stated, N m."""

    def __post_init__(self) -> None:
        check_orders(self.temporal_order, self.spatial_order)
        not_negative("speed", self.speed)
        finite("torque", self.torque)
        for name in ("radial", "tangential"):
            values = np.array(getattr(self, name), dtype=complex)
            check_pressures(name, values, (len(self.temporal_order),))
            values.flags.writeable = False
            object.__setattr__(self, name, values)

    @property
    def frequency(self) -> FloatArray:
        """Frequencies of the waves in the frame that does not rotate, Hz. Shape (W,)."""
        return np.asarray(self.temporal_order * self.speed / (2.0 * np.pi))

    def pressure(self, angle: FloatArray, time: float) -> tuple[FloatArray, FloatArray]:
        """Return radial and tangential pressure, Pa, (N,) each, at angles (N,) in rad and a time in s."""
        turns = np.multiply.outer(np.asarray(angle, dtype=float), self.spatial_order)
        pattern = np.exp(1j * (turns - self.temporal_order * self.speed * time))
        return np.real(pattern @ self.radial), np.real(pattern @ self.tangential)

    def rotated(self, angle: float) -> ForceWaves:
        """Return the waves in a frame whose x axis lies at `angle` (rad): a phase grows by r angle."""
        turn = np.exp(1j * self.spatial_order * finite("angle", angle))
        return replace(self, radial=self.radial * turn, tangential=self.tangential * turn)


def check_orders(temporal: IntArray, spatial: IntArray) -> None:
    """Refuse orders that are no integers in their bounds, or a pair of them that stands there twice."""
    if len(temporal) == 0 or len(spatial) != len(temporal):
        raise InputError(
            "spatial_order", len(spatial), f"as many as temporal orders ({len(temporal)}), 1 at least"
        )
    known: set[tuple[int, int]] = set()
    for index, (k, r) in enumerate(zip(temporal, spatial, strict=True)):
        integer(f"temporal_order[{index}]", k, 0, MAX_ORDER)
        integer(
            f"spatial_order[{index}]", r, 0 if k == 0 else -MAX_ORDER, MAX_ORDER, _STATIC if k == 0 else ""
        )
        if (int(k), int(r)) in known:
            raise InputError(
                f"spatial_order[{index}]", r, "of another wave than those before it", "Give each once."
            )
        known.add((int(k), int(r)))


def check_pressures(name: str, values: ComplexArray, shape: tuple[int, ...]) -> None:
    """Refuse amplitudes of another shape, or that are not finite."""
    if values.shape != shape:
        raise InputError(name, str(values.shape), f"of the shape {shape}")
    if not np.all(np.isfinite(values)):
        raise InputError(name, None, "finite pressures")
