"""The boundary of one gear divided for one position: real teeth, plain ring, held circle."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise

import numpy as np

from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.curve_division import divide, middles, spread
from fe_contact.mesh.outline import Outline, Piece, arc, piece
from fe_contact.mesh.quadratic_mesh import rotated
from fe_contact.mesh.tooth_outline import LARGEST_ARC
from fe_contact.types import FloatArray, IntArray
from verification.full_contact.condensation.modified_flank import kinks, material_removed
from verification.full_contact.condensation.resolution import Resolution
from verification.full_contact.condensation.sites import SizedStrip

FLANK, FILLET, LAND, IDLE, BODY = 0.15, 0.1, 0.2, 0.35, 1.0
"""Largest sizes in modules: flanks, fillets, tip and root lands, teeth that do not touch, the body."""


HALF = 0.4  # largest element of the plain ring, in parts of its depth


RAISED = 0.2
"""Modules by which the plain ring stands above the root circle, for the teeth that it lacks.

Ten pairs in plane strain, external and internal, 17 to 90 teeth, rims of 0.8 modules to solid: STE at two
positions is within 0.013 % of that with all teeth; a ring at the root circle leaves it up to 0.18 % above.
"""


SAMPLES = 1201


TURNED = 0.5
"""Largest turn of the normal over an element, rad: more leaves elements behind a fillet folded."""


Size = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class GearBoundary:
    """Closed loops around one gear in its own frame, tooth 0 on +y."""

    toothed: Outline
    seat: Outline
    """`toothed`, `seat`: The teeth with the plain ring between them; the bore, or the outside of a ring
    gear's rim.
    """
    s: Mapping[int, FloatArray]
    """Flank coordinates of the nodes of the piece ``flank j``, from the tooth space to the tip, m. Mapping of
    int to (k,) array.
    """


def gear_boundary(
    gear: Toothing, teeth: IntArray, strips: Mapping[int, SizedStrip], resolution: Resolution
) -> GearBoundary:
    """Divide the boundary of a gear with consecutive real `teeth`; `strips` are by tooth that may touch."""
    size = _size_near(gear, strips, resolution)
    pieces: list[Piece] = []
    s = {}
    for tooth in teeth.tolist():
        made, s[tooth] = _tooth(gear, tooth, size, resolution, loaded=tooth in strips)
        pieces += made
    if len(teeth) < gear.teeth:
        pieces.append(_plain_ring(gear, pieces, gear.teeth - len(teeth), resolution))
    return GearBoundary(Outline(tuple(pieces)), _seat_circle(gear, resolution), s)


def _size_near(gear: Toothing, strips: Mapping[int, SizedStrip], resolution: Resolution) -> Size:
    pitch = tooth_profile(gear).pitch_angle
    points, sizes = [], []
    for tooth, strip in strips.items():
        at = np.clip(strip.at, tooth_profile(gear).s_space, tooth_profile(gear).s_tip)
        points.append(rotated(_modified_flank(gear, at), tooth * pitch))
        sizes.append(strip.size)
    largest = resolution.part(BODY, gear.normal_module)
    return spread(np.concatenate(points), np.concatenate(sizes), resolution.growth, largest)


def _modified_flank(gear: Toothing, s: FloatArray) -> FloatArray:
    """Return points (n, 2) of the loaded right flank in the tooth frame at flank coordinates (n,), m."""
    profile = tooth_profile(gear)
    return np.asarray(profile.flank(s) - material_removed(gear, s)[:, None] * profile.normal(s))


def _tooth(
    gear: Toothing, tooth: int, size: Size, resolution: Resolution, *, loaded: bool
) -> tuple[list[Piece], FloatArray]:
    """Return flank, tip land and coast flank of one tooth counter-clockwise, and the flank's coordinates."""
    profile, module = tooth_profile(gear), gear.normal_module
    turn = tooth * profile.pitch_angle
    shares = (FLANK, FILLET, LAND) if loaded else (IDLE, IDLE, IDLE)
    flank_size, fillet_size, land_size = (resolution.part(share, module) for share in shares)

    def flank(s: FloatArray) -> FloatArray:
        return rotated(_modified_flank(gear, s), turn)

    def coast(s: FloatArray) -> FloatArray:
        return rotated(profile.flank(s) * [-1.0, 1.0], turn)

    def largest(s: FloatArray) -> FloatArray:
        share = np.where(s > profile.s_form, flank_size, np.where(s > profile.s_root, fillet_size, land_size))
        return np.minimum(share, TURNED / np.interp(s, *_curvature(gear)))

    ends = _divided(flank, largest, size, [profile.s_space, *kinks(gear), profile.s_tip])
    back = _divided(coast, largest, size, [profile.s_space, *kinks(gear), profile.s_tip])[::-1]
    land = partial(_tip_land, flank(ends[-1:])[0], coast(back[:1])[0])
    across = _divided(land, lambda t: np.full_like(t, land_size), size, [0.0, 1.0], gear.tip_tooth_thickness)
    s = np.empty(2 * len(ends) - 1)
    s[::2], s[1::2] = ends, middles(ends)
    made = [
        piece(f"flank {tooth}", flank, ends),
        piece(f"tip {tooth}", land, across),
        piece(f"coast {tooth}", coast, back),
    ]
    return made, s


@lru_cache(maxsize=8)
def _curvature(gear: Toothing) -> tuple[FloatArray, FloatArray]:
    """Return flank coordinates and the curvature of the unmodified flank there, 1/m, >= 0."""
    profile = tooth_profile(gear)
    s = np.linspace(profile.s_space, profile.s_tip, SAMPLES)
    normal = profile.normal(s)
    angle = np.unwrap(np.arctan2(normal[:, 1], normal[:, 0]))
    return s, np.abs(np.gradient(angle, s)) + 1e-6 / gear.normal_module


def _divided(
    curve: Size, largest: Size, size: Size, breaks: Sequence[float], length: float = 1.0
) -> FloatArray:
    """Divide a curve between breaks; `length` is that of the curve per unit of its parameter, m."""

    def element_size(at: FloatArray) -> FloatArray:
        return np.minimum(size(curve(at)), largest(at)) / length

    parts = [divide(a, b, element_size, SAMPLES) for a, b in pairwise(breaks)]
    return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])


def _tip_land(right: FloatArray, left: FloatArray, fraction: FloatArray) -> FloatArray:
    """Return points from one tip edge to the other along an arc about the center."""
    radii = [np.hypot(*right), np.hypot(*left)]
    start = np.arctan2(right[0], right[1])
    turned = np.arctan2(left[0] * right[1] - left[1] * right[0], left @ right)
    radius, angle = radii[0] + (radii[1] - radii[0]) * fraction, start + turned * fraction
    return np.asarray(radius[:, None] * np.stack([np.sin(angle), np.cos(angle)], axis=-1))


def _plain_ring(gear: Toothing, pieces: Sequence[Piece], missing: int, resolution: Resolution) -> Piece:
    """Return the plain ring in place of missing teeth, from the last tooth counter-clockwise to the first."""
    x, y = pieces[-1].nodes[-1]
    start, length = float(np.arctan2(x, y)), missing * tooth_profile(gear).pitch_angle
    radius, module = gear.root_radius, gear.normal_module
    last = float(pieces[-1].edge_lengths[-1])
    largest = min(HALF * gear.body_depth, resolution.part(BODY, module), LARGEST_ARC * radius)
    circle = arc(radius)

    def distance(turned: FloatArray) -> FloatArray:
        return radius * np.minimum(turned, length - turned)

    def size(turned: FloatArray) -> FloatArray:
        return np.minimum(last + resolution.growth * distance(turned), largest) / radius

    def raised(turned: FloatArray) -> FloatArray:
        height = -gear.sign * RAISED * module * np.expm1(-distance(turned) / module)
        return (1.0 + height / radius)[:, None] * circle(start - turned)

    ring = piece("plain ring", raised, divide(0.0, length, size))
    ring.nodes[0], ring.nodes[-1] = pieces[-1].nodes[-1], pieces[0].nodes[0]
    return ring


def _seat_circle(gear: Toothing, resolution: Resolution) -> Outline:
    radius = gear.seat_radius
    size = min(2.0 * resolution.part(BODY, gear.normal_module), HALF * gear.body_depth)
    step = min(size / radius, LARGEST_ARC)
    ends = divide(0.0, 2.0 * np.pi, lambda angle: np.full_like(angle, step))
    return Outline((piece("circle", arc(radius), ends),))
