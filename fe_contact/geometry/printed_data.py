"""Printed digits of data sheets, and the change of backlash by their rounding (docs/theory/geometry.md).

Nominal gears have no backlash: the center distance follows from their profile shifts, or the sum of the
shifts from the center distance. A sheet prints rounded values of both, with which the teeth may overlap. Each
printed value is off by at most half its last digit. To first order, backlash is off by at most the sum of its
changes by these halves.

The last digit of a value is the first of the customary ones of which the value is a whole multiple.
A value on the round grid of its kind was chosen, not rounded: a module of ISO 54, a shift of 0, a center
distance in half millimeters, a helix angle in tenths of a degree.
Numbers of teeth, pressure angles and thickness allowances are exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fe_contact.geometry.backlash import working_pressure_angle
from fe_contact.geometry.toothing import Toothing

CONVERSION = 1e-6
"""Difference from a whole number of digits that is rounding of the conversion into SI."""


@dataclass(frozen=True)
class _PrintedDigits:
    """The printed form of a quantity."""

    last: tuple[float, ...]
    """Customary units of the last digit, m or 1. A sheet prints the first that divides all its values."""
    round_grid: float = 0.0
    """Grid of chosen values: its multiples are exact. 0: no grid."""

    def rounding(self, *values: float) -> float:
        """Return the largest change by printing of each of the values, which stand on one sheet."""
        if all(_is_multiple(value, self.round_grid) for value in values):
            return 0.0
        fits = (digit for digit in self.last if all(_is_multiple(value, digit) for value in values))
        return 0.5 * next(fits, self.last[-1])


PROFILE_SHIFT = _PrintedDigits(last=(1e-3, 1e-4))
CENTER_DISTANCE = _PrintedDigits(last=(1e-5, 1e-6), round_grid=5e-4)
NORMAL_MODULE = _PrintedDigits(last=(1e-6, 1e-7), round_grid=5e-6)
HELIX_ANGLE = _PrintedDigits(
    last=tuple(math.radians(degrees) for degrees in (0.01, 1.0 / 60.0, 1.0 / 3600.0)),
    round_grid=math.radians(0.1),
)


def backlash_rounding(pinion: Toothing, wheel: Toothing, center_distance: float) -> float:
    """Return the largest change of the backlash of a pair, m, by printing x_1, x_2, a, m_n and beta.

    With the base module m_b = m_t cos(alpha_t) and j = 0::

        dj/dx = -2 m_b tan(alpha_n)                                   either gear
        dj/da = 2 sin(alpha_wt)                                       internal: negative
        dj/dm_n = -(a / m_n) dj/da                                    j has the degree 1 in lengths
        dj/dbeta = -2 (r_b1 + r_b2) tan(beta) cos^2(alpha_t) [tan(alpha_wt) + tan^3(alpha_t)]
    """
    working = working_pressure_angle(pinion, wheel, center_distance)
    by_distance = 2.0 * math.sin(working)
    by_module = by_distance * center_distance / pinion.normal_module
    return (
        _by_shift(pinion, wheel)
        + by_distance * CENTER_DISTANCE.rounding(center_distance)
        + by_module * NORMAL_MODULE.rounding(pinion.normal_module)
        + _by_helix(pinion, center_distance, working) * HELIX_ANGLE.rounding(pinion.helix_angle)
    )


def _by_shift(pinion: Toothing, wheel: Toothing) -> float:
    """Return the change of backlash by the rounding of both profile shifts, m; a shift of 0 is exact."""
    shifts = [gear.profile_shift_coefficient for gear in (pinion, wheel)]
    shifts = [shift for shift in shifts if shift]
    base_module = pinion.base_pitch / math.pi
    slope = 2.0 * base_module * math.tan(pinion.normal_pressure_angle)
    return slope * len(shifts) * PROFILE_SHIFT.rounding(*shifts)


def _by_helix(pinion: Toothing, center_distance: float, working: float) -> float:
    """Return the size of dj/dbeta at a working pressure angle, m per rad."""
    transverse = pinion.transverse_pressure_angle
    bracket = math.tan(working) + math.tan(transverse) ** 3
    base_radii = center_distance * math.cos(working)
    helix = math.tan(abs(pinion.helix_angle))
    return 2.0 * base_radii * helix * math.cos(transverse) ** 2 * bracket


def _is_multiple(value: float, unit: float) -> bool:
    """Return whether a value is a whole number of units, up to rounding of its conversion into SI."""
    if value == 0.0:
        return True
    count = value / unit if unit else math.inf
    return math.isfinite(count) and abs(count - round(count)) < CONVERSION
