"""Contact candidates of a plane model: one per tooth pair, on the line of action or at a tip edge."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.contact.patch import Patches, tip_patches
from fe_contact.contact.problem import Candidates
from fe_contact.contact.touch import Touch, conjugate_touch, flank_coordinate, modified_touch
from fe_contact.geometry import GearPair
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class PatchRule:
    """How wide the load patches are.

    Attributes
    ----------
    half_width : float
        Away from the tip edges, m.
    edge_length : float
        Length of the patch at a tip edge, m.
    """

    half_width: float
    edge_length: float


def plane_candidates(
    pair: GearPair,
    model: ContactModel,
    position: FloatArray,
    rule: PatchRule,
) -> Candidates:
    """Find where the tooth pairs can touch at each position.

    Parameters
    ----------
    pair : GearPair
    model : ContactModel
    position : ndarray, shape (P,)
        Base pitches by the driving gear's angle.
    rule : PatchRule

    Returns
    -------
    Candidates
        Pairs that touch nowhere are left out.
    """
    index = _pair_indices(pair, position)
    roll_1, roll_2 = pair.roll_lengths(position[:, None], index[None, :])
    touch = conjugate_touch(pair, roll_1, roll_2, model.corner_contact)
    if model.gaps:
        touch = modified_touch(pair, touch, model.gaps)
    keep = np.any(np.isfinite(touch.gap), axis=0)
    return _candidates(pair, position, index[keep], touch.columns(keep), rule)


def _pair_indices(pair: GearPair, position: FloatArray) -> IntArray:
    """Return all pairs between A and E, and one more beyond either end."""
    path = pair.path_of_contact
    first = np.floor((path.start - path.pitch_point) / path.base_pitch - position.max())
    last = np.ceil((path.end - path.pitch_point) / path.base_pitch - position.min())
    return np.arange(int(first), int(last) + 1)


def _candidates(
    pair: GearPair, position: FloatArray, index: IntArray, touch: Touch, rule: PatchRule
) -> Candidates:
    """Turn touching points into patches, curvatures and edge angles."""
    cosine = math.cos(pair.base_helix_angle)
    tip_1 = float(flank_coordinate(pair.pinion, pair.pinion.tip_roll_length))
    tip_2 = float(flank_coordinate(pair.wheel, pair.wheel.tip_roll_length))
    shift_1 = _shift(touch.s_2, touch.offset_2, tip_2, rule)
    shift_2 = _shift(touch.s_1, touch.offset_1, tip_1, rule)
    radius = touch.radius / cosine
    return Candidates(
        position=position,
        pair=index,
        patch_1=_patches(touch.s_1, touch.offset_1, tip_1, shift_1, rule),
        patch_2=_patches(touch.s_2, touch.offset_2, tip_2, shift_2, rule),
        gap=touch.gap,
        lever_1=touch.lever_1,
        lever_2=touch.lever_2,
        radius=radius,
        edge_slope=-np.minimum(touch.offset_1, touch.offset_2) / radius,
        width=np.full(index.size, pair.face_width / cosine),
        base_helix_cosine=cosine,
    )


def _shift(s: FloatArray, offset: FloatArray, tip: float, rule: PatchRule) -> FloatArray:
    """How far the partner's edge moves the load's centroid to its root, m: both forces must be in line."""
    return np.maximum(s - tip_patches(s, offset, tip, rule.half_width, rule.edge_length).centroid, 0.0)


def _patches(s: FloatArray, offset: FloatArray, tip: float, shift: FloatArray, rule: PatchRule) -> Patches:
    """Patches of one gear; beside the partner's edge they follow its load towards the own tip."""
    return tip_patches(s + shift, offset - shift, tip, rule.half_width, rule.edge_length)
