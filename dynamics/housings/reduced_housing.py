"""A housing by the motion of its seats and a few modes: what it is, its response, its part in a scene."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.linalg import block_diag, eigh

from bounds import Quantity, Text
from dynamics.bearings.matrix import Matrix, matrix_rows
from dynamics.checks import not_negative
from dynamics.errors import InputError, ResultError
from dynamics.housings.rigid_body import RigidBody
from dynamics.housings.supports import SeatFrame
from dynamics.joints import Housing
from dynamics.types import FloatArray, IntArray
from dynamics.work_cost import WorkCost
from model_studies.netcdf import UnreadableFile
from model_studies.record_file import read_record, write_record

SCHEMA = "lineofaction reduced housing"
SINGULAR = 1e-14
"""Relative to the diagonal."""
VALID = 0.7
"""Of the highest frequency kept: to it a reduction follows the whole mesh within 1 %."""
PARALLEL = 1e-3
"""Sine of the angle to z from which a bore is no seat of a shaft along z."""


@dataclass(frozen=True)
class SurfaceMotion:
    """Motion of the surface."""

    points: FloatArray
    """m. Shape (p, 3)."""
    triangles: IntArray
    """Corners, counter-clockwise from outside, then mid-side nodes. Walls of inner cavities are among them.
    Shape (t, 6).
    """
    motion: FloatArray
    """Displacement of each point per reduced coordinate. Shape (p, 3, r)."""


@dataclass(frozen=True)
class PointMotion:
    """Motion of a named point: that of the node next to it, at `position` (m); `motion` is (3, r)."""

    name: str
    position: FloatArray
    motion: FloatArray


@dataclass(frozen=True)
class ReductionChecks:
    """Residuals of a reduction, each to be small against one."""

    volume: float
    """Mass by the mass matrix against that by the volume inside the surface, relative."""
    eigen: float
    """Largest residual of a mode, relative."""
    solve: float
    """Largest work of unbalanced forces on a deflection under a force on a seat, relative to the force's."""
    rigid_frequency: float
    """Highest frequency of a rigid motion over the first elastic mode; 0 if the housing is held."""
    seat_rigid: float
    """Largest deviation of the seats' motion from that of the body in a rigid motion, relative."""


@dataclass(frozen=True)
class ReducedHousing:
    """M x'' + C x' + K x = (f, 0): motions of the seats, then amplitudes of modes with the seats held."""

    mass: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    """`mass`, `stiffness`, `damping`: Symmetric; SI. Shape (r, r) each."""
    seats: tuple[SeatFrame, ...]
    """In the order of the coordinates: those of a seat are its `motions`, along its own axes."""
    frequency: FloatArray
    """Natural frequencies kept, with the seats free, Hz, rising; rigid motions first, as zeros. Shape (m,).
    """
    damping_ratio: FloatArray
    """Of these modes. Shape (m,)."""
    body: RigidBody | None = None
    """Of the mesh."""
    checks: ReductionChecks | None = None
    surface: SurfaceMotion | None = None
    points: tuple[PointMotion, ...] = ()
    mount_damping: FloatArray | None = None
    """What of `damping` is that of the mounts; None: nothing, or not known apart. Shape (r, r)."""
    mount_stiffness: FloatArray | None = None
    """What of `stiffness` is that of the mounts; the same. Shape (r, r)."""
    loss_factor: float | None = None
    """Of the material, where the rest of `damping` follows from it (`MaterialDamping`)."""
    cost: WorkCost | None = None
    """Of the reduction, predicted and measured; None: nobody measured it."""

    @property
    def motions(self) -> int:
        """Motions of all seats: the first coordinates."""
        return sum(len(seat.motions) for seat in self.seats)

    @property
    def valid_frequency(self) -> float:
        """Return the frequency in Hz up to which the modes kept carry the motion; 0 without modes."""
        return VALID * float(np.max(self.frequency, initial=0.0))

    @cached_property
    def modes(self) -> tuple[FloatArray, FloatArray]:
        """Circular frequencies in rad/s and modes of unit modal mass, (r, m), with the seats free.

        Motions without mass are left out. The first `len(frequency)` are modes of the housing; the rest carry
        what its higher modes give statically.
        """
        diagonal = np.diag(self.mass)
        scale = np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), 0.0)
        if np.linalg.eigvalsh(scale[:, None] * self.mass * scale)[0] > SINGULAR:
            square, shape = eigh(self.stiffness, self.mass)
            return np.sqrt(np.maximum(square, 0.0)), shape
        inverse, shape = eigh(self.mass, self.stiffness)  # massless motions are no modes
        moving = np.flatnonzero(inverse > SINGULAR * max(inverse[-1], SINGULAR))[::-1]
        return 1.0 / np.sqrt(inverse[moving]), shape[:, moving] / np.sqrt(inverse[moving])

    def to_netcdf(self, path: str | Path) -> None:
        """Write the housing; the file appears whole or not at all."""
        write_record(self, Path(path), SCHEMA)

    @classmethod
    def from_netcdf(cls, path: str | Path) -> ReducedHousing:
        """Read what `to_netcdf` wrote, bit by bit the same.

        Raises `ResultError`: the file is missing, damaged, or no reduced housing.
        """
        try:
            housing = read_record(Path(path), {SCHEMA: cls})
        except UnreadableFile as error:
            raise ResultError(str(error)) from error
        assert isinstance(housing, cls)
        return housing


def receptance(
    housing: ReducedHousing, frequency: Sequence[float] | FloatArray, *, residual: bool = True
) -> FloatArray:
    """Return the motion under unit harmonic forces on the seats.

    Raises `InputError`: a frequency is negative or no number.

    Parameters
    ----------
    frequency : (n,) array
        Hz.
    residual : bool
        Whether the flexibility of the modes that are not kept is in it; without it, the sum over the kept
        modes alone, for comparison: seats are too stiff then.

    Returns
    -------
    (n, r, s) complex array
        Reduced coordinates per force (m/N) or moment on the seats; the first s rows are the seats' motions.
        `SurfaceMotion.motion @` it and `PointMotion.motion @` it are displacements.
    """
    hertz = np.asarray(frequency, dtype=float)
    for index, value in enumerate(hertz):
        not_negative(f"frequency[{index}]", float(value))
    omega = 2.0 * math.pi * hertz[:, None, None]
    matrices = housing.mass, housing.damping, housing.stiffness
    if residual:  # coordinates of like size: they are meters, radians and modal amplitudes
        diagonal = np.diag(housing.stiffness)
        basis = np.diag(1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)))
    else:
        basis = housing.modes[1][:, : len(housing.frequency)]
    mass, damping, stiffness = (basis.T @ matrix @ basis for matrix in matrices)
    forces = basis[: housing.motions].T
    try:
        amplitude = np.linalg.solve(stiffness + 1j * omega * damping - omega**2 * mass, forces[None])
    except np.linalg.LinAlgError as error:
        remedy = "The housing moves freely there, or resonates without damping."
        raise InputError(
            "frequency", "singular", "off frequencies at which the motion is infinite", remedy
        ) from error
    return np.asarray(basis @ amplitude)


def scene_housing(housing: ReducedHousing, name: str, bushings: tuple[str, ...] | None = None) -> Housing:
    """Return a reduced housing for a scene; its mesh stands in the scene's frame, shafts along z.

    Raises `InputError`: a bore is not along z, the seats have different numbers of motions, or what `Housing`
    refuses.

    Parameters
    ----------
    housing : ReducedHousing
        Without mass it is one without modes.
    name : str
        Of the housing in the scene.
    bushings : tuple of str, optional
        Names of the bearings, in the order of the seats; by default those of the seats.
    """
    counts = {len(seat.motions) for seat in housing.seats}
    if len(counts) > 1:
        bound = "of as many motions each: 3, 5 or 6"
        raise InputError("seats", sorted(counts), bound, "Reduce the housing with the same motions for all.")
    turn = scene_axes(housing)
    massive, positions = bool(np.any(housing.mass)), (seat.position for seat in housing.seats)
    return Housing(
        name,
        tuple(seat.name for seat in housing.seats) if bushings is None else bushings,
        _turned(housing.stiffness, turn),
        _turned(housing.damping, turn) if massive or np.any(housing.damping) else None,
        _turned(housing.mass, turn) if massive else None,
        modal_coordinates=len(housing.stiffness) - housing.motions,
        seat_positions=tuple((float(x), float(y), float(z)) for x, y, z in positions),
    )


def scene_axes(housing: ReducedHousing) -> FloatArray:
    """Return the reduced coordinates per row of the matrices of its `scene_housing`, (r, r)."""
    coordinates = len(housing.stiffness) - housing.motions
    return np.asarray(block_diag(*(_turn(seat) for seat in housing.seats), np.eye(coordinates)))


def _turn(seat: SeatFrame) -> FloatArray:
    """Return the motions along the seat's axes per those along the scene's, (p, p)."""
    off = math.hypot(float(seat.axes[0, 2]), float(seat.axes[1, 2]))
    if off > PARALLEL:
        angle = Quantity(math.asin(min(off, 1.0)), "rad", digits=3)
        bound = Text.of("along z, as the shafts of a scene; its bore is off by ", angle)
        raise InputError(f"seats.{seat.name}", "not along z", bound, "Turn the mesh.")
    rotation = np.kron(np.eye(2), seat.axes.T)
    return np.asarray(rotation[: len(seat.motions), : len(seat.motions)])


def _turned(matrix: FloatArray, turn: FloatArray) -> Matrix:
    """Return the rows of a matrix over motions along the scene's axes; unchanged where they are the same."""
    rotated = matrix if np.array_equal(turn, np.eye(len(turn))) else turn.T @ matrix @ turn
    return matrix_rows(rotated)


@dataclass(frozen=True)
class SurfaceHousing:
    """A housing with a surface: its name, its reduction, and the bearings in the order of its seats."""

    name: str
    body: ReducedHousing
    bearings: tuple[str, ...]
