"""The hexahedra of one tooth sector in space: nodes, displacements from freedoms, stresses, quality."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.deformed_gear import stress_of, turn_about_axis
from fe_contact.compliance.hexahedron_stiffness import REFERENCE, determinants, gradients, hexahedra
from fe_contact.compliance.plane_hypothesis import PlaneHypothesis
from fe_contact.compliance.sector_stiffness import node_axes, placed_layer, twist
from fe_contact.geometry import Toothing
from fe_contact.mesh.element_stack import LOWER_FACE
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.quality import quad_quality
from fe_contact.mesh.swept_sector import SweptSector
from fe_contact.types import FloatArray, IntArray

# Points where the stress of a 20-node hexahedron is most exact: two Gauss points each way, in -1 .. 1.
INNER = REFERENCE[:8] / np.sqrt(3.0)


@dataclass(frozen=True)
class _Part:
    """A batch of elements (c, m), with what turns freedoms into stresses in the frame of the layers."""

    elements: IntArray
    frames: FloatArray
    """Cartesian displacements of the element's nodes per freedom. Shape (m, 60, 60)."""
    gradient: FloatArray
    """Gradients of the element functions at `INNER`. Shape (m, 8, 20, 3)."""
    turns: FloatArray
    """Rotations from the frame of each layer to the frame of mid-face. Shape (c, 3, 3)."""


@dataclass(frozen=True)
class SectorElements:
    """The elements of one sector, in the frame of mid-face, tooth on +y."""

    nodes: FloatArray
    """Nodes of the elements, m, in the order of `SweptSector.elements`, which is VTK's. Elements of an
    elastic seat are left out. Shape (e, 20, 3).
    """
    numbers: IntArray
    """Point number of each node; nodes that hang on a coarser face have points of their own. Shape (e, 20).
    """
    points: int
    """Number of points."""
    quality: dict[str, FloatArray]
    """Quality measures of the elements by name, (e,)."""
    sector: SweptSector
    lame: tuple[float, float]
    parts: tuple[_Part, ...]

    def displacement(self, field: FloatArray) -> FloatArray:
        """Return the displacement (e, 20, 3) in m at the nodes for the freedoms `field` (n,)."""
        freedoms = self.sector.element_freedoms
        local = np.where(freedoms >= 0, field[freedoms], 0.0)
        motion = np.empty_like(self.nodes)
        for part in self.parts:
            values = np.einsum("mij,cmj->cmi", part.frames, local[part.elements])
            values = values.reshape(*part.elements.shape, 20, 3)
            motion[part.elements] = np.einsum("cxy,cmpy->cmpx", part.turns, values)
        return motion

    def stress(self, motion: FloatArray) -> FloatArray:
        """Return the stress (e, 20, 3, 3) in Pa at the nodes for displacements (e, 20, 3)."""
        stress = np.empty((*motion.shape, 3))
        for part in self.parts:
            # gradients are known in the frame of the layer: turn the displacement into it, the stress out
            local = np.einsum("cxy,cmpx->cmpy", part.turns, motion[part.elements])
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
    """Place the bodies of a sector; the gear is right hand or spur, as the sector was made for."""
    axes, bodies = node_axes(gear, section), [batch for batch in sector.batches if not batch.seat]
    nodes, jacobian = np.empty((sector.bodies, 20, 3)), np.empty(sector.bodies)
    numbers, points = sector.elements[: sector.bodies].copy(), len(sector.freedoms)
    parts = []
    for batch in bodies:
        local, frames = placed_layer(section, batch, axes, twist(gear))
        # heights of the middles of the layers, which lie at half numbers between the ends of the layers
        middle = np.interp(
            sector.grid_cell[batch.elements[:, 0], 2], np.arange(len(sector.layers.ends)), sector.layers.ends
        )
        turns = np.stack([turn_about_axis(twist(gear) * float(z)) for z in middle])
        nodes[batch.elements] = np.einsum("cxy,mpy->cmpx", turns, local)
        nodes[batch.elements, :, 2] += middle[:, None, None]
        mesh = hexahedra(local)
        inner, outer = (0.5 * (at.T + 1.0) for at in (INNER, REFERENCE))  # in 0 .. 1, as scikit-fem has them
        volume = determinants(mesh, np.hstack([inner, outer]))
        jacobian[batch.elements] = volume.min(axis=1) / np.abs(volume).max(axis=1)
        parts.append(_Part(batch.elements, frames, gradients(mesh, inner), turns))
        if batch.half:
            hanging = (batch.elements.size, len(LOWER_FACE))
            hanging_numbers = points + np.arange(hanging[0] * hanging[1]).reshape(hanging)
            numbers[batch.elements.ravel()[:, None], LOWER_FACE] = hanging_numbers
            points += hanging_numbers.size
    angle = quad_quality(section.points, section.grid.quads).angle
    quality = {"scaled_jacobian": jacobian, "corner_angle_deg": np.empty(sector.bodies)}
    for batch in bodies:
        quality["corner_angle_deg"][batch.elements] = np.degrees(angle[batch.quads])
    lame = PlaneHypothesis.PLANE_STRAIN.lame_parameters(gear.material)
    return SectorElements(nodes, numbers, points, quality, sector, lame, tuple(parts))
