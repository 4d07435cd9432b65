"""How a housing vibrates under its bearings, and through what where it does most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.types import FloatArray, Json
from dynamics.vibration.bearing_harmonics import ReportedHarmonics
from dynamics.vibration.contributions import Parts, bearing_parts, mode_parts
from dynamics.vibration.housing_motion import housing_motion
from dynamics.vibration.housing_vibration import HousingVibration, housing_vibration
from dynamics.vibration.points import point_rows
from dynamics.vibration.seat_forces import ComplexArray
from dynamics.vibration.surface_shape import SurfaceShape, operating_deflection
from dynamics.vibration.surface_weight import surface_weight
from dynamics.vibration.transfer_functions import mean_square_mobility, transfer_functions

FREQUENCIES = 800
"""Of the transfer functions, evenly spaced; resonances kept are among them."""


@dataclass(frozen=True)
class Mobilities:
    """Transfer functions from the motions of the seats, n frequencies.

    Attributes
    ----------
    seat : tuple of str
        Bearing and motion of each column, s.
    frequency : (n,) array
        Hz.
    point : (k, 3, n, s) complex array
        Velocity of points along x, y, z per force, m/(N s) or per moment, 1/(N s).
    surface : (n, s) array
        Mean square normal velocity of the outer hull per mean square force; 0 without a surface.
    """

    seat: tuple[str, ...]
    frequency: FloatArray
    point: ComplexArray
    surface: FloatArray


@dataclass(frozen=True)
class Shares:
    """Contributions of bearings or modes, each adding up to 1 (`Parts.shares`).

    Attributes
    ----------
    name : tuple of str
    frequency : (p,) array
        Natural frequencies, Hz; NaN of what is no mode.
    point : (k, p) array
        To the mean square velocity of each point.
    surface : (p,) array
        To that of the outer hull; NaN without a surface.
    """

    name: tuple[str, ...]
    frequency: FloatArray
    point: FloatArray
    surface: FloatArray


@dataclass(frozen=True)
class VibrationAnalysis:
    """Vibration over speed, and what makes it at one speed and order.

    Attributes
    ----------
    housing : str
    vibration : HousingVibration
    mobilities : Mobilities
    at_speed, at_order : int
        Indices of the speed and the order looked at.
    bearings, modes : Shares
    deflection : SurfaceShape or None
        Velocity of the surface there; None without a surface.
    facts : dict
        Plain JSON, of the response.
    """

    housing: str
    vibration: HousingVibration
    mobilities: Mobilities
    at_speed: int
    at_order: int
    bearings: Shares
    modes: Shares
    deflection: SurfaceShape | None = None
    facts: Json = field(default_factory=dict)


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

    Parameters
    ----------
    response : ReportedHarmonics
        A forced response, or the orders of a run.
    housing : ReducedHousing
        With mass, and with a surface or named points.
    name : str
        Of the housing.
    bearings, points
        As in `housing_vibration`.
    speed, order : float, optional
        Whose parts are wanted, the nearest ones, rad/s; by default where the motion is largest
        (`HousingVibration.largest`).

    Raises
    ------
    InputError
        Nothing of the housing can be looked at, nothing moves, or as `housing_vibration`.
    """
    if housing.surface is None and not housing.points:
        advice = "Reduce it from its mesh or STEP file: matrices alone do not say what moves."
        raise InputError("housing", name, "one with a surface or named points", advice)
    vibration = housing_vibration(response, housing, bearings, points)
    at = vibration.largest(speed, order)
    hertz, force = float(vibration.frequency[at]), vibration.seat_force[at]
    rate = 2j * np.pi * hertz * housing_motion(housing, np.array(hertz), force)
    return VibrationAnalysis(
        name,
        vibration,
        mobilities(housing, float(vibration.frequency.max()), points),
        *at,
        _shares(housing, bearing_parts(housing, hertz, force), points),
        _shares(housing, mode_parts(housing, hertz, force), points),
        None if housing.surface is None else operating_deflection(housing, rate),
        response.facts,
    )


def mobilities(housing: ReducedHousing, highest: float, points: Sequence[str] | None = None) -> Mobilities:
    """Return the transfer functions of a housing up to a frequency in Hz, its resonances among them."""
    even = np.linspace(highest / FREQUENCIES, highest, FREQUENCIES)
    own = housing.frequency[(housing.frequency > even[0]) & (housing.frequency < highest)]
    hertz = np.unique(np.concatenate([even, own]))
    rows = point_rows(housing, points)
    moved = transfer_functions(housing, hertz, rows.reshape(-1, rows.shape[2]))
    surface = np.zeros((hertz.size, housing.motions))
    if housing.surface is not None:
        surface = mean_square_mobility(housing, hertz, surface_weight(housing))
    names = tuple(f"{seat.name} {motion}" for seat in housing.seats for motion in seat.motions)
    by_point = moved.reshape(hertz.size, len(rows), 3, housing.motions)
    return Mobilities(names, hertz, np.ascontiguousarray(np.moveaxis(by_point, 0, 2)), surface)


def _shares(housing: ReducedHousing, parts: Parts, points: Sequence[str] | None) -> Shares:
    """Return contributions to the motion of each point and of the surface."""
    rows = point_rows(housing, points)
    shares = np.array([parts.shares(row.T @ row) for row in rows]).reshape(len(rows), len(parts.name))
    surface = np.full(len(parts.name), np.nan)
    if housing.surface is not None:
        surface = parts.shares(surface_weight(housing))
    return Shares(parts.name, parts.frequency, shares, surface)
