"""The surface of the tooth root, and the stress on it from the nodes of the elements below."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from fe_contact.compliance.plane_elasticity import PlaneHypothesis
from fe_contact.geometry.flank_profile import FlankProfile
from fe_contact.material import Material
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.quadratic import SIDES
from fe_contact.mesh.tooth_sector import ToothSector
from fe_contact.types import FloatArray, IntArray

# The surface of the tooth root in a mesh, from the middle of the tooth space to the form point.


SAMPLES = 4001  # of the exact profile that nodes are sought on


@dataclass(frozen=True)
class RootSurface:
    """Both root fillets of one tooth, each with its half of the root land.

    Attributes
    ----------
    nodes : (2, 2e + 1) int array
        Nodes of the transverse section from the middle of the tooth space up to the form point: corner,
        mid-side, corner ... First the side of the loaded (right) flank, then the other.
    s : (2e + 1,) array
        Flank coordinate of both, m, increasing.
    """

    nodes: IntArray
    s: FloatArray


def triangle_root(sector: ToothSector, profile: FlankProfile) -> RootSurface:
    """Return the root of a sector of six-node triangles; it is found by walking along the boundary."""
    form = int(np.argmin(np.abs(sector.s[::2] - profile.s_form)))
    ahead = _boundary(sector.triangles)
    back = {after: (middle, before) for before, (middle, after) in ahead.items()}
    if profile.gear.sign < 0:  # teeth that point inwards
        ahead, back = back, ahead
    right = _walk(ahead, int(sector.right_side[-1]), int(sector.flank[2 * form]))
    left = _walk(back, int(sector.left_side[-1]), int(sector.coast_flank[2 * form]))
    return RootSurface(np.array([right, left]), _flank_coordinate(profile, sector.points[right]))


def quad_root(section: QuadSector, profile: FlankProfile) -> RootSurface:
    """Return the root of a sector of eight-node quadrilaterals."""
    grid = section.grid
    land = grid.number[2 * grid.body_rows]
    tooth = grid.number[2 * grid.body_rows : 2 * (grid.body_rows + _below_form(section, profile)) + 1]
    low, high = 2 * grid.land, 2 * (grid.land + grid.across)
    right = np.concatenate([land[:low], tooth[:, low]])
    left = np.concatenate([land[:high:-1], tooth[:, high]])
    return RootSurface(np.array([right, left]), _flank_coordinate(profile, section.points[right]))


def _flank_coordinate(profile: FlankProfile, points: FloatArray) -> FloatArray:
    """Return the flank coordinates (n,) in m of points (n, 2) on the root of the right flank.

    The nearest sample of the exact profile, then along its tangent: good to the square of the sample's
    distance over the radius of curvature.
    """
    samples = np.linspace(profile.s_space, profile.s_form, SAMPLES)
    curve = profile.flank(samples)
    nearest = np.argmin(np.linalg.norm(points[:, None] - curve, axis=2), axis=1)
    normal = profile.normal(samples[nearest])
    tangent = profile.gear.sign * np.stack([-normal[:, 1], normal[:, 0]], axis=1)  # towards the tip
    along = np.sum((points - curve[nearest]) * tangent, axis=1)
    return np.asarray(samples[nearest] + along)


def _below_form(section: QuadSector, profile: FlankProfile) -> int:
    return int(np.argmin(np.abs(section.s[::2] - profile.s_form)))


def _boundary(triangles: IntArray) -> dict[int, tuple[int, int]]:
    """Return the middle and the end of the boundary edge that begins at each corner, counter-clockwise."""
    edges = np.concatenate([triangles[:, [*side, 3 + i]] for i, side in enumerate(SIDES)])
    ends = np.sort(edges[:, :2], axis=1)
    _, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
    return {int(a): (int(middle), int(b)) for a, b, middle in edges[first[count == 1]]}


def _walk(following: dict[int, tuple[int, int]], start: int, stop: int) -> list[int]:
    """Return the nodes from one corner of the boundary to another."""
    nodes = [start]
    while nodes[-1] != stop:
        nodes += following[nodes[-1]]
    return nodes


STATIONS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
"""Stations of an edge at which its strain is evaluated, in its coordinate from -1 to 1."""
COMPONENTS = 3
"""Along the profile, across it, and the shear between them."""
# Nodes of a surface element over profile (-1 .. 1) and layer (-1 .. 1): corners, then middles.
ALONG = np.array([-1.0, 1.0, 1.0, -1.0, 0.0, 1.0, 0.0, -1.0])
ACROSS = np.array([-1.0, -1.0, 1.0, 1.0, -1.0, 0.0, 1.0, 0.0])


class SurfaceElements(NamedTuple):
    """Eight-node quadrilaterals of a surface.

    Attributes
    ----------
    nodes : (m, 8, 3) array
        Places in the order of `ALONG` and `ACROSS`, m.
    frames : (m, 8, 3, 3) array
        Axes of the freedoms of each node, one per column.
    freedoms : (m, 8, 3) int array
        Their numbers; -1 where held.
    """

    nodes: FloatArray
    frames: FloatArray
    freedoms: IntArray


def between_nodes(values: FloatArray) -> FloatArray:
    """Return values (..., 2e + 1) at the nodes of quadratic edges at their stations, (..., 2e)."""
    low, middle, high = values[..., :-2:2], values[..., 1::2], values[..., 2::2]
    x = STATIONS[:, None]
    at_stations = 0.5 * x * (x - 1.0) * low[..., None, :] + (1.0 - x * x) * middle[..., None, :]
    at_stations = at_stations + 0.5 * x * (x + 1.0) * high[..., None, :]
    return np.asarray(np.swapaxes(at_stations, -1, -2).reshape(*values.shape[:-1], -1))


def edge_stress(
    points: FloatArray, nodes: IntArray, material: Material, hypothesis: PlaneHypothesis
) -> sp.csr_array:
    """Return the stresses of a chain of quadratic edges by the displacement of a plane mesh.

    Parameters
    ----------
    points : (n, 2) array
        Nodes of the mesh, m.
    nodes : (2e + 1,) int array
        The chain.
    material : Material
        E and nu.
    hypothesis : PlaneHypothesis
        Plane strain or plane stress.

    Returns
    -------
    (3 * 2e, 2n) sparse array
        Pa/m; all stations of one component stand together. There is no shear between profile and axis.
    """
    edges = np.stack([nodes[:-2:2], nodes[1::2], nodes[2::2]], axis=1)
    slopes = np.stack([STATIONS - 0.5, -2.0 * STATIONS, STATIONS + 0.5], axis=1)
    along = slopes @ points[edges]  # (e, 2 stations, 2)
    length = np.linalg.norm(along, axis=2)[:, :, None, None]
    strain = slopes[:, :, None] * along[:, :, None, :] / length**2  # (e, station, node, component)
    freedoms = np.broadcast_to(2 * edges[:, None, :, None] + np.arange(2), strain.shape)
    rows = np.broadcast_to(np.arange(2 * len(edges)).reshape(-1, 2, 1, 1), strain.shape)
    shape = (2 * len(edges), 2 * len(points))
    profile = hypothesis.contact_modulus(material) * sp.csr_array(
        (strain.ravel(), (rows.ravel(), freedoms.ravel())), shape=shape
    )
    held = material.poissons_ratio if hypothesis is PlaneHypothesis.PLANE_STRAIN else 0.0
    return sp.csr_array(sp.vstack([profile, held * profile, sp.csr_array(shape)]))


def face_stress(elements: SurfaceElements, material: Material, size: int) -> sp.csr_array:
    """Return the stresses of surface elements by the freedoms of a mesh.

    Parameters
    ----------
    elements : SurfaceElements
        m of them.
    material : Material
        E and nu.
    size : int
        Number of free freedoms.

    Returns
    -------
    (3 * 4 m, size) sparse array
        Pa/m; all stations of one component stand together, those of an element by position across, then
        along. "Along" is the profile in the transverse section; "across" is perpendicular to it in the
        surface, towards larger z.
    """
    strains = _surface_strains(elements.nodes)  # (3, m, 4, 8, 3)
    nu = material.poissons_ratio
    plane, shear = material.plane_strain_modulus, material.youngs_modulus / (1.0 + nu)
    along, across, between = strains
    stresses = np.stack([plane * (along + nu * across), plane * (across + nu * along), shear * between])
    own = np.einsum("kmgia,miab->kmgib", stresses, elements.frames)
    freedoms = np.broadcast_to(elements.freedoms[:, None], own.shape)
    rows = np.arange(own[..., 0, 0].size).reshape(*own.shape[:3], 1, 1)
    free = freedoms >= 0
    entries = own[free], (np.broadcast_to(rows, own.shape)[free], freedoms[free])
    return sp.csr_array(sp.coo_array(entries, shape=(own[..., 0, 0].size, size)))


def _surface_strains(nodes: FloatArray) -> FloatArray:
    """Return e_11, e_22, e_12 by Cartesian displacements, (3, m, 4, 8, 3), in orthonormal surface axes."""
    y, x = (grid.ravel() for grid in np.meshgrid(STATIONS, STATIONS, indexing="ij"))
    slopes = _slopes(x, y)
    g1, g2 = np.einsum("tgi,mia->tmga", slopes, nodes)
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
