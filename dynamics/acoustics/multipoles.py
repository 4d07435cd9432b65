"""Radiation efficiencies of a sphere that moves in spherical harmonics, and the models' errors by them.

A housing is none, but its size over the wavelength, ka, and how many parts of its surface move against each
other, the order n, say how far a radiation model is off: 0 pulsation, 1 oscillation, 2 ovaling.

References
----------
.. [1] Morse, P. M.; Ingard, K. U.: Theoretical Acoustics. McGraw-Hill 1968, section 7.2.
"""

from __future__ import annotations

import numpy as np
from scipy.special import spherical_jn, spherical_yn

from dynamics.checks import integer, positive
from dynamics.types import FloatArray


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
