"""The models of a full contact: plane strain, or the whole face."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import SuperLU, splu

from fe_contact.errors import SolveError
from fe_contact.full_contact.condensation.linearized_contact import (
    LEAST_FACING,
    Configuration,
    ContactGeometry,
    ContactSystem,
    LinearizedContact,
    Solution,
    rotation,
    turned_back,
)
from fe_contact.full_contact.condensation.placed_mesh import PlacedBody
from fe_contact.full_contact.condensation.sites import ContactSite
from fe_contact.full_contact.condensation.weak_gap import FlankCurve, WeakGap, weak_gap
from fe_contact.full_contact.table import LineLoad
from fe_contact.geometry import ParallelAxes, tooth_profile
from fe_contact.material import Material
from fe_contact.mesh.quality import shape_derivatives
from fe_contact.types import BoolArray, FloatArray, IntArray

# Six-node triangles in plane strain: their stiffness, and the order that eliminates their nodes.

_A, _B = 0.445948490915965, 0.091576213509771
POINTS = np.array(
    [
        [_A, _A],
        [1.0 - 2.0 * _A, _A],
        [_A, 1.0 - 2.0 * _A],
        [_B, _B],
        [1.0 - 2.0 * _B, _B],
        [_B, 1.0 - 2.0 * _B],
    ]
)
WEIGHTS = 0.5 * np.repeat([0.223381589678011, 0.109951743655322], 3)
"""Six points of order 4 (Dunavant 1985): exact on straight sides, enough on curved ones."""
MESH_STIFFNESS = 20e9 / 210e9
"""Of steel teeth, about 20 N/(mm um), over the modulus of elasticity: a first guess of the deflection."""


def mesh_graph(triangles: IntArray, count: int) -> sp.csr_array:
    """Return which of `count` nodes share six-node triangles (e, 6), a node with itself too."""
    rows = np.repeat(triangles, triangles.shape[1], axis=1).ravel()
    columns = np.tile(triangles, triangles.shape[1]).ravel()
    return sp.csr_array(sp.coo_array((np.ones(len(rows)), (rows, columns)), shape=(count, count)))


def dissected(graph: sp.csr_array, nodes: IntArray) -> IntArray:
    """Return nodes in an order that fills little: METIS' nested dissection of their graph."""
    import pymetis  # noqa: PLC0415 - only the factorisation needs it

    inner = sp.csr_array(graph[nodes][:, nodes])
    inner.setdiag(0.0)
    inner.eliminate_zeros()
    order, _ = pymetis.nested_dissection(pymetis.CSRAdjacency(inner.indptr, inner.indices))
    return np.asarray(nodes[np.asarray(order, dtype=np.int64)])


def plane_strain_stiffness(points: FloatArray, triangles: IntArray, material: Material) -> sp.csc_array:
    """Assemble the stiffness of linear elasticity, symmetric (2 n, 2 n), N/m per m.

    Triangles (m, 6) have corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0. Freedom 2 i
    + c is component c of node i.
    """
    local = _element_stiffness(points[triangles], _elasticity(material))
    freedoms = (2 * triangles[:, :, None] + np.arange(2)).reshape(len(triangles), 12)
    rows = np.broadcast_to(freedoms[:, :, None], local.shape).ravel()
    columns = np.broadcast_to(freedoms[:, None, :], local.shape).ravel()
    size = 2 * len(points)
    return sp.csc_array(sp.coo_array((local.ravel(), (rows, columns)), shape=(size, size)))


def _elasticity(material: Material) -> FloatArray:
    modulus, nu = material.youngs_modulus, material.poissons_ratio
    factor = modulus / ((1.0 + nu) * (1.0 - 2.0 * nu))
    rows = [[1.0 - nu, nu, 0.0], [nu, 1.0 - nu, 0.0], [0.0, 0.0, 0.5 - nu]]
    return factor * np.array(rows)


def _element_stiffness(nodes: FloatArray, elasticity: FloatArray) -> FloatArray:
    """Return the element matrices (m, 12, 12) of nodes (m, 6, 2)."""
    slopes = shape_derivatives(POINTS)
    total = np.zeros((len(nodes), 12, 12))
    for slope, weight in zip(slopes, WEIGHTS, strict=True):
        jacobian = slope @ nodes  # (m, d, x)
        determinant = jacobian[:, 0, 0] * jacobian[:, 1, 1] - jacobian[:, 0, 1] * jacobian[:, 1, 0]
        inverse = np.empty_like(jacobian)
        inverse[:, 0, 0], inverse[:, 1, 1] = jacobian[:, 1, 1], jacobian[:, 0, 0]
        inverse[:, 0, 1], inverse[:, 1, 0] = -jacobian[:, 0, 1], -jacobian[:, 1, 0]
        gradient = (inverse / determinant[:, None, None]) @ slope  # (m, x, a)
        strain = np.zeros((len(nodes), 3, 12))
        strain[:, 0, 0::2] = strain[:, 2, 1::2] = gradient[:, 0]
        strain[:, 1, 1::2] = strain[:, 2, 0::2] = gradient[:, 1]
        stress = elasticity @ strain * (weight * determinant)[:, None, None]
        total += strain.transpose(0, 2, 1) @ stress
    return total


# One gear condensed to the nodes of its strips: one factorisation, the strips' freedoms last.


@dataclass(frozen=True)
class CondensedBody:
    """One gear seen from the nodes of its strips, per unit face width."""

    body: PlacedBody
    nodes: IntArray
    """All nodes of its strips. Shape (k,)."""
    columns: Mapping[int, IntArray]
    """By pair index: where in `nodes` those of a strip are."""
    compliance: FloatArray
    """Displacement per nodal force, m per N/m; freedom 2 i + c is component c of node i. Shape (2 k, 2 k)."""
    stiffness: sp.csc_array
    """Of all nodes, the held ones too. (2 n, 2 n) sparse array."""
    solve: Callable[[FloatArray], FloatArray]
    """Forces on the freedoms of all nodes (2 n,) to displacements; held nodes stay."""

    @property
    def freedoms(self) -> IntArray:
        """Freedoms of the nodes of its strips."""
        return freedoms(self.nodes)

    @property
    def points(self) -> FloatArray:
        """Nodes of its strips, undeformed, (k, 2) m."""
        return self.body.points[self.nodes]


def condensed_body(body: PlacedBody, material: Material) -> CondensedBody:
    """Assemble, factorise, condense; raises `SolveError`: the stiffness is singular."""
    matrix = plane_strain_stiffness(body.points, body.triangles, material)
    nodes = np.unique(np.concatenate([strip.nodes for strip in body.strips.values()]))
    columns = {ahead: np.searchsorted(nodes, strip.nodes) for ahead, strip in body.strips.items()}
    inner = np.setdiff1d(np.arange(len(body.points)), np.concatenate([nodes, body.held]))
    inner = dissected(mesh_graph(body.triangles, len(body.points)), inner)
    order = np.concatenate([freedoms(inner), freedoms(nodes)])
    permuted = sp.csc_array(matrix[order][:, order])
    try:
        factor = splu(permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SolveError(f"full contact: {error}") from error

    def solve(forces: FloatArray) -> FloatArray:
        displacement = np.zeros_like(forces)
        displacement[order] = factor.solve(forces[order])
        return displacement

    schur = _trailing_product(factor, 2 * len(nodes))
    compliance = cho_solve(cho_factor(schur), np.eye(len(schur)))
    return CondensedBody(body, nodes, columns, 0.5 * (compliance + compliance.T), matrix, solve)


def freedoms(nodes: IntArray) -> IntArray:
    """Return the two freedoms of each node, node by node."""
    return np.asarray((2 * nodes[:, None] + np.arange(2)).ravel())


def _trailing_product(factor: SuperLU, count: int) -> FloatArray:
    """Return L_ss U_ss of the last `count` freedoms: their Schur complement, symmetric."""
    size = factor.shape[0]
    last = np.arange(size - count, size)
    if not (np.array_equal(factor.perm_c[last], last) and np.array_equal(factor.perm_r[last], last)):
        raise SolveError("full contact: the factorisation changed the order of the strips")
    lower = factor.L[size - count :, size - count :].toarray()
    upper = factor.U[size - count :, size - count :].toarray()
    product = lower @ upper
    return np.asarray(0.5 * (product + product.T))


# Laws that a solution must keep, checked on the displacements of all nodes: reactions and energy.


Bodies = tuple[CondensedBody, CondensedBody]


def _of_body(bodies: Bodies, number: int, solutions: Sequence[Solution]) -> tuple[FloatArray, FloatArray]:
    """Return the moments of the bore's reactions about the center, and the work of the forces, (T,)."""
    body = bodies[number]
    forces = np.zeros((body.stiffness.shape[0], len(solutions)))
    for i, (contact, pressure, _) in enumerate(solutions):
        forces[body.freedoms, i] = contact.forces[number] @ pressure
    moved = body.solve(forces)
    held = body.body.held
    reactions = np.asarray(body.stiffness @ moved).reshape(-1, 2, len(solutions))[held]
    arms = body.body.points[held] - body.body.center
    moments = arms[:, 0] @ reactions[:, 1] - arms[:, 1] @ reactions[:, 0]
    return moments, np.sum(moved * forces, axis=0)


def _moment(body: CondensedBody, forces: FloatArray) -> float:
    """Return the moment of forces (2 k,) on the strips' nodes about the gear's center, counter-clockwise."""
    arms = body.points - body.body.center
    return float(arms[:, 0] @ forces[1::2] - arms[:, 1] @ forces[0::2])


# All weak gaps of a pair in plane strain, undeformed or deformed, as one contact system.


@dataclass(frozen=True)
class _PairGeometry:
    """Two condensed bodies that may touch at sites."""

    pair: ParallelAxes
    sites: tuple[ContactSite, ...]
    bodies: tuple[CondensedBody, CondensedBody]

    @property
    def undeformed(self) -> Configuration:
        first, second = (np.zeros(2 * len(body.nodes)) for body in self.bodies)
        return Configuration(0.0, (first, second))

    @property
    def lag_rate(self) -> float:
        """Counter-clockwise angle of gear 2 by the lag, rad/m."""
        return -self.pair.wheel.sign / self.pair.wheel.base_radius

    @property
    def thickness(self) -> float:
        """Face width that the plane stands for, m."""
        return self.pair.face_width

    def line_loads(self, _contact: LinearizedContact, _pressure: FloatArray) -> tuple[LineLoad, ...]:
        """Return none: in the plane the load is even."""
        return ()

    def checks(self, solutions: Sequence[Solution]) -> list[tuple[float, float]]:
        """Return the largest relative breach of the laws, and the torque of gear 2 over that of gear 1.

        The moment of the reactions at gear 1's bore is the torque, at gear 2's bore that of the contact
        forces; the work u f of both gears is p C p. Nothing condensed enters the reactions: all nodes are
        solved for.
        """
        reactions, work = zip(*(_of_body(self.bodies, number, solutions) for number in range(2)), strict=True)
        checks = []
        for i, (contact, pressure, torque) in enumerate(solutions):
            driven = _moment(self.bodies[1], contact.forces[1] @ pressure)
            balance = max(
                abs(float(reactions[0][i]) / torque + 1.0), abs(float(reactions[1][i]) / driven + 1.0)
            )
            elastic = float(pressure @ contact.system.compliance @ pressure)
            energy = abs(float(work[0][i] + work[1][i]) / elastic - 1.0)
            checks.append((max(balance, energy), abs(driven) / torque))
        return checks

    def linearized(self, at: Configuration) -> LinearizedContact:
        turn, center = rotation(self.lag_rate * at.lag), self.bodies[1].body.center
        rigid = (self.bodies[0].points, (self.bodies[1].points - center) @ turn.T + center)
        first, second = (u.reshape(-1, 2) for u in at.displacements)
        deformed = (rigid[0] + first, rigid[1] + second @ turn.T)

        def lag(points: FloatArray) -> FloatArray:
            return np.asarray(self.lag_rate * (points - center)[:, ::-1] * [-1.0, 1.0])

        gaps = []
        for site in self.sites:
            columns = [body.columns[site.ahead] for body in self.bodies]
            curves = FlankCurve(deformed[0][columns[0]]), FlankCurve(deformed[1][columns[1]])
            reference = FlankCurve(rigid[site.slave][columns[site.slave]])
            gaps.append(weak_gap(curves, reference, site.slave, lag))
        return self._gathered(gaps, at, turn)

    def _gathered(self, gaps: Sequence[WeakGap], at: Configuration, turn: FloatArray) -> LinearizedContact:
        """Join the pairs, without hats that hardly face their mate."""
        facing = [_full_weights(self, site) * LEAST_FACING for site in self.sites]
        kept = np.concatenate([gap.weight > least for gap, least in zip(gaps, facing, strict=True)])
        first, second = self._forces(gaps, 0)[:, kept], turned_back(self._forces(gaps, 1)[:, kept], turn)
        moved = self.bodies[0].compliance @ first, self.bodies[1].compliance @ second
        compliance = first.T @ moved[0] + second.T @ moved[1]
        closing = np.concatenate([gap.closing for gap in gaps])[kept]
        points, deformed = self.bodies[0].points, at.displacements
        system = ContactSystem(
            gap=np.concatenate([gap.gap for gap in gaps])[kept]
            + closing * at.lag
            - first.T @ deformed[0]
            - second.T @ deformed[1],
            compliance=0.5 * (compliance + compliance.T),
            closing=closing,
            lever=points[:, 0] @ first[1::2] - points[:, 1] @ first[0::2],
            weight=np.concatenate([gap.weight for gap in gaps])[kept],
        )
        site = np.repeat(np.arange(len(gaps)), [len(gap.gap) for gap in gaps])[kept]
        ends = [at_end(self.pair, each, self.bodies[each.slave].body) for each in self.sites]
        return LinearizedContact(system, (first, second), moved, site, site, np.concatenate(ends)[kept])

    def _forces(self, gaps: Sequence[WeakGap], number: int) -> FloatArray:
        """Return the nodal forces (2 k, h) of all pairs on one gear."""
        body = self.bodies[number]
        blocks = []
        for site, gap in zip(self.sites, gaps, strict=True):
            block = np.zeros((2 * len(body.nodes), len(gap.gap)))
            block[freedoms(body.columns[site.ahead])] = gap.forces[number]
            blocks.append(block)
        return np.concatenate(blocks, axis=1)


def _full_weights(geometry: _PairGeometry, site: ContactSite) -> FloatArray:
    """Return the lengths of the hats of a site's slave, m."""
    body = geometry.bodies[site.slave]
    nodes = body.points[body.columns[site.ahead]]
    lengths = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    return np.asarray(0.5 * (np.append(lengths, 0.0) + np.insert(lengths, 0, 0.0)))


def at_end(pair: ParallelAxes, site: ContactSite, slave: PlacedBody) -> BoolArray:
    """Say which hats along the profile of a site are at an end of its strip that is no tip edge."""
    s = slave.strips[site.ahead].s
    gear = (pair.pinion, pair.wheel)[site.slave]
    ends = np.zeros(len(s), dtype=bool)
    ends[0], ends[-1] = True, s[-1] < tooth_profile(gear).s_tip
    return ends


class ContactModel(Protocol):
    """The contacts made of the plane mesh of a position."""

    @property
    def count(self) -> int:
        """Number of contacts that share the bodies."""

    def largest_line_load(self, pair: ParallelAxes, normal_force: float) -> float:
        """Return about the largest load per face width, N/m."""

    def closer(self, pair: ParallelAxes) -> float:
        """Return by how much flanks come closer anywhere than at mid-face, m, >= 0."""

    def geometries(
        self,
        pair: ParallelAxes,
        sites: tuple[ContactSite, ...],
        meshes: tuple[PlacedBody, PlacedBody],
        layers: int,
    ) -> tuple[tuple[ContactGeometry, ...], int]:
        """Return the contacts, and the unknowns of their bodies."""


@dataclass(frozen=True)
class PlaneStrain:
    """One contact, the same all along the face."""

    count: int = 1

    def largest_line_load(self, pair: ParallelAxes, normal_force: float) -> float:
        """Return the mean: it is the same everywhere."""
        return normal_force / pair.face_width

    def closer(self, pair: ParallelAxes) -> float:
        """Return 0."""
        return 0.0

    def geometries(
        self,
        pair: ParallelAxes,
        sites: tuple[ContactSite, ...],
        meshes: tuple[PlacedBody, PlacedBody],
        layers: int,
    ) -> tuple[tuple[ContactGeometry, ...], int]:
        """Condense both gears in the plane."""
        materials = (pair.pinion.material, pair.wheel.material)
        first, second = (condensed_body(m, material) for m, material in zip(meshes, materials, strict=True))
        unknowns = 2 * sum(len(mesh.points) for mesh in meshes)
        return (_PairGeometry(pair, sites, (first, second)),), unknowns


def softness(pair: ParallelAxes) -> float:
    """Return about the lag by a load per face width, m per N/m."""
    gears = (pair.pinion, pair.wheel)
    return sum(0.5 / gear.material.youngs_modulus for gear in gears) / MESH_STIFFNESS
