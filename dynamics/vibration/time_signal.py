"""Motion of a housing over time under the forces of its bearings.

Between the samples the force is a cubic spline. Each mode is integrated exactly over a step for forces of
that shape.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import factorial
from typing import Protocol

import numpy as np

from bounds import Quantity, Text
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.kernels.compiled import compiled
from dynamics.types import FloatArray
from dynamics.vibration.housing_motion import ROUNDING
from dynamics.vibration.housing_vibration import MotionQuantity, named_points
from host.optional_modules import linalg

UNIFORM = 1e-6
"""Largest deviation of a sample's time from a uniform grid, in steps."""
LOOSE = 1e-6
"""Natural frequency over the highest one, below which it is rounding and the mode moves freely."""
PIECE = 4096
"""Number of samples whose states are in memory at a time."""
REACH = 32
"""Samples beyond a piece that its spline uses: a sample n away counts by (2 - sqrt 3)^n, after 32 by 5e-19.
"""
CUBIC = 4
"""Coefficients of a piece of a cubic spline."""


class _Propagator(Protocol):
    """Advances the m modes of a housing by one sample, exactly under forces that are cubic in time."""

    @property
    def scale(self) -> FloatArray:
        """Keeps stiff modes and rigid motions of like size in the state, (m,)."""

    def advance(self, derivatives: FloatArray, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the states of at most `PIECE` samples, the first one `state` (2 m,), and the last of all.

        Modal amplitudes times `scale`, then their rates times the step. `derivatives` (4, P, s) are those of
        the forces between P + 1 samples, in steps.
        """


@dataclass(frozen=True)
class _CoupledModes:
    """Modes that damping couples."""

    transition: FloatArray
    """Transition of the state over a step. State: modal amplitudes times `scale`, then their rates times the
    step. Shape (2 m, 2 m).
    """
    gain: FloatArray
    """State per derivative of the force at the sample, in steps. Shape (4, 2 m, s)."""
    scale: FloatArray
    """Scale of the modal amplitudes. Shape (m,)."""

    @classmethod
    def of(cls, natural: FloatArray, damping: FloatArray, push: FloatArray, step: float) -> _CoupledModes:
        """Integrate p'' + damping p' + natural^2 p = push f over a step, for forces 1, t, t^2/2, t^3/6.

        By the exponential of the system that the derivatives of the force extend (C. F. van Loan, IEEE
        Transactions on Automatic Control 23 (1978) 395-404).
        """
        modes, forces = push.shape
        angle = natural * step
        scale = np.maximum(angle, 1.0)
        system = np.zeros((2 * modes + CUBIC * forces,) * 2)
        system[:modes, modes : 2 * modes] = np.diag(scale)
        system[modes : 2 * modes, :modes] = -np.diag(angle**2 / scale)
        system[modes : 2 * modes, modes : 2 * modes] = -step * damping
        system[modes : 2 * modes, 2 * modes : 2 * modes + forces] = step**2 * push
        system[2 * modes : -forces, 2 * modes + forces :] = np.eye((CUBIC - 1) * forces)
        exponential = linalg.expm(system)[: 2 * modes]
        gain = exponential[:, 2 * modes :].reshape(2 * modes, CUBIC, forces)
        return cls(exponential[:, : 2 * modes], np.ascontiguousarray(np.moveaxis(gain, 1, 0)), scale)

    def advance(self, derivatives: FloatArray, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Advance all modes together."""
        increments = sum(part @ gain.T for part, gain in zip(derivatives, self.gain, strict=True))
        states = [state]
        for increment in increments:
            states.append(self.transition @ states[-1] + increment)
        return np.array(states[:PIECE]), states[-1]


@dataclass(frozen=True)
class _SeparateModes:
    """Modes each by itself: damping couples none."""

    transition: FloatArray
    """Transition of the state of each mode over a step. State: amplitude times `scale`, rate times the step.
    Shape (2, 2, m).
    """
    gain: FloatArray
    """State of a mode per derivative of its modal force, in steps. Shape (2, 4, m)."""
    push: FloatArray
    """Modal forces per force. Shape (m, s)."""
    scale: FloatArray
    """Scale of the modal amplitudes. Shape (m,)."""

    @classmethod
    def of(cls, natural: FloatArray, damping: FloatArray, push: FloatArray, step: float) -> _SeparateModes:
        """Integrate as `_CoupledModes` does, with the `damping` (m,) of each mode."""
        angle = natural * step
        scale = np.maximum(angle, 1.0)
        systems = np.zeros((natural.size, 2 + CUBIC, 2 + CUBIC))
        systems[:, 0, 1], systems[:, 1, 0], systems[:, 1, 1] = scale, -(angle**2) / scale, -step * damping
        systems[:, 1, 2] = step**2
        systems[:, 2:-1, 3:] = np.eye(CUBIC - 1)
        exponential = np.ascontiguousarray(np.moveaxis(linalg.expm(systems)[:, :2], 0, 2))
        return cls(exponential[:, :2].copy(), exponential[:, 2:].copy(), push, scale)

    def advance(self, derivatives: FloatArray, state: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Advance every mode by itself, all modes of a sample in lanes."""
        modal = np.ascontiguousarray(derivatives @ self.push.T)
        states = np.empty((modal.shape[1] + 1, 2, self.scale.size))
        states[0] = state.reshape(2, -1)
        _advance_modes(self.transition, self.gain, modal, states)
        rows = states.reshape(len(states), -1)
        return rows[:PIECE], rows[-1].copy()


@compiled
def _advance_modes(transition: FloatArray, gain: FloatArray, force: FloatArray, states: FloatArray) -> None:
    """Write the states (P + 1, 2, m) after the first one under modal forces (4, P, m), modes in lanes."""
    for sample in range(states.shape[0] - 1):
        for mode in range(states.shape[2]):
            amplitude, rate = states[sample, 0, mode], states[sample, 1, mode]
            advanced = transition[0, 0, mode] * amplitude + transition[0, 1, mode] * rate
            paced = transition[1, 0, mode] * amplitude + transition[1, 1, mode] * rate
            for order in range(CUBIC):
                advanced += gain[0, order, mode] * force[order, sample, mode]
                paced += gain[1, order, mode] * force[order, sample, mode]
            states[sample + 1, 0, mode], states[sample + 1, 1, mode] = advanced, paced


def point_signal(
    housing: ReducedHousing,
    time: FloatArray,
    force: FloatArray,
    points: Sequence[str] | None = None,
    quantity: MotionQuantity = MotionQuantity.VELOCITY,
) -> FloatArray:
    """Return the motion of points of a housing under forces over time.

    As `motion_pieces` does, of named points along the axes of the mesh. Raises `InputError` as
    `motion_pieces` does, or the housing has no such point.

    Parameters
    ----------
    housing, time, force, quantity
        Arguments of `motion_pieces`.
    points : sequence of str, optional
        Points by name; by default all, in their order.

    Returns
    -------
    (T, k, 3) array
        m, m/s or m/s^2.
    """
    motion = np.stack([point.motion for point in named_points(housing, points)])
    rows = motion.reshape(-1, motion.shape[2])
    signal = np.concatenate(list(motion_pieces(housing, time, force, rows, quantity)))
    return signal.reshape(-1, *motion.shape[:2])


def motion_pieces(
    housing: ReducedHousing,
    time: FloatArray,
    force: FloatArray,
    rows: FloatArray,
    quantity: MotionQuantity = MotionQuantity.VELOCITY,
) -> Iterator[FloatArray]:
    """Yield combinations of the reduced coordinates of a housing under forces over time, piece by piece.

    Between the samples the force is a cubic spline, and the modes follow it exactly, damping between them
    included. The only error is that of the spline: a harmonic of n samples a period enters with the gain
    sinc(1/n)^4 3/(2 + cos(2 pi/n)), 1 - (2 pi/n)^4/720 for large n: 0.02 % low at 10 samples a period, 0.3 %
    at 6, 1.5 % at 4, and with images about multiples of the sampling rate, (n - 1)^-4 of it.

    The housing starts at rest, deflected by the first force; motions that nothing holds start at zero. Memory
    beyond that of the force does not grow with its length. Raises `InputError`: shapes differ, times are not
    uniform, a force is no number, or the housing has no mass.

    Parameters
    ----------
    housing : ReducedHousing
        Housing with mass.
    time : (T,) array
        s, uniform.
    force : (T, s) array
        Forces on the motions of the seats, N and N m (`run_seat_forces`).
    rows : (q, r) array
        Quantities to return per reduced coordinate, such as `PointMotion.motion`.
    quantity : MotionQuantity
        Displacement, velocity or acceleration.

    Yields
    ------
    (P, q) array
        At most `PIECE` samples, one after the other; m, m/s or m/s^2 for rows of points.
    """
    times, forces = np.asarray(time, dtype=float), np.asarray(force, dtype=float)
    step = _checked_step(times, forces, housing)
    natural, shape = housing.modes
    damping = shape.T @ housing.damping @ shape
    loaded_shape, measured_shape = shape[: housing.motions].T, (np.asarray(rows) @ shape).T
    propagator = _propagator(natural, damping, loaded_shape, step)
    elastic = natural > LOOSE * natural.max()
    rest = np.divide(loaded_shape @ forces[0], natural**2, out=np.zeros(natural.size), where=elastic)
    state = np.concatenate([rest * propagator.scale, np.zeros(natural.size)])
    of_amplitudes, of_rates = measured_shape / propagator.scale[:, None], measured_shape / step
    for first in range(0, times.size, PIECE):
        states, state = propagator.advance(_derivatives(forces, first), state)
        amplitudes, rates = states[:, : natural.size], states[:, natural.size :]
        if quantity is MotionQuantity.DISPLACEMENT:
            yield amplitudes @ of_amplitudes
        elif quantity is MotionQuantity.VELOCITY:
            yield rates @ of_rates
        else:
            pushed = forces[first : first + PIECE] @ (loaded_shape.T @ measured_shape)
            yield (
                pushed - rates @ (damping.T @ of_rates) - amplitudes @ (natural[:, None] ** 2 * of_amplitudes)
            )


def _checked_step(time: FloatArray, force: FloatArray, housing: ReducedHousing) -> float:
    if time.ndim != 1 or time.size < 2:
        raise InputError("time", time.shape, "at least two samples, (T,)")
    step = float((time[-1] - time[0]) / (time.size - 1))
    uneven = np.abs(time - (time[0] + step * np.arange(time.size)))
    if not (step > 0.0 and np.all(uneven <= UNIFORM * step)):
        worst = Text.of("a uniform grid; off by ", Quantity(float(np.max(uneven)), "s", digits=2))
        raise InputError("time", "not uniform", worst, "Resample the force.")
    if force.shape != (time.size, housing.motions):
        raise InputError("force", force.shape, f"shape {(time.size, housing.motions)}")
    if not np.all(np.isfinite(force)):
        raise InputError("force", "not finite", "finite numbers")
    if not np.any(housing.mass):
        raise InputError("mass", 0.0, "a housing with mass", "Reduce its mesh, or give its mass matrix.")
    return step


def _propagator(natural: FloatArray, damping: FloatArray, push: FloatArray, step: float) -> _Propagator:
    """Return the propagator of the modes over a step: one for each mode unless damping couples them."""
    diagonal = np.diag(damping)
    if np.all(
        np.abs(damping - np.diag(diagonal)) <= ROUNDING * np.sqrt(np.outer(diagonal, diagonal).clip(0.0))
    ):
        return _SeparateModes.of(natural, diagonal, push, step)
    return _CoupledModes.of(natural, damping, push, step)


def _derivatives(force: FloatArray, first: int) -> FloatArray:
    """Return derivatives of the spline of the force at the piece from a sample on, in steps, (4, P, s)."""
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 (start-up time)

    start = max(first - REACH, 0)
    near = force[start : first + PIECE + REACH]
    power = CubicSpline(np.arange(len(near), dtype=float), near).c[::-1, first - start :][:, :PIECE]
    return np.stack([factorial(order) * part for order, part in enumerate(power)])
