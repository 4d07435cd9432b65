"""Equivalent radiated power: every panel radiates as a part of an infinite plane that moves as one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import spherical_jn, spherical_yn

from dynamics.acoustics.air import Air
from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.checks import integer, positive
from dynamics.types import FloatArray
from dynamics.work_cost import Cost

# Radiation efficiencies of a sphere that moves in spherical harmonics, and the models' errors by them.


def sphere_efficiency(order: int, ka: float) -> float:
    """Return the radiation efficiency of a sphere in spherical harmonics of an order, 1/abs(ka h_n'(ka))^2.

    (ka)^2/(1 + (ka)^2) for order 0, (ka)^4/(4 + (ka)^4) for order 1.

    Raises
    ------
    InputError
        If the order is not from 0 to 50, or ka not above zero.
    """
    integer("order", order, 0, 50)
    positive("ka", ka)
    slope = spherical_jn(order, ka, True) ** 2 + spherical_yn(order, ka, True) ** 2
    return float(1.0 / (ka * ka * slope))


def monopoles_efficiency(order: int, ka: float) -> float:
    """Return the efficiency that monopoles on the sphere without scattering give, (ka j_n(ka))^2.

    Raises
    ------
    InputError
        As `sphere_efficiency` does.
    """
    integer("order", order, 0, 50)
    return float((positive("ka", ka) * spherical_jn(order, ka)) ** 2)


def errors_db(ka: float, orders: int = 3) -> dict[str, FloatArray]:
    """Return the level errors of the models by the first orders of a sphere, (orders,) dB, > 0 too loud."""
    exact = np.array([sphere_efficiency(order, ka) for order in range(orders)])
    monopoles = np.array([monopoles_efficiency(order, ka) for order in range(orders)])
    return {
        "equivalent_radiated_power": -10.0 * np.log10(exact),
        "monopoles": 10.0 * np.log10(np.maximum(monopoles, 1e-300) / exact),
    }


PRODUCT = 0.1e-9
"""CPU seconds for a panel and a pair of shapes."""
SMALLER = 0.8
"""Size of the sphere: two waves on a wall are shorter than those around the body."""


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
        """Return -2 dB, and what a smaller sphere with four poles is off, at least 4 dB."""
        return -2.0, max(4.0, *errors_db(SMALLER * ka)[self.model_name].tolist())

    def panel_power(
        self, hull: Hull, frequency: float, normal_velocity: ComplexArray, air: Air
    ) -> FloatArray:
        """Return rho c / 2 S abs(v_n)^2, (T,), W."""
        del frequency
        return np.asarray(0.5 * air.impedance * hull.areas * np.abs(normal_velocity) ** 2)
