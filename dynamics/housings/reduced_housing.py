"""A housing reduced to the motions of its seats and a few modes; its response, and its part in a scene.

Its r reduced coordinates are the motions of its bearing seats (`ReducedHousing.motions` of them), then
amplitudes of modes with the seats held. `frequency` belongs to other modes, m of them: those of the reduced
housing with its seats free. In a scene the motions are along the scene's axes instead of the seats' own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from bounds import Quantity, Text
from dynamics.bearings.matrix import Matrix, matrix_rows
from dynamics.checks import not_negative
from dynamics.errors import InputError, ResultError
from dynamics.housings.rigid_body import RigidBody
from dynamics.housings.supports import SeatFrame
from dynamics.joints import Housing
from dynamics.types import FloatArray, IntArray
from dynamics.work_cost import WorkCost
from host.optional_modules import linalg
from model_studies.netcdf import UnreadableFile
from model_studies.record_file import read_record, write_record

SCHEMA = "lineofaction reduced housing"
SINGULAR = 1e-14
"""Smallest eigenvalue of a matrix with a diagonal of ones that counts as more than rounding."""
VALID = 0.7
"""Share of the highest natural frequency up to which a reduction follows the whole mesh within 1 %."""
PARALLEL = 1e-3
"""Largest sine of the angle between a bore and z for which the bore can be the seat of a shaft along z."""


@dataclass(frozen=True)
class SurfaceMotion:
    """The surface of a housing, and its motion by the reduced coordinates."""

    points: FloatArray
    """Nodes of the surface, m. Shape (p, 3)."""
    triangles: IntArray
    """Points of every triangle: corners, counter-clockwise seen from outside, then mid-side nodes. Walls of
    inner cavities belong to the surface. Shape (t, 6).
    """
    motion: FloatArray
    """Displacement of each point per reduced coordinate. Shape (p, 3, r)."""


@dataclass(frozen=True)
class PointMotion:
    """A named point, and its displacement by the reduced coordinates: that of the node nearest to the point.

    `position` (3,) in m is that of the node; `motion` is (3, r).
    """

    name: str
    position: FloatArray
    motion: FloatArray


@dataclass(frozen=True)
class ReductionChecks:
    """Relative residuals of a reduction; all are small against one if the reduction is sound."""

    volume: float
    """Mass by the mass matrix less mass by the volume inside the surface, over the mass."""
    eigen: float
    """Largest residual of the eigenvalue problem in a mode."""
    solve: float
    """Largest work of the forces left unbalanced under a force on a seat, over the work of that force."""
    rigid_frequency: float
    """Highest frequency of a rigid motion over that of the first elastic mode; 0 if the housing is held."""
    seat_rigid: float
    """Largest deviation of the motion of a seat from that of the body in a rigid motion."""


@dataclass(frozen=True)
class ReducedHousing:
    """A housing by M x'' + C x' + K x = (f, 0), with the forces and moments f on its seats.

    The coordinates x are the motions of the seats, then the amplitudes of modes with the seats held.
    """

    mass: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    """`mass`, `stiffness`, `damping`: Symmetric matrices M, K, C in SI units. Shape (r, r) each."""
    seats: tuple[SeatFrame, ...]
    """Seats in the order of their coordinates; those of a seat are its `motions`, along its own axes."""
    frequency: FloatArray
    """Natural frequencies with the seats free, Hz, rising; rigid motions come first, as zeros. Shape (m,)."""
    damping_ratio: FloatArray
    """Damping ratios of the modes of `frequency`. Shape (m,)."""
    body: RigidBody | None = None
    """Rigid body of the whole mesh; None: not known."""
    checks: ReductionChecks | None = None
    surface: SurfaceMotion | None = None
    points: tuple[PointMotion, ...] = ()
    mount_damping: FloatArray | None = None
    """Part of `damping` from the elastic mounts; None: there is none, or it is not known. Shape (r, r)."""
    mount_stiffness: FloatArray | None = None
    """Part of `stiffness` from the elastic mounts; None: there is none, or it is not known. Shape (r, r)."""
    loss_factor: float | None = None
    """Loss factor of the material from which the rest of `damping` follows (`MaterialDamping`)."""
    cost: WorkCost | None = None
    """Cost of the reduction, predicted and measured; None: it was not measured."""

    @property
    def motions(self) -> int:
        """Number of the motions of all seats, which are the first coordinates."""
        return sum(len(seat.motions) for seat in self.seats)

    @property
    def valid_frequency(self) -> float:
        """Frequency in Hz up to which the reduction follows the whole mesh; 0 without modes."""
        return VALID * float(np.max(self.frequency, initial=0.0))

    @cached_property
    def modes(self) -> tuple[FloatArray, FloatArray]:
        """Circular frequencies in rad/s and modes of unit modal mass, (r, m), with the seats free.

        Motions without mass are left out. The first `len(frequency)` are modes of the housing; the rest have
        the static flexibility of those modes that the reduction has left out.
        """
        diagonal = np.diag(self.mass)
        scale = np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), 0.0)
        # Coordinates are meters, radians and amplitudes: only scaled to ones on the diagonal can eigenvalues
        # tell whether the mass matrix is regular.
        if np.linalg.eigvalsh(scale[:, None] * self.mass * scale)[0] > SINGULAR:
            square, shape = linalg.eigh(self.stiffness, self.mass)
            return np.sqrt(np.maximum(square, 0.0)), shape
        # A singular mass matrix: 1/omega^2 are the eigenvalues, and 0 for motions without mass. These are
        # left out; the reversal makes the frequencies rise. `SINGULAR` in `max` is for a mass of zero.
        inverse, shape = linalg.eigh(self.mass, self.stiffness)
        moving = np.flatnonzero(inverse > SINGULAR * max(inverse[-1], SINGULAR))[::-1]
        return 1.0 / np.sqrt(inverse[moving]), shape[:, moving] / np.sqrt(inverse[moving])

    def to_netcdf(self, path: str | Path) -> None:
        """Write the housing to a netCDF file; the file appears whole or not at all."""
        write_record(self, Path(path), SCHEMA)

    @classmethod
    def from_netcdf(cls, path: str | Path) -> ReducedHousing:
        """Return the housing that `to_netcdf` wrote, the same to the last bit.

        Raises `ResultError` if the file is missing, damaged, or not that of a reduced housing.
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
    """Return the complex motion under unit harmonic forces on the seats.

    Raises `InputError` if a frequency is negative or no number, or if the motion is infinite there.

    Parameters
    ----------
    frequency : (n,) array
        Frequencies, Hz.
    residual : bool
        Whether the static flexibility of the modes left out is included. Without it the motion is the sum
        over the modes of `frequency` alone, in which seats are too stiff; it is for comparison.

    Returns
    -------
    (n, r, s) complex array
        Reduced coordinates per force (m/N) or moment on the seats, in the s motions of the seats; the first s
        rows are these motions. `SurfaceMotion.motion @ receptance` and `PointMotion.motion @ receptance` are
        displacements per force.
    """
    hertz = np.asarray(frequency, dtype=float)
    for index, value in enumerate(hertz):
        not_negative(f"frequency[{index}]", float(value))
    omega = 2.0 * math.pi * hertz[:, None, None]
    # The basis: all coordinates, scaled to like size since they are meters, radians and amplitudes; or modes.
    if residual:
        diagonal = np.diag(housing.stiffness)
        basis = np.diag(1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)))
    else:
        _, shapes = housing.modes
        basis = shapes[:, : len(housing.frequency)]
    mass = basis.T @ housing.mass @ basis
    damping = basis.T @ housing.damping @ basis
    stiffness = basis.T @ housing.stiffness @ basis
    forces = basis[: housing.motions].T
    dynamic_stiffness = stiffness + 1j * omega * damping - omega**2 * mass  # (n, basis, basis)
    try:
        amplitude = np.linalg.solve(dynamic_stiffness, forces[None])  # the same forces at all frequencies
    except np.linalg.LinAlgError as error:
        remedy = "The housing moves freely there, or resonates without damping."
        raise InputError(
            "frequency", "singular", "off frequencies at which the motion is infinite", remedy
        ) from error
    return np.asarray(basis @ amplitude)


def scene_housing(housing: ReducedHousing, name: str, bushings: tuple[str, ...] | None = None) -> Housing:
    """Return a reduced housing as the `Housing` of a scene, with its motions along the scene's axes.

    The housing's mesh has to stand in the frame of the scene, with the shafts along z. Raises `InputError` if
    a bore is not along z, if the seats have different numbers of motions, or if `Housing` refuses a value.

    Parameters
    ----------
    housing : ReducedHousing
        A reduced housing without mass gives a housing without modes.
    name : str
        Name of the housing in the scene.
    bushings : tuple of str, optional
        Names of the bearings, in the order of the seats; by default the names of the seats.
    """
    counts = {len(seat.motions) for seat in housing.seats}
    if len(counts) > 1:
        bound = "of as many motions each: 3, 5 or 6"
        raise InputError("seats", sorted(counts), bound, "Reduce the housing with the same motions for all.")
    axes = scene_axes(housing)
    has_mass = bool(np.any(housing.mass))
    positions = [seat.position for seat in housing.seats]
    return Housing(
        name,
        tuple(seat.name for seat in housing.seats) if bushings is None else bushings,
        _along_scene_axes(housing.stiffness, axes),
        _along_scene_axes(housing.damping, axes) if has_mass or np.any(housing.damping) else None,
        _along_scene_axes(housing.mass, axes) if has_mass else None,
        modal_coordinates=len(housing.stiffness) - housing.motions,
        seat_positions=tuple((float(x), float(y), float(z)) for x, y, z in positions),
    )


def scene_axes(housing: ReducedHousing) -> FloatArray:
    """Return the matrix T (r, r) with x = T y, from coordinates y of the `scene_housing` to reduced ones x.

    The motions of the seats in y are along the scene's axes; amplitudes of modes are the same in both.
    """
    amplitudes = len(housing.stiffness) - housing.motions
    return np.asarray(
        linalg.block_diag(*(_seat_rotation(seat) for seat in housing.seats), np.eye(amplitudes))
    )


def _seat_rotation(seat: SeatFrame) -> FloatArray:
    """Return the motions of a seat along its own axes per its motions along the scene's, square."""
    sine = math.hypot(float(seat.axes[0, 2]), float(seat.axes[1, 2]))  # sine of the angle between bore and z
    if sine > PARALLEL:
        angle = Quantity(math.asin(min(sine, 1.0)), "rad", digits=3)
        bound = Text.of("along z, as the shafts of a scene; its bore is off by ", angle)
        raise InputError(f"seats.{seat.name}", "not along z", bound, "Turn the mesh.")
    rotation = np.kron(np.eye(2), seat.axes.T)  # displacements, then rotations
    # A seat may have only the first 3 or 5 of these; as the bore is along z, the rest do not mix with them.
    return np.asarray(rotation[: len(seat.motions), : len(seat.motions)])


def _along_scene_axes(matrix: FloatArray, axes: FloatArray) -> Matrix:
    """Return a matrix over reduced coordinates as rows over the coordinates of `scene_axes`."""
    same = np.array_equal(axes, np.eye(len(axes)))  # then the product would only add rounding
    return matrix_rows(matrix if same else axes.T @ matrix @ axes)


@dataclass(frozen=True)
class SurfaceHousing:
    """A housing whose surface is known: its name, its reduction, its bearings in the order of the seats."""

    name: str
    body: ReducedHousing
    bearings: tuple[str, ...]
