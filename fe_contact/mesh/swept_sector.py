"""One tooth sector swept across the face into 20-node hexahedra: numbering of nodes and freedoms.

Every layer is a copy of the section, turned along the helix. Freedoms are components in each node's own
cylindrical frame (radial, tangential, axial), so layers and sectors share element matrices. Deep in the
body two layers become one; nodes left hanging on the finer side do not exist: their displacement is that of
the coarser face. A web has the layers between its faces only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from fe_contact.body import CLAMPED, ROUNDING, BoreSeat, Web
from fe_contact.errors import InputError
from fe_contact.mesh.recipe import SectorRecipe
from fe_contact.mesh.sector_grid import BoreSupport, ClampedBore, SectorGrid
from fe_contact.types import BoolArray, FloatArray, IntArray

# Division of the face width into layers of elements, finer towards both ends.


RISE = 3  # groups of layers over which the thickness grows from an end to the middle
TOLERATED = 0.3  # of a group of layers: a part of the face this much longer gets no further one
DIGITS = 12  # of a layer's thickness over the face width: equal in them is equally thick


@dataclass(frozen=True)
class _Layers:
    """Layers of elements, or those above mid-face; symmetric unless a web or a seat of the bore is not."""

    ends: FloatArray
    """Axial positions of their ends, m; 0 is mid-face, increasing. Shape (L + 1,)."""
    kind: IntArray
    """Layers of the same kind are equally thick, bit for bit. Shape (L,)."""
    thickness: FloatArray
    """Thickness of each kind, m. Shape (kinds,)."""


def _layers_to_mid_face(
    width: float, count: int, growth: float = 1.0, breaks: Sequence[float] = ()
) -> _Layers:
    """Divide the upper half of a face of `width` into layers that thicken from its end towards mid-face.

    The layer at mid-face is `growth` times as thick as the end layer. A layer ends at each of `breaks`,
    increasing axial positions above 0, m.
    """
    if len(breaks):
        below = [-z for z in reversed(breaks)]
        whole = _broken(width, 0.5 * width / count, 1, growth, [*below, 0.0, *breaks])
        middle = len(whole.kind) // 2
        return _Layers(whole.ends[middle:], whole.kind[middle:], whole.thickness)
    kind = np.arange(count)[::-1]
    relative = growth ** (np.arange(count) / max(count - 1, 1))
    thickness = 0.5 * width * relative / relative.sum()
    ends = np.concatenate([[0.0], np.cumsum(thickness[kind])])
    ends[-1] = 0.5 * width
    return _Layers(ends, kind, thickness)


def _layers_across(
    width: float, count: int, group: int = 1, growth: float = 1.0, breaks: Sequence[float] = ()
) -> _Layers:
    """Divide `width` into `count` layers of which every `group` successive ones are equally thick.

    `group` divides `count`; a middle layer is `growth` times as thick as an end layer. A group ends at
    each of `breaks`, increasing axial positions, m. Each part of the face has groups about as thick as
    without them, and at least one; so there may be more than `count` layers.
    """
    if len(breaks):
        return _broken(width, width * group / count, group, growth, breaks)
    number = np.arange(count // group)
    top = max(1, min(RISE, (len(number) - 1) // 2))
    kind = np.repeat(np.minimum(np.minimum(number, number[::-1]), top), group)
    relative = growth ** (np.arange(top + 1) / top)
    thickness = relative * width / relative[kind].sum()
    ends = np.concatenate([[0.0], np.cumsum(thickness[kind])]) - 0.5 * width
    ends[-1] = 0.5 * width
    return _Layers(0.5 * (ends - ends[::-1]), kind, thickness)


def _broken(width: float, usual: float, group: int, growth: float, breaks: Sequence[float]) -> _Layers:
    """Divide every part of the face by itself; `usual` is the thickness of a group without breaks."""
    corners = [-0.5 * width, *breaks, 0.5 * width]
    ends, thickness = [corners[:1]], []
    for i, (low, high) in enumerate(pairwise(corners)):
        number = np.arange(max(1, math.ceil((high - low) / usual - TOLERATED)))
        top = max(1, min(RISE, len(number) - 1))
        relative = np.ones(len(number))
        if i == 0:
            relative = growth ** (np.minimum(number, top) / top)
        elif i == len(corners) - 2:
            relative = growth ** (np.minimum(number[::-1], top) / top)
        parts = np.repeat(relative / relative.sum() * (high - low) / group, group)
        thickness.append(parts)
        ends.append([*(low + np.cumsum(parts))[:-1], high])
    rounded = np.round(np.concatenate(thickness) / width, DIGITS)
    _, first, kind = np.unique(rounded, return_index=True, return_inverse=True)
    return _Layers(np.concatenate(ends), kind, np.concatenate(thickness)[first])


# 20-node hexahedra _stacked across the face on the quadrilaterals of a section, by equal matrices.


# Nodes of an element that lie above the side 0-1 of its quadrilateral, towards the bore.
LOWER_FACE = [0, 1, 4, 5, 8, 12, 16, 17]


@dataclass(frozen=True)
class Batch:
    """Elements above some quadrilaterals that share their matrices layer by layer."""

    quads: IntArray
    """Quadrilaterals of the section. Shape (m,)."""
    thickness: float
    """Of the layer, m."""
    half: int
    """0: conforming. -1, +1: the lower face is the lower or upper half of a face of the next coarser layer.
    """
    elements: IntArray
    """Rows of `SweptSector.elements`, one line for each of the c layers. Shape (c, m)."""
    seat: bool = False
    """An elastic seat below the bodies' elements on the bore instead of bodies."""


Stack = tuple[tuple[Batch, ...], IntArray, FloatArray]
"""Elements by equal matrices; their nodes (e, 20); column, row and layer of each, (e, 3)."""


def _stacked(
    grid: SectorGrid,
    layers: _Layers,
    nodes: IntArray,
    level: IntArray,
    node_level: IntArray,
    extent: IntArray,
) -> Stack:
    """Stack the elements layer by layer.

    `nodes` (2 L + 1, n) are those above each section node in each plane, -1 where there is none; `level`
    (m,) and `node_level` (n,) say how often layers were merged there; `extent` (m, 2) is the first layer
    of each quadrilateral, and the first one above it.
    """
    alike = np.column_stack([level, node_level[grid.quads[:, 0]] > level, extent])
    elements: list[IntArray] = []
    position: list[FloatArray] = []
    batches: list[Batch] = []
    count = 0
    for lv, hangs, first_layer, last_layer in np.unique(alike, axis=0):
        quads = np.flatnonzero((alike == [lv, hangs, first_layer, last_layer]).all(axis=1))
        sharing: dict[tuple[int, int], list[IntArray]] = {}
        for first in range(first_layer, last_layer, 1 << lv):
            half = (-1, 1)[(first >> lv) % 2] if hangs else 0
            elements.append(_layer(nodes, grid.quads[quads], 2 * first, 2 << lv, half))
            position.append(np.column_stack([grid.cells[quads], np.full(len(quads), first + 0.5 * 2**lv)]))
            numbers = count + np.arange(len(quads))
            sharing.setdefault((int(layers.kind[first]), half), []).append(numbers)
            count += len(quads)
        for (kind, half), rows in sharing.items():
            batches.append(Batch(quads, 2.0**lv * layers.thickness[kind], half, np.array(rows)))
    return tuple(batches), np.concatenate(elements), np.concatenate(position)


def _with_seat(
    grid: SectorGrid, layers: _Layers, bodies: Stack, ends: tuple[float, float], elastic: bool
) -> Stack:
    """Add the elements of a seat between axial positions `ends` in m: the nodes of the bodies above them."""
    batches, elements, position = bodies
    if not elastic:
        return bodies
    low, high = (np.abs(layers.ends - z).argmin() for z in ends)
    on_bore = grid.cells[:, 1] == -grid.body_rows
    added: list[IntArray] = []
    count, more = len(elements), []
    for batch in batches:
        columns = on_bore[batch.quads]
        lines = (position[batch.elements[:, 0], 2] > low) & (position[batch.elements[:, 0], 2] < high)
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
        np.concatenate([position, position[rows]]),
    )


def _layer(nodes: IntArray, quads: IntArray, low: int, height: int, half: int) -> IntArray:
    corners, middles = quads[:, :4], quads[:, 4:]
    middle, high = low + height // 2, low + height
    parts = [(low, corners), (high, corners), (low, middles), (high, middles), (middle, corners)]
    elements = np.concatenate([nodes[plane][on] for plane, on in parts], axis=1)
    if half:
        coarse = _layer(nodes, quads, low if half < 0 else low - height, 2 * height, 0)
        elements[:, LOWER_FACE] = coarse[:, LOWER_FACE]
    return elements


@dataclass(frozen=True)
class SweptSector:
    """Hexahedra of one tooth sector."""

    grid: SectorGrid
    layers: _Layers
    """The layers of the tooth, L of them."""
    nodes: IntArray
    """Node above each section node in each plane (layer ends and middles), -1 where there is none. Shape (2 L
    + 1, n).
    """
    elements: IntArray
    """Nodes: bottom corners, top corners, bottom middles, top middles, middles between bottom and top; each
    four in the order of `SectorGrid.quads`. Shape (e, 20).
    """
    place: FloatArray
    """Column, row and layer of each element on the logical grid. Shape (e, 3)."""
    batches: tuple[Batch, ...]
    """The elements by equal matrices."""
    freedoms: IntArray
    """Number of each node's freedoms, -1 where held. Shape (N, 3)."""
    seat: BoreSeat = CLAMPED
    """What the bore rests on."""

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
        """Number of each flank node among the flank freedoms, (2 L + 1, k), -1 at the centers of faces."""
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
    node_level = np.zeros(grid.nodes, dtype=np.int64)
    np.maximum.at(node_level, grid.quads.ravel(), np.repeat(level, 8))
    extent = _extents(grid, layers, web)
    exists = _existing(grid, node_level, extent, planes)
    nodes = np.where(exists, np.cumsum(exists).reshape(exists.shape) - 1, -1)
    batches, elements, position = _stacked(grid, layers, nodes, level, node_level, extent)
    batches, elements, position = _with_seat(
        grid, layers, (batches, elements, position), support.seat.ends(face_width), support.seat.elastic
    )
    held = support.held(grid, between_ends(layers.ends))
    held[0, :, 2] |= recipe.half_face
    free = ~held[exists]
    freedoms = np.where(free, np.cumsum(free).reshape(free.shape) - 1, -1)
    return SweptSector(grid, layers, nodes, elements, position, batches, freedoms, support.seat)


def between_ends(ends: FloatArray) -> FloatArray:
    """Return the axial positions of all planes of nodes: ends and middles of layers."""
    z = np.repeat(ends, 2)[:-1]
    z[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return z


def _layers(face_width: float, recipe: SectorRecipe, web: Web | None, seat: BoreSeat) -> _Layers:
    """Divide the face, or its half above mid-face; groups of layers end where web and seat end."""
    faces: tuple[float, ...] = () if web is None else (web.low, web.high)
    if seat.width is not None:
        faces = (*faces, *seat.ends(face_width))
    if recipe.half_face:
        if abs(sum(faces)) > ROUNDING * face_width:
            bound = "False for a web or a seat off the middle"
            raise InputError("half_face", True, bound, "Sweep the whole face.")
        above = _inner_breaks([z for z in faces if z > 0.0], face_width)
        return _layers_to_mid_face(face_width, recipe.layers, recipe.layer_growth, above)
    breaks = _inner_breaks(faces, face_width)
    return _layers_across(face_width, recipe.layers, recipe.layer_group, recipe.layer_growth, breaks)


def _inner_breaks(positions: Sequence[float], face_width: float) -> tuple[float, ...]:
    """Return the different axial positions inside the face, increasing."""
    close, breaks = ROUNDING * face_width, [-0.5 * face_width]
    for z in sorted(positions):
        if z > breaks[-1] + close and z < 0.5 * face_width - close:
            breaks.append(float(z))
    return tuple(breaks[1:])


def _extents(grid: SectorGrid, layers: _Layers, web: Web | None) -> IntArray:
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
