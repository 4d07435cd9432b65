"""Stiffness of uncoupled slices from the series of ISO 6336-1, method B; it was fitted to external pairs."""

from __future__ import annotations

import numpy as np

from fe_contact.contact import Candidates
from fe_contact.geometry import GearPair, ParallelAxes
from fe_contact.geometry.iso6336_stiffness import MEASURED_OVER_THEORY, iso6336_stiffness
from fe_contact.types import FloatArray


def mean_stiffness(pair: ParallelAxes, candidates: Candidates) -> FloatArray:
    """Stiffness per unit width whose mean over the cycle of all pairs is c_gamma_alpha, N/m per m."""
    value = iso6336_stiffness(_external(pair)).mesh_stiffness / pair.transverse_contact_ratio
    return np.full(candidates.gap.shape, value)


def parabolic_stiffness(pair: ParallelAxes, candidates: Candidates) -> FloatArray:
    """Stiffness per unit width c'/C_M (1 - k xi^2), xi from -1 to 1 along the path of contact, N/m per m.

    Its mean over the path, 1 - k/3, is (0.75 eps_alpha + 0.25)/eps_alpha, hence k = 0.75 (1 - 1/eps_alpha);
    a tip edge that touches beyond the path has the stiffness of its end.
    """
    largest = iso6336_stiffness(_external(pair)).single_stiffness / MEASURED_OVER_THEORY
    path = pair.path_of_contact
    phase = candidates.position - np.floor(candidates.position)
    roll, _ = pair.roll_lengths(phase[:, None], candidates.pair)
    roll = roll - candidates.face_position * np.tan(pair.base_helix_angle)
    along = np.clip(2.0 * (roll - path.start) / path.length - 1.0, -1.0, 1.0)
    drop = 0.75 * (1.0 - 1.0 / pair.transverse_contact_ratio)
    return np.asarray(largest * (1.0 - drop * along**2))


def _external(pair: ParallelAxes) -> GearPair:
    """Return the pair as an external one; callers have refused any other."""
    if not isinstance(pair, GearPair):
        raise TypeError("the stiffness of ISO 6336-1 applies to external pairs only")
    return pair
