"""Nominal intensities of a tooth load by closed forms: orders of magnitude before anything is solved.

.. [1] ISO 6336-2:2019, clause 6: nominal contact stress at the pitch point.
.. [2] ISO 6336-3:2019, clauses 6 and 7: form factor Y_F and stress correction factor Y_S.
.. [3] ISO 6336-1:2019, clause 9: c' = 14 N/(mm um) of steel gears.
"""

from __future__ import annotations

import math

import numpy as np

from fe_contact.geometry import ParallelAxes, tooth_profile
from fe_contact.geometry.iso6336_stiffness import STEEL_STIFFNESS
from fe_contact.geometry.root_tangent import critical_section, tangent_angle
from fe_contact.geometry.toothing import Toothing
from fe_contact.hertz import contact_modulus, peak_pressure
from fe_contact.material import STEEL

_SAMPLES = 33
"""Points of the fillet among which the critical section is sought."""

_NOTCH = (1.0, 8.0)
"""Range in which the stress correction factor is valid: chord over twice the root radius [2]_."""


def _line_load(pair: ParallelAxes, normal_force: float) -> float:
    """Return the load per length of contact, N/m."""
    ratio, overlap = pair.transverse_contact_ratio, min(pair.overlap_ratio, 1.0)
    # the least number of pairs in contact; for wide helical gears their mean number
    sharing_pairs = (1.0 - overlap) * max(1.0, math.floor(ratio)) + overlap * max(1.0, ratio)
    return normal_force * math.cos(pair.base_helix_angle) / (pair.face_width * sharing_pairs)


def pitch_point_pressure(pair: ParallelAxes, normal_force: float) -> float:
    """Return the Hertz pressure with contact at the pitch point, Pa [1]_."""
    curvature = float(pair.relative_curvature(pair.path_of_contact.pitch_point))
    radius = 1.0 / (curvature * math.cos(pair.base_helix_angle))
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    return float(peak_pressure(_line_load(pair, normal_force), radius, modulus))


def nominal_deflection(pair: ParallelAxes, normal_force: float) -> float:
    """Return the deflection of the teeth along the line of action, m [3]_."""
    moduli = [gear.material.youngs_modulus for gear in (pair.pinion, pair.wheel)]
    mean = 2.0 * moduli[0] * moduli[1] / sum(moduli)
    return _line_load(pair, normal_force) / (STEEL_STIFFNESS * mean / STEEL.youngs_modulus)


def nominal_root_stresses(pair: ParallelAxes, normal_force: float) -> tuple[float, float]:
    """Return the nominal root stress of pinion and wheel, Pa: load at the end of single contact [2]_.

    For spur gears it is method B without its load factors; for helical gears the transverse section replaces
    the virtual spur gear.
    """
    path, load = pair.path_of_contact, _line_load(pair, normal_force)
    high = min(path.start + path.base_pitch, path.end)
    low = max(path.end - path.base_pitch, path.start)
    on_wheel = float(pair.mating_roll_length(low))
    return _root_stress(pair.pinion, load, high), _root_stress(pair.wheel, load, on_wheel)


def _root_stress(gear: Toothing, load: float, roll_length: float) -> float:
    """Return the stress at the root section by the load (N/m) at a roll length, with its notch factor, Pa."""
    profile = tooth_profile(gear)
    critical = critical_section(profile, _SAMPLES)
    section = profile.flank(np.array([critical]))[0]
    arc = gear.sign * roll_length**2 / (2.0 * gear.base_radius)  # of the involute from its base
    point, normal = profile.flank(np.array([arc]))[0], profile.normal(np.array([arc]))[0]
    chord = 2.0 * float(section[0])
    # the arm of the load about the section, where its line crosses the center line of the tooth (x = 0)
    lever = abs(float(point[1] - point[0] * normal[1] / normal[0] - section[1]))
    bending = 6.0 * lever * abs(float(normal[0])) * load / chord**2
    step = 0.01 * profile.fillet_length
    turn = float(np.ptp(tangent_angle(profile, np.array([critical - step, critical + step]))))
    # chord over twice the radius of curvature, which is 2 step / turn
    sharpness = min(max(chord * turn / (4.0 * step), _NOTCH[0]), _NOTCH[1])
    slimness = chord / max(lever, 1e-9 * chord)
    notch_factor = (1.2 + 0.13 * slimness) * sharpness ** (1.0 / (1.21 + 2.3 / slimness))  # Y_S [2]_
    return float(bending * notch_factor)
