"""Forces of bearings on the seats of a reduced housing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.orders import bearing_signals
from dynamics.orders.resampling import interpolated
from dynamics.results import RunResult
from dynamics.types import BoolArray, ComplexArray, FloatArray, Json

# Forces of bearings by speed and order, from wherever they are known.


class BearingHarmonics(Protocol):
    """Forces of b bearings at S speeds in H orders, each as in a steady state.

    A linear response (`dynamics.linearize.HarmonicResponse`) is one, the orders of a run
    (`dynamics.orders.BearingOrders`) are another.
    """

    @property
    def bearing(self) -> tuple[str, ...]:
        """Names."""

    @property
    def speed(self) -> FloatArray:
        """Of the leading drive, rad/s, (S,)."""

    @property
    def order(self) -> FloatArray:
        """Multiples of the frequency of the first mesh that turns, (H,)."""

    @property
    def frequency(self) -> FloatArray:
        """Hz, (S, H)."""

    @property
    def bearing_force(self) -> ComplexArray:
        """Peak amplitudes on the ground, (b, 3, S, H) in N or (b, 6, S, H) with moments in N m.

        The phases of all bearings at one speed and order are about one moment.
        """

    @property
    def in_contact(self) -> BoolArray:
        """Whether all driving flanks stay in contact at each speed, (S,)."""


class ReportedHarmonics(BearingHarmonics, Protocol):
    """The same with what is known of their origin."""

    @property
    def facts(self) -> Json:
        """Plain JSON."""


HALF_LENGTH = 24
"""Of the filter of `finer_seat_forces`, in samples of the run."""


def seat_forces(
    response: BearingHarmonics, housing: ReducedHousing, bearings: Sequence[str] | None = None
) -> ComplexArray:
    """Return the forces on the seats of a housing by speed and order.

    Parameters
    ----------
    response : BearingHarmonics
        S speeds, H orders of a linear response or a run; in the frame of the housing's mesh.
    housing : ReducedHousing
    bearings : sequence of str, optional
        Bearings in the order of the seats; by default those with the names of the seats.

    Returns
    -------
    (S, H, s) array
        Complex peak amplitudes by the seats' motions, along their own axes, N and N m.

    Raises
    ------
    InputError
        A bearing is not in the response, or their number is not that of the seats.
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

    Between finer samples a cubic spline follows what the run's output passes: see `motion_signal`.
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
    turns = [_turn(seat.axes, signals.shape[1])[: len(seat.motions)] for seat in housing.seats]
    own = [signals[known.index(name)] for name in names]
    return np.concatenate([np.tensordot(turn, force, 1) for turn, force in zip(turns, own, strict=True)])


def _turn(axes: FloatArray, signals: int) -> FloatArray:
    """Return forces and moments along the seat's axes per the bearing's signals, (6, 3 or 6)."""
    return np.asarray(np.kron(np.eye(2), axes.T)[:, :signals])
