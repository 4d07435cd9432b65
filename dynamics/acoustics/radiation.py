"""Sound power of a vibrating hull by a radiation model, and its radiation efficiency.

A radiation model gives the radiation resistance R of shapes of normal velocity. With their complex peak
amplitudes v, the sound power is W = v^H R v / 2, whatever the model. Phasors are of e^{+i omega t}.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from dynamics.acoustics.air import Air
from dynamics.acoustics.hull import Hull
from dynamics.checks import integer, positive
from dynamics.errors import InputError
from dynamics.types import ComplexArray, FloatArray
from dynamics.work_cost import Cost
from host.optional_modules import special

PRODUCT = 0.1e-9
"""CPU seconds for a panel and a pair of shapes."""
SMALLER = 0.8
"""Radius of the sphere that stands for a body in `error_band`, over the body's equivalent radius.

It is below 1 because two waves on one wall are shorter than two waves around the whole body.
"""


class RadiationModel(Protocol):
    """A way to compute the sound that a hull radiates."""

    @property
    def model_name(self) -> str:
        """Return the name by which results are listed."""

    def resistance(self, hull: Hull, frequency: float, shapes: ComplexArray, air: Air) -> ComplexArray:
        """Return the radiation resistance of shapes, (M, M), Hermitian and positive semidefinite.

        Parameters
        ----------
        frequency : float
            Frequency, Hz, above zero.
        shapes : (T, M) array
            Normal velocity of the panels per unit of each shape's amplitude, > 0 outwards.

        Returns
        -------
        (M, M) array
            W s^2 over the square of the amplitudes' unit: kg/s for amplitudes in m/s.
        """

    def cost(self, panels: int, ka: float, shapes: int) -> Cost:
        """Predict the cost of `resistance` at one frequency on the reference host of `host_speed`.

        Parameters
        ----------
        panels, shapes : int
            T and M.
        ka : float
            Wavenumber times `Hull.outer_radius`.
        """

    def error_band(self, ka: float) -> tuple[float, float]:
        """Return by how much levels are off, dB: from (below 0: too quiet) and to.

        The bounds hold for bodies that breathe, move as a whole or bend once around, and for walls of boxes
        (docs/theory/sound-power.md). `ka`: wavenumber times `Hull.equivalent_radius`.
        """


class PanelModel(RadiationModel, Protocol):
    """A radiation model that says through which panels the sound leaves a hull."""

    def panel_power(
        self, hull: Hull, frequency: float, normal_velocity: ComplexArray, air: Air
    ) -> FloatArray:
        """Return the power of every panel, (T,), W, negative where it takes power from the others.

        Half the velocity times the sound pressure in phase with it, times the area; the sum is v^H R v / 2.
        """


def resistance(
    model: RadiationModel, hull: Hull, frequency: float, shapes: ComplexArray, air: Air
) -> ComplexArray:
    """Check what a model is given and return its radiation resistance, (M, M), as `RadiationModel` has it.

    Raises `InputError`: the frequency is not above zero, `shapes` are not (T, M) finite numbers, or the model
    refuses.
    """
    return model.resistance(hull, frequency, _checked(hull, frequency, shapes), air)


def _checked(hull: Hull, frequency: float, shapes: ComplexArray) -> ComplexArray:
    """Return shapes that are finite and of the hull's panels, at a frequency above zero."""
    positive("frequency", frequency)
    shapes = np.asarray(shapes)
    if shapes.ndim != 2 or len(shapes) != len(hull.triangles) or not np.all(np.isfinite(shapes)):
        raise InputError("shapes", shapes.shape, f"finite, of shape ({len(hull.triangles)}, M)")
    return shapes


def sound_power(
    model: RadiationModel, hull: Hull, frequency: float, normal_velocity: ComplexArray, air: Air
) -> float:
    """Return the radiated sound power of one vibration, W.

    `normal_velocity` (T,): complex peak amplitudes, m/s. Raises `InputError` as `resistance` does.
    """
    matrix = resistance(model, hull, frequency, np.asarray(normal_velocity)[:, None], air)
    return 0.5 * float(matrix[0, 0].real)


def panel_power(
    model: PanelModel, hull: Hull, frequency: float, normal_velocity: ComplexArray, air: Air
) -> FloatArray:
    """Return the sound power of every panel, (T,), W, as `PanelModel` has it; the sum is `sound_power`.

    Over the areas it is the active intensity normal to the hull, W/m^2. Raises `InputError` as `sound_power`
    does.

    Parameters
    ----------
    frequency : float
        Frequency, Hz.
    normal_velocity : (T,) array
        Complex peak amplitudes, m/s.
    """
    shapes = _checked(hull, frequency, np.asarray(normal_velocity)[:, None])
    return model.panel_power(hull, frequency, shapes[:, 0], air)


def mean_square_velocity(hull: Hull, normal_velocity: ComplexArray) -> float:
    """Return the square of the normal velocity's rms in time, averaged over the hull, (m/s)^2."""
    return float(0.5 * hull.areas @ np.abs(normal_velocity) ** 2 / hull.area)


def radiation_efficiency(
    model: RadiationModel, hull: Hull, frequency: float, normal_velocity: ComplexArray, air: Air
) -> float:
    """Return sigma = W / (rho c S <v_n^2>), 1.

    Raises `InputError` as `resistance` does, or if nothing moves.
    """
    moving = positive("normal_velocity", mean_square_velocity(hull, normal_velocity), "Nothing moves.")
    power = sound_power(model, hull, frequency, normal_velocity, air)
    return power / (air.impedance * hull.area * moving)


def sphere_efficiency(order: int, ka: float) -> float:
    """Return the radiation efficiency of a sphere in spherical harmonics of an order, 1/abs(ka h_n'(ka))^2.

    (ka)^2/(1 + (ka)^2) for order 0, (ka)^4/(4 + (ka)^4) for order 1. Raises `InputError`: the order is not
    from 0 to 50, or ka not above zero.
    """
    integer("order", order, 0, 50)
    positive("ka", ka)
    slope = special.spherical_jn(order, ka, True) ** 2 + special.spherical_yn(order, ka, True) ** 2
    return float(1.0 / (ka * ka * slope))


def monopoles_efficiency(order: int, ka: float) -> float:
    """Return the efficiency that monopoles on the sphere without scattering give, (ka j_n(ka))^2.

    Raises `InputError` as `sphere_efficiency` does.
    """
    integer("order", order, 0, 50)
    return float((positive("ka", ka) * special.spherical_jn(order, ka)) ** 2)


def errors_db(ka: float, orders: int = 3) -> dict[str, FloatArray]:
    """Return the level errors of two models on a sphere in its first orders, (orders,) dB, > 0: too loud."""
    exact = np.array([sphere_efficiency(order, ka) for order in range(orders)])
    monopoles = np.array([monopoles_efficiency(order, ka) for order in range(orders)])
    return {
        "equivalent_radiated_power": -10.0 * np.log10(exact),
        "monopoles": 10.0 * np.log10(np.maximum(monopoles, 1e-300) / exact),
    }


@dataclass(frozen=True)
class EquivalentRadiatedPower:
    """The radiation model of efficiency 1, W = rho c / 2 times the sum of S abs(v_n)^2.

    It takes no account of interference, neither between panels nor around the hull: too high by 1/sigma, see
    `multipoles`. An upper estimate where the efficiency is at most 1. That holds for a sphere's pulsation and
    oscillation; its orders 2 to 5 exceed 1 by 0.3 to 1.5 dB near ka = n + 2, single walls of a box by up to
    1.7 dB (docs/theory/sound-power.md), plates near coincidence.
    """

    model_name: str = "equivalent_radiated_power"

    def resistance(self, hull: Hull, frequency: float, shapes: ComplexArray, air: Air) -> ComplexArray:
        """Return rho c Phi^H diag(S) Phi."""
        del frequency
        return np.asarray(air.impedance * shapes.conj().T @ (hull.areas[:, None] * shapes))

    def cost(self, panels: int, ka: float, shapes: int) -> Cost:
        """Predict the cost: one product of matrices."""
        del ka
        return Cost(PRODUCT * panels * shapes**2, 16.0 * panels * shapes)

    def error_band(self, ka: float) -> tuple[float, float]:
        """Return -2 dB, and the largest error on a smaller sphere of orders 0 to 2, at least 3 dB."""
        return -2.0, max(3.0, *errors_db(SMALLER * ka)[self.model_name].tolist())

    def panel_power(
        self, hull: Hull, frequency: float, normal_velocity: ComplexArray, air: Air
    ) -> FloatArray:
        """Return rho c / 2 S abs(v_n)^2, (T,), W."""
        del frequency
        return np.asarray(0.5 * air.impedance * hull.areas * np.abs(normal_velocity) ** 2)
