"""The bodies of a mechanism: rotors, each a shaft with all on it, and housings with mass by their modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import overload

import numpy as np

from dynamics.bearings.seat import SEAT
from dynamics.identity_cache import identity_cached
from dynamics.joints import Housing
from dynamics.mechanism.rotor import Rotor
from dynamics.types import FloatArray
from host.optional_modules import linalg

ROUNDING = 1e-9
"""Coupling of two modes over the damping of both, below which it is rounding."""


@dataclass(frozen=True)
class _ModalHousing:
    """M = 1, C and K over m modal amplitudes, and the motion of s seats by them.

    All modes of the matrices are kept, so that static motions are those of the matrices.
    """

    name: str
    bearings: tuple[str, ...]
    """Names of the bearings that sit in the housing."""
    stiffness: FloatArray
    """Squares of the natural circular frequencies, rising, 1/s^2. Shape (m,)."""
    damping: FloatArray
    """Damping over the modal amplitudes, 1/s. Shape (m, m)."""
    shape: FloatArray
    """x, y, z (m), tilt_x, tilt_y (rad) of each seat per amplitude, of unit modal mass. Shape (s, 5, m)."""
    rows: FloatArray
    """Motion of every row of the housing's matrices per amplitude, modal coordinates among them. Shape
    (r, m).
    """

    @property
    def kinds(self) -> tuple[str, ...]:
        """Names of the amplitudes: mode_1, ... (m kg^1/2)."""
        return tuple(f"mode_{number + 1}" for number in range(self.stiffness.size))

    @property
    def frequency(self) -> FloatArray:
        """Natural frequencies, Hz."""
        return np.asarray(np.sqrt(self.stiffness) / (2.0 * np.pi))

    def seat(self, bearing: str) -> FloatArray:
        """Return the motion of the seat of `bearing`, (5, m)."""
        return np.asarray(self.shape[self.bearings.index(bearing)])


@identity_cached
def modal_housing(housing: Housing) -> _ModalHousing:
    """Return the modes of a housing with mass.

    They are those of M x = theta K x, in which the shapes reproduce the compliance: sum theta x x^T = K^-1 to
    rounding, however stiff the highest modes are.
    """
    mass, stiffness = _symmetric(housing.mass), _symmetric(housing.stiffness)
    unit = 1.0 / np.sqrt(np.diag(stiffness))
    theta, shape = linalg.eigh(unit[:, None] * mass * unit, unit[:, None] * stiffness * unit)
    theta, shape = theta[::-1], (unit[:, None] * shape / np.sqrt(theta))[:, ::-1]
    square = 1.0 / theta
    damping = np.diag(2.0 * housing.damping_ratio * np.sqrt(square))
    if housing.damping is not None:
        damping = shape.T @ _symmetric(housing.damping) @ shape
        root = np.sqrt(np.maximum(np.diag(damping), 0.0))
        damping = np.where(np.abs(damping) > ROUNDING * np.outer(root, root), damping, 0.0)
    seats = np.zeros((SEAT * len(housing.bushings), square.size))
    seats[list(housing.columns)] = shape[list(housing.matrix_columns)]
    of_seats = seats.reshape(-1, SEAT, square.size)
    return _ModalHousing(housing.name, housing.bushings, square, damping, of_seats, shape)


def _symmetric(matrix: object) -> FloatArray:
    values = np.array(matrix, dtype=float)
    return np.asarray(0.5 * (values + values.T))


@dataclass(frozen=True, eq=False)
class Bodies(Sequence[Rotor]):
    """A sequence of the rotors of a scene, one per shaft, with the housings whose modes are freedoms.

    `housings`: other housings have no mass: they are condensed into their bearings.
    """

    rotors: tuple[Rotor, ...]
    housings: tuple[_ModalHousing, ...] = ()

    @overload
    def __getitem__(self, index: int) -> Rotor: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Rotor, ...]: ...
    def __getitem__(self, index: int | slice) -> Rotor | tuple[Rotor, ...]:
        return self.rotors[index]

    def __len__(self) -> int:
        return len(self.rotors)

    @cached_property
    def first_of_housings(self) -> int:
        """Number of freedoms of the rotors: the amplitudes of the housings come behind them."""
        return 6 * len(self) + sum(rotor.elastic_count for rotor in self)

    @cached_property
    def freedoms(self) -> int:
        """Number of freedoms of all bodies."""
        return self.first_of_housings + sum(housing.stiffness.size for housing in self.housings)

    def housing_of(self, bearing: str) -> int | None:
        """Return the index of the housing that moves under `bearing`; None: nothing does."""
        return next((k for k, part in enumerate(self.housings) if bearing in part.bearings), None)
