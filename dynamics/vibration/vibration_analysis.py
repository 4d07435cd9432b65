"""Vibration of a housing under its bearings, and its largest parts by bearings and modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dynamics.acoustics.outer_hull import QUARTERS
from dynamics.checks import integer, not_negative
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.types import ComplexArray, FloatArray, IntArray, Json
from dynamics.vibration.housing_motion import ReportedHarmonics, housing_motion, modal_amplitudes
from dynamics.vibration.housing_vibration import (
    HousingVibration,
    MotionQuantity,
    housing_vibration,
    mean_square,
    point_rows,
    surface_weight,
)
from model_studies.record import under_key

RESIDUAL = "residual"
"""Name of the contribution of all modes that are not kept: static flexibility of the seats."""

FREQUENCIES = 800
"""Number of evenly spaced frequencies of the transfer functions, to which the natural frequencies are added.
"""


@dataclass(frozen=True)
class Parts:
    """A motion as a coherent sum."""

    name: tuple[str, ...]
    """Bearing seats, or modes by their number from 1; `RESIDUAL` is the rest."""
    frequency: FloatArray
    """Natural frequencies in Hz; NaN for parts that are no mode. Shape (p,)."""
    motion: ComplexArray
    """Motion of the reduced coordinates by each part, m and rad; the sum is the whole motion. Shape (p, r).
    """

    @classmethod
    def of_bearings(cls, housing: ReducedHousing, frequency: float, force: ComplexArray) -> Parts:
        """Return the motion under the force of each bearing.

        Parameters
        ----------
        frequency : float
            Frequency, Hz.
        force : (s,) complex array
            Forces on the motions of the seats (`seat_forces`).
        """
        owner = np.repeat(np.arange(len(housing.seats)), [len(seat.motions) for seat in housing.seats])
        separate = np.where(owner == np.arange(len(housing.seats))[:, None], force, 0.0)
        motion = housing_motion(housing, np.full(len(separate), float(frequency)), separate)
        return cls(tuple(seat.name for seat in housing.seats), np.full(len(separate), np.nan), motion)

    @classmethod
    def of_modes(cls, housing: ReducedHousing, frequency: float, force: ComplexArray) -> Parts:
        """Return the motion in each mode kept, and in the rest together; parameters as `of_bearings`."""
        loads = np.asarray(force)[None, None]
        amplitude = modal_amplitudes(housing, np.array([float(frequency)]), loads)[0, 0]
        by_mode = amplitude[:, None] * housing.modes[1].T
        count = len(housing.frequency)
        names = tuple(f"mode {number + 1}" for number in range(count))
        if count == len(by_mode):
            return cls(names, housing.frequency, by_mode)
        motion = np.vstack([by_mode[:count], by_mode[count:].sum(axis=0, keepdims=True)])
        return cls((*names, RESIDUAL), np.append(housing.frequency, np.nan), motion)

    def shares(self, weight: FloatArray) -> FloatArray:
        """Return contributions to a mean square, (p,): they add up to 1, and some may be negative.

        Each is the part of its motion that is in phase and in shape with the sum: Re(x^H W x_p)/(x^H W x).
        Raises `InputError`: nothing moves.

        Parameters
        ----------
        weight : (r, r) array
            Symmetric: `surface_weight`, or m^T m of the rows m of a point's motion.
        """
        total = self.motion.sum(axis=0)
        felt = (total.conj() @ weight) @ self.motion.T
        size = float(felt.sum().real)
        if not size > 0.0:
            raise InputError(
                "motion", size, "a motion", "No force acts on the seats at this order and speed."
            )
        return np.asarray(felt.real / size)


def transfer_functions(
    housing: ReducedHousing,
    frequency: FloatArray,
    response: FloatArray,
    excitation: FloatArray | None = None,
    quantity: MotionQuantity = MotionQuantity.VELOCITY,
) -> ComplexArray:
    """Return the motion per unit force: receptance, mobility or accelerance by the quantity.

    Rows are motions per reduced coordinate, such as `PointMotion.motion`. They are reciprocal: exchanging
    response and excitation transposes the result. Forces on seats act with the residual flexibility of the
    modes left out; forces elsewhere act through the reduced coordinates alone. Raises `InputError`: a
    frequency is negative, or as `modal_amplitudes`.

    Parameters
    ----------
    housing : ReducedHousing
        Housing with mass.
    frequency : (n,) array
        Frequencies, Hz.
    response : (q, r) array
    excitation : (e, r) array, optional
        Excited coordinates; by default the motions of the seats.

    Returns
    -------
    (n, q, e) complex array
        m/N, m/(N s) or m/(N s^2) for rows of points; rad and N m for those of rotations.
    """
    hertz = np.asarray(frequency, dtype=float)
    for index, value in enumerate(hertz):
        not_negative(f"frequency[{index}]", float(value))
    loads = np.eye(housing.motions, len(housing.mass)) if excitation is None else np.asarray(excitation)
    amplitude = modal_amplitudes(housing, hertz, loads[None].astype(complex))
    motion = np.swapaxes(amplitude @ (np.asarray(response) @ housing.modes[1]).T, 1, 2)
    return quantity.of(motion, hertz[:, None, None])


def mean_square_mobility(housing: ReducedHousing, frequency: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the mean square velocity per mean square force on each motion of the seats, (n, s).

    Parameters
    ----------
    frequency : (n,) array
        Frequencies, Hz.
    weight : (r, r) array
        Weight of the surface (`surface_weight`).

    Returns
    -------
    (n, s) array
        m^2/(N s)^2, of moments 1/(N s)^2.
    """
    coordinates = np.eye(len(housing.mass))
    return 2.0 * mean_square(np.swapaxes(transfer_functions(housing, frequency, coordinates), 1, 2), weight)


@dataclass(frozen=True)
class SurfaceShape:
    """Complex peak amplitudes of the motion of a surface."""

    points: FloatArray
    """Points of the surface, m. Shape (p, 3)."""
    triangles: IntArray
    """Corners, counter-clockwise from outside, then mid-side nodes, if it has them. (t, 6) or (t, 3) int
    array.
    """
    motion: ComplexArray
    """Motion of the points, m, m/s or m/s^2; that of a mode is real, with the largest motion 1. Shape (p, 3).
    """

    @property
    def facets(self) -> IntArray:
        """Return plane triangles, four for each of six nodes, (4 t, 3)."""
        corners = self.triangles.shape[1] == 3
        return self.triangles if corners else np.asarray(self.triangles[:, QUARTERS].reshape(-1, 3))

    @property
    def normal_motion(self) -> ComplexArray:
        """Return the mean outward motion of each facet, (4 t,)."""
        a, b, c = np.moveaxis(self.points[self.facets], 1, 0)
        normal = np.cross(b - a, c - a)
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        return np.asarray(np.sum(self.motion[self.facets].mean(axis=1) * normal, axis=1))


def operating_deflection(housing: ReducedHousing, motion: ComplexArray) -> SurfaceShape:
    """Return the surface's motion by that of the reduced coordinates, (r,), of any quantity."""
    surface = housing.surface
    if surface is None:
        remedy = "Reduce its mesh or STEP file: matrices alone have no surface."
        raise InputError("surface", "none", "a housing with a surface", remedy)
    return SurfaceShape(surface.points, surface.triangles, np.asarray(surface.motion @ motion, dtype=complex))


def mode_shape(housing: ReducedHousing, number: int) -> SurfaceShape:
    """Return a natural mode of the housing with its seats free; `number` counts from 1, rigid motions first.

    Raises `InputError`: there is no such mode, or the housing has no surface.
    """
    integer("number", number, 1, len(housing.frequency))
    shape = operating_deflection(housing, housing.modes[1][:, number - 1].astype(complex))
    largest = np.linalg.norm(shape.motion, axis=1).max()
    return SurfaceShape(shape.points, shape.triangles, shape.motion / largest)


@dataclass(frozen=True)
class _Mobilities:
    """Transfer functions from the motions of the seats, n frequencies."""

    seat: tuple[str, ...]
    """Bearing and motion of each column, s."""
    frequency: FloatArray
    """Hz. Shape (n,)."""
    point: ComplexArray
    """Velocity of points along x, y, z per force, m/(N s) or per moment, 1/(N s). Shape (k, 3, n, s)."""
    surface: FloatArray
    """Mean square normal velocity of the outer hull per mean square force; 0 without a surface. Shape (n, s).
    """


@dataclass(frozen=True)
class Shares:
    """Contributions of bearings or modes, each adding up to 1 (`Parts.shares`)."""

    name: tuple[str, ...]
    frequency: FloatArray
    """Natural frequencies, Hz; NaN for parts that are no mode. Shape (p,)."""
    point: FloatArray
    """Contributions to the mean square velocity of each point. Shape (k, p)."""
    surface: FloatArray
    """Contributions to the mean square velocity of the outer hull; NaN without a surface. Shape (p,)."""


@dataclass(frozen=True)
class VibrationAnalysis:
    """Vibration over speed, and its causes at one speed and order."""

    housing: str
    vibration: HousingVibration
    mobilities: _Mobilities
    at_speed: int
    at_order: int
    """`at_speed`, `at_order`: Indices of the speed and the order of `deflection` and shares."""
    bearings: Shares
    modes: Shares
    deflection: SurfaceShape | None = None
    """Velocity of the surface at that speed and order; None without a surface."""
    metadata: Json = field(default_factory=dict, metadata=under_key("facts"))
    """Plain JSON, of the response."""


def analyze_vibration(
    response: ReportedHarmonics,
    housing: ReducedHousing,
    name: str,
    *,
    bearings: Sequence[str] | None = None,
    points: Sequence[str] | None = None,
    speed: float | None = None,
    order: float | None = None,
) -> VibrationAnalysis:
    """Return vibration, transfer functions and contributions of a housing.

    Raises `InputError`: nothing of the housing can be looked at, nothing moves, or as `housing_vibration`.

    Parameters
    ----------
    response : ReportedHarmonics
        A forced response, or the orders of a run.
    housing : ReducedHousing
        Housing with mass, and with a surface or named points.
    name : str
        Name of the housing.
    bearings, points
        Arguments of `housing_vibration`.
    speed, order : float, optional
        Whose parts are wanted, the nearest ones, rad/s; by default where the motion is largest
        (`HousingVibration.largest`).
    """
    if housing.surface is None and not housing.points:
        remedy = "Reduce it from its mesh or STEP file: matrices alone do not say what moves."
        raise InputError("housing", name, "one with a surface or named points", remedy)
    vibration = housing_vibration(response, housing, bearings, points)
    at = vibration.largest(speed, order)
    hertz, force = float(vibration.frequency[at]), vibration.seat_force[at]
    rate = 2j * np.pi * hertz * housing_motion(housing, np.array(hertz), force)
    return VibrationAnalysis(
        name,
        vibration,
        _mobilities(housing, float(vibration.frequency.max()), points),
        *at,
        _shares(housing, Parts.of_bearings(housing, hertz, force), points),
        _shares(housing, Parts.of_modes(housing, hertz, force), points),
        None if housing.surface is None else operating_deflection(housing, rate),
        response.metadata,
    )


def _mobilities(housing: ReducedHousing, highest: float, points: Sequence[str] | None = None) -> _Mobilities:
    """Return the transfer functions of a housing up to a frequency in Hz, its resonances among them."""
    even = np.linspace(highest / FREQUENCIES, highest, FREQUENCIES)
    natural = housing.frequency[(housing.frequency > even[0]) & (housing.frequency < highest)]
    hertz = np.unique(np.concatenate([even, natural]))
    rows = point_rows(housing, points)
    transfer = transfer_functions(housing, hertz, rows.reshape(-1, rows.shape[2]))
    surface = np.zeros((hertz.size, housing.motions))
    if housing.surface is not None:
        surface = mean_square_mobility(housing, hertz, surface_weight(housing))
    names = tuple(f"{seat.name} {motion}" for seat in housing.seats for motion in seat.motions)
    by_point = transfer.reshape(hertz.size, len(rows), 3, housing.motions)
    return _Mobilities(names, hertz, np.ascontiguousarray(np.moveaxis(by_point, 0, 2)), surface)


def _shares(housing: ReducedHousing, parts: Parts, points: Sequence[str] | None) -> Shares:
    rows = point_rows(housing, points)
    shares = np.array([parts.shares(row.T @ row) for row in rows]).reshape(len(rows), len(parts.name))
    surface = np.full(len(parts.name), np.nan)
    if housing.surface is not None:
        surface = parts.shares(surface_weight(housing))
    return Shares(parts.name, parts.frequency, shares, surface)
