"""Contact candidates: one per tooth pair and slice, on the line of action or at a tip edge."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.contact.patch import Patches, tip_patches
from fe_contact.contact.problem import Candidates
from fe_contact.contact.slices import Slices
from fe_contact.contact.touch import Touch, conjugate_touch, flank_coordinate, modified_touch
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.hertz import wedge_softness
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class PatchRule:
    """How wide the load patches are.

    Attributes
    ----------
    half_width : float
        Away from the tip edges, m.
    edge_length : float
        Least length of the patch at a tip edge, m.
    edge_load : float
        4 p/(pi E*) of the line load p whose strip the patch at a tip edge follows, m.
    """

    half_width: float
    edge_length: float
    edge_load: float = 0.0

    def lengths(self, offset: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the lengths of patches at a tip edge, m: those of the strip, (4) of docs/theory/hertz.md.

        Parameters
        ----------
        offset : ndarray
            Distance t of the contact from the edge, m; negative = -phi R off the line of action.
        radius : ndarray
            Relative radius R in the normal section, m.
        """
        strip = (2.0 / 3.0) * (offset + np.sqrt(np.square(offset) + 3.0 * self.edge_load * radius))
        return np.clip(strip, self.edge_length, 2.0 * self.half_width)


def contact_candidates(
    pair: ParallelAxes, model: ContactModel, position: FloatArray, rule: PatchRule, slices: Slices
) -> Candidates:
    """Find where the tooth pairs can touch at each position.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    model : ContactModel
        Whether tip edges may touch; its gaps are added by `with_gaps`.
    position : ndarray, shape (P,)
        Base pitches by the driving gear's angle.
    rule : PatchRule
    slices : Slices

    Returns
    -------
    Candidates
        Of plain involutes: n = pairs x slices, pairs that touch nowhere left out.
    """
    index = _pair_indices(pair, position, slices)
    pairs, face = np.repeat(index, slices.center.size), np.tile(slices.center, index.size)
    roll_1, _ = pair.roll_lengths(position[:, None], pairs)
    # on a right-hand driving gear the contact line runs towards the root as the face position grows
    roll_1 = roll_1 - face * math.tan(pair.base_helix_angle)
    touch = conjugate_touch(pair, roll_1, pair.mating_roll_length(roll_1), model.corner_contact)
    touching = np.any(np.isfinite(touch.gap), axis=0).reshape(index.size, -1).any(axis=1)
    keep = np.repeat(touching, slices.center.size)
    return _candidates(pair, position, pairs[keep], face[keep], touch.columns(keep), rule, slices.width)


def with_gaps(pair: ParallelAxes, candidates: Candidates, model: ContactModel) -> Candidates:
    """Add the gaps of the model: how far apart the rigid flanks are, and their course about that place.

    The load patches stay where plain involutes touch, so that the compliance between the candidates depends
    on the macro geometry alone and serves every modification, misalignment and load.
    """
    if not model.gaps:
        return candidates
    touch = modified_touch(pair, candidates.touch, candidates.face_position, model.gaps)
    return candidates.touching(touch)


def teeth_in_reach(pair: ParallelAxes) -> int:
    """Return how many teeth, odd and centred on tooth 0, hold every contact of a plane pair in a pitch.

    Where the path of contact lies off the pitch point, as with unlike profile shifts, pairs run further to
    one side than to the other.
    """
    first, last = _pair_range(pair, 0.0, 1.0, (0.0, 0.0))
    return 2 * max(math.ceil(pair.transverse_contact_ratio), -first, last) + 1


def _pair_indices(pair: ParallelAxes, position: FloatArray, slices: Slices) -> IntArray:
    """Return all pairs between A and E in any slice, and one more beyond either end."""
    lead = slices.center * math.tan(pair.base_helix_angle)
    ends = float(lead.min()), float(lead.max())
    first, last = _pair_range(pair, float(position.min()), float(position.max()), ends)
    return np.arange(first, last + 1)


def _pair_range(pair: ParallelAxes, low: float, high: float, lead: tuple[float, float]) -> tuple[int, int]:
    """Return the first and the last pair from position `low` to `high`; `lead` of the outer slices, m."""
    path = pair.path_of_contact
    first = np.floor((path.start - path.pitch_point + lead[0]) / path.base_pitch - high)
    last = np.ceil((path.end - path.pitch_point + lead[1]) / path.base_pitch - low)
    return int(first), int(last)


def _candidates(
    pair: ParallelAxes,
    position: FloatArray,
    pairs: IntArray,
    face: FloatArray,
    touch: Touch,
    rule: PatchRule,
    slice_width: float,
) -> Candidates:
    """Turn touching points into patches."""
    tip_1 = float(flank_coordinate(pair.pinion, pair.pinion.tip_roll_length))
    tip_2 = float(flank_coordinate(pair.wheel, pair.wheel.tip_roll_length))
    radius = touch.radius / math.cos(pair.base_helix_angle)
    shift_1 = _shift(touch.s_2, touch.offset_2, tip_2, radius, rule)
    shift_2 = _shift(touch.s_1, touch.offset_1, tip_1, radius, rule)
    return Candidates(
        position=position,
        pair=pairs,
        face_position=face,
        touch=touch,
        patch_1=_patches(touch.s_1, touch.offset_1, tip_1, shift_1, radius, rule),
        patch_2=_patches(touch.s_2, touch.offset_2, tip_2, shift_2, radius, rule),
        slice_width=slice_width,
        base_helix_angle=pair.base_helix_angle,
        corner_1=corner_softness(pair.pinion),
        corner_2=corner_softness(pair.wheel),
    )


def _shift(s: FloatArray, offset: FloatArray, tip: float, radius: FloatArray, rule: PatchRule) -> FloatArray:
    """How far the partner's edge moves the load's centroid to its root, m: both forces must be in line."""
    patches = tip_patches(s, offset, tip, rule.half_width, rule.lengths(offset, radius))
    return np.maximum(s - patches.centroid, 0.0)


def _patches(
    s: FloatArray, offset: FloatArray, tip: float, shift: FloatArray, radius: FloatArray, rule: PatchRule
) -> Patches:
    """Patches of one gear; beside the partner's edge they follow its load towards the own tip."""
    offset = offset - shift
    return tip_patches(s + shift, offset, tip, rule.half_width, rule.lengths(offset, radius))


def corner_softness(gear: Toothing) -> float:
    """Return what the corner at a gear's tip edge yields over a half plane; see `wedge_softness`.

    Flank and tip circle meet at a right angle and the pressure angle at the tip.
    """
    return wedge_softness(0.5 * math.pi + math.acos(gear.base_radius / gear.tip_radius))
