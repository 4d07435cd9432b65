"""Sliding along the path of contact: the position of the load and the sense in which it slides.

A pair that touches at y from the pitch point, along the line of action in the sense in which the driving
flank pushes, slides at (omega_1 + omega_2) y. Friction on the driven gear has the sign of y, and its moment
about the pitch point the arm y.
"""

from __future__ import annotations

import math

import numpy as np

from fe_contact.ste.fields import SteFields
from fe_contact.types import FloatArray

SMOOTHING = 0.01
"""Half width of the smoothed change of direction at the pitch point, base pitches."""


def sliding(database: SteFields) -> tuple[FloatArray, FloatArray]:
    """Return sum of share sign(y) and sum of share |y| (m) over the pairs, both (P, F, M, D).

    The sign is y/sqrt(y^2 + h^2), h `SMOOTHING` base pitches. On helical teeth the load of a pair lies
    uniformly on its line of contact over the whole face, which spans b tan(beta_b) of the path.
    """
    facts = database.facts
    phase = database.position - np.floor(database.position)
    y = (phase[:, None] + database.pair) * facts.base_pitch
    half = 0.5 * facts.face_width * math.tan(facts.base_helix_angle)
    direction, arm = _averages(y, half, SMOOTHING * facts.base_pitch)
    total = database.load_share.sum(axis=-1)
    share = database.load_share / np.where(total > 0.0, total, 1.0)[..., None]
    return np.einsum("pfmdn,pn->pfmd", share, direction), np.einsum("pfmdn,pn->pfmd", share, arm)


def _averages(y: FloatArray, half: float, width: float) -> tuple[FloatArray, FloatArray]:
    """Means of the smoothed sign(y) and of y sign(y) over y - half .. y + half."""
    if half <= 1e-9 * width:
        root = np.sqrt(y**2 + width**2)
        return np.asarray(y / root), np.asarray(y**2 / root)
    low, high = y - half, y + half
    root_low, root_high = np.sqrt(low**2 + width**2), np.sqrt(high**2 + width**2)
    arm = high * root_high - low * root_low - width**2 * (np.arcsinh(high / width) - np.arcsinh(low / width))
    return np.asarray((root_high - root_low) / (2.0 * half)), np.asarray(arm / (4.0 * half))
