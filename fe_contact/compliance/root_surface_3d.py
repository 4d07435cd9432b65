"""The surface of the tooth root in eight-node quadrilaterals, and the stress on it.

A tooth sector is a plane section that is swept over layers across the face. A *chain* are the section's nodes
along the root, corners and middles in turn. *Along* is the profile, *across* is towards larger z in the
surface. Stresses are taken at four *stations* of each of m elements: two by two points of its square.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fe_contact.compliance.hexahedron_stiffness import above, cylindrical_frames
from fe_contact.compliance.root_surface import STATIONS, RootSurface, root_coordinate
from fe_contact.geometry.flank_profile import FlankProfile
from fe_contact.material import Material
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.swept_sector import SweptSector
from fe_contact.types import FloatArray, IntArray
from host.optional_modules import sparse as sp

# Nodes of a surface element over profile (-1 .. 1) and layer (-1 .. 1): corners, then middles.
ALONG = np.array([-1.0, 1.0, 1.0, -1.0, 0.0, 1.0, 0.0, -1.0])

ACROSS = np.array([-1.0, -1.0, 1.0, 1.0, -1.0, 0.0, 1.0, 0.0])


def surface_elements(
    section: QuadSector, sector: SweptSector, chain: IntArray, axes: FloatArray, turn_per_length: float
) -> SurfaceElements:
    """Return the quadrilaterals of a chain of the root, layer by layer, in the frames of their nodes.

    `axes` are the axes of the freedoms of each node of the section; `turn_per_length` is the helix, rad/m.
    """
    first = 2 * np.arange(len(chain) // 2)
    # 1 + ALONG: 0, 1 or 2 nodes after the first one of an element
    on_section = chain[first[:, None] + (1 + ALONG).astype(int)]  # (e, 8)
    positions, frames, freedoms = [], [], []
    for layer, kind in enumerate(sector.layers.kind):
        thickness = float(sector.layers.thickness[kind])
        nodes = above(section.points[on_section], 0.5 * ACROSS, thickness, thickness * turn_per_length)
        positions.append(nodes)
        frames.append(cylindrical_frames(nodes) @ axes[on_section])
        freedoms.append(sector.freedoms[sector.nodes[2 * layer + (1 + ACROSS).astype(int), on_section]])
    return SurfaceElements(np.concatenate(positions), np.concatenate(frames), np.concatenate(freedoms))


def quad_root(section: QuadSector, profile: FlankProfile) -> RootSurface:
    """Return the root of a sector of eight-node quadrilaterals."""
    grid = section.grid
    # a grid of corners and middles: twice as many rows and columns as elements
    land = grid.number[2 * grid.body_rows]
    below_form = int(np.argmin(np.abs(section.s[::2] - profile.s_form)))
    tooth = grid.number[2 * grid.body_rows : 2 * (grid.body_rows + below_form) + 1]
    low, high = 2 * grid.land, 2 * (grid.land + grid.across)
    right = np.concatenate([land[:low], tooth[:, low]])
    left = np.concatenate([land[:high:-1], tooth[:, high]])
    return RootSurface(np.array([right, left]), root_coordinate(profile, section.points[right]))


class SurfaceElements(NamedTuple):
    """Eight-node quadrilaterals of a surface."""

    nodes: FloatArray
    """Coordinates of the nodes in the order of `ALONG` and `ACROSS`, m. Shape (m, 8, 3)."""
    frames: FloatArray
    """Axes of the freedoms of each node, one per column. Shape (m, 8, 3, 3)."""
    freedoms: IntArray
    """Numbers of the freedoms of each node; -1 for a fixed one. Shape (m, 8, 3)."""


def face_stress(elements: SurfaceElements, material: Material, size: int) -> sp.csr_array:
    """Return the stresses of surface elements by the `size` freedoms of a mesh, (3 * 4 m, size) in Pa/m.

    Rows: the stress along at all stations, then that across, then the shear stress. The stations of an
    element are ordered by their position across, then along. The surface is free of normal stress.
    """
    strains = _surface_strains(elements.nodes)  # (3, m, 4, 8, 3)
    nu = material.poissons_ratio
    plane, shear = material.plane_strain_modulus, material.youngs_modulus / (1.0 + nu)
    along, across, between = strains
    stresses = np.stack([plane * (along + nu * across), plane * (across + nu * along), shear * between])
    # k components, m elements, g stations, i nodes; a Cartesian, b along the axes of the freedoms
    in_frames = np.einsum("kmgia,miab->kmgib", stresses, elements.frames)
    freedoms = np.broadcast_to(elements.freedoms[:, None], in_frames.shape)
    rows = np.arange(in_frames[..., 0, 0].size).reshape(*in_frames.shape[:3], 1, 1)
    free = freedoms >= 0
    entries = in_frames[free], (np.broadcast_to(rows, in_frames.shape)[free], freedoms[free])
    return sp.csr_array(sp.coo_array(entries, shape=(in_frames[..., 0, 0].size, size)))


def _surface_strains(nodes: FloatArray) -> FloatArray:
    """Return the strains e_11, e_22, e_12 by Cartesian displacements of the nodes, (3, m, 4, 8, 3).

    They are in orthonormal axes of the surface: 1 along, 2 across.
    """
    y, x = (grid.ravel() for grid in np.meshgrid(STATIONS, STATIONS, indexing="ij"))
    slopes = _slopes(x, y)
    g1, g2 = np.einsum("tgi,mia->tmga", slopes, nodes)
    # g1, g2: tangents of the element's lines; t1, t2: orthonormal axes from them
    t1 = g1 / np.linalg.norm(g1, axis=-1, keepdims=True)
    t2 = g2 - np.sum(g2 * t1, axis=-1, keepdims=True) * t1
    t2 /= np.linalg.norm(t2, axis=-1, keepdims=True)
    # g_a = A_ab t_b with A triangular; covariant strains are e_ab = (g_a . u_,b + g_b . u_,a) / 2.
    a11, a21, a22 = (np.sum(g * t, axis=-1)[..., None, None] for g, t in ((g1, t1), (g2, t1), (g2, t2)))
    d1, d2 = (d[None, :, :, None] for d in slopes)
    e11, e22 = d1 * g1[:, :, None], d2 * g2[:, :, None]
    e12 = 0.5 * (d2 * g1[:, :, None] + d1 * g2[:, :, None])
    skew = a21 / a11
    return np.stack(
        [e11 / a11**2, (skew**2 * e11 - 2.0 * skew * e12 + e22) / a22**2, (e12 - skew * e11) / (a11 * a22)]
    )


def _slopes(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the derivatives of the eight-node functions along x and y at points (n,), (2, n, 8)."""
    slopes = np.empty((2, len(x), 8))
    for i, (a, b) in enumerate(zip(ALONG, ACROSS, strict=True)):
        if a and b:
            slopes[0, :, i] = 0.25 * a * (1.0 + b * y) * (2.0 * a * x + b * y)
            slopes[1, :, i] = 0.25 * b * (1.0 + a * x) * (a * x + 2.0 * b * y)
        elif b:
            slopes[0, :, i], slopes[1, :, i] = -x * (1.0 + b * y), 0.5 * b * (1.0 - x * x)
        else:
            slopes[0, :, i], slopes[1, :, i] = 0.5 * a * (1.0 - y * y), -y * (1.0 + a * x)
    return slopes
