"""The loaded flank with its modification: the exact profile less the material removed along its normal."""

from __future__ import annotations

import numpy as np

from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.types import FloatArray


def material_removed(gear: Toothing, s: FloatArray, face: float = 0.0) -> FloatArray:
    """Return the material removed along the normal at flank coordinates, m; it fades out over the fillet.

    `face` is the face position from mid-face, m.
    """
    profile = tooth_profile(gear)
    roll = profile.roll_length(np.clip(s, profile.s_form, profile.s_tip))
    return removed_at_roll(gear, roll, face) * np.clip((s - profile.s_root) / profile.fillet_length, 0.0, 1.0)


def removed_at_roll(gear: Toothing, roll: FloatArray, face: float = 0.0) -> FloatArray:
    """Return the material removed at roll lengths, m; beyond the involute that of its ends."""
    ends = gear.form_roll_length, gear.tip_roll_length
    within = np.clip(roll, min(ends), max(ends))
    return np.asarray(gear.modification.material_removed(gear, within, face), dtype=float)


def kinks(gear: Toothing) -> FloatArray:
    """Return the flank coordinates where the slope or the curvature of the flank jumps, m, rising."""
    profile = tooth_profile(gear)
    starts = [float(start.roll_length) for start in gear.modification.relief_starts(gear)]
    reliefs = gear.sign * 0.5 * np.square(starts) / gear.base_radius
    inner = np.concatenate([[profile.s_root, profile.s_form], reliefs])
    close = 1e-6 * gear.normal_module
    inner = np.unique(inner[(inner > profile.s_space + close) & (inner < profile.s_tip - close)])
    return np.asarray(inner[np.diff(inner, prepend=-np.inf) > close])
