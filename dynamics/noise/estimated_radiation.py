"""The level that monopoles and equivalent radiated power both allow, mode by mode of a housing.

Monopoles neglect scattering and are mostly too quiet, equivalent radiated power neglects interference and is
mostly too loud. Each states from where to where its level is off (`RadiationModel.error_band`), so each
allows a range of levels for a mode that moves alone. The band is the range that both allow, the estimate a
level in it (`SHARE`). Where they exclude each other, near the interior resonances of the
monopoles' surface, as of a pulsating sphere near ka = pi, monopoles say nothing: the range is that of the
velocity.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from dynamics.acoustics import Air, ElementalRadiators, EquivalentRadiatedPower, outer_hull
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.noise.housing_radiation import HousingRadiation
from dynamics.types import BoolArray, ComplexArray, FloatArray

NAME = "estimate"
INTERIOR = 2.0
"""ka below which a body has no interior resonance; a sphere has its first at pi."""
SHARE_AT, SHARE = (1.0, 2.0), (0.5, 0.7)
"""ka, and where in the range the estimate lies: the middle, and higher where walls shadow each other.

Fitted to resonances of five gear cases by boundary elements, ka of 1.3 to 5.4 (docs/theory/sound-power.md).
"""
MIN = 1e-30
"""Resistance that stands for a motion without sound, kg/s."""


def allowed_levels(
    monopoles: FloatArray, plane: FloatArray, ka: FloatArray, resolved: BoolArray
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return the bounds of the levels that both models allow, and whether the velocity alone decides.

    Parameters
    ----------
    monopoles, plane : (F, m) arrays
        Levels of the same motions by monopoles and by equivalent radiated power, dB.
    ka : (F,) array
        Wavenumber times `Hull.equivalent_radius`.
    resolved : (F,) bool array
        Whether there are levels by monopoles.
    """
    monopoles_off, plane_off = (
        np.array([model.error_band(float(value)) for value in ka]).T[:, :, None]
        for model in (ElementalRadiators(), EquivalentRadiatedPower())
    )
    low, high = (plane - plane_off[1 - end] for end in (0, 1))
    first, last = (monopoles - monopoles_off[1 - end] for end in (0, 1))
    disjoint = (first > high) | (last < low)
    by_velocity = (disjoint & (ka > INTERIOR)[:, None]) | ~resolved[:, None]
    by_monopoles = disjoint & ~by_velocity
    low = np.where(by_velocity, low, np.where(by_monopoles, first, np.maximum(low, first)))
    high = np.where(by_velocity, high, np.where(by_monopoles, last, np.minimum(high, last)))
    return low, high, by_velocity


@dataclass(frozen=True)
class EstimatedRadiation(HousingRadiation):
    """Radiation resistance whose power of every mode alone is corrected; it stays positive semidefinite."""

    correction: FloatArray
    """Factor on the velocity of the coordinates, before monopoles radiate it. Shape (F, r, r)."""
    mode_error: FloatArray
    """Bounds of the error of the level of each mode of `ReducedHousing.modes`, dB: lower and upper; a
    negative error is a level that is too low. Shape (2, F, m).
    """
    by_velocity: BoolArray
    """Whether monopoles state nothing of a mode, so that its velocity alone decides. Shape (F, m)."""

    def radiating(self, velocity: ComplexArray, knot: float) -> ComplexArray:
        """Return the velocity (r,) that the model radiates at a computed frequency, Hz."""
        return np.asarray(self.correction[int(np.searchsorted(self.frequency, knot))] @ velocity)

    def error_band(self, frequency: float, mode_power: FloatArray) -> tuple[float, float]:
        """Return the bounds of the error of the level at a frequency, Hz, as `RadiationModel` does.

        The mean of the bands of the first modes, weighted with what they radiate alone, (m,) W.
        """
        count, total_power = len(mode_power), max(float(mode_power.sum()), MIN)
        knot = int(np.abs(self.frequency - frequency).argmin())
        off: FloatArray = self.mode_error[:, knot, :count] @ mode_power / total_power
        return float(off[0]), float(off[1])

    def gains(self, housing: ReducedHousing, frequency: FloatArray) -> FloatArray:
        """Return the factor on the velocity of each mode before monopoles radiate it, (N, m).

        At frequencies (N,) in Hz; beyond those that are computed and resolved as at the nearest of them.
        """
        inside = self.frequency <= self.metadata.resolved_frequency
        shape = housing.modes[1]
        if not np.any(inside):
            return np.ones((len(frequency), shape.shape[1]))
        impulse = shape.T @ housing.mass
        log_gain = np.log(np.einsum("mr,frs,sm->fm", impulse, self.correction[inside], shape, optimize=True))
        rows = [np.interp(frequency, self.frequency[inside], column) for column in log_gain.T]
        return np.asarray(np.exp(rows).T)

    def off(self, frequency: FloatArray, mode_power: FloatArray) -> FloatArray:
        """Return `error_band` of powers (m, S, H) at frequencies (S, H), (2, S, H), dB."""
        rows = zip(frequency.ravel().tolist(), mode_power.reshape(len(mode_power), -1).T, strict=True)
        return np.array([self.error_band(*row) for row in rows]).T.reshape(2, *frequency.shape)

    def replaced(self, natural: FloatArray) -> FloatArray:
        """Return the natural frequencies, Hz, at which monopoles state nothing of the mode."""
        knot = np.minimum(np.searchsorted(self.frequency, natural), self.frequency.size - 1)
        inside = (natural >= self.frequency[0]) & (natural <= self.metadata.resolved_frequency)
        return np.asarray(natural[inside & self.by_velocity[knot, np.arange(natural.size)]])


def estimated_radiation(
    housing: ReducedHousing, monopoles: HousingRadiation, air: Air | None = None
) -> EstimatedRadiation:
    """Return the estimate for a housing from its resistance by monopoles; the air is theirs."""
    air, shape = air or Air(), housing.modes[1]
    ka = 2.0 * np.pi / air.sound_speed * monopoles.frequency * outer_hull(housing).hull.equivalent_radius
    monopole_level = _levels(np.einsum("mk,fmn,nk->fk", shape, monopoles.matrix, shape, optimize=True).real)
    plane = _levels(monopoles.impedance * np.einsum("mk,mn,nk->k", shape, monopoles.surface, shape))
    resolved = monopoles.frequency <= monopoles.metadata.resolved_frequency
    low, high, by_velocity = allowed_levels(monopole_level, plane[None], ka, resolved)
    level = low + np.interp(ka, SHARE_AT, SHARE)[:, None] * (high - low)
    factor = 10.0 ** ((level - monopole_level) / 20.0) - 1.0
    correction = np.eye(len(shape)) + (shape * factor[:, None]) @ (shape.T @ housing.mass)
    values = {item.name: getattr(monopoles, item.name) for item in fields(HousingRadiation)}
    values["matrix"] = np.swapaxes(correction, 1, 2) @ monopoles.matrix @ correction
    return EstimatedRadiation(
        **(values | {"model_name": NAME}),
        correction=correction,
        mode_error=np.stack([level - high, level - low]),
        by_velocity=by_velocity,
    )


def _levels(resistance: FloatArray) -> FloatArray:
    return np.asarray(10.0 * np.log10(np.maximum(resistance, MIN)))
