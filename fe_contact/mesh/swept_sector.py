"""One tooth sector swept across the face into 20-node hexahedra: numbering of nodes and freedoms.

Every layer is a copy of the section, turned along the helix. Freedoms are components in each node's own
cylindrical frame (radial, tangential, axial), so layers and sectors share element matrices. Deep in the
body two layers become one; nodes left hanging on the finer side do not exist: their displacement is that of
the coarser face. A web has the layers between its faces only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_contact.errors import InputError
from fe_contact.geometry.bore_seat import CLAMPED, BoreSeat
from fe_contact.geometry.gear_blank import ROUNDING, Web
from fe_contact.mesh.bore_support import BoreSupport, ClampedBore
from fe_contact.mesh.layers import Layers, layers_across, layers_to_mid_face
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.mesh.sector_recipe import SectorRecipe
from fe_contact.types import BoolArray, FloatArray, IntArray

# Nodes of an element that lie above the side 0-1 of its quadrilateral, towards the bore.
LOWER_FACE = [0, 1, 4, 5, 8, 12, 16, 17]


@dataclass(frozen=True)
class Batch:
    """Elements above some quadrilaterals that share their matrices layer by layer.

    Attributes
    ----------
    quads : (m,) int array
        Quadrilaterals of the section.
    thickness : float
        Of the layer, m.
    half : int
        0: conforming. -1, +1: the lower face is the lower or upper half of a face of the next coarser layer.
    elements : (c, m) int array
        Rows of `SweptSector.elements`, one line for each of the c layers.
    seat : bool
        An elastic seat below the bodies' elements on the bore instead of bodies.
    """

    quads: IntArray
    thickness: float
    half: int
    elements: IntArray
    seat: bool = False


@dataclass(frozen=True)
class SweptSector:
    """Hexahedra of one tooth sector.

    Attributes
    ----------
    grid : SectorGrid
        The section.
    layers : Layers
        The layers of the tooth, L of them.
    nodes : (2 L + 1, n) int array
        Node above each section node in each plane (layer ends and middles), -1 where there is none.
    elements : (e, 20) int array
        Nodes: bottom corners, top corners, bottom middles, top middles, middles between bottom and top;
        each four in the order of `SectorGrid.quads`.
    place : (e, 3) array
        Column, row and layer of each element on the logical grid.
    batches : tuple of Batch
        The elements by equal matrices.
    freedoms : (N, 3) int array
        Number of each node's freedoms, -1 where held.
    seat : BoreSeat
        What the bore rests on.
    """

    grid: SectorGrid
    layers: Layers
    nodes: IntArray
    elements: IntArray
    place: FloatArray
    batches: tuple[Batch, ...]
    freedoms: IntArray
    seat: BoreSeat = CLAMPED

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
        return self.freedoms[self.elements].reshape(len(self.elements), 60)

    @cached_property
    def flank_index(self) -> IntArray:
        """Number of each flank node among the flank freedoms, (2 L + 1, k), -1 at the centres of faces."""
        exists = self.nodes[:, self.grid.flank] >= 0
        return np.where(exists, np.cumsum(exists).reshape(exists.shape) - 1, -1)

    @property
    def flank(self) -> IntArray:
        """Freedoms along the flank normal, plane by plane; the first of the three of a flank node."""
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
        """Where on a cut its tangential freedoms on the bore are if the seat has a key, else none."""
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
    grid : SectorGrid
        Topology of the section.
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
    node_level = np.zeros(grid.nodes, dtype=np.int64)
    np.maximum.at(node_level, grid.quads.ravel(), np.repeat(level, 8))
    extent = _extents(grid, layers, web)
    exists = _existing(grid, node_level, extent, planes)
    nodes = np.where(exists, np.cumsum(exists).reshape(exists.shape) - 1, -1)
    batches, elements, place = _elements(grid, layers, nodes, level, node_level, extent)
    batches, elements, place = _with_seat(
        grid, layers, (batches, elements, place), support.seat.ends(face_width), support.seat.elastic
    )
    held = support.held(grid, between_ends(layers.ends))
    held[0, :, 2] |= recipe.half_face
    free = ~held[exists]
    freedoms = np.where(free, np.cumsum(free).reshape(free.shape) - 1, -1)
    return SweptSector(grid, layers, nodes, elements, place, batches, freedoms, support.seat)


def between_ends(ends: FloatArray) -> FloatArray:
    """Return the axial positions of all planes of nodes: ends and middles of layers."""
    z = np.repeat(ends, 2)[:-1]
    z[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return z


def _layers(face_width: float, recipe: SectorRecipe, web: Web | None, seat: BoreSeat) -> Layers:
    """Divide the face, or its half above mid-face; groups of layers end where web and seat end."""
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
    """Return the different axial positions inside the face, increasing."""
    close, breaks = ROUNDING * face_width, [-0.5 * face_width]
    for z in sorted(positions):
        if z > breaks[-1] + close and z < 0.5 * face_width - close:
            breaks.append(float(z))
    return tuple(breaks[1:])


def _extents(grid: SectorGrid, layers: Layers, web: Web | None) -> IntArray:
    """Return the first layer of each quadrilateral, and the first one above it, (m, 2)."""
    extent = np.tile([0, len(layers.kind)], (len(grid.quads), 1))
    if web is not None:
        extent[grid.web] = [np.abs(layers.ends - z).argmin() for z in (web.low, web.high)]
    return extent


def _existing(grid: SectorGrid, node_level: IntArray, extent: IntArray, planes: int) -> BoolArray:
    """Return where a section node has a node above it: corners also between bottom and top of an element."""
    step = np.where(grid.corner, 1, 2) * 2**node_level
    low, high = np.full(grid.nodes, planes), np.zeros(grid.nodes, dtype=np.int64)
    np.minimum.at(low, grid.quads.ravel(), np.repeat(2 * extent[:, 0], 8))
    np.maximum.at(high, grid.quads.ravel(), np.repeat(2 * extent[:, 1], 8))
    plane = np.arange(planes)[:, None]
    return np.asarray((plane % step == 0) & (plane >= low) & (plane <= high))


def _elements(
    grid: SectorGrid,
    layers: Layers,
    nodes: IntArray,
    level: IntArray,
    node_level: IntArray,
    extent: IntArray,
) -> tuple[tuple[Batch, ...], IntArray, FloatArray]:
    """Stack the elements layer by layer."""
    alike = np.column_stack([level, node_level[grid.quads[:, 0]] > level, extent])
    elements: list[IntArray] = []
    place: list[FloatArray] = []
    batches: list[Batch] = []
    count = 0
    for lv, hangs, first_layer, last_layer in np.unique(alike, axis=0):
        quads = np.flatnonzero((alike == [lv, hangs, first_layer, last_layer]).all(axis=1))
        sharing: dict[tuple[int, int], list[IntArray]] = {}
        for first in range(first_layer, last_layer, 1 << lv):
            half = (-1, 1)[(first >> lv) % 2] if hangs else 0
            elements.append(_layer(nodes, grid.quads[quads], 2 * first, 2 << lv, half))
            place.append(np.column_stack([grid.cells[quads], np.full(len(quads), first + 0.5 * 2**lv)]))
            numbers = count + np.arange(len(quads))
            sharing.setdefault((int(layers.kind[first]), half), []).append(numbers)
            count += len(quads)
        for (kind, half), rows in sharing.items():
            batches.append(Batch(quads, 2.0**lv * layers.thickness[kind], half, np.array(rows)))
    return tuple(batches), np.concatenate(elements), np.concatenate(place)


Stack = tuple[tuple[Batch, ...], IntArray, FloatArray]


def _with_seat(
    grid: SectorGrid, layers: Layers, bodies: Stack, ends: tuple[float, float], elastic: bool
) -> Stack:
    """Add the elements of an elastic seat: the nodes of the bodies above them."""
    batches, elements, place = bodies
    if not elastic:
        return bodies
    low, high = (np.abs(layers.ends - z).argmin() for z in ends)
    on_bore = grid.cells[:, 1] == -grid.body_rows
    added: list[IntArray] = []
    count, more = len(elements), []
    for batch in batches:
        columns = on_bore[batch.quads]
        lines = (place[batch.elements[:, 0], 2] > low) & (place[batch.elements[:, 0], 2] < high)
        chosen = batch.elements[lines][:, columns]
        if chosen.size:
            numbers = count + np.arange(chosen.size).reshape(chosen.shape)
            more.append(Batch(batch.quads[columns], batch.thickness, 0, numbers, seat=True))
            added.append(chosen.ravel())
            count += chosen.size
    rows = np.concatenate(added)
    return (
        (*batches, *more),
        np.concatenate([elements, elements[rows]]),
        np.concatenate([place, place[rows]]),
    )


def _layer(nodes: IntArray, quads: IntArray, low: int, height: int, half: int) -> IntArray:
    """Return the nodes of the elements from plane `low` to `low + height`."""
    corners, middles = quads[:, :4], quads[:, 4:]
    middle, high = low + height // 2, low + height
    parts = [(low, corners), (high, corners), (low, middles), (high, middles), (middle, corners)]
    elements = np.concatenate([nodes[plane][on] for plane, on in parts], axis=1)
    if half:
        coarse = _layer(nodes, quads, low if half < 0 else low - height, 2 * height, 0)
        elements[:, LOWER_FACE] = coarse[:, LOWER_FACE]
    return elements
