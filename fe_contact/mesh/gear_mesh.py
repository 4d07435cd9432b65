"""The finite-element mesh of one gear: identical tooth sectors, and a hub that closes the ring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.errors import FeContactError
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.hub import Hub, hub_outline, inner_rings, joined_hub
from fe_contact.mesh.quadratic_mesh import Part, quadratic_meshes, rotated
from fe_contact.mesh.quality import QualityLimits
from fe_contact.mesh.recipe import MeshRecipe
from fe_contact.mesh.tooth_outline import tooth_outline
from fe_contact.mesh.tooth_sector import ToothSector, tooth_sector
from fe_contact.types import FloatArray, IntArray
from host import ChildFailed

SLENDER = 3.0  # deepest sector down to the bore, in root circle pitches: beyond it a hub needs fewer elements
TAPER = 0.35  # least bore of sectors down to it, in root circles: below it a sector is a needle
RIM_DEPTH = 2.0  # depth of a sector above a hub, in normal modules

_ahead: dict[tuple[Toothing, MeshRecipe], ToothSector] = {}
"""Tooth sectors of `mesh_ahead` that are not yet taken: at most those of its last call."""


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
    """Nodes that the gear is held by: on its bore, or on the outside of a ring gear's rim, and of a sector on
    its cut planes. Shape (b,).
    """
    flanks: tuple[_FlankNodes, ...]
    """Right flanks of the real teeth, in the order of `teeth`."""
    teeth: IntArray
    """Consecutive numbers of the real teeth, 0 among them. Shape (t,)."""
    pitch_angle: float
    """Angle of a pitch, rad."""
    sector: ToothSector
    """Mesh of one tooth in the frame of the tooth."""
    sector_nodes: IntArray
    """Number of each sector node in the gear mesh. Shape (t, n_sector)."""
    hub_nodes: IntArray
    """Number of each hub node in the gear mesh. Shape (n_hub,)."""
    hub: Hub | None
    """Mesh of the hub; None if the sectors reach down to the held circle."""


def real_teeth(teeth: int, modeled: int | None) -> IntArray:
    """Return the numbers of the real teeth: `modeled` of them centered on 0, or all."""
    count = teeth if modeled is None else min(modeled, teeth)
    return np.arange(count) - (count - 1) // 2


def _assemble(
    sector: ToothSector, hub: Hub | None, teeth: IntArray, pitch_angle: float, normals: FloatArray
) -> GearMesh:
    """Join the sectors of `teeth` and the hub; `normals` (k, 2) at `sector.flank` are in the tooth frame.

    Teeth that are neither all nor joined by a hub end at cut planes, which are held like the bore.
    """
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
    if hub is None and not closed:
        bore = np.unique(
            np.concatenate([bore, sector_nodes[0, sector.right_side], sector_nodes[-1, sector.left_side]])
        )
    flanks = tuple(
        _FlankNodes(int(j), sector_nodes[i, sector.flank], sector.s, rotated(normals, j * pitch_angle))
        for i, j in enumerate(teeth)
    )
    return GearMesh(
        points=points,
        triangles=triangles,
        bore_nodes=bore,
        flanks=flanks,
        teeth=teeth,
        pitch_angle=pitch_angle,
        sector=sector,
        sector_nodes=sector_nodes,
        hub_nodes=hub_nodes,
        hub=hub,
    )


def _number_sectors(sector: ToothSector, count: int, closed: bool) -> IntArray:
    """Return the number in the gear of each sector's nodes; a left side is the next sector's right side."""
    size = len(sector.points)
    owned = np.ones(size, dtype=bool)
    owned[sector.left_side] = False
    nodes_of_sector = int(owned.sum())
    nodes = np.empty((count, size), dtype=np.int64)
    nodes[:, owned] = np.arange(count * nodes_of_sector).reshape(count, nodes_of_sector)
    following = np.roll(nodes[:, sector.right_side], -1, axis=0)
    nodes[:, sector.left_side] = following
    if not closed:
        nodes[-1, sector.left_side] = count * nodes_of_sector + np.arange(len(sector.left_side))
    return nodes


def _number_hub(sector: ToothSector, sector_nodes: IntArray, hub: Hub | None) -> IntArray:
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
    teeth = _modeled_teeth(gear, recipe)
    sector = _ahead.pop((gear, recipe), None) if limits == QualityLimits() else None
    if sector is None:
        (sector,) = _sectors([(gear, recipe)], limits)
    is_whole = _sector_bottom(gear, recipe) == gear.seat_radius
    rest = None if is_whole else _mesh_hub(gear, sector, teeth, recipe, limits)
    # Copies of the sector are as good as the sector, which is checked.
    return _assemble(sector, rest, teeth, profile.pitch_angle, profile.normal(sector.s))


def mesh_ahead(sections: Sequence[tuple[Toothing, MeshRecipe]]) -> None:
    """Mesh the tooth sectors of several sections in one process of gmsh, for the next calls of `mesh_gear`.

    That process takes longer to start than to mesh a sector. Sections that cannot be meshed are left to
    `mesh_gear`, which says why. Raises `MeshError`: the process failed, ran out of time or of memory, as a
    second one would.
    """
    made = {section: _ahead[section] for section in sections if section in _ahead}
    new = [section for section in dict.fromkeys(sections) if section not in made]
    _ahead.clear()
    _ahead.update(made)
    if len(new) > 1:
        try:
            _ahead.update(zip(new, _sectors(new, QualityLimits()), strict=True))
        except FeContactError as error:
            if isinstance(error.__cause__, ChildFailed):
                raise


def _sectors(sections: Sequence[tuple[Toothing, MeshRecipe]], limits: QualityLimits) -> list[ToothSector]:
    """Mesh a tooth sector of each section."""
    outlines = [
        tooth_outline(tooth_profile(gear), _sector_bottom(gear, recipe), recipe) for gear, recipe in sections
    ]
    parts = [
        Part("tooth sector", (outline.outline,), gear.normal_module, recipe.growth)
        for (gear, recipe), outline in zip(sections, outlines, strict=True)
    ]
    meshes = quadratic_meshes(parts, limits)
    return [tooth_sector(mesh, outline) for mesh, outline in zip(meshes, outlines, strict=True)]


def _modeled_teeth(gear: Toothing, recipe: MeshRecipe) -> IntArray:
    """Return the teeth of a section: all of them, those of a toothed sector, or those of the recipe."""
    return real_teeth(gear.teeth, gear.sector_teeth or recipe.real_teeth)


def _sector_bottom(gear: Toothing, recipe: MeshRecipe) -> float:
    """Return the radius to which a tooth sector reaches, m."""
    if gear.sector_teeth is not None:
        return gear.seat_radius
    all_real = len(_modeled_teeth(gear, recipe)) == gear.teeth
    depth = gear.rim_thickness
    slender = depth > SLENDER * gear.root_radius * tooth_profile(gear).pitch_angle
    if gear.web is None and all_real and not slender and gear.seat_radius >= TAPER * gear.root_radius:
        return gear.seat_radius
    return gear.root_radius - gear.sign * min(RIM_DEPTH * gear.normal_module, 0.5 * depth)


def _mesh_hub(
    gear: Toothing, sector: ToothSector, teeth: IntArray, recipe: MeshRecipe, limits: QualityLimits
) -> Hub:
    """Mesh the rest of the ring: of a solid gear in one piece, else what is left of the rim, web and hub."""
    toothed = hub_outline(gear, sector, teeth, recipe)
    rings = inner_rings(gear, float(np.linalg.norm(sector.points[sector.bottom[0]])), recipe)
    parts, around = [], toothed
    for ring in rings:
        outermost_first = (around, ring.circle)[:: gear.sign]
        parts.append(Part("hub", outermost_first, gear.normal_module, recipe.growth))
        around = ring.circle.reversed()
    meshes = quadratic_meshes(parts, limits)
    return joined_hub(meshes, toothed, [ring.thickness for ring in rings], teeth, gear.sign)
