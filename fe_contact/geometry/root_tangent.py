"""Inclination of the surface of a tooth root: the tangents of ISO 6336-3."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fe_contact.geometry.flank_profile import FlankProfile
from fe_contact.types import FloatArray

CRITICAL_ANGLE = {1: math.radians(30.0), -1: math.radians(60.0)}
"""Tangent to the fillet that ISO 6336-3 takes for the critical section, external (+1) and internal gears."""

SAMPLES = 1001


def tangent_angle(profile: FlankProfile, s: ArrayLike) -> FloatArray:
    """Angle in rad between the surface at flank coordinates `s` and the tooth's center line.

    Taken in the transverse section; 0 where the surface is parallel to the center line, pi/2 in the middle
    of the tooth space of a large gear, negative above the waist of an undercut tooth.
    """
    normal = profile.normal(s)
    return np.asarray(np.arctan2(profile.gear.sign * normal[..., 1], normal[..., 0]))


def critical_section(profile: FlankProfile, samples: int = SAMPLES) -> float:
    """Flank coordinate in m where the fillet's tangent has `CRITICAL_ANGLE` with the tooth's center line.

    At an end of the fillet if it leans less or more everywhere. Interpolated linearly between `samples`.
    """
    angle = CRITICAL_ANGLE[profile.gear.sign]
    s = np.linspace(profile.s_form, profile.s_root, samples)
    return float(np.interp(angle, np.maximum.accumulate(tangent_angle(profile, s)), s))
