"""Tooth stiffness of external gear pairs after ISO 6336-1, method B, in SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fe_contact.errors import positive
from fe_contact.geometry.gear import Gear
from fe_contact.geometry.gear_pair import GearPair
from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.geometry.toothing import Toothing

STEEL_STIFFNESS = 14e9
"""c' of pairs of steel teeth on solid bodies, N/m per m of face width: the usual value of clause 9.3."""
MEASURED_OVER_THEORY = 0.8
"""C_M: stiffness of measured gears over the theoretical stiffness."""
_PER_MM_UM = 1e9  # N/(mm um) in N/m per m of face width
_THINNEST_WEB = 0.2  # b_s/b
_THINNEST_RIM = 1.0  # s_R/m_n
_LOW_LINE_LOAD = 1e5  # N/m (100 N/mm): below it the stiffness falls with the load
_LOW_LOAD_EXPONENT = 0.25
_STEEL_MODULUS = 206e9
"""Young's modulus of the steel pairs of the series, Pa; others scale."""
_SERIES = (0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182)
"""C_1 to C_9 of the flexibility q', mm um/N."""


@dataclass(frozen=True)
class Iso6336Stiffness:
    """Stiffness per unit face width, N/m per m."""

    theoretical_single_stiffness: float
    """c'_th, of one pair of teeth with solid disc bodies."""
    single_stiffness: float
    """c': the largest stiffness of one pair of teeth, normal to the flank in the transverse plane."""
    mesh_stiffness: float
    """c_gamma_alpha: the mean over the cycle."""
    face_load_mesh_stiffness: float
    """c_gamma_beta, for face load factors."""


def iso6336_stiffness(pair: GearPair, line_load: float | None = None) -> Iso6336Stiffness:
    """Return the tooth stiffness of `pair` (ISO 6336-1, method B), whose blanks are the gear bodies.

    Parameters
    ----------
    pair : GearPair
        External gears. Gear 1 of the series is the smaller one, whichever drives; it was fitted for -0.5 <=
        x_1 + x_2 <= 2 and x_1 >= x_2.
    line_load : float, optional
        Specific load F_t K_A / b in N/m; below 1e5 N/m the stiffness falls with its fourth root. Default:
        1e5 N/m or more.
    """
    gears = sorted((pair.pinion, pair.wheel), key=lambda gear: (gear.teeth, -gear.profile_shift_coefficient))
    theoretical = _PER_MM_UM / _flexibility(*gears)
    rack = 0.5 * (_rack_factor(pair.pinion) + _rack_factor(pair.wheel))
    body = 0.5 * (blank_factor(pair.pinion) + blank_factor(pair.wheel))
    single = (
        theoretical
        * MEASURED_OVER_THEORY
        * body
        * rack
        * math.cos(pair.pinion.helix_angle)
        * modulus_ratio(pair)
    )
    if line_load is not None:
        single *= min(1.0, positive("line_load", line_load) / _LOW_LINE_LOAD) ** _LOW_LOAD_EXPONENT
    mesh = single * (0.75 * pair.transverse_contact_ratio + 0.25)
    return Iso6336Stiffness(theoretical, single, mesh, 0.85 * mesh)  # factors of the standard


def blank_factor(gear: Toothing) -> float:
    """Return the gear blank factor C_R of ISO 6336-1 (method B): 1 for a solid disc, below 1 with a web.

    C_R = 1 + ln(b_s/b) / (5 exp(s_R / (5 m_n))), with b_s/b taken as at least 0.2 and s_R/m_n as at least 1.
    """
    if gear.web is None:
        return 1.0
    web = max(gear.web.thickness / gear.face_width, _THINNEST_WEB)
    rim = max(gear.rim_thickness / gear.normal_module, _THINNEST_RIM)
    return 1.0 + math.log(web) / (5.0 * math.exp(0.2 * rim))


def _flexibility(small: Gear, large: Gear) -> float:
    """Return the flexibility q' in mm um/N by the series of the standard."""
    c1, c2, c3, c4, c5, c6, c7, c8, c9 = _SERIES
    x1, x2 = small.profile_shift_coefficient, large.profile_shift_coefficient
    z1, z2 = _virtual_teeth(small), _virtual_teeth(large)
    linear = c1 + c2 / z1 + c3 / z2 + c4 * x1 + c5 * x1 / z1 + c6 * x2 + c7 * x2 / z2
    return linear + c8 * x1**2 + c9 * x2**2


def _virtual_teeth(gear: Gear) -> float:
    """Return z_n, the teeth of the virtual spur gear."""
    return gear.teeth / (math.cos(gear.base_helix_angle) ** 2 * math.cos(gear.helix_angle))


def _rack_factor(gear: Gear) -> float:
    """Return C_B, the factor of basic racks other than h_fP = 1.2 m_n and alpha = 20 deg."""
    height = 1.0 + 0.5 * (1.2 - gear.dedendum_coefficient)
    return height * (1.0 - 0.02 * (20.0 - math.degrees(gear.normal_pressure_angle)))


def modulus_ratio(pair: ParallelAxes) -> float:
    """Return the harmonic mean of both moduli over that of steel, since the series is for steel pairs."""
    moduli = pair.pinion.material.youngs_modulus, pair.wheel.material.youngs_modulus
    mean = 2.0 * moduli[0] * moduli[1] / sum(moduli)
    return mean / _STEEL_MODULUS
