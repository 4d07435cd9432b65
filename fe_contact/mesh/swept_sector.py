"""One tooth sector swept across the face into 20-node hexahedra: numbering of nodes and freedoms.

Every layer is a copy of the section, turned along the helix. Freedoms are components in each node's own
cylindrical frame (radial, tangential, axial), so layers and sectors share element matrices. Deep in the
body two layers are merged into one, and two of these again further down: the level of a cell is the number of
such mergers. Nodes left hanging on the finer side of a merger do not exist: their displacement is that of the
coarser face. A web has the layers between its faces only. The left and the right cut bound the sector. A
held freedom is fixed to zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_contact.body import CLAMPED, ROUNDING, BoreSeat, Web
from fe_contact.errors import InputError
from fe_contact.mesh.bore_support import BoreSupport, ClampedBore
from fe_contact.mesh.element_stack import Batch, stacked, with_seat
from fe_contact.mesh.face_layers import Layers, layers_across, layers_to_mid_face
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.types import BoolArray, FloatArray, IntArray

ELEMENT_FREEDOMS = 60
"""Freedoms of an element: three at each of its 20 nodes."""
CELL_NODES = 8
"""Nodes of a quadrilateral of the section: four corners, four middles of sides."""


@dataclass(frozen=True)
class SweptSector:
    """Hexahedra of one tooth sector."""

    grid: SectorGrid
    layers: Layers
    """The layers of the tooth, L of them."""
    nodes: IntArray
    """Node above each section node in each plane (layer ends and middles), -1 where there is none. Shape (2 L
    + 1, n).
    """
    elements: IntArray
    """Nodes: bottom corners, top corners, bottom middles, top middles, middles between bottom and top; each
    four in the order of `SectorGrid.quads`. Shape (e, 20).
    """
    grid_cell: FloatArray
    """Column, row and layer of each element on the logical grid. Shape (e, 3)."""
    batches: tuple[Batch, ...]
    """The elements by equal matrices."""
    freedoms: IntArray
    """Number of each node's freedoms, -1 where held. Shape (N, 3)."""
    seat: BoreSeat = CLAMPED
    """Seat that the bore rests on."""

    @property
    def bodies(self) -> int:
        """Number of elements that are bodies; those of an elastic seat follow them."""
        return sum(batch.elements.size for batch in self.batches if not batch.seat)

    @property
    def size(self) -> int:
        """Number of free freedoms."""
        return int(self.freedoms.max()) + 1

    @cached_property
    def element_freedoms(self) -> IntArray:
        """Freedoms of each element, (e, 60), node by node; -1 where held."""
        return self.freedoms[self.elements].reshape(len(self.elements), ELEMENT_FREEDOMS)

    @cached_property
    def flank_index(self) -> IntArray:
        """Number of each flank node among the flank freedoms, (2 L + 1, k), -1 at the centers of faces."""
        exists = self.nodes[:, self.grid.flank] >= 0  # element faces have nodes at corners and side middles
        return np.where(exists, np.cumsum(exists).reshape(exists.shape) - 1, -1)

    @property
    def flank(self) -> IntArray:
        """Freedoms along the flank normal, plane by plane: the first of the three of each flank node."""
        nodes = self.nodes[:, self.grid.flank]
        return np.asarray(self.freedoms[nodes[nodes >= 0], 0])

    @property
    def loaded(self) -> IntArray:
        """Freedoms that forces from outside may act on: the flank, and what a key may hold."""
        return np.concatenate([self.flank, self.key_bore])

    @cached_property
    def key_bore(self) -> IntArray:
        """Tangential freedoms on the bore between the cuts if the seat has a key, else none."""
        return self._tangential(self.grid.bore[1:-1])

    @cached_property
    def key_cut(self) -> IntArray:
        """Positions on a cut of its tangential freedoms on the bore if the seat has a key, else none."""
        return np.flatnonzero(np.isin(self.left, self._tangential(self.grid.left[:1])))

    def _tangential(self, column: IntArray) -> IntArray:
        """Return the tangential freedoms above section nodes, none without a key."""
        nodes = self.nodes[:, column]
        freedoms = self.freedoms[nodes[nodes >= 0], 1]
        return np.asarray(freedoms[freedoms >= 0] if self.seat.key is not None else freedoms[:0])

    @property
    def left(self) -> IntArray:
        """Freedoms on the left cut: the right ones of the next sector counter-clockwise."""
        return self._cut(self.grid.left)

    @property
    def right(self) -> IntArray:
        """Freedoms on the right cut, in the order of the left ones."""
        return self._cut(self.grid.right)

    def _cut(self, column: IntArray) -> IntArray:
        """Return the free freedoms above a column of section nodes."""
        nodes = self.nodes[:, column]
        freedoms = self.freedoms[nodes[nodes >= 0]].ravel()
        return freedoms[freedoms >= 0]


def swept_sector(
    grid: SectorGrid,
    face_width: float,
    recipe: SectorRecipe,
    support: BoreSupport | None = None,
    web: Web | None = None,
) -> SweptSector:
    """Sweep the section `grid` across `face_width`.

    Parameters
    ----------
    face_width : float
        m.
    recipe : SectorRecipe
        Layers, and where they are merged.
    support : BoreSupport, optional
        Default `ClampedBore()`.
    web : Web, optional
        The rows `SectorGrid.web_rows` have elements between its faces only.
    """
    support = support or ClampedBore()
    layers = _layers(face_width, recipe, web, support.seat)
    planes = 2 * len(layers.kind) + 1
    level = np.sum(grid.cells[:, 1, None] < np.array(recipe.merge_rows, dtype=int), axis=1)
    node_level = np.zeros(grid.nodes, dtype=np.int64)  # the largest level of the cells that share a node
    np.maximum.at(node_level, grid.quads.ravel(), np.repeat(level, CELL_NODES))
    extent = _extents(grid, layers, web)
    exists = _existing(grid, node_level, extent, planes)
    nodes = np.where(exists, np.cumsum(exists).reshape(exists.shape) - 1, -1)
    batches, elements, position = stacked(grid, layers, nodes, level, node_level, extent)
    batches, elements, position = with_seat(
        grid, layers, (batches, elements, position), support.seat.ends(face_width), support.seat.elastic
    )
    fixed = support.constrained(grid, between_ends(layers.ends))
    fixed[0, :, 2] |= recipe.half_face  # the first plane of a half face is mid-face, which moves in its plane
    free = ~fixed[exists]
    freedoms = np.where(free, np.cumsum(free).reshape(free.shape) - 1, -1)
    return SweptSector(grid, layers, nodes, elements, position, batches, freedoms, support.seat)


def between_ends(ends: FloatArray) -> FloatArray:
    """Return the axial positions of all planes of nodes: ends and middles of layers."""
    z = np.repeat(ends, 2)[:-1]
    z[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return z


def _layers(face_width: float, recipe: SectorRecipe, web: Web | None, seat: BoreSeat) -> Layers:
    """Divide the face, or its half above mid-face, into layers; web and seat end at the ends of layers."""
    faces: tuple[float, ...] = () if web is None else (web.low, web.high)
    if seat.width is not None:
        faces = (*faces, *seat.ends(face_width))
    if recipe.half_face:
        if abs(sum(faces)) > ROUNDING * face_width:
            bound = "False for a web or a seat off the middle"
            raise InputError("half_face", True, bound, "Sweep the whole face.")
        above = inner_breaks([z for z in faces if z > 0.0], face_width)
        return layers_to_mid_face(face_width, recipe.layers, recipe.layer_growth, above)
    breaks = inner_breaks(faces, face_width)
    return layers_across(face_width, recipe.layers, recipe.layer_group, recipe.layer_growth, breaks)


def inner_breaks(positions: Sequence[float], face_width: float) -> tuple[float, ...]:
    """Return the axial positions inside the face, increasing; those closer than `ROUNDING` are one."""
    close, breaks = ROUNDING * face_width, [-0.5 * face_width]
    for z in sorted(positions):
        if z > breaks[-1] + close and z < 0.5 * face_width - close:
            breaks.append(float(z))
    return tuple(breaks[1:])


def _extents(grid: SectorGrid, layers: Layers, web: Web | None) -> IntArray:
    """Return the first layer of elements above each quadrilateral, and the one after the last, (m, 2)."""
    extent = np.tile([0, len(layers.kind)], (len(grid.quads), 1))
    if web is not None:
        extent[grid.web] = [np.abs(layers.ends - z).argmin() for z in (web.low, web.high)]
    return extent


def _existing(grid: SectorGrid, node_level: IntArray, extent: IntArray, planes: int) -> BoolArray:
    """Return the planes in which a section node has a node, (planes, nodes).

    A corner of the section has nodes at bottom, middle and top of an element, a middle of a side at bottom
    and top only. Each merger of layers doubles the distance of these planes.
    """
    step = np.where(grid.corner, 1, 2) * 2**node_level
    low, high = np.full(grid.nodes, planes), np.zeros(grid.nodes, dtype=np.int64)
    np.minimum.at(low, grid.quads.ravel(), np.repeat(2 * extent[:, 0], CELL_NODES))
    np.maximum.at(high, grid.quads.ravel(), np.repeat(2 * extent[:, 1], CELL_NODES))
    plane = np.arange(planes)[:, None]
    return np.asarray((plane % step == 0) & (plane >= low) & (plane <= high))
