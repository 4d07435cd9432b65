"""A housing by the motion of its seats and a few modes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from dynamics.errors import ResultError
from dynamics.housing_modes.rigid_motion import RigidBody
from dynamics.housing_modes.seats import SeatFrame
from dynamics.types import FloatArray, IntArray
from dynamics.work_cost import WorkCost

SCHEMA = "lineofaction reduced housing"
SINGULAR = 1e-14
"""Relative to the diagonal."""
VALID = 0.7
"""Of the highest frequency kept: to it a reduction follows the whole mesh within 1 %."""


@dataclass(frozen=True)
class SurfaceMotion:
    """Motion of the surface.

    Attributes
    ----------
    points : (p, 3) array
        m.
    triangles : (t, 6) int array
        Corners, counter-clockwise from outside, then mid-side nodes. Walls of inner cavities are among them.
    motion : (p, 3, r) array
        Displacement of each point per reduced coordinate.
    """

    points: FloatArray
    triangles: IntArray
    motion: FloatArray

    def normal_displacement(self) -> tuple[FloatArray, FloatArray]:
        """Return mean outward displacements of triangles per coordinate, (t, r), and areas, (t,) in m^2."""
        from dynamics.housing_modes.quadrature import over_surface, triangle  # noqa: PLC0415 (extra)

        area, _ = over_surface(self.points, self.triangles)
        nodal = np.einsum("tpi,ap->tai", area, triangle().shape)
        size = np.linalg.norm(area, axis=2).sum(axis=1)
        flow = np.einsum("tai,tair->tr", nodal, self.motion[self.triangles], optimize=True)
        return flow / size[:, None], size


@dataclass(frozen=True)
class PointMotion:
    """Motion of a named point: that of the node next to it, at `position` (m); `motion` is (3, r)."""

    name: str
    position: FloatArray
    motion: FloatArray


@dataclass(frozen=True)
class ReductionChecks:
    """Residuals of a reduction, each to be small against one.

    Attributes
    ----------
    volume : float
        Mass by the mass matrix against that by the volume inside the surface, relative.
    eigen : float
        Largest residual of a mode, relative.
    solve : float
        Largest work of unbalanced forces on a deflection under a force on a seat, relative to the force's.
    rigid_frequency : float
        Highest frequency of a rigid motion over the first elastic mode; 0 if the housing is held.
    seat_rigid : float
        Largest deviation of the seats' motion from that of the body in a rigid motion, relative.
    """

    volume: float
    eigen: float
    solve: float
    rigid_frequency: float
    seat_rigid: float


@dataclass(frozen=True)
class ReducedHousing:
    """M x'' + C x' + K x = (f, 0): motions of the seats, then amplitudes of modes with the seats held.

    Attributes
    ----------
    mass, stiffness, damping : (r, r) arrays
        Symmetric; SI.
    seats : tuple of SeatFrame
        In the order of the coordinates: those of a seat are its `motions`, along its own axes.
    frequency : (m,) array
        Natural frequencies kept, with the seats free, Hz, rising; rigid motions first, as zeros.
    damping_ratio : (m,) array
        Of these modes.
    body : RigidBody or None
        Of the mesh.
    checks : ReductionChecks or None
    surface : SurfaceMotion or None
    points : tuple of PointMotion
    mount_damping : (r, r) array or None
        What of `damping` is that of the mounts; None: nothing, or not known apart.
    mount_stiffness : (r, r) array or None
        What of `stiffness` is that of the mounts; the same.
    loss_factor : float or None
        Of the material, where the rest of `damping` follows from it (`MaterialDamping`).
    cost : WorkCost or None
        Of the reduction, predicted and measured; None: nobody measured it.
    """

    mass: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    seats: tuple[SeatFrame, ...]
    frequency: FloatArray
    damping_ratio: FloatArray
    body: RigidBody | None = None
    checks: ReductionChecks | None = None
    surface: SurfaceMotion | None = None
    points: tuple[PointMotion, ...] = ()
    mount_damping: FloatArray | None = None
    mount_stiffness: FloatArray | None = None
    loss_factor: float | None = None
    cost: WorkCost | None = None

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
        from scipy.linalg import eigh  # noqa: PLC0415 (start-up time)

        if np.linalg.eigvalsh(_unit_diagonal(self.mass))[0] > SINGULAR:
            square, shape = eigh(self.stiffness, self.mass)
            return np.sqrt(np.maximum(square, 0.0)), shape
        inverse, shape = eigh(self.mass, self.stiffness)  # massless motions are no modes
        moving = np.flatnonzero(inverse > SINGULAR * max(inverse[-1], SINGULAR))[::-1]
        return 1.0 / np.sqrt(inverse[moving]), shape[:, moving] / np.sqrt(inverse[moving])

    def to_netcdf(self, path: str | Path) -> None:
        """Write the housing; the file appears whole or not at all."""
        from model_studies.record_file import write_record  # noqa: PLC0415 (start-up time)

        write_record(self, Path(path), SCHEMA)

    @classmethod
    def from_netcdf(cls, path: str | Path) -> ReducedHousing:
        """Read what `to_netcdf` wrote, bit by bit the same.

        Raises
        ------
        ResultError
            The file is missing, damaged, or no reduced housing.
        """
        from model_studies.netcdf_input import UnreadableFile  # noqa: PLC0415 (start-up time)
        from model_studies.record_file import read_record  # noqa: PLC0415

        try:
            housing = read_record(Path(path), {SCHEMA: cls})
        except UnreadableFile as error:
            raise ResultError(str(error)) from error
        assert isinstance(housing, cls)
        return housing


def _unit_diagonal(matrix: FloatArray) -> FloatArray:
    """Return a matrix in units in which its diagonal is 1, or 0 where it is."""
    diagonal = np.diag(matrix)
    scale = np.where(diagonal > 0.0, 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)), 0.0)
    return np.asarray(scale[:, None] * matrix * scale)
