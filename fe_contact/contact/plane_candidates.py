"""Contact candidates of a plane model: one per tooth pair, on the line of action or at a tip edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.contact.patch import Patches, tip_patches
from fe_contact.contact.problem import Candidates
from fe_contact.geometry import Gear, GearPair, corner_contact
from fe_contact.hertz import relative_radius
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
    touch = _line_of_action(pair, roll_1, roll_2)
    if model.corner_contact:
        _add_corners(pair, roll_1, roll_2, touch)
    for term in model.gaps:
        touch.gap += np.where(np.isfinite(touch.gap), term(pair, touch.roll_1, touch.roll_2), 0.0)
    keep = np.any(np.isfinite(touch.gap), axis=0)
    return _candidates(pair, position, index[keep], touch.columns(keep), rule)


@dataclass
class _Touch:
    """Touching points under construction; arrays (P, n)."""

    roll_1: FloatArray
    roll_2: FloatArray
    gap: FloatArray
    arm_1: FloatArray
    arm_2: FloatArray
    corner_slope: FloatArray

    def columns(self, keep: FloatArray) -> _Touch:
        """Keep some pairs."""
        return _Touch(*(getattr(self, name)[:, keep] for name in self.__dataclass_fields__))


def _pair_indices(pair: GearPair, position: FloatArray) -> IntArray:
    """Return all pairs between A and E, and one more beyond either end."""
    path = pair.path_of_contact
    first = np.floor((path.start - path.pitch_point) / path.base_pitch - position.max())
    last = np.ceil((path.end - path.pitch_point) / path.base_pitch - position.min())
    return np.arange(int(first), int(last) + 1)


def _line_of_action(pair: GearPair, roll_1: FloatArray, roll_2: FloatArray) -> _Touch:
    """Conjugate contact from A to E: no gap, arms of the base circles."""
    inside = (roll_1 <= pair.pinion.tip_roll_length) & (roll_2 <= pair.wheel.tip_roll_length)
    one = np.ones_like(roll_1)
    return _Touch(
        np.clip(roll_1, pair.path_of_contact.start, pair.pinion.tip_roll_length),
        np.clip(roll_2, pair.common_tangent - pair.path_of_contact.end, pair.wheel.tip_roll_length),
        np.where(inside, 0.0, np.inf),
        one,
        one.copy(),
        np.full_like(roll_1, np.nan),
    )


def _add_corners(pair: GearPair, roll_1: FloatArray, roll_2: FloatArray, touch: _Touch) -> None:
    """Fill in tip-edge contact before A (edge of gear 2) and after E (edge of gear 1)."""
    for side, overshoot, flank_roll in (
        ("approach", roll_2 - pair.wheel.tip_roll_length, touch.roll_1),
        ("exit", roll_1 - pair.pinion.tip_roll_length, touch.roll_2),
    ):
        beyond = overshoot > 0.0
        corner = corner_contact(pair, side, overshoot[beyond])  # type: ignore[arg-type]
        touch.gap[beyond] = np.where(corner.valid, corner.gap, np.inf)
        flank_roll[beyond] = np.where(corner.valid, corner.flank_roll_length, flank_roll[beyond])
        touch.arm_1[beyond] = np.where(corner.valid, corner.lever_arm_ratio_pinion, 1.0)
        touch.arm_2[beyond] = np.where(corner.valid, corner.lever_arm_ratio_wheel, 1.0)
        touch.corner_slope[beyond] = np.where(corner.valid, corner.slope_angle, np.nan)


def _candidates(
    pair: GearPair,
    position: FloatArray,
    index: IntArray,
    touch: _Touch,
    rule: PatchRule,
) -> Candidates:
    """Turn touching points into patches, curvatures and edge angles."""
    cosine = np.cos(pair.base_helix_angle)
    radius = relative_radius(touch.roll_1, touch.roll_2) / cosine
    s_1, tip_1 = _flank_coordinates(pair.pinion, touch.roll_1)
    s_2, tip_2 = _flank_coordinates(pair.wheel, touch.roll_2)
    opening = np.nan_to_num(touch.corner_slope) * radius
    offset_1 = np.where(s_1 < tip_1, tip_1 - s_1, -opening)
    offset_2 = np.where(s_2 < tip_2, tip_2 - s_2, -opening)
    return Candidates(
        position=position,
        pair=index,
        patch_1=_patches(s_1, offset_1, tip_1, _shift(s_2, offset_2, tip_2, rule), rule),
        patch_2=_patches(s_2, offset_2, tip_2, _shift(s_1, offset_1, tip_1, rule), rule),
        gap=touch.gap,
        lever_1=touch.arm_1,
        lever_2=touch.arm_2,
        radius=radius,
        edge_slope=-np.minimum(offset_1, offset_2) / radius,
        width=np.full(index.size, pair.face_width / cosine),
        base_helix_cosine=float(cosine),
    )


def _flank_coordinates(gear: Gear, roll: FloatArray) -> tuple[FloatArray, float]:
    """Flank coordinates of roll lengths, and of the tip edge, m."""
    return roll**2 / (2.0 * gear.base_radius), gear.tip_roll_length**2 / (2.0 * gear.base_radius)


def _shift(s: FloatArray, offset: FloatArray, tip: float, rule: PatchRule) -> FloatArray:
    """How far the partner's edge moves the load's centroid to its root, m: both forces must be in line."""
    return np.maximum(s - tip_patches(s, offset, tip, rule.half_width, rule.edge_length).centroid, 0.0)


def _patches(s: FloatArray, offset: FloatArray, tip: float, shift: FloatArray, rule: PatchRule) -> Patches:
    """Patches of one gear; beside the partner's edge they follow its load towards the own tip."""
    return tip_patches(s + shift, offset - shift, tip, rule.half_width, rule.edge_length)
