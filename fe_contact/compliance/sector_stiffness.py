"""Stiffness of a swept tooth sector in the frames of its nodes and flanks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.compliance.coarse_face import coarse_face
from fe_contact.compliance.hexahedron_stiffness import SECTION, cylindrical_frames, layer_nodes, stiffness_of
from fe_contact.compliance.plane_hypothesis import PlaneHypothesis
from fe_contact.compliance.seat_stiffness import seat_stiffness
from fe_contact.geometry import Toothing
from fe_contact.mesh.element_stack import Batch
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.swept_sector import SweptSector
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class ElementStiffness:
    """Stiffness of the elements of a sector."""

    matrices: FloatArray
    """Different element matrices, N/m; freedoms in the order of `SweptSector.element_freedoms`. Shape (p, 60,
    60).
    """
    of_element: IntArray
    """Index of each element's matrix in `matrices`. Shape (e,)."""


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


def node_axes(gear: Toothing, section: QuadSector) -> FloatArray:
    """Return the axes (n, 3, 3) of the freedoms at all nodes of a section, in cylindrical components."""
    axes = np.tile(np.eye(3), (section.grid.nodes, 1, 1))
    axes[section.grid.flank] = flank_frames(section, twist(gear))
    return axes


def sector_stiffness(gear: Toothing, section: QuadSector, sector: SweptSector) -> ElementStiffness:
    """Compute the matrices of all batches of a sector.

    `gear`: its material and helix matter.
    """
    axes, lame = node_axes(gear, section), PlaneHypothesis.PLANE_STRAIN.lame_parameters(gear.material)
    bodies = [batch for batch in sector.batches if not batch.seat]
    placed = [placed_layer(section, batch, axes, twist(gear)) for batch in bodies]
    solid = stiffness_of(np.concatenate([nodes for nodes, _ in placed]), lame)
    ends = np.cumsum([len(batch.quads) for batch in bodies])
    matrices = [
        transform.transpose(0, 2, 1) @ local @ transform
        for local, (_, transform) in zip(np.split(solid, ends[:-1]), placed, strict=True)
    ]
    for batch in sector.batches[len(bodies) :]:
        seat = seat_stiffness(gear, sector.grid, batch.thickness, sector.seat)
        matrices.append(np.tile(seat, (len(batch.quads), 1, 1)))
    of_element = np.empty(len(sector.elements), dtype=np.int64)
    first = 0
    for batch in sector.batches:
        of_element[batch.elements] = first + np.arange(len(batch.quads))
        first += len(batch.quads)
    return ElementStiffness(np.concatenate(matrices), of_element)


def placed_layer(
    section: QuadSector, batch: Batch, axes: FloatArray, turn_per_length: float
) -> tuple[FloatArray, FloatArray]:
    """Return nodes (m, 20, 3) of a batch and Cartesian displacements (m, 60, 60) per freedom."""
    quads, angle = section.grid.quads[batch.quads], batch.thickness * turn_per_length
    corners = section.points[quads]
    nodes = layer_nodes(corners, batch.thickness, angle)
    frames = cylindrical_frames(nodes) @ axes[quads[:, SECTION]]
    if batch.half:
        face = coarse_face(corners, batch.thickness, angle, batch.half)
        return face.attach(nodes), face.transform(frames)
    transform, every = np.zeros((len(nodes), 20, 3, 20, 3)), np.arange(20)
    transform[:, every, :, every] = frames.transpose(1, 0, 2, 3)
    return nodes, transform.reshape(len(nodes), 60, 60)
