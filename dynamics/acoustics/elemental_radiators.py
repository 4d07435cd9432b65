"""Panels as small pistons that work against each other's sound.

References
----------
.. [1] Elliott, S. J.; Johnson, M. E.: Radiation modes and the active control of sound power. J. Acoust. Soc.
   Am. 94 (1993), 2194-2204.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.acoustics.air import Air
from dynamics.acoustics.hull import ComplexArray, Hull
from dynamics.acoustics.plane_waves import BLOCK as WAVES
from dynamics.acoustics.plane_waves import mutual_pressure, mutual_resistance, order_of, order_of_waves
from dynamics.types import FloatArray
from dynamics.work_cost import Cost

BLOCK = 512  # panels whose mutual resistances are held at a time
PAIR, PAIR_SHAPE = 48e-9, 0.1e-9
"""CPU seconds of a pair of panels: its resistance, and for each shape."""
WAVE, WAVE_SHAPE = 11e-9, 0.065e-9
"""CPU seconds of a panel and a plane wave: its phase, and for each shape; 720 to 13 520 panels."""
WAVES_HELD = 4
"""Arrays of phases."""


@dataclass(frozen=True)
class ElementalRadiators:
    """Panels smaller than the wavelength; mutual resistance by sin(kr)/(kr) of their distance.

    Attributes
    ----------
    baffled : bool
        True: every panel lies in the same rigid plane (Rayleigh integral, exact for it). False: every panel
        is a monopole in free space; the hull neither scatters nor shadows. It is right for what breathes
        below ka = 0.5, and 3.5 dB low for what oscillates as a whole there; see `multipoles`.
    """

    baffled: bool = False

    @property
    def model_name(self) -> str:
        """Return the name by which results are listed."""
        return "rayleigh_integral" if self.baffled else "monopoles"

    @property
    def solid_angle(self) -> float:
        """Return that into which each panel radiates, sr."""
        return 2.0 * np.pi if self.baffled else 4.0 * np.pi

    def resistance(self, hull: Hull, frequency: float, shapes: ComplexArray, air: Air) -> ComplexArray:
        """Return rho c k^2 / (2 pi or 4 pi) Q^H [sin(kr)/(kr)] Q with the volume velocities Q = S v_n.

        Raises
        ------
        InputError
            The panels are too large for the wavelength.
        """
        wavenumber = self._resolved(hull, frequency, air)
        volume_velocity = hull.areas[:, None] * shapes
        if self._by_waves(hull, wavenumber):
            total = mutual_resistance(hull.centers, volume_velocity, wavenumber)
        else:
            total = volume_velocity.conj().T @ _by_pairs(hull, volume_velocity, wavenumber)
        return np.asarray(self._factor(wavenumber, air) * 0.5 * (total + total.conj().T))

    def cost(self, panels: int, ka: float, shapes: int) -> Cost:
        """Predict the cost: by plane waves or pairs of panels, whichever `resistance` takes."""
        waves = 2 * order_of(ka) ** 2
        if self.baffled or waves >= panels:
            return Cost((PAIR + PAIR_SHAPE * shapes) * panels**2, 8.0 * panels * (6.0 * BLOCK + 3.0 * shapes))
        seconds = (WAVE + WAVE_SHAPE * shapes) * waves * panels
        return Cost(seconds, 8.0 * (WAVES_HELD * WAVES + 3.0 * panels * shapes))

    def error_band(self, ka: float) -> tuple[float, float]:
        """Return what monopoles were off on spheres and boxes, but for pulsation alone near ka = pi."""
        del ka
        return (-4.0, 5.0) if self.baffled else (-7.0, 2.0)

    def panel_power(
        self, hull: Hull, frequency: float, normal_velocity: ComplexArray, air: Air
    ) -> FloatArray:
        """Return the power that each panel gives to the sound of all, (T,), W.

        Raises
        ------
        InputError
            The panels are too large for the wavelength.
        """
        wavenumber = self._resolved(hull, frequency, air)
        flow = (hull.areas * normal_velocity)[:, None]
        if self._by_waves(hull, wavenumber):
            felt = mutual_pressure(hull.centers, flow, wavenumber)
        else:
            felt = _by_pairs(hull, flow, wavenumber)
        return np.asarray(0.5 * self._factor(wavenumber, air) * (flow.conj() * felt)[:, 0].real)

    def _resolved(self, hull: Hull, frequency: float, air: Air) -> float:
        """Return the wavenumber, 1/m, whose waves the panels resolve."""
        wavenumber = 2.0 * np.pi * frequency / air.sound_speed
        hull.require_resolved(wavenumber, air.sound_speed)
        return wavenumber

    def _by_waves(self, hull: Hull, wavenumber: float) -> bool:
        """Whether plane waves take less than pairs of panels."""
        return not self.baffled and 2 * order_of_waves(hull.centers, wavenumber) ** 2 < len(hull.triangles)

    def _factor(self, wavenumber: float, air: Air) -> float:
        """Return rho c k^2 over the solid angle, kg/(s m^4)."""
        return float(air.impedance * wavenumber**2 / self.solid_angle)


def _by_pairs(hull: Hull, volume_velocity: ComplexArray, wavenumber: float) -> ComplexArray:
    """Return [sin(kr)/(kr)] Q of all panels, (T, M)."""
    total = np.zeros(volume_velocity.shape, dtype=volume_velocity.dtype)
    for first in range(0, len(volume_velocity), BLOCK):
        block = slice(first, first + BLOCK)
        total[block] = _mutual(hull.centers[block], hull.centers, wavenumber) @ volume_velocity
    return total


def _mutual(rows: FloatArray, columns: FloatArray, wavenumber: float) -> FloatArray:
    """Return sin(kr)/(kr) of the distances between two sets of points, (A, B)."""
    squares = np.sum((rows[:, None] - columns) ** 2, axis=2)
    return np.asarray(np.sinc(wavenumber / np.pi * np.sqrt(squares)))
