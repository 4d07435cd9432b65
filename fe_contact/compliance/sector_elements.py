"""The hexahedra of one tooth sector in space: nodes, displacements from freedoms, stresses, quality."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.deformed_gear import stress_of, turn_about_axis
from fe_contact.compliance.hanging_nodes import coarse_face
from fe_contact.compliance.hexahedron import (
    REFERENCE,
    SECTION,
    cylindrical_frames,
    gradients_at,
    layer_nodes,
)
from fe_contact.compliance.sector_stiffness import flank_frames, lame_parameters, twist
from fe_contact.geometry import Toothing
from fe_contact.mesh.hexahedra import LOWER_FACE, Batch
from fe_contact.mesh.quad_quality import quad_quality
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.swept_sector import SweptSector
from fe_contact.types import FloatArray, IntArray

# Points where the stress of a 20-node hexahedron is most exact: two Gauss points each way, in -1 .. 1.
INNER = REFERENCE[:8] / np.sqrt(3.0)


@dataclass(frozen=True)
class _Part:
    """One batch: its elements (c, m) and, in the frame of its layers, what turns freedoms into stresses.

    Attributes
    ----------
    frames : (m, 60, 60) array
        Cartesian displacement per freedom.
    gradient : (m, 8, 20, 3) array
        Gradients of the functions at `INNER`.
    turns : (c, 3, 3) array
        From the frame of each layer to that of mid-face.
    """

    elements: IntArray
    frames: FloatArray
    gradient: FloatArray
    turns: FloatArray


@dataclass(frozen=True)
class SectorElements:
    """The elements of one sector, in the frame of mid-face, tooth on +y.

    Attributes
    ----------
    nodes : (e, 20, 3) array
        m, in the order of `SweptSector.elements`, which is VTK's.
    numbers : (e, 20) int array
        Point of each; nodes that hang on a coarser face have points of their own.
    points : int
        Number of points.
    quality : dict
        By name, (e,).
    """

    nodes: FloatArray
    numbers: IntArray
    points: int
    quality: dict[str, FloatArray]
    sector: SweptSector
    lame: tuple[float, float]
    parts: tuple[_Part, ...]

    def displacement(self, field: FloatArray) -> FloatArray:
        """Return the displacement (e, 20, 3) in m at the nodes for the freedoms `field` (n,)."""
        freedoms = self.sector.element_freedoms
        local = np.where(freedoms >= 0, field[freedoms], 0.0)
        moved = np.empty_like(self.nodes)
        for part in self.parts:
            values = np.einsum("mij,cmj->cmi", part.frames, local[part.elements])
            values = values.reshape(*part.elements.shape, 20, 3)
            moved[part.elements] = np.einsum("cxy,cmpy->cmpx", part.turns, values)
        return moved

    def stress(self, moved: FloatArray) -> FloatArray:
        """Return the stress (e, 20, 3, 3) in Pa at the nodes for displacements (e, 20, 3)."""
        stress = np.empty((*moved.shape, 3))
        for part in self.parts:
            # gradients are known in the frame of the layer: turn the displacement into it, the stress out
            local = np.einsum("cxy,cmpx->cmpy", part.turns, moved[part.elements])
            gradient = np.einsum("mqpi,cmpj->cmqij", part.gradient, local)
            inner = stress_of(gradient, self.lame)
            nodal = np.einsum("aq,cmqij->cmaij", _EXTRAPOLATION, inner)
            turns = part.turns[:, None, None]
            stress[part.elements] = turns @ nodal @ np.swapaxes(turns, -1, -2)
        return stress


def _trilinear(at: FloatArray) -> FloatArray:
    """Return the monomials of a trilinear function at points (n, 3), (n, 8)."""
    x, y, z = at.T
    return np.stack([np.ones_like(x), x, y, z, x * y, y * z, x * z, x * y * z], axis=1)


_EXTRAPOLATION = _trilinear(REFERENCE) @ np.linalg.inv(_trilinear(INNER))


def sector_elements(gear: Toothing, section: QuadSector, sector: SweptSector) -> SectorElements:
    """Place the elements of a sector.

    Parameters
    ----------
    gear : Gear or RingGear
        Right hand or spur, as the sector was made for.
    section : QuadSector
        Its transverse mesh.
    sector : SweptSector
        Its hexahedra.
    """
    axes = np.tile(np.eye(3), (sector.grid.nodes, 1, 1))
    axes[sector.grid.flank] = flank_frames(section, twist(gear))
    count = len(sector.elements)
    nodes, jacobian = np.empty((count, 20, 3)), np.empty(count)
    numbers, points = sector.elements.copy(), len(sector.freedoms)
    parts = []
    for batch in sector.batches:
        local, frames = _frames(section, batch, axes, twist(gear))
        middle = np.interp(
            sector.place[batch.elements[:, 0], 2], np.arange(len(sector.layers.ends)), sector.layers.ends
        )
        turns = np.stack([turn_about_axis(twist(gear) * float(z)) for z in middle])
        nodes[batch.elements] = np.einsum("cxy,mpy->cmpx", turns, local)
        nodes[batch.elements, :, 2] += middle[:, None, None]
        gradient, determinant = gradients_at(local, 0.5 * (np.concatenate([INNER, REFERENCE]).T + 1.0))
        jacobian[batch.elements] = determinant.min(axis=1) / np.abs(determinant).max(axis=1)
        parts.append(_Part(batch.elements, frames, np.ascontiguousarray(gradient[:, : len(INNER)]), turns))
        if batch.half:
            hanging = (batch.elements.size, len(LOWER_FACE))
            own = points + np.arange(hanging[0] * hanging[1]).reshape(hanging)
            numbers[batch.elements.ravel()[:, None], LOWER_FACE] = own
            points += own.size
    angle = quad_quality(section.points, section.grid.quads).angle
    quality = {"scaled_jacobian": jacobian, "corner_angle_deg": np.empty(count)}
    for batch in sector.batches:
        quality["corner_angle_deg"][batch.elements] = np.degrees(angle[batch.quads])
    return SectorElements(
        nodes, numbers, points, quality, sector, lame_parameters(gear.material), tuple(parts)
    )


def _frames(
    section: QuadSector, batch: Batch, axes: FloatArray, turn_per_length: float
) -> tuple[FloatArray, FloatArray]:
    """Return nodes (m, 20, 3) and Cartesian displacements per freedom (m, 60, 60) in a layer's frame."""
    quads, turn = section.grid.quads[batch.quads], batch.thickness * turn_per_length
    corners = section.points[quads]
    nodes = layer_nodes(corners, batch.thickness, turn)
    frames = cylindrical_frames(nodes) @ axes[quads[:, SECTION]]
    if batch.half:
        face = coarse_face(corners, batch.thickness, turn, batch.half)
        return face.attach(nodes), face.transform(frames)
    transform = np.zeros((len(nodes), 20, 3, 20, 3))
    every = np.arange(20)
    transform[:, every, :, every] = frames.transpose(1, 0, 2, 3)
    return nodes, transform.reshape(len(nodes), 60, 60)
