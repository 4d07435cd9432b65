"""Forces of bearings on the seats of a housing, from a response or a run, and its motion under them.

The reduced coordinates of a housing are the motions of its bearing seats, then amplitudes of modes. Forces
act on the seats alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from bounds import Quantity, Text
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.linearize.line_floor import LineFloor
from dynamics.orders import bearing_signals
from dynamics.orders.resampling import interpolated
from dynamics.results import RunResult
from dynamics.types import BoolArray, ComplexArray, FloatArray, Json

HALF_LENGTH = 24
"""Half length of the filter of `finer_seat_forces`, in samples of the run."""
ROUNDING = 1e-9
"""Coupling of two modes over the damping of both, below which it is rounding."""
UNDAMPED = 1e-12
"""Dynamic stiffness of a mode over the sum of its stiffness and inertia terms, below which it counts as 0.

The mode then resonates without damping.
"""
BLOCK = 64
"""Number of frequencies whose matrices are in memory at a time, where damping couples modes."""


class BearingForces(Protocol):
    """Forces of b bearings."""

    @property
    def bearing(self) -> tuple[str, ...]:
        """Names."""

    @property
    def bearing_force(self) -> ComplexArray:
        """Peak amplitudes on the ground, (b, 3, ...) in N or (b, 6, ...) with moments in N m."""


class BearingHarmonics(BearingForces, Protocol):
    """Forces of b bearings at S speeds in H orders, each as in a steady state.

    A linear response (`dynamics.linearize.HarmonicResponse`) is one, the orders of a run
    (`dynamics.orders.BearingOrders`) are another.
    """

    @property
    def speed(self) -> FloatArray:
        """Speed of the leading drive, rad/s, (S,)."""

    @property
    def order(self) -> FloatArray:
        """Multiples of the frequency of the first mesh that turns, (H,)."""

    @property
    def frequency(self) -> FloatArray:
        """Hz, (S, H)."""

    @property
    def bearing_force(self) -> ComplexArray:
        """Peak amplitudes on the ground, (b, 3, S, H) in N or (b, 6, S, H) with moments in N m.

        The phases of all bearings at one speed and order refer to the same instant.
        """

    @property
    def in_contact(self) -> BoolArray:
        """Whether all driving flanks stay in contact at each speed, (S,)."""

    @property
    def floor(self) -> LineFloor | None:
        """Forces in the lines of a long period that are not listed; None where every line is."""


class ReportedHarmonics(BearingHarmonics, Protocol):
    """Forces of bearings in orders, with the metadata of the result that they are from."""

    @property
    def metadata(self) -> Json:
        """Metadata of the result, in plain JSON."""


def seat_forces(
    response: BearingForces, housing: ReducedHousing, bearings: Sequence[str] | None = None
) -> ComplexArray:
    """Return the forces on the seats of a housing by speed and order.

    Raises `InputError`: a bearing is not in the response, or their number is not that of the seats.

    Parameters
    ----------
    response : BearingForces
        S speeds, H orders of a linear response or a run; in the frame of the housing's mesh. Further
        dimensions are kept, such as those of the inputs of a transfer function.
    bearings : sequence of str, optional
        Bearings in the order of the seats; by default those with the names of the seats.

    Returns
    -------
    (S, H, ..., s) array
        Complex peak amplitudes by the seats' motions, along their own axes, N and N m.
    """
    force = _on_seats(response.bearing_force, response.bearing, housing, bearings)
    return np.moveaxis(force, 0, -1)


def run_seat_forces(
    result: RunResult, housing: ReducedHousing, bearings: Sequence[str] | None = None
) -> FloatArray:
    """Return the forces on the seats of a housing over the time of a run, (T, s), N and N m.

    Parameters and errors as those of `seat_forces`; it refuses runs without bearing forces too.
    """
    force = _on_seats(bearing_signals(result), result.bearing, housing, bearings)
    return np.moveaxis(force, 0, -1)


def finer_seat_forces(
    result: RunResult, housing: ReducedHousing, bearings: Sequence[str] | None, factor: int
) -> tuple[FloatArray, FloatArray]:
    """Return times (F,) and `run_seat_forces` (F, s) at `factor` times the rate of the run.

    A cubic spline through the finer samples has the whole band that the run's output filter passes, see
    `motion_pieces`.
    """
    force = run_seat_forces(result, housing, bearings)
    finer = np.empty((factor * (len(force) - 1) + 1, force.shape[1]))
    for column, series in zip(finer.T, force.T, strict=True):
        column[:] = interpolated(series, factor, HALF_LENGTH)
    return result.time[0] + np.arange(len(finer)) / (factor * result.sample_rate), finer


def _on_seats(
    signals: NDArray[Any], known: Sequence[str], housing: ReducedHousing, bearings: Sequence[str] | None
) -> NDArray[Any]:
    """Return forces of bearings (b, 3 or 6, ...) by the motions of the seats, (s, ...)."""
    names = tuple(seat.name for seat in housing.seats) if bearings is None else tuple(bearings)
    if len(names) != len(housing.seats):
        raise InputError("bearings", len(names), f"{len(housing.seats)}, one per seat")
    for index, name in enumerate(names):
        if name not in known:
            raise InputError(f"bearings[{index}]", name, f"one of {', '.join(known)}")
    turns = [  # forces and moments along a seat's axes per a bearing's signals
        np.kron(np.eye(2), seat.axes.T)[: len(seat.motions), : signals.shape[1]] for seat in housing.seats
    ]
    seat_signals = [signals[known.index(name)] for name in names]
    return np.concatenate(
        [np.tensordot(turn, force, 1) for turn, force in zip(turns, seat_signals, strict=True)]
    )


def modal_amplitudes(housing: ReducedHousing, frequency: FloatArray, force: ComplexArray) -> ComplexArray:
    """Return amplitudes of `ReducedHousing.modes`, with damping between modes.

    Raises `InputError`: the housing has no mass, or it resonates there without damping.

    Parameters
    ----------
    housing : ReducedHousing
        Housing with mass.
    frequency : (N,) array
        Frequencies, Hz.
    force : (N, e, q) or (1, e, q) complex array
        Forces on the first q reduced coordinates, e loads at each frequency.

    Returns
    -------
    (N, e, m) array
        Complex peak amplitudes; modes have unit modal mass.
    """
    if not np.any(housing.mass):
        raise InputError("mass", 0.0, "a housing with mass", "Reduce its mesh, or give its mass matrix.")
    natural, shape = housing.modes
    damping = shape.T @ housing.damping @ shape
    omega = 2.0 * math.pi * np.asarray(frequency, dtype=float)
    modal_force = np.asarray(force) @ shape[: np.shape(force)[-1]]
    diagonal = np.diag(damping)
    square = natural**2 - omega[:, None] ** 2
    dynamic = square + 1j * omega[:, None] * diagonal  # stiffness of every mode, (N, m)
    # negated, so that NaN counts as a resonance
    resonant = ~(np.abs(dynamic) > UNDAMPED * (natural**2 + omega[:, None] ** 2))
    if np.any(resonant):
        at, mode = np.argwhere(resonant)[0]
        remedy = "Give the housing damping (loss_factor, damping_ratio, mounts), or leave that speed out."
        where = Quantity(float(natural[mode] / (2.0 * math.pi)), "Hz")
        off = Text.of("off the natural frequency of a mode of the housing without damping, ", where)
        raise InputError("frequency", float(omega[at] / (2.0 * math.pi)), off, remedy)
    if np.all(
        np.abs(damping - np.diag(diagonal)) <= ROUNDING * np.sqrt(np.outer(diagonal, diagonal).clip(0.0))
    ):
        return np.asarray(modal_force / dynamic[:, None, :])
    return _coupled(square, omega, damping, modal_force)


def _coupled(
    square: FloatArray, omega: FloatArray, damping: FloatArray, modal_force: ComplexArray
) -> ComplexArray:
    """Return the amplitudes (N, e, m) of modes that damping couples, a block of frequencies at a time.

    `square` (N, m): squares of the natural frequencies less that of omega; `modal_force` (N or 1, e, m).
    """
    loads = np.broadcast_to(modal_force, (omega.size, *modal_force.shape[1:]))
    amplitude = np.empty(loads.shape, dtype=complex)
    for first in range(0, omega.size, BLOCK):
        part = slice(first, first + BLOCK)
        dynamic = 1j * omega[part, None, None] * damping + np.eye(len(damping)) * square[part, None, :]
        solved = np.linalg.solve(dynamic, np.swapaxes(loads[part], 1, 2))
        amplitude[part] = np.swapaxes(solved, 1, 2)
    return amplitude


def housing_motion(housing: ReducedHousing, frequency: FloatArray, force: ComplexArray) -> ComplexArray:
    """Return the displacements of a housing by harmonics.

    Raises `InputError`: the shapes differ, the housing has no mass, or it resonates there without damping.

    Parameters
    ----------
    housing : ReducedHousing
        Housing with mass.
    frequency : (...,) array
        Frequencies, Hz, any shape.
    force : (..., s) array
        Complex peak amplitudes on the motions of the seats, N and N m (`seat_forces`).

    Returns
    -------
    (..., r) array
        Complex peak amplitudes of the reduced coordinates, m, rad; times 2 pi i frequency: velocities.
        `SurfaceMotion.motion @` and `PointMotion.motion @` them move the surface and points.
    """
    hertz = np.asarray(frequency, dtype=float)
    if np.shape(force) != (*hertz.shape, housing.motions):
        raise InputError("force", np.shape(force), f"shape {(*hertz.shape, housing.motions)}")
    loads = np.reshape(force, (hertz.size, 1, housing.motions))
    amplitude = modal_amplitudes(housing, hertz.ravel(), loads)[:, 0]
    return np.asarray((amplitude @ housing.modes[1].T).reshape(*hertz.shape, -1))
