"""The finite-element mesh of one gear: identical tooth sectors, and a hub that closes the ring."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.mesh.hub import Hub
from fe_contact.mesh.quadratic import rotated
from fe_contact.mesh.tooth_sector import ToothSector
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class FlankNodes:
    """Nodes along the right flank of one tooth.

    Attributes
    ----------
    tooth : int
        Number of the tooth; 0 is on +y, counted counter-clockwise.
    nodes : (k,) int array
        Node numbers of the gear mesh from root to tip: corner, mid-side, corner ...
    s : (k,) array
        Flank coordinate, m. Mid-side nodes lie at the exact middle of their corners.
    normals : (k, 2) array
        Outward unit normals of the exact profile.
    """

    tooth: int
    nodes: IntArray
    s: FloatArray
    normals: FloatArray


@dataclass(frozen=True)
class GearMesh:
    """Six-node triangles on the complete ring of one gear, transverse section.

    Tooth sectors are copies of one mesh, turned by whole pitches, so all teeth are discretized alike.

    Attributes
    ----------
    points : (n, 2) array
        Nodes, m.
    triangles : (m, 6) array
        Nodes of the elements: corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0 (gmsh, VTK).
        With e elements per sector those of tooth `teeth[i]` are i e ... (i + 1) e - 1; the hub's follow.
    bore_nodes : (b,) int array
        Nodes on the circle that the gear is held by: its bore, or the outside of a ring gear's rim.
    flanks : tuple of FlankNodes
        Right flanks of the real teeth, in the order of `teeth`.
    teeth : (t,) int array
        Consecutive numbers of the real teeth, 0 among them.
    pitch_angle : float
        rad.
    sector : ToothSector
        The mesh of one tooth in its own frame.
    sector_nodes : (t, n_sector) int array
        Node of the gear mesh that each sector node is.
    hub_nodes : (n_hub,) int array
        Node of the gear mesh that each hub node is.
    hub : Hub or None
        None if the sectors reach down to that circle.
    """

    points: FloatArray
    triangles: IntArray
    bore_nodes: IntArray
    flanks: tuple[FlankNodes, ...]
    teeth: IntArray
    pitch_angle: float
    sector: ToothSector
    sector_nodes: IntArray
    hub_nodes: IntArray
    hub: Hub | None


def real_teeth(teeth: int, modeled: int | None) -> IntArray:
    """Return the numbers of the real teeth: `modeled` of them centered on 0, or all."""
    count = teeth if modeled is None else min(modeled, teeth)
    return np.arange(count) - (count - 1) // 2


def assemble(
    sector: ToothSector, hub: Hub | None, teeth: IntArray, pitch_angle: float, normals: FloatArray
) -> GearMesh:
    """Join the sectors of `teeth` and the hub.

    Parameters
    ----------
    sector : ToothSector
        Mesh of one tooth.
    hub : Hub or None
        The rest of the ring.
    teeth : (t,) int array
        Consecutive tooth numbers.
    pitch_angle : float
        rad.
    normals : (k, 2) array
        Outward normals at `sector.flank` in the tooth frame.
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
    flanks = tuple(
        FlankNodes(int(j), sector_nodes[i, sector.flank], sector.s, rotated(normals, j * pitch_angle))
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
