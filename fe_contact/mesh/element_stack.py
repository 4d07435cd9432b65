"""A stack of 20-node hexahedra on the quadrilaterals of a section, in batches of equal matrices.

Layers are merged in pairs away from the teeth: at level v an element is 2^v layers thick. An element hangs if
its lower face is half a face of a coarser element. Nodes lie in 2 L + 1 planes, ends and middles of L layers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.mesh.face_layers import Layers
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.types import FloatArray, IntArray

# Nodes of an element that lie above the side 0-1 of its quadrilateral, towards the bore.
LOWER_FACE = [0, 1, 4, 5, 8, 12, 16, 17]


@dataclass(frozen=True)
class Batch:
    """Elements above some quadrilaterals that share their matrices layer by layer."""

    quads: IntArray
    """Quadrilaterals of the section. Shape (m,)."""
    thickness: float
    """Thickness of the layer, m."""
    half: int
    """Coarser side of the elements. 0: conforming. -1, +1: the lower face is the lower or upper half of a
    face of the next coarser layer.
    """
    elements: IntArray
    """Rows of `SweptSector.elements`, one line for each of the c layers. Shape (c, m)."""
    seat: bool = False
    """An elastic seat below the bodies' elements on the bore instead of bodies."""


Stack = tuple[tuple[Batch, ...], IntArray, FloatArray]
"""Elements by equal matrices; their nodes (e, 20); column, row and layer of each, (e, 3)."""


def stacked(
    grid: SectorGrid,
    layers: Layers,
    nodes: IntArray,
    level: IntArray,
    node_level: IntArray,
    extent: IntArray,
) -> Stack:
    """Stack the elements layer by layer.

    `nodes` (2 L + 1, n) are those above each section node in each plane, -1 where there is none; `level`
    (m,) and `node_level` (n,) say how often layers were merged there. Elements stand on a quadrilateral from
    layer `extent[:, 0]` to below layer `extent[:, 1]`.
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
            half = (-1, 1)[(first >> lv) % 2] if hangs else 0  # even elements are lower halves
            elements.append(_layer(nodes, grid.quads[quads], 2 * first, 2 << lv, half))  # in planes
            position.append(np.column_stack([grid.cells[quads], np.full(len(quads), first + 0.5 * 2**lv)]))
            numbers = count + np.arange(len(quads))
            sharing.setdefault((int(layers.kind[first]), half), []).append(numbers)
            count += len(quads)
        for (kind, half), rows in sharing.items():
            batches.append(Batch(quads, 2.0**lv * layers.thickness[kind], half, np.array(rows)))
    return tuple(batches), np.concatenate(elements), np.concatenate(position)


def with_seat(
    grid: SectorGrid, layers: Layers, bodies: Stack, ends: tuple[float, float], elastic: bool
) -> Stack:
    """Add a seat between axial positions `ends` in m: elements on the nodes of body elements there."""
    batches, elements, position = bodies
    if not elastic:
        return bodies
    low, high = (np.abs(layers.ends - z).argmin() for z in ends)  # layers, as in `position`
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
    elements = np.concatenate([nodes[plane][columns] for plane, columns in parts], axis=1)
    if half:
        coarse = _layer(nodes, quads, low if half < 0 else low - height, 2 * height, 0)
        elements[:, LOWER_FACE] = coarse[:, LOWER_FACE]
    return elements
