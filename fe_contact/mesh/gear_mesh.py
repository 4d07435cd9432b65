"""The mesh of a gear's transverse section: tooth sectors on a hub."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fe_contact.geometry import Toothing, ToothProfile, tooth_profile
from fe_contact.mesh.outline import Outline, Piece, arc, divide, piece
from fe_contact.mesh.quality import QualityLimits
from fe_contact.mesh.recipe import MeshRecipe
from fe_contact.mesh.tooth_sector import LARGEST_ARC, ToothSector, tooth_outline, tooth_sector
from fe_contact.mesh.triangulation import QuadraticMesh, quadratic_meshes, rotated
from fe_contact.types import FloatArray, IntArray

# Mesh of what lies below and beside the real teeth: the rest of the ring down to the bore.


HALF = 0.5  # largest element of the plain ring, in parts of its thickness


@dataclass(frozen=True)
class _Hub:
    """The ring without the sectors of the real teeth."""

    points: FloatArray
    """Nodes, m. Shape (n, 2)."""
    triangles: IntArray
    """Six-node triangles. Shape (m, 6)."""
    bottoms: IntArray
    """Nodes shared with the bottom of each sector, left to right. Shape (t, b)."""
    right_side: IntArray
    left_side: IntArray
    """`right_side`, `left_side`: Nodes shared with the first sector's right and the last one's left side,
    from the bottom up; empty if all teeth are real.
    """
    bore: IntArray
    """Nodes on the bore, or on the outside of a ring gear's rim."""
    thickness: FloatArray
    """Axial thickness of each element over the face width: below 1 in a web. Shape (m,)."""


@dataclass(frozen=True)
class _InnerRing:
    """A region between a boundary and the next circle, and its thickness over the face width."""

    circle: Outline
    thickness: float


def _hub_outline(gear: Toothing, sector: ToothSector, teeth: IntArray, recipe: MeshRecipe) -> Outline:
    """Return the boundary that follows the sectors of `teeth`; that of a ring gear is the inner one."""
    pitch = 2.0 * np.pi / gear.teeth
    # From the right end of a bottom to its left: counter-clockwise, as the teeth are numbered.
    pieces = [Piece(f"bottom {j}", rotated(sector.points[sector.bottom[::-1]], j * pitch)) for j in teeth]
    if len(teeth) < gear.teeth:
        left = Piece("left side", rotated(sector.points[sector.left_side], teeth[-1] * pitch))
        right = Piece("right side", rotated(sector.points[sector.right_side[::-1]], teeth[0] * pitch))
        rim = _plain_rim(left, gear.teeth - len(teeth), pitch, gear.rim_inside_radius, recipe)
        pieces += [left, rim, right]
    return Outline(tuple(pieces))


def _plain_rim(side: Piece, missing: int, pitch: float, inside: float, recipe: MeshRecipe) -> Piece:
    """Return the root circle from the end of `side` counter-clockwise over the missing teeth."""
    x, y = side.nodes[-1]
    radius, angle, length = float(np.hypot(x, y)), float(np.arctan2(x, y)), missing * pitch
    largest = min(HALF * abs(1.0 - inside / radius), LARGEST_ARC)

    def size(turned: FloatArray) -> FloatArray:
        distance = np.minimum(turned, length - turned)
        target: FloatArray = side.edge_lengths[-1] / radius + recipe.growth * distance
        return np.minimum(target, largest)

    circle = arc(radius)
    return piece("plain rim", lambda turned: circle(angle - turned), divide(0.0, length, size))


def _inner_rings(gear: Toothing, bottom_radius: float, recipe: MeshRecipe) -> tuple[_InnerRing, ...]:
    """Return what lies below the sectors from there on: one ring, or the rim's rest, web and hub."""
    held, web = gear.held_radius, gear.web
    radii, thickness = [bottom_radius, held], [1.0]
    if web is not None:
        radii = [bottom_radius, web.outer_radius, web.inner_radius]
        thickness = [1.0, web.thickness / gear.face_width]
        if web.inner_radius > held:
            radii, thickness = [*radii, held], [*thickness, 1.0]
    depths = [*(abs(a - b) for a, b in pairwise(radii)), np.inf]
    return tuple(
        _InnerRing(_divided_circle(r, min(near), abs(bottom_radius - r), recipe), part)
        for r, near, part in zip(radii[1:], pairwise(depths), thickness, strict=True)
    )


def _divided_circle(radius: float, depth: float, distance: float, recipe: MeshRecipe) -> Outline:
    """Return a circle, clockwise; `depth` of the thinner ring beside it, `distance` from the sectors, m."""
    size = min(recipe.body_size + recipe.growth * distance, HALF * depth)
    step = min(size / radius, LARGEST_ARC)
    ends = divide(0.0, 2.0 * np.pi, lambda angle: np.full_like(angle, step))
    return Outline((piece("circle", arc(radius), ends),))


def _joined_hub(
    meshes: Sequence[QuadraticMesh],
    toothed: Outline,
    thickness: Sequence[float],
    teeth: IntArray,
    sign: int = 1,
) -> _Hub:
    """Join the meshes of the rings, from the sectors to the circle that the gear is held by.

    Their boundary nodes get names. `toothed` is the outline that follows the sectors of `teeth` (t,), the
    inner one where `sign` is -1; `thickness` is that of the rings over the face width.
    """
    mesh, parts = meshes[0], [np.full(len(meshes[0].triangles), thickness[0])]
    for ring, thick in zip(meshes[1:], thickness[1:], strict=True):
        mesh = _joined(mesh, ring)
        parts.append(np.full(len(ring.triangles), thick))
    around, held = mesh.boundary[::sign]
    names = {p.name for p in toothed.pieces}

    def nodes(name: str) -> IntArray:
        return around[toothed.positions(name)] if name in names else np.empty(0, dtype=np.int64)

    return _Hub(
        points=mesh.points,
        triangles=mesh.triangles,
        bottoms=np.array([nodes(f"bottom {j}")[::-1] for j in teeth]),
        right_side=nodes("right side")[::-1],
        left_side=nodes("left side"),
        bore=held,
        thickness=np.concatenate(parts),
    )


def _joined(outside: QuadraticMesh, inside: QuadraticMesh) -> QuadraticMesh:
    """Join two meshes along the inner boundary of one and the outer one of the other, its reverse."""
    own = np.ones(len(inside.points), dtype=bool)
    own[inside.boundary[0]] = False
    number = np.empty(len(own), dtype=np.int64)
    number[own] = len(outside.points) + np.arange(int(own.sum()))
    number[inside.boundary[0]] = np.roll(outside.boundary[1][::-1], 1)
    return QuadraticMesh(
        points=np.concatenate([outside.points, inside.points[own]]),
        triangles=np.concatenate([outside.triangles, number[inside.triangles]]),
        boundary=(outside.boundary[0], number[inside.boundary[1]]),
    )


# The finite-element mesh of one gear: identical tooth sectors, and a hub that closes the ring.


@dataclass(frozen=True)
class _FlankNodes:
    """Nodes along the right flank of one tooth."""

    tooth: int
    """Number of the tooth; 0 is on +y, counted counter-clockwise."""
    nodes: IntArray
    """Node numbers of the gear mesh from root to tip: corner, mid-side, corner ... Shape (k,)."""
    s: FloatArray
    """Flank coordinate, m. Mid-side nodes lie at the exact middle of their corners. Shape (k,)."""
    normals: FloatArray
    """Outward unit normals of the exact profile. Shape (k, 2)."""


@dataclass(frozen=True)
class GearMesh:
    """Six-node triangles on the complete ring of one gear, transverse section.

    Tooth sectors are copies of one mesh, turned by whole pitches, so all teeth are discretized alike.
    """

    points: FloatArray
    """Nodes, m. Shape (n, 2)."""
    triangles: IntArray
    """Nodes of the elements: corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0 (gmsh, VTK).
    With e elements per sector those of tooth `teeth[i]` are i e ... (i + 1) e - 1; the hub's follow. Shape
    (m, 6).
    """
    bore_nodes: IntArray
    """Nodes on the circle that the gear is held by: its bore, or the outside of a ring gear's rim. Shape
    (b,).
    """
    flanks: tuple[_FlankNodes, ...]
    """Right flanks of the real teeth, in the order of `teeth`."""
    teeth: IntArray
    """Consecutive numbers of the real teeth, 0 among them. Shape (t,)."""
    pitch_angle: float
    """rad."""
    sector: ToothSector
    """The mesh of one tooth in its own frame."""
    sector_nodes: IntArray
    """Node of the gear mesh that each sector node is. Shape (t, n_sector)."""
    hub_nodes: IntArray
    """Node of the gear mesh that each hub node is. Shape (n_hub,)."""
    hub: _Hub | None
    """None if the sectors reach down to that circle."""


def real_teeth(teeth: int, modeled: int | None) -> IntArray:
    """Return the numbers of the real teeth: `modeled` of them centered on 0, or all."""
    count = teeth if modeled is None else min(modeled, teeth)
    return np.arange(count) - (count - 1) // 2


def _assemble(
    sector: ToothSector, hub: _Hub | None, teeth: IntArray, pitch_angle: float, normals: FloatArray
) -> GearMesh:
    """Join the sectors of `teeth` and the hub; `normals` (k, 2) at `sector.flank` are in the tooth frame."""
    closed = len(teeth) == round(2.0 * np.pi / pitch_angle)
    sector_nodes = _number_sectors(sector, len(teeth), closed)
    hub_nodes = _number_hub(sector, sector_nodes, hub)
    points = np.empty((max(sector_nodes.max(), hub_nodes.max(initial=0)) + 1, 2))
    if hub is not None:
        points[hub_nodes] = hub.points
    for i, j in enumerate(teeth):
        points[sector_nodes[i]] = rotated(sector.points, j * pitch_angle)
    triangles = sector_nodes[:, sector.triangles].reshape(-1, 6)
    if hub is not None:
        triangles = np.concatenate([triangles, hub_nodes[hub.triangles]])
    bore = hub_nodes[hub.bore] if hub is not None else np.unique(sector_nodes[:, sector.bottom])
    flanks = tuple(
        _FlankNodes(int(j), sector_nodes[i, sector.flank], sector.s, rotated(normals, j * pitch_angle))
        for i, j in enumerate(teeth)
    )
    return GearMesh(points, triangles, bore, flanks, teeth, pitch_angle, sector, sector_nodes, hub_nodes, hub)


def _number_sectors(sector: ToothSector, count: int, closed: bool) -> IntArray:
    """Return the number in the gear of each sector's nodes; a left side is the next sector's right side."""
    size = len(sector.points)
    owned = np.ones(size, dtype=bool)
    owned[sector.left_side] = False
    each = int(owned.sum())
    nodes = np.empty((count, size), dtype=np.int64)
    nodes[:, owned] = np.arange(count * each).reshape(count, each)
    following = np.roll(nodes[:, sector.right_side], -1, axis=0)
    nodes[:, sector.left_side] = following
    if not closed:
        nodes[-1, sector.left_side] = count * each + np.arange(len(sector.left_side))
    return nodes


def _number_hub(sector: ToothSector, sector_nodes: IntArray, hub: _Hub | None) -> IntArray:
    """Return the number in the gear of every hub node; shared ones keep the sectors' numbers."""
    if hub is None:
        return np.empty(0, dtype=np.int64)
    nodes = np.full(len(hub.points), -1)
    nodes[hub.bottoms] = sector_nodes[:, sector.bottom]
    if len(hub.right_side):
        nodes[hub.right_side] = sector_nodes[0, sector.right_side]
        nodes[hub.left_side] = sector_nodes[-1, sector.left_side]
    new = nodes < 0
    nodes[new] = sector_nodes.max() + 1 + np.arange(int(new.sum()))
    return nodes


SLENDER = 3.0  # deepest sector down to the bore, in root circle pitches: beyond it a hub needs fewer elements
TAPER = 0.35  # least bore of sectors down to it, in root circles: below it a sector is a needle
RIM_DEPTH = 2.0  # depth of a sector above a hub, in normal modules


def mesh_gear(
    gear: Toothing,
    recipe: MeshRecipe | None = None,
    limits: QualityLimits | None = None,
) -> GearMesh:
    """Mesh the transverse section of one gear.

    Raises `MeshError`: gmsh failed, was killed or ran out of time, or an element misses its quality limit.

    Parameters
    ----------
    gear : Gear or RingGear
        Its modification plays no part.
    recipe : MeshRecipe, optional
        Element sizes; default `MeshRecipe.standard(gear)`.
    limits : QualityLimits, optional
        Least acceptable element quality.
    """
    recipe, limits = recipe or MeshRecipe.standard(gear), limits or QualityLimits()
    profile = tooth_profile(gear)
    teeth = real_teeth(gear.teeth, recipe.real_teeth)
    bottom_radius = _sector_bottom(gear, profile, all_real=len(teeth) == gear.teeth)
    outline = tooth_outline(profile, bottom_radius, recipe)
    outlines, module = {"tooth sector": (outline.outline,)}, profile.gear.normal_module
    (mesh,) = quadratic_meshes(outlines, module, recipe.growth, limits)
    sector = tooth_sector(mesh, outline)
    rest = None if bottom_radius == gear.held_radius else _mesh_hub(gear, sector, teeth, recipe, limits)
    # Copies of the sector are as good as the sector, which is checked.
    return _assemble(sector, rest, teeth, profile.pitch_angle, profile.normal(sector.s))


def _sector_bottom(gear: Toothing, profile: ToothProfile, all_real: bool) -> float:
    """Return the radius to which a tooth sector reaches, m."""
    depth = gear.rim_thickness
    slender = depth > SLENDER * gear.root_radius * profile.pitch_angle
    if gear.web is None and all_real and not slender and gear.held_radius >= TAPER * gear.root_radius:
        return gear.held_radius
    return gear.root_radius - gear.sign * min(RIM_DEPTH * gear.normal_module, 0.5 * depth)


def _mesh_hub(
    gear: Toothing, sector: ToothSector, teeth: IntArray, recipe: MeshRecipe, limits: QualityLimits
) -> _Hub:
    """Mesh the rest of the ring: of a solid gear in one piece, else what is left of the rim, web and hub."""
    toothed = _hub_outline(gear, sector, teeth, recipe)
    rings = _inner_rings(gear, float(np.linalg.norm(sector.points[sector.bottom[0]])), recipe)
    meshes, around = [], toothed
    for ring in rings:
        outermost_first = (around, ring.circle)[:: gear.sign]
        meshes += quadratic_meshes({"hub": outermost_first}, gear.normal_module, recipe.growth, limits)
        around = ring.circle.reversed()
    return _joined_hub(meshes, toothed, [ring.thickness for ring in rings], teeth, gear.sign)
