"""Contact candidates: points of the contact lines of tooth pairs, on the line of action or at a tip edge."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.contact.free_end import ENDLESS, FreeEnds, end_softness
from fe_contact.contact.model import ContactModel
from fe_contact.contact.patch import Patches, tip_patches
from fe_contact.contact.plain_touch import FLAT, Touch, conjugate_touch
from fe_contact.contact.problem import Candidates, LoadedSlices
from fe_contact.contact.slices import Slices
from fe_contact.contact.touch import modified_touch
from fe_contact.contact.touch_cache import cached_touch
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.hertz import STRIP_DISTANCE, lateral_share, wedge_softness
from fe_contact.types import FloatArray, IntArray

LAW_LENGTH = 0.45
"""Reference length of the local law over the width of a slice.

It is the depth to which a line load that varies along the face matters: 0.3 to 0.6 widths for waves of one
slice and shorter. Waves of two slices, the shortest ones that the finite elements describe, move the bodies
as patches of 0.72 slices would.
"""
LONGEST_LAW = 0.5
"""Largest reference length of the local law in modules: about half the thickness of a tooth."""

_FLUSH = 1e-6
"""Distance between the ends of two faces over their width, below which they count as at the same place."""
_USUAL_LOAD = 60e6
"""Normal force over face width and module, Pa; near that of the rated load."""


@dataclass(frozen=True)
class PatchRule:
    """The widths of the load patches."""

    half_width: float
    """Half-width of patches away from the tip edges, m."""
    edge_length: float
    """Least length of the patch at a tip edge, m."""
    edge_load: float = 0.0
    """4 p/(pi E*) in m, where p is the line load whose strip is as long as the patch at a tip edge."""
    law_length: float = 0.0
    """Least reference length of the local law, m, which the widest strip needs."""

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
    model : ContactModel
        Whether tip edges may touch; its gaps are added by `with_gaps`.
    position : ndarray, shape (P,)
        Base pitches by the driving gear's angle.

    Returns
    -------
    Candidates
        Candidates on plain involutes: m = pairs x slices x points, without the pairs that touch nowhere.
    """
    lead = slices.point_center * math.tan(pair.base_helix_angle)
    ends = float(lead.min()), float(lead.max())
    first, last = _pair_range(pair, float(position.min()), float(position.max()), ends)
    index = np.arange(first, last + 1)
    touch, part = _touching(pair, model, position, index, slices.point_center, slices.point_width)
    meets = np.isfinite(touch.gap).any(axis=0).reshape(index.size, -1).any(axis=1)
    index, keep = index[meets], np.repeat(meets, slices.point_center.size)
    touch, part = touch.columns(keep), part[:, keep]
    middle = touch  # where slices have one point it is their middle
    if slices.points > 1:
        middle, _ = _touching(pair, model, position, index, slices.center, 0.0)
    curves, heights = slices.curves
    return Candidates(
        position=position,
        pair=np.repeat(index, slices.point_center.size),
        face_position=np.tile(slices.point_center, index.size),
        touch=touch,
        width=part * (slices.point_width / math.cos(pair.base_helix_angle)),
        point_width=slices.point_width,
        slices=_loaded_slices(pair, touch, middle, index, rule, slices),
        curves=curves,
        heights=heights,
    )


def _touching(
    pair: ParallelAxes,
    model: ContactModel,
    position: FloatArray,
    index: IntArray,
    face: FloatArray,
    width: float,
) -> tuple[Touch, FloatArray]:
    """Return where plain involutes touch, and which part of each point's width touches.

    Both are arrays (P, J f) over pairs `index` (J,) and face positions `face` (f,) in m. Each point stands
    for `width` in m of the face. Without corner contact, only the part of it on the path of contact touches,
    so that nothing jumps as the contact line moves on.
    """
    pairs, face_of_point = np.repeat(index, face.size), np.tile(face, index.size)
    roll, _ = pair.roll_lengths(position[:, None], pairs)
    # on a right-hand driving gear the contact line runs towards the root as the face position grows
    lead = math.tan(pair.base_helix_angle)
    roll = roll - face_of_point * lead
    touch = conjugate_touch(pair, roll, pair.mating_roll_length(roll), model.corner_contact)
    half = 0.5 * width * abs(lead)
    if model.corner_contact or half == 0.0:
        return touch, np.ones(roll.shape)
    path = pair.path_of_contact
    inside = np.minimum(roll + half, path.end) - np.maximum(roll - half, path.start)
    part = np.clip(inside / (2.0 * half), 0.0, 1.0)
    return replace(touch, gap=np.where(part > 0.0, 0.0, np.inf)), np.where(part > 0.0, part, 1.0)


def with_gaps(pair: ParallelAxes, candidates: Candidates, model: ContactModel) -> Candidates:
    """Add the gaps of the model: distances of the rigid flanks at touching points, and the gaps about them.

    The load patches stay where plain involutes touch, so that the compliance between the candidates depends
    on the macro geometry alone and serves every modification, misalignment and load.
    """
    if not model.gaps:
        return candidates
    plain, face = candidates.touch, candidates.face_position
    touch = cached_touch(
        (pair, model.gaps),
        (plain.roll_1, plain.s_1, plain.gap, face),
        lambda: modified_touch(pair, plain, face, model.gaps),
    )
    return candidates.touching(touch)


def teeth_in_reach(pair: ParallelAxes) -> int:
    """Return the odd number of teeth, centered on tooth 0, among which all contacts of a plane pair occur.

    Where the path of contact is not centered on the pitch point, as with unequal profile shifts, more teeth
    are in contact on one side of tooth 0 than on the other.
    """
    first, last = _pair_range(pair, 0.0, 1.0, (0.0, 0.0))
    return 2 * max(math.ceil(pair.transverse_contact_ratio), -first, last) + 1


def _pair_range(pair: ParallelAxes, low: float, high: float, lead: tuple[float, float]) -> tuple[int, int]:
    """Return the first and the last pair in contact at any position from `low` to `high`.

    `lead`: Least and largest product of face position and tan(beta_b), m.
    """
    path = pair.path_of_contact
    first = np.floor((path.start - path.pitch_point + lead[0]) / path.base_pitch - high)
    last = np.ceil((path.end - path.pitch_point + lead[1]) / path.base_pitch - low)
    return int(first), int(last)


def _loaded_slices(
    pair: ParallelAxes,
    touch: Touch,
    middle: Touch,
    index: IntArray,
    rule: PatchRule,
    slices: Slices,
) -> LoadedSlices:
    """Return the slices of all pairs, with load patches where their points touch.

    `touch`, `middle`: Touching points at the points and at the middles of the slices.
    """
    tip_1 = float(pair.pinion.flank_coordinate(pair.pinion.tip_roll_length))
    tip_2 = float(pair.wheel.flank_coordinate(pair.wheel.tip_roll_length))
    radius = touch.radius / math.cos(pair.base_helix_angle)
    shift_1 = _shift(touch.s_2, touch.offset_2, tip_2, radius, rule)
    shift_2 = _shift(touch.s_1, touch.offset_1, tip_1, radius, rule)
    meets = np.isfinite(touch.gap).reshape(len(touch.gap), index.size, -1).any(axis=2)
    width = slices.width / math.cos(pair.base_helix_angle)
    module = pair.pinion.normal_module
    patch_1 = _patches(touch.s_1, touch.offset_1, tip_1, shift_1, radius, rule)
    patch_2 = _patches(touch.s_2, touch.offset_2, tip_2, shift_2, radius, rule)
    curvatures = _flank_curvature(pair.pinion, patch_1), _flank_curvature(pair.wheel, patch_2)
    first, second = (lateral_share(gear.material.poissons_ratio) for gear in (pair.pinion, pair.wheel))
    return LoadedSlices(
        pair=np.repeat(index, slices.center.size),
        face_position=np.tile(slices.center, index.size),
        present=np.repeat(meets, slices.center.size, axis=1),
        touch=middle,
        patch_1=replace(patch_1, count=slices.points, bulge=first * curvatures[0]),
        patch_2=replace(patch_2, count=slices.points, bulge=second * curvatures[1]),
        slice_width=slices.width,
        base_helix_angle=pair.base_helix_angle,
        corner_1=corner_softness(pair.pinion),
        corner_2=corner_softness(pair.wheel),
        tip_inclinations=(_tip_inclination(pair.pinion), _tip_inclination(pair.wheel)),
        law_length=max(rule.half_width, rule.law_length, min(LAW_LENGTH * width, LONGEST_LAW * module)),
        edge_load=rule.edge_load,
        end_1=_free_ends(pair, pair.pinion, 0.0, slices),
        end_2=_free_ends(pair, pair.wheel, pair.axial_offset, slices),
        lateral_shares=(first, second),
        turned_normals=_turned_normals(pair, curvatures, rule),
    )


def _free_ends(pair: ParallelAxes, gear: Toothing, middle: float, slices: Slices) -> FreeEnds:
    """Return the ends of a gear's face where the common face ends, too; in a plane it has none.

    `middle`: Distance of the gear's mid-face from the pinion's, m.
    """
    if slices.center.size == 1:
        return ENDLESS
    low, high = (middle + part * gear.face_width for part in (-0.5, 0.5))
    tolerance = _FLUSH * gear.face_width
    return FreeEnds(
        low if abs(low - pair.common_face[0]) <= tolerance else -math.inf,
        high if abs(high - pair.common_face[1]) <= tolerance else math.inf,
        end_softness(gear.material.poissons_ratio),
    )


def _shift(s: FloatArray, offset: FloatArray, tip: float, radius: FloatArray, rule: PatchRule) -> FloatArray:
    """Return how far the load's centroid moves to a gear's root near the gear's tip edge, m.

    The load on the partner moves as far, as both forces must be in line.
    """
    patches = tip_patches(s, offset, tip, rule.half_width, rule.lengths(offset, radius))
    return np.maximum(s - patches.centroid, 0.0)


def _patches(
    s: FloatArray, offset: FloatArray, tip: float, shift: FloatArray, radius: FloatArray, rule: PatchRule
) -> Patches:
    """Return the patches of one gear; at the partner's edge they move with its load towards the own tip."""
    offset = offset - shift
    return tip_patches(s + shift, offset, tip, rule.half_width, rule.lengths(offset, radius))


def _flank_curvature(gear: Toothing, patches: Patches) -> FloatArray:
    """Return the curvature of flanks under patches in the normal section, 1/m; negative where concave.

    On the fillet, below the involute, it is that of the involute a quarter of a patch above its base.
    """
    coordinate = np.maximum(np.abs(patches.center), 0.5 * patches.half_width)
    return math.cos(gear.base_helix_angle) / (gear.sign * np.sqrt(2.0 * gear.base_radius * coordinate))


def _turned_normals(
    pair: ParallelAxes, curvatures: tuple[FloatArray, FloatArray], rule: PatchRule
) -> FloatArray:
    """Return the angle by which normals turn over the mean distance of two points of the strip, rad.

    The strip is that of a usual load instead of the real one, so that the angle does not depend on the load.
    Both flanks have one curvature over the strip, nearer to that of the stiffer one.
    """
    first, second = (1.0 / gear.material.plane_strain_modulus for gear in (pair.pinion, pair.wheel))
    relative = curvatures[0] + curvatures[1]
    flattest = math.cos(pair.base_helix_angle) / (FLAT * pair.wheel.base_radius)
    squared = 4.0 / math.pi * _USUAL_LOAD * pair.pinion.normal_module * (first + second)
    strip = np.sqrt(squared / np.maximum(relative, flattest))
    curvature = (second * curvatures[0] - first * curvatures[1]) / (first + second)
    return np.asarray(STRIP_DISTANCE * np.minimum(strip, rule.half_width) * curvature)


def _tip_inclination(gear: Toothing) -> float:
    """Return the tangent of the transverse pressure angle at a gear's tip."""
    return abs(gear.tip_roll_length) / gear.base_radius


def corner_softness(gear: Toothing) -> float:
    """Return the softness of the corner at a tip edge over that of a half plane; see `wedge_softness`.

    Flank and tip circle meet at the angle of 90 degrees and the pressure angle at the tip.
    """
    return wedge_softness(0.5 * math.pi + math.acos(gear.base_radius / gear.tip_radius))
