"""Sound power of a vibrating hull by a radiation model, and its radiation efficiency.

A radiation model gives the radiation resistance R of shapes of normal velocity. With their complex peak
amplitudes v, the sound power is W = v^H R v / 2, whatever the model. Phasors are of e^{+i omega t}.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from dynamics.acoustics.air import Air
from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.types import FloatArray
from dynamics.work_cost import Cost


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
            Hz, above zero.
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

        Of bodies that breathe, move as a whole or bend once around, and of walls of boxes
        (docs/theory/sound-power.md).

        Parameters
        ----------
        ka : float
            Wavenumber times `Hull.equivalent_radius`.
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

    Raises
    ------
    InputError
        The frequency is not above zero, `shapes` are not (T, M) finite numbers, or the model refuses.
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

    Parameters
    ----------
    normal_velocity : (T,) array
        Complex peak amplitudes, m/s.

    Raises
    ------
    InputError
        As `resistance` does.
    """
    matrix = resistance(model, hull, frequency, np.asarray(normal_velocity)[:, None], air)
    return 0.5 * float(matrix[0, 0].real)


def panel_power(
    model: PanelModel, hull: Hull, frequency: float, normal_velocity: ComplexArray, air: Air
) -> FloatArray:
    """Return the sound power of every panel, (T,), W, as `PanelModel` has it; the sum is `sound_power`.

    Over the areas it is the active intensity normal to the hull, W/m^2.

    Parameters
    ----------
    frequency : float
        Hz.
    normal_velocity : (T,) array
        Complex peak amplitudes, m/s.

    Raises
    ------
    InputError
        As `sound_power` does.
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

    Raises
    ------
    InputError
        As `resistance` does, or if nothing moves.
    """
    moving = positive("normal_velocity", mean_square_velocity(hull, normal_velocity), "Nothing moves.")
    power = sound_power(model, hull, frequency, normal_velocity, air)
    return power / (air.impedance * hull.area * moving)
