"""The play of a bearing row at temperature, by the pressure between rings, shaft and housing.

References
----------
.. [1] S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed. 1970, section 28: thick cylinders.
.. [2] T. A. Harris, M. N. Kotzalas, Essential Concepts of Bearing Technology, 5th ed. 2006, chapter 3: play
   by interference and temperature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

from dynamics.bearings.ring_fits import RingFits
from dynamics.shafts.bodies import STEEL_POISSON_RATIO, STEEL_YOUNGS_MODULUS


@dataclass(frozen=True)
class Cylinder:
    """A hollow or solid cylinder."""

    bore: float
    outer: float
    """`bore`, `outer`: Diameters, m."""
    youngs_modulus: float = STEEL_YOUNGS_MODULUS
    poissons_ratio: float = STEEL_POISSON_RATIO
    """`youngs_modulus`, `poissons_ratio`: Pa, 1."""
    strain: float = 0.0
    """Thermal strain."""

    @property
    def _stretch(self) -> float:
        return (self.outer**2 + self.bore**2) / (self.outer**2 - self.bore**2)

    @property
    def shrinkage(self) -> float:
        """Return the decrease of the outer diameter over itself, per pressure on it, 1/Pa [1]_."""
        return (self._stretch - self.poissons_ratio) / self.youngs_modulus

    @property
    def widening(self) -> float:
        """Return the increase of the bore over itself, per pressure in it, 1/Pa [1]_."""
        return (self._stretch + self.poissons_ratio) / self.youngs_modulus

    def far_side(self, pressed: float) -> float:
        """Return the increase of the free diameter, m per Pa of pressure on the diameter `pressed` (m) [1]_.

        A pressure in the bore widens the outside, one on the outside narrows the bore.
        """
        sign, free = (1.0, self.outer) if pressed == self.bore else (-1.0, self.bore)
        wall = self.outer**2 - self.bore**2
        return sign * 2.0 * pressed**2 * free / (self.youngs_modulus * wall)


def fit_pressure(inside: Cylinder, around: Cylinder, interference: float) -> float:
    """Return the pressure between two cylinders by their interference in diameter (m), Pa; loose: 0 [1]_."""
    compliance = around.bore * (inside.shrinkage + around.widening)
    return max(interference, 0.0) / compliance


@dataclass(frozen=True)
class WarmRings:
    """Play and interference of a row at temperature."""

    play: float
    """Change of the row's clearance, m: along the axis if the row has a contact angle, else across it."""
    interference: tuple[float, float] | None
    """Interference of the inner ring on the shaft and of the outer ring in its bore, m; < 0: loose. None: no
    fits are stated.
    """


class _Row(Protocol):
    """Geometry of a row that its play follows from, in m and rad."""

    @property
    def pitch_diameter(self) -> float: ...
    @property
    def contact_angle(self) -> float: ...
    @property
    def raceways(self) -> tuple[float, float]: ...


def warm_rings(
    row: _Row, fits: RingFits | None, strain: tuple[float, float], shaft: Cylinder, housing: Cylinder
) -> WarmRings:
    """Return the play of a row whose inner and outer ring have a thermal `strain`.

    Its elements are as warm as the mean of both rings. The play across the axis grows by the difference of
    the strains times the pitch diameter, and by the change of the raceways' diameters under the pressure of
    the fits [2]_. The play along the axis of a row with a contact angle grows by 1/(2 tan) of that. Fits
    press, or come loose; they do not pull. `shaft`, `housing`: what the rings sit on and in; the diameters of
    the seats themselves are those of the fits.
    """
    across, interference = row.pitch_diameter * (strain[1] - strain[0]), None
    if fits is not None:
        growth, interference = _by_fits(row.raceways, fits, strain, shaft, housing)
        across += growth
    angle = abs(row.contact_angle)
    return WarmRings(across / (2.0 * math.tan(angle)) if angle else across, interference)


def _by_fits(
    raceways: tuple[float, float],
    fits: RingFits,
    strain: tuple[float, float],
    shaft: Cylinder,
    housing: Cylinder,
) -> tuple[float, tuple[float, float]]:
    """Return the growth of the play across the axis by changed fits, and the interference left, m."""
    inner, outer = Cylinder(fits.bore, raceways[0]), Cylinder(raceways[1], fits.outside_diameter)
    on_shaft = fits.shaft_interference + fits.bore * (shaft.strain - strain[0])
    in_bore = fits.housing_interference + fits.outside_diameter * (strain[1] - housing.strain)
    shaft, housing = replace(shaft, outer=fits.bore), replace(housing, bore=fits.outside_diameter)

    def pressed(inside: Cylinder, around: Cylinder, before: float, after: float) -> float:
        return fit_pressure(inside, around, after) - fit_pressure(inside, around, before)

    at_shaft = pressed(shaft, inner, fits.shaft_interference, on_shaft)
    at_bore = pressed(outer, housing, fits.housing_interference, in_bore)
    growth = outer.far_side(outer.outer) * at_bore - inner.far_side(inner.bore) * at_shaft
    return growth, (on_shaft, in_bore)
