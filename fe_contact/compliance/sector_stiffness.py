"""Element matrices of one swept tooth sector, flank nodes in the frame of the flank."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.body.bore_seat import BoreSeat
from fe_contact.compliance.hanging_nodes import coarse_face, face_functions
from fe_contact.compliance.hexahedron import (
    SECTION,
    cylindrical_frames,
    in_frames,
    layer_nodes,
    stiffness_of,
)
from fe_contact.geometry import Toothing
from fe_contact.material import Material
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.mesh.swept_sector import LOWER_FACE, Batch, SweptSector
from fe_contact.types import FloatArray, IntArray

# Stiffness of an elastic seat under the bore: a foundation in cylindrical components.


def face_mass() -> FloatArray:
    """Return the products of the eight functions of a face integrated over -1 .. 1 squared, (8, 8)."""
    t, weight = np.polynomial.legendre.leggauss(3)
    x, y = (part.ravel() for part in np.meshgrid(t, t))
    functions = face_functions(x, y)
    return np.asarray(functions.T * np.outer(weight, weight).ravel() @ functions)


def _seat_stiffness(gear: Toothing, grid: SectorGrid, thickness: float, seat: BoreSeat) -> FloatArray:
    """Return the matrix (60, 60) of the seat below one element on the bore, N/m.

    Nodes on the bore are equally spaced in angle, so the radial, tangential and axial displacements are
    quadratic over a rectangle of the unrolled cylinder: a turn of the whole bore is met exactly, on helical
    meshes too.

    Parameters
    ----------
    gear : Toothing
        Its bore radius and teeth.
    grid : SectorGrid
        Its columns share one pitch.
    thickness : float
        Of the layer, m.
    seat : BoreSeat
        Only its finite stiffnesses count; freedoms in rigid directions are held.
    """
    area = gear.held_radius * 2.0 * math.pi / gear.teeth / grid.columns * thickness
    mass = 0.25 * area * face_mass()
    matrix, nodes = np.zeros((20, 3, 20, 3)), np.array(LOWER_FACE)
    for c, stiffness in enumerate(seat.stiffness):
        if math.isfinite(stiffness):
            matrix[nodes[:, None], c, nodes, c] = stiffness * mass
    return matrix.reshape(60, 60)


@dataclass(frozen=True)
class ElementStiffness:
    """Stiffness of the elements of a sector.

    Attributes
    ----------
    matrices : (p, 60, 60) array
        N/m; freedoms in the order of `SweptSector.element_freedoms`.
    of_element : (e,) int array
        Which of them each element has.
    """

    matrices: FloatArray
    of_element: IntArray


def twist(gear: Toothing) -> float:
    """Return the turn of the section per axial length, rad/m, of the gear or its right-hand mirror image."""
    return abs(math.tan(gear.helix_angle)) / gear.reference_radius


def flank_frames(section: QuadSector, turn_per_length: float) -> FloatArray:
    """Return the axes (k, 3, 3) at the flank nodes in cylindrical components, one per column.

    The first is the outward normal of the helicoid: with the transverse normal (n_r, n_phi),
    n_z = -n_phi r dphi/dz. The other two are tangents.
    """
    p, n = section.points[section.grid.flank], section.normals
    radius = np.linalg.norm(p, axis=1)
    radial = np.sum(n * p, axis=1) / radius
    around = (n[:, 1] * p[:, 0] - n[:, 0] * p[:, 1]) / radius
    normal = np.stack([radial, around, -around * radius * turn_per_length], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    first = np.cross(normal, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([normal, first, np.cross(normal, first)], axis=-1)


def sector_stiffness(
    gear: Toothing, section: QuadSector, sector: SweptSector, frames: FloatArray
) -> ElementStiffness:
    """Compute the matrices of all batches of a sector.

    Parameters
    ----------
    gear : Gear
        Its material and helix matter.
    section : QuadSector
        Transverse mesh.
    sector : SweptSector
        Its hexahedra.
    frames : (k, 3, 3) array
        Axes at the flank nodes.
    """
    axes = np.tile(np.eye(3), (sector.grid.nodes, 1, 1))
    axes[sector.grid.flank] = frames
    matrices = [
        np.tile(_seat_stiffness(gear, sector.grid, batch.thickness, sector.seat), (len(batch.quads), 1, 1))
        if batch.seat
        else _batch_stiffness(gear.material, section, batch, axes, twist(gear))
        for batch in sector.batches
    ]
    of_element = np.empty(len(sector.elements), dtype=np.int64)
    first = 0
    for batch in sector.batches:
        of_element[batch.elements] = first + np.arange(len(batch.quads))
        first += len(batch.quads)
    return ElementStiffness(np.concatenate(matrices), of_element)


def lame_parameters(material: Material) -> tuple[float, float]:
    """Return lambda and mu of the solid, Pa."""
    E, nu = material.youngs_modulus, material.poissons_ratio
    return E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * E / (1.0 + nu)


def _batch_stiffness(
    material: Material, section: QuadSector, batch: Batch, axes: FloatArray, turn_per_length: float
) -> FloatArray:
    """Return the matrices of one batch, (m, 60, 60)."""
    quads, turn = section.grid.quads[batch.quads], batch.thickness * turn_per_length
    points = section.points[quads]
    nodes = layer_nodes(points, batch.thickness, turn)
    frames = cylindrical_frames(nodes) @ axes[quads[:, SECTION]]
    lame = lame_parameters(material)
    if not batch.half:
        return in_frames(stiffness_of(nodes, lame), frames)
    face = coarse_face(points, batch.thickness, turn, batch.half)
    transform = face.transform(frames)
    return np.asarray(transform.transpose(0, 2, 1) @ stiffness_of(face.attach(nodes), lame) @ transform)
