"""Nominal tooth-root stress of ISO 6336-3 (2006), method B, of external gears cut by a rack; its symbols.

sigma_F0 = F_t/(b m_n) Y_F Y_S Y_beta with the load at the outer point of single pair tooth contact, for
2 > eps_alpha,n; clause 6 (form factor) and clause 7 (stress correction factor). Lengths in normal modules.
"""

from __future__ import annotations

import math
from typing import NamedTuple


class RootSection(NamedTuple):
    """Critical section: chord s_Fn, fillet radius rho_F, lever arm h_Fe, load angle alpha_Fen; factors."""

    chord: float
    radius: float
    arm: float
    load_angle: float
    form_factor: float
    stress_correction: float


def involute(angle: float) -> float:
    return math.tan(angle) - angle


def root_section(
    z: int,
    x: float,
    *,
    h_fp: float,
    rho_fp: float,
    h_ap: float,
    contact_ratio: float,
    alpha: float = math.radians(20.0),
    beta: float = 0.0,
) -> RootSection:
    """Critical section of one gear; `contact_ratio` is the transverse eps_alpha."""
    base_cosine = math.sqrt(1.0 - (math.sin(beta) * math.cos(alpha)) ** 2)
    z_n = z / (base_cosine**2 * math.cos(beta))
    e = 0.25 * math.pi - h_fp * math.tan(alpha) - (1.0 - math.sin(alpha)) * rho_fp / math.cos(alpha)
    g = rho_fp - h_fp + x
    h = 2.0 / z_n * (0.5 * math.pi - e) - math.pi / 3.0
    theta = math.pi / 6.0
    for _ in range(200):
        theta = 2.0 * g / z_n * math.tan(theta) - h
    third = math.pi / 3.0 - theta
    chord = z_n * math.sin(third) + math.sqrt(3.0) * (g / math.cos(theta) - rho_fp)
    radius = rho_fp + 2.0 * g**2 / (math.cos(theta) * (z_n * math.cos(theta) ** 2 - 2.0 * g))
    base, tip = 0.5 * z_n * math.cos(alpha), 0.5 * z_n + x + h_ap
    virtual_ratio = contact_ratio / base_cosine**2
    roll = math.sqrt(tip**2 - base**2) - math.pi * math.cos(alpha) * (virtual_ratio - 1.0)
    outer = math.hypot(roll, base)
    alpha_e = math.acos(base / outer)
    gamma = (0.5 * math.pi + 2.0 * x * math.tan(alpha)) / z_n + involute(alpha) - involute(alpha_e)
    load = alpha_e - gamma
    arm = 0.5 * (
        (math.cos(gamma) - math.sin(gamma) * math.tan(load)) * 2.0 * outer
        - z_n * math.cos(third)
        - g / math.cos(theta)
        + rho_fp
    )
    form = 6.0 * arm * math.cos(load) / (chord**2 * math.cos(alpha))
    slender, notch = chord / arm, chord / (2.0 * radius)
    correction = (1.2 + 0.13 * slender) * notch ** (1.0 / (1.21 + 2.3 / slender))
    return RootSection(chord, radius, arm, load, form, correction)


def nominal_stress(section: RootSection, tangential_force: float, width: float, module: float) -> float:
    """sigma_F0 of a spur gear (Y_beta = 1)."""
    return tangential_force / (width * module) * section.form_factor * section.stress_correction
