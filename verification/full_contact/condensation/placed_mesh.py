"""One mesh of both gears for one position, in one frame, finest where tooth pairs may touch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.involute import involute_normal
from fe_contact.mesh.gear_mesh import real_teeth
from fe_contact.mesh.quadratic_mesh import Part, QuadraticMesh, quadratic_meshes, rotated
from fe_contact.mesh.quality import QualityLimits
from fe_contact.mesh.tooth_sector import MIRRORED
from fe_contact.types import FloatArray, IntArray
from verification.full_contact.condensation.gear_boundary import GearBoundary, gear_boundary
from verification.full_contact.condensation.resolution import Resolution
from verification.full_contact.condensation.sites import ContactSite

FEW_TEETH, MANY_TEETH = 5, 9
"""Real teeth; the larger number for contact ratios above 2 and in ring gears."""
AHEAD = (-1, 1)
"""Number of the tooth that is one pair ahead, on gear 1 and gear 2: teeth are numbered counter-clockwise."""
SECONDS = 120.0


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
    bore_nodes: IntArray
    """Nodes of the bore, or of the outside of a ring gear's rim. Shape (b,)."""
    center: FloatArray
    """Center of the gear, m. Shape (2,)."""
    strips: Mapping[int, Strip]
    """Strips of the flanks by pair index."""


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
        gear_boundary(
            gear,
            real_teeth(gear.teeth, _teeth(pair, gear, sites)),
            {AHEAD[number] * site.ahead: site.strips[number] for site in sites},
            resolution,
        )
        for number, gear in enumerate(gears)
    ]
    scale, growth = pair.pinion.normal_module, resolution.inner_growth
    parts = [
        Part(f"gear {number}", (boundary.toothed, boundary.seat)[:: gear.sign], scale, growth)
        for number, (boundary, gear) in enumerate(zip(boundaries, gears, strict=True), start=1)
    ]
    meshes = quadratic_meshes(parts, QualityLimits(), SECONDS)
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
    boundary: GearBoundary,
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
    bore_nodes = mesh.boundary[:: gear.sign][1]
    return PlacedBody(points, triangles, bore_nodes, center, strips)
