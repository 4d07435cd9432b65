"""One mesh of both gears for one position, in one frame, finest where tooth pairs may touch."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise

import numpy as np

from fe_contact.flank.involute import involute_normal
from fe_contact.full_contact.condensation.sites import (
    ContactSite,
    Resolution,
    SizedStrip,
    kinks,
    material_removed,
)
from fe_contact.geometry import ParallelAxes, Toothing, tooth_profile
from fe_contact.mesh.curve_division import divide, middles, spread
from fe_contact.mesh.gear_mesh import real_teeth
from fe_contact.mesh.outline import Outline, Piece, arc, piece
from fe_contact.mesh.quadratic_mesh import QuadraticMesh, quadratic_meshes, rotated
from fe_contact.mesh.quality import QualityLimits
from fe_contact.mesh.tooth_outline import LARGEST_ARC
from fe_contact.mesh.tooth_sector import MIRRORED
from fe_contact.types import FloatArray, IntArray

# Boundary of one gear divided for one position: real teeth, plain ring, held circle.


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
FEW_TEETH, MANY_TEETH = 5, 9
"""Real teeth; the larger number for contact ratios above 2 and in ring gears."""
AHEAD = (-1, 1)
"""Number of the tooth that is one pair ahead, on gear 1 and gear 2: teeth are numbered counter-clockwise."""
SECONDS = 120.0


@dataclass(frozen=True)
class _GearBoundary:
    """Closed loops around one gear in its own frame, tooth 0 on +y."""

    toothed: Outline
    held: Outline
    """`toothed`, `held`: The teeth with the plain ring between them; the bore, or the outside of a ring
    gear's rim.
    """
    s: Mapping[int, FloatArray]
    """Flank coordinates of the nodes of the piece ``flank j``, from the tooth space to the tip, m. Mapping of
    int to (k,) array.
    """


def _gear_boundary(
    gear: Toothing, teeth: IntArray, strips: Mapping[int, SizedStrip], resolution: Resolution
) -> _GearBoundary:
    """Divide the boundary of a gear with consecutive real `teeth`; `strips` are by tooth that may touch."""
    size = _size_near(gear, strips, resolution)
    pieces: list[Piece] = []
    s = {}
    for tooth in teeth.tolist():
        made, s[tooth] = _tooth(gear, tooth, size, resolution, loaded=tooth in strips)
        pieces += made
    if len(teeth) < gear.teeth:
        pieces.append(_plain_ring(gear, pieces, gear.teeth - len(teeth), resolution))
    return _GearBoundary(Outline(tuple(pieces)), _held_circle(gear, resolution), s)


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
    """Return what stands for the missing teeth, from the last tooth counter-clockwise to the first."""
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


def _held_circle(gear: Toothing, resolution: Resolution) -> Outline:
    radius = gear.held_radius
    size = min(2.0 * resolution.part(BODY, gear.normal_module), HALF * gear.body_depth)
    step = min(size / radius, LARGEST_ARC)
    ends = divide(0.0, 2.0 * np.pi, lambda angle: np.full_like(angle, step))
    return Outline((piece("circle", arc(radius), ends),))


@dataclass(frozen=True)
class Strip:
    """Nodes along the part of a flank that may touch."""

    nodes: IntArray
    """Corner, mid-side, corner ... towards the tip. Shape (2 e + 1,)."""
    s: FloatArray
    """Flank coordinates, m. Shape (2 e + 1,)."""


@dataclass(frozen=True)
class PlacedBody:
    """One gear's mesh in the frame of the pair: gear 1's center is the origin, the teeth meet on +y."""

    points: FloatArray
    """Nodes, m. Shape (n, 2)."""
    triangles: IntArray
    """Six-node triangles, corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0. Shape (m, 6).
    """
    held: IntArray
    """Nodes of the bore, or of the outside of a ring gear's rim. Shape (b,)."""
    center: FloatArray
    """m. Shape (2,)."""
    strips: Mapping[int, Strip]
    """By pair index."""


def placed_bodies(
    pair: ParallelAxes, position: float, sites: Sequence[ContactSite], resolution: Resolution
) -> tuple[PlacedBody, PlacedBody]:
    """Mesh both gears and put them into the conjugate position.

    Raises `MeshError`: gmsh failed, or an element misses its quality limit.

    Parameters
    ----------
    position : float
        Base pitches; the reference pair touches there on the line of action.
    sites : sequence of ContactSite
        Pairs that may touch there.
    """
    gears = (pair.pinion, pair.wheel)
    boundaries = [
        _gear_boundary(
            gear,
            real_teeth(gear.teeth, _teeth(pair, gear, sites)),
            {AHEAD[number] * site.ahead: site.strips[number] for site in sites},
            resolution,
        )
        for number, gear in enumerate(gears)
    ]
    loops = {
        f"gear {number}": (boundary.toothed, boundary.held)[:: gear.sign]
        for number, (boundary, gear) in enumerate(zip(boundaries, gears, strict=True), start=1)
    }
    meshes = quadratic_meshes(
        loops, pair.pinion.normal_module, resolution.inner_growth, QualityLimits(), SECONDS
    )
    bodies = []
    for number, (gear, mesh) in enumerate(zip(gears, meshes, strict=True)):
        strips = {
            site.ahead: _strip(gear, mesh, boundaries[number], AHEAD[number] * site.ahead, site, number)
            for site in sites
        }
        bodies.append(_placed(pair, number, mesh, strips, position))
    return bodies[0], bodies[1]


def _teeth(pair: ParallelAxes, gear: Toothing, sites: Sequence[ContactSite]) -> int:
    """Return how many teeth of a gear are real: one more to either side than may touch, at least."""
    many = gear.sign < 0 or pair.transverse_contact_ratio > 2.0
    touching = 2 * max(abs(site.ahead) for site in sites) + 3
    return max(MANY_TEETH if many else FEW_TEETH, touching)


def _strip(
    gear: Toothing,
    mesh: QuadraticMesh,
    boundary: _GearBoundary,
    tooth: int,
    site: ContactSite,
    number: int,
) -> Strip:
    """Return the elements of a flank that a strip reaches into."""
    along = mesh.boundary[:: gear.sign][0]
    nodes, s = along[boundary.toothed.positions(f"flank {tooth}")], boundary.s[tooth]
    ends = site.strips[number]
    corners = s[::2]
    first = max(int(np.searchsorted(corners, ends.low, side="right")) - 1, 0)
    last = min(int(np.searchsorted(corners, ends.high, side="left")), len(corners) - 1)
    part = slice(2 * first, 2 * last + 1)
    return Strip(nodes[part], s[part])


def _placed(
    pair: ParallelAxes, number: int, mesh: QuadraticMesh, strips: Mapping[int, Strip], position: float
) -> PlacedBody:
    """Mirror a ring gear, turn, move: its flank's outward normal lies on the line of action."""
    gear = (pair.pinion, pair.wheel)[number]
    roll = float(pair.roll_lengths(position)[number])
    angle = pair.working_pressure_angle
    outward = np.array([np.cos(angle), np.sin(angle)]) * (1.0, -1.0)[number]
    normal = involute_normal(gear.base_radius, gear.base_thickness_half_angle, np.array(gear.sign * roll))
    normal = normal * [gear.sign, 1.0]  # a ring gear is seen from its other side
    turn = float(np.arctan2(outward[1], outward[0]) - np.arctan2(normal[1], normal[0]))
    center = np.array([0.0, number * gear.sign * pair.center_distance])
    points = rotated(mesh.points * [gear.sign, 1.0], turn) + center
    triangles = mesh.triangles if gear.sign > 0 else mesh.triangles[:, MIRRORED]
    held = mesh.boundary[:: gear.sign][1]
    return PlacedBody(points, triangles, held, center, strips)
