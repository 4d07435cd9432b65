"""The level that monopoles and equivalent radiated power both allow, mode by mode of a housing.

Monopoles neglect scattering and are mostly too quiet; equivalent radiated power, which the surface velocity
alone determines, neglects interference and is mostly too loud. Each model states bounds of its error
(`RadiationModel.error_band`), so that each allows a range of levels for a mode that vibrates alone. The band
is the intersection of both ranges, and the estimate a level in it (`SHARE`). The ranges are disjoint near
interior resonances of the monopoles' surface, for example of a pulsating sphere near ka = pi. There the
monopoles are invalid, and the range is that of equivalent radiated power. Sizes: F frequencies, r coordinates
of the housing, m modes.
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
"""Place of the estimate in the band (0: lower end, 1: upper end) at two values of ka, linear between them:
the middle at low ka, and higher where walls shadow each other.

Fitted to resonances of five gear cases by boundary elements, ka of 1.3 to 5.4 (docs/theory/sound-power.md).
"""
MIN = 1e-30
"""Least resistance, kg/s, so that a motion without sound has a level."""


def allowed_levels(
    monopoles: FloatArray, plane: FloatArray, ka: FloatArray, resolved: BoolArray
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return the bounds of the level that both models allow, and whether equivalent radiated power decides.

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
    # exact level = level - error: the upper error gives the lower bound
    low, high = plane - plane_off[1], plane - plane_off[0]
    first, last = monopoles - monopoles_off[1], monopoles - monopoles_off[0]
    disjoint = (first > high) | (last < low)
    by_velocity = (disjoint & (ka > INTERIOR)[:, None]) | ~resolved[:, None]
    by_monopoles = disjoint & ~by_velocity
    low = np.where(by_velocity, low, np.where(by_monopoles, first, np.maximum(low, first)))
    high = np.where(by_velocity, high, np.where(by_monopoles, last, np.minimum(high, last)))
    return low, high, by_velocity


@dataclass(frozen=True)
class EstimatedRadiation(HousingRadiation):
    """Radiation resistance by monopoles with the power of every single mode corrected to the estimate.

    The resistance stays positive semidefinite.
    """

    correction: FloatArray
    """Factor on the velocity of the coordinates, before monopoles radiate it. Shape (F, r, r)."""
    mode_error: FloatArray
    """Bounds of the error of the level of each mode of `ReducedHousing.modes`, dB: lower and upper; a
    negative error is a level that is too low. Shape (2, F, m).
    """
    by_velocity: BoolArray
    """Whether monopoles are invalid for a mode, so that equivalent radiated power decides. Shape (F, m)."""

    def radiating(self, velocity: ComplexArray, knot: float) -> ComplexArray:
        """Return the velocity (r,) that the model radiates at a computed frequency, Hz."""
        return np.asarray(self.correction[int(np.searchsorted(self.frequency, knot))] @ velocity)

    def error_band(self, frequency: float, mode_power: FloatArray) -> tuple[float, float]:
        """Return the bounds of the error of the level at a frequency, Hz, as `RadiationModel` does.

        They are the means of those of the first modes, weighted with the power that each of them radiates
        alone, `mode_power` (m,) in W.
        """
        count, total_power = len(mode_power), max(float(mode_power.sum()), MIN)
        knot = int(np.abs(self.frequency - frequency).argmin())
        off: FloatArray = self.mode_error[:, knot, :count] @ mode_power / total_power
        return float(off[0]), float(off[1])

    def gains(self, housing: ReducedHousing, frequency: FloatArray) -> FloatArray:
        """Return the factor on the velocity of each mode before monopoles radiate it, (N, m).

        `frequency` (N,) is in Hz. Outside the computed and resolved frequencies the nearest of them counts.
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
        """Return the natural frequencies, Hz, at which monopoles are invalid for the mode."""
        knot = np.minimum(np.searchsorted(self.frequency, natural), self.frequency.size - 1)
        inside = (natural >= self.frequency[0]) & (natural <= self.metadata.resolved_frequency)
        return np.asarray(natural[inside & self.by_velocity[knot, np.arange(natural.size)]])


def estimated_radiation(
    housing: ReducedHousing, monopoles: HousingRadiation, air: Air | None = None
) -> EstimatedRadiation:
    """Return the estimate for a housing from its resistance by monopoles, which was computed in `air`."""
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
    """Return levels of resistances, dB re 1 kg/s."""
    return np.asarray(10.0 * np.log10(np.maximum(resistance, MIN)))
