"""One helical gear condensed to its right flanks: over the face on a coarse section, and finely in sections.

The compliance that a coarse mesh lacks is local: it dies out within some elements from the load. It equals
that of a section in which nothing varies along the contact line, and is added section by section.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import splu

from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.material import Material
from fe_contact.mesh.gear_mesh import real_teeth
from fe_contact.mesh.quadratic_mesh import Part, quadratic_meshes
from fe_contact.mesh.quality import QualityLimits
from fe_contact.types import FloatArray, IntArray
from verification.full_contact.condensation.condensed_body import dissected, mesh_graph
from verification.full_contact.condensation.gear_boundary import gear_boundary
from verification.full_contact.condensation.placed_mesh import SECONDS
from verification.full_contact.condensation.resolution import Resolution
from verification.full_contact.condensation.sites import SizedStrip
from verification.full_contact.helical.twisted_stiffness import (
    Section,
    outward,
    section_stiffness,
    twisted_stiffness,
)
from verification.full_contact.over_face.layers import Layers
from verification.full_contact.over_face.schur_complement import ColumnMatrix, schur_complement

TEETH = 7
"""Real teeth of a section."""
_GAUSS, _WEIGHTS = np.polynomial.legendre.leggauss(6)
AT_TIP = 0.15
"""Size of the finest elements at a tip edge over that on the flank."""
BELOW = 0.1
"""Modules by which flanks are resolved below the active ones."""


@dataclass(frozen=True)
class FlankStrip:
    """Nodes of a flank from its foot to the tip: corner, mid-side, corner ..."""

    nodes: IntArray
    """Numbers of the nodes of the strip. Shape (2 e + 1,)."""
    s: FloatArray
    """Flank coordinates, m. Shape (2 e + 1,)."""

    def shapes(self, s: FloatArray) -> tuple[sp.csr_array, sp.csr_array]:
        """Return the quadratics (q, 2 e + 1) and the linear functions of the corners (q, e + 1) at s (q,)."""
        corners = self.s[::2]
        piece = np.clip(np.searchsorted(corners, s, side="right") - 1, 0, len(corners) - 2)
        low, middle, high = self.s[2 * piece], self.s[2 * piece + 1], self.s[2 * piece + 2]
        x = _parameter((s - low) / (high - low), (middle - low) / (high - low))
        values = np.stack([(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)], axis=-1)
        rows = np.arange(len(s))
        nodes, ends = 2 * piece[:, None] + np.arange(3), piece[:, None] + np.arange(2)
        shape = (len(s), len(self.s)), (len(s), len(corners))
        quadratic = (values.ravel(), (np.repeat(rows, 3), nodes.ravel()))
        linear = (np.stack([1.0 - x, x], axis=-1).ravel(), (np.repeat(rows, 2), ends.ravel()))
        return sp.csr_array(quadratic, shape=shape[0]), sp.csr_array(linear, shape=shape[1])

    def spread(self, s: FloatArray, elements: float) -> tuple[sp.csr_array, sp.csr_array]:
        """Return both averaged about s (q,) over `elements` to either side, or as far as the tip edge.

        What is spread has the same force and the same moment.
        """
        size = float(np.mean(np.diff(self.s[::2])))
        half = np.minimum(elements * size, np.maximum(self.s[-1] - s, 0.0))
        quadratic, linear = self.shapes(np.concatenate([s + half * x for x in _GAUSS]))
        weights = (0.75 * (1.0 - _GAUSS**2) * _WEIGHTS)[None]
        average = sp.csr_array(sp.kron(weights, sp.eye_array(len(s)), format="csr"))
        return sp.csr_array(average @ quadratic), sp.csr_array(average @ linear)


def _parameter(t: FloatArray, middle: FloatArray) -> FloatArray:
    """Return x with 4 m x (1 - x) + x (2 x - 1) = t, where the middle node stands at m."""
    a, b = 2.0 - 4.0 * middle, 4.0 * middle - 1.0
    return np.asarray(2.0 * t / (b + np.sqrt(np.maximum(b * b + 4.0 * a * t, 0.0))))


@dataclass(frozen=True)
class MeshedSection:
    """Section of a gear with the strips of its loaded teeth; tooth 0 stands on +y."""

    section: Section
    bore_nodes: IntArray
    strips: dict[int, FlankStrip]


def meshed_section(
    gear: Toothing, loaded: range, size: float, at_tip: float, resolution: Resolution
) -> MeshedSection:
    """Mesh a gear; elements on the loaded flanks have a `size`, at the tip edge `at_tip`, m."""
    profile = tooth_profile(gear)
    low = max(profile.s_form - BELOW * gear.normal_module, profile.s_root)
    at = np.linspace(low, profile.s_tip, 201)
    sizes = np.minimum(size, at_tip + 0.15 * (profile.s_tip - at))
    wanted = {tooth: SizedStrip(low, profile.s_tip, at, sizes) for tooth in loaded}
    teeth = real_teeth(gear.teeth, max(TEETH, len(loaded) + 2))
    boundary = gear_boundary(gear, teeth, wanted, resolution)
    outlines = boundary.toothed, boundary.seat
    part = Part("gear", outlines, gear.normal_module, resolution.inner_growth)
    (mesh,) = quadratic_meshes([part], QualityLimits(), SECONDS)
    strips = {}
    for tooth in loaded:
        nodes, s = mesh.boundary[0][boundary.toothed.positions(f"flank {tooth}")], boundary.s[tooth]
        first = 2 * max(int(np.searchsorted(s[::2], low, side="right")) - 1, 0)
        strips[tooth] = FlankStrip(nodes[first:], s[first:])
    twist = float(np.tan(gear.base_helix_angle)) / gear.base_radius
    section = Section(mesh.points, mesh.triangles, twist, gear.base_radius)
    return MeshedSection(section, mesh.boundary[1], strips)


def _normals(section: Section, nodes: IntArray) -> FloatArray:
    """Return normals (n, 3) of right flanks whose part across the axis is a unit vector."""
    across = outward(section.points[nodes], section.base_radius)
    along = np.full((len(nodes), 1), section.twist * section.base_radius)
    return np.concatenate([across, along], axis=1)


def section_compliance(meshed: MeshedSection, material: Material) -> dict[int, FloatArray]:
    """Return for each strip the normal displacements of its nodes by nodal loads (k, k), m per N/m."""
    section = meshed.section
    matrix = section_stiffness(section, material)
    count = len(section.points)
    inner = np.setdiff1d(np.arange(count), meshed.bore_nodes)
    order = dissected(mesh_graph(section.triangles, count), inner)
    free = (3 * order[:, None] + np.arange(3)).ravel()
    factor = splu(
        sp.csc_array(matrix[free][:, free]),
        permc_spec="NATURAL",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    number = np.full(3 * count, -1)
    number[free] = np.arange(len(free))
    by_tooth = {}
    for tooth, strip in meshed.strips.items():
        loads = np.zeros((len(free), len(strip.nodes)))
        rows = number[3 * strip.nodes[:, None] + np.arange(3)]
        loads[rows, np.arange(len(strip.nodes))[:, None]] = _normals(section, strip.nodes)
        compliance = loads.T @ factor.solve(loads)
        by_tooth[tooth] = 0.5 * (compliance + compliance.T)
    return by_tooth


@dataclass(frozen=True)
class FaceBody:
    """A gear over the face seen from its loaded flanks.

    A freedom is a function of a node of a strip along its normal: those of the hats of all its nodes, node by
    node, then those of the bubbles of its corners.
    """

    meshed: MeshedSection
    layers: Layers
    starts: dict[int, int]
    """First freedom of a tooth."""
    compliance: FloatArray
    """Compliance of the strips, m/N. Shape (m, m)."""
    unknowns: int
    spread: float
    """Elements to either side over which loads are spread on its mesh: a narrow load that slants through its
    elements it would find too stiff, a wide one it resolves.
    """

    def shapes(self, tooth: int, s: FloatArray, z: FloatArray) -> sp.csr_array:
        """Return the freedoms' functions (q, m) at places of a flank, s and z (q,)."""
        quadratic, linear = self.meshed.strips[tooth].spread(s, self.spread)
        functions = self.layers.functions(z)
        hats = self.layers.count + 1
        functions_of_tooth = sp.hstack(
            [_rowwise(quadratic, functions[:, :hats]), _rowwise(linear, functions[:, hats:])], format="csr"
        )
        start, width = self.starts[tooth], len(self.compliance)
        return sp.csr_array(
            (functions_of_tooth.data, functions_of_tooth.indices + start, functions_of_tooth.indptr),
            shape=(len(s), width),
        )


def _rowwise(one: sp.csr_array, other: FloatArray) -> sp.csr_array:
    """Return the products of all entries of equal rows, (q, a b)."""
    second = sp.csr_array(other)
    repeated = np.diff(second.indptr)
    rows = np.repeat(np.arange(one.shape[0]), np.diff(one.indptr))
    times = repeated[rows]
    row = np.repeat(rows, times)
    within = np.arange(times.sum()) - np.repeat(np.cumsum(times) - times, times)
    entry = second.indptr[row] + within
    columns = np.repeat(one.indices, times) * other.shape[1] + second.indices[entry]
    data = np.repeat(one.data, times) * second.data[entry]
    return sp.csr_array((data, (row, columns)), shape=(one.shape[0], one.shape[1] * other.shape[1]))


def face_body(meshed: MeshedSection, layers: Layers, material: Material, spread: float) -> FaceBody:
    """Assemble a body over the face and eliminate all but the normal displacements of the loaded flanks."""
    section = meshed.section
    stiffness = twisted_stiffness(section, layers, material)
    count = len(section.points)
    nodes = np.unique(np.concatenate([strip.nodes for strip in meshed.strips.values()]))
    graph = mesh_graph(section.triangles, count)
    inner = np.setdiff1d(np.arange(count), np.concatenate([nodes, meshed.bore_nodes]))
    order = np.concatenate([dissected(graph, inner), nodes])
    rank = np.full(count, -1)
    rank[order] = np.arange(len(order))
    free = np.flatnonzero(rank[stiffness.node] >= 0)
    free = free[np.argsort(rank[stiffness.node[free]], kind="stable")]
    starts = np.searchsorted(rank[stiffness.node[free]], np.arange(len(order) + 1))
    lower = sp.csc_array(sp.tril(stiffness.matrix[free][:, free]))
    complement = schur_complement(
        ColumnMatrix(lower, starts, sp.csr_array(graph[order][:, order])), len(nodes)
    )
    retained = free[starts[len(inner)] :]
    loads, first = _normal_loads(
        meshed, stiffness.node[retained], stiffness.component[retained], stiffness.function[retained], layers
    )
    flank_compliance = loads @ cho_solve(
        cho_factor(complement, lower=True, overwrite_a=True), loads.T.toarray()
    )
    return FaceBody(meshed, layers, first, 0.5 * (flank_compliance + flank_compliance.T), len(free), spread)


def _normal_loads(
    meshed: MeshedSection, node: IntArray, component: IntArray, function: IntArray, layers: Layers
) -> tuple[sp.csr_array, dict[int, int]]:
    """Return unit loads (m, kept) of all freedoms along the normals, and the first of each tooth."""
    functions = 2 * layers.count + 1
    code = (node * 3 + component) * functions + function
    sorter = np.argsort(code)
    rows, starts, start = [], {}, 0
    for tooth, strip in meshed.strips.items():
        starts[tooth] = start
        for nodes, of_nodes in (
            (strip.nodes, np.arange(layers.count + 1)),
            (strip.nodes[::2], np.arange(layers.count + 1, functions)),
        ):
            normals = _normals(meshed.section, nodes)
            wanted = (nodes[:, None, None] * 3 + np.arange(3)) * functions + of_nodes[None, :, None]
            index = sorter[np.searchsorted(code, wanted, sorter=sorter)]
            size = len(nodes) * len(of_nodes)
            values = np.broadcast_to(normals[:, None], wanted.shape)
            entries = (values.ravel(), (np.repeat(np.arange(size), 3), index.ravel()))
            rows.append(sp.csr_array(entries, shape=(size, len(node))))
            start += size
    return sp.csr_array(sp.vstack(rows)), starts


@dataclass(frozen=True)
class HelicalGear:
    """One gear condensed over its face, and the sections that give the compliance that its mesh lacks."""

    body: FaceBody
    fine: FlankStrip
    """Flank strip of a section with a finely meshed tooth."""
    fine_compliance: FloatArray
    coarse_compliance: dict[int, FloatArray]
    """`fine_compliance`, `coarse_compliance`: Compliance of the fine section, and of the coarse section by
    tooth, m per N/m. (k, k) arrays.
    """

    @property
    def lead(self) -> float:
        """Roll length per face position by which the contact line runs to the root, with its sign."""
        section = self.body.meshed.section
        return section.twist * section.base_radius

    def lacking(self, tooth: int, s: FloatArray, loads: FloatArray) -> FloatArray:
        """Return the missing compliance of the coarse mesh for loads (q, i) at s (q,), (i, i) m per N/m."""
        fine = self.fine.shapes(s)[0].T @ loads
        coarse = self.body.meshed.strips[tooth].spread(s, self.body.spread)[0].T @ loads
        near = np.flatnonzero(np.any(fine != 0.0, axis=1))
        local = self.fine_compliance[np.ix_(near, near)]
        return np.asarray(
            fine[near].T @ local @ fine[near] - coarse.T @ self.coarse_compliance[tooth] @ coarse
        )


@dataclass(frozen=True)
class BodyMesh:
    """Sizes of a condensed gear, m; its layers, resolution of body and section, and its spread."""

    flank: float
    fine: float
    layers: int
    body: Resolution
    section: Resolution
    spread: float


def helical_gear(gear: Toothing, face: float, teeth: range, mesh: BodyMesh) -> HelicalGear:
    """Condense a gear for contacts on some of its teeth."""
    coarse = meshed_section(gear, teeth, mesh.flank, mesh.flank, mesh.body)
    fine = meshed_section(gear, range(1), mesh.fine, AT_TIP * mesh.fine, mesh.section)
    planes = np.linspace(-0.5 * face, 0.5 * face, mesh.layers + 1)
    return HelicalGear(
        face_body(coarse, Layers(planes), gear.material, mesh.spread),
        fine.strips[0],
        section_compliance(fine, gear.material)[0],
        section_compliance(coarse, gear.material),
    )
