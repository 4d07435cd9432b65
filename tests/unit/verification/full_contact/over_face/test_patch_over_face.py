"""Patch test over the face, laws of the condensed bodies, and the elimination that condenses them."""

from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp
from contact_blocks import DEPTH, WIDTH, block
from scipy.sparse.linalg import spsolve

from fe_contact.errors import SolveError
from fe_contact.material import Material
from fe_contact.types import FloatArray
from verification.full_contact.condensation.active_set import ContactSystem, solve_active_set
from verification.full_contact.condensation.condensed_body import condensed_body, dissected, freedoms
from verification.full_contact.condensation.flank_curve import FlankCurve
from verification.full_contact.condensation.weak_gap import weak_gap
from verification.full_contact.over_face.extruded_body import ExtrudedBody, extruded_body
from verification.full_contact.over_face.extruded_stiffness import X, Z, extruded_stiffness
from verification.full_contact.over_face.face_gap import FaceGap, face_gap
from verification.full_contact.over_face.layers import Layers, graded_layers
from verification.full_contact.over_face.schur_complement import ColumnMatrix, schur_complement

FACE, FORCE = 8e-3, 2e3  # m, N
LAYERS = graded_layers(FACE, 3)

# without lateral contraction a block clamped at its back is strained evenly
SOFT, STIFF = Material(70e9, 0.0), Material(210e9, 0.0)
STEEL = Material(206e9, 0.3)


@cache
def blocks(layers: int = 3) -> tuple[ExtrudedBody, ExtrudedBody]:
    over = graded_layers(FACE, layers)
    return extruded_body(block(0), over, SOFT), extruded_body(block(1), over, STIFF)


@cache
def steel() -> ExtrudedBody:
    return extruded_body(block(0), LAYERS, STEEL)


def towards(points: FloatArray) -> FloatArray:
    return np.tile([-1.0, 0.0], (len(points), 1))


def pressed(slave: int, layers: int = 3, skew: float = 0.0) -> tuple[FaceGap, ContactSystem]:
    """The right block moves towards the left one, which is hollow by `skew` at one end of the face."""
    bodies = blocks(layers)
    curves = [FlankCurve(body.points[body.columns[0]]) for body in bodies]

    def section(z):
        assert 0.0 < abs(z) < 0.5 * FACE
        away = FlankCurve(curves[1].nodes + np.array([skew * (z / FACE + 0.5) ** 2, 0.0]))
        return weak_gap((curves[0], away), (curves[0], away)[slave], slave, towards), 0.0

    gap = face_gap(section, bodies[0].layers)
    compliance = np.zeros((len(gap.gap),) * 2)
    for body, forces in zip(bodies, gap.forces, strict=True):
        count, functions = len(body.nodes), 2 * body.layers.count + 1
        block_rows = np.zeros((2, count, 2 * functions, len(gap.gap)))
        block_rows[:, body.columns[0]] = forces.reshape(2, count, 2 * functions, -1)
        rows = sp.csr_array(block_rows.reshape(-1, len(gap.gap)).T)
        compliance += rows @ body.displacement(rows)
    return gap, ContactSystem(gap.gap, compliance, gap.closing, gap.closing, gap.weight)


@pytest.mark.parametrize("slave", [0, 1])
def test_a_flat_contact_carries_one_pressure_and_action_is_reaction(slave):
    _, system = pressed(slave)
    solution = solve_active_set(system, FORCE)
    assert solution.status.usable
    area = WIDTH * FACE
    np.testing.assert_allclose(solution.pressure, FORCE / area, rtol=1e-10, atol=0.0)
    modulus = 1.0 / (1.0 / SOFT.youngs_modulus + 1.0 / STIFF.youngs_modulus)
    assert solution.lag == pytest.approx(FORCE / area * DEPTH / modulus, rel=1e-11)
    # All over the face, and about mid-face: the moment of the halves is opposite.
    gap, _ = pressed(slave)
    pressure = np.random.default_rng(5).uniform(1.0, 2.0, len(gap.gap))
    functions = 2 * LAYERS.count + 1
    totals, moments = [], []
    for forces in gap.forces:
        halves = (forces @ pressure).reshape(2, -1, 2, functions)[..., X, : LAYERS.count + 1].sum(axis=1)
        totals.append(float(halves.sum()))
        moments.append(float((halves[0] - halves[1]) @ LAYERS.planes))
    assert totals[0] == pytest.approx(-totals[1], rel=1e-12)
    assert moments[0] == pytest.approx(-moments[1], rel=1e-9)
    assert abs(totals[0]) == pytest.approx(gap.weight @ pressure, rel=1e-12)
    assert gap.weight.sum() == pytest.approx(WIDTH * FACE, rel=1e-12)


def test_condensed_compliances_are_those_of_the_whole_halves():
    """Reciprocity, positive energy, u f = p C p, and the reactions at the held side."""
    body, stiffness = steel(), extruded_stiffness(block(0).points, block(0).triangles, LAYERS, STEEL)
    rng = np.random.default_rng(3)
    held = np.isin(stiffness.node, body.body.bore_nodes)
    for odd, compliance in enumerate((body.even, body.odd)):
        at_middle = (stiffness.function == 0) & ((stiffness.component != Z) == bool(odd))
        free = np.flatnonzero(~(held | at_middle))
        loaded = (stiffness.component == X) & np.isin(stiffness.node, body.nodes)
        loaded &= (stiffness.function <= LAYERS.count) & ~at_middle
        forces = np.where(loaded, rng.normal(size=len(loaded)), 0.0)
        moved = np.zeros(len(forces))
        moved[free] = spsolve(sp.csc_array(stiffness.matrix[free][:, free]), forces[free])
        own = np.zeros((len(body.nodes), 2, 2 * LAYERS.count + 1))
        node = np.searchsorted(body.nodes, stiffness.node[loaded])
        own[node, 0, stiffness.function[loaded]] = forces[loaded]
        energy = own.ravel() @ compliance @ own.ravel()
        assert energy == pytest.approx(moved @ forces, rel=1e-10)
        assert np.array_equal(compliance, compliance.T)
        assert np.linalg.eigvalsh(compliance).min() > -1e-12 * np.abs(compliance).max()
        if not odd:
            reaction = (stiffness.matrix @ moved).reshape(-1)[held]
            arms = body.body.points[stiffness.node[held]]
            hats = stiffness.function[held] <= LAYERS.count
            turned = np.select([stiffness.component[held] == k for k in (0, 1)], [-arms[:, 1], arms[:, 0]])
            moment = float(reaction[hats] @ turned[hats])
            assert body.bore_moment @ own.ravel() == pytest.approx(moment, rel=1e-9)
            assert moment == pytest.approx(-float(body.arms @ own.ravel()), rel=1e-9)


def test_rigid_motions_and_even_strains_have_their_energy():
    stiffness = extruded_stiffness(block(0).points, block(0).triangles, LAYERS, STEEL)
    x, y = block(0).points[stiffness.node].T
    hats = stiffness.function <= LAYERS.count
    z = np.append(LAYERS.planes, np.zeros(LAYERS.count))[stiffness.function]
    place = np.stack([x, y, z])
    scale = STEEL.youngs_modulus * WIDTH * DEPTH * 0.5 * FACE
    for a in range(3):
        for b in range(3):
            moved = np.where(hats & (stiffness.component == a), place[b], 0.0)
            turned = moved - np.where(hats & (stiffness.component == b), place[a], 0.0)
            assert abs(turned @ stiffness.matrix @ turned) < 1e-10 * scale
            shear = 0.5 / (1.0 + STEEL.poissons_ratio)
            pure = (1.0 - STEEL.poissons_ratio) / (1.0 + STEEL.poissons_ratio)
            expected = pure / (1.0 - 2.0 * STEEL.poissons_ratio) if a == b else shear
            assert moved @ stiffness.matrix @ moved == pytest.approx(expected * scale, rel=1e-10)


@pytest.mark.law
def test_more_layers_converge():
    """Where the contact ends inside the face: differences fall with the square of the thickness or so."""
    lags = []
    for layers in (2, 4, 8, 16):
        _, system = pressed(0, layers, skew=10e-6)
        solution = solve_active_set(system, FORCE)
        assert 0.0 < np.mean(solution.pressure > 0.0) < 0.9
        lags.append(solution.lag)
    steps = np.abs(np.diff(lags))
    assert steps[2] < 0.5 * steps[1] < 0.25 * steps[0]
    assert steps[2] < 1e-3 * lags[-1]


def test_a_wide_block_is_in_plane_strain_in_its_middle():
    wide = Layers(np.array([0.0, 4.0, 8.0, 10.0, 11.0, 11.5, 12.0]) * DEPTH)
    body, plane = extruded_body(block(0), wide, STEEL), condensed_body(block(0), STEEL)
    line = np.zeros(2 * len(plane.nodes))
    line[freedoms(plane.columns[0])[::2]] = -1.0
    mass, _, _ = wide.integrals()
    over = mass[:, : wide.count + 1].sum(axis=1)  # the same everywhere along the face
    forces = (line.reshape(-1, 2)[:, :, None] * over).ravel()
    middle = (body.even @ forces).reshape(-1, 2, 2 * wide.count + 1)[:, :, 0].ravel()
    expected = plane.compliance @ line
    np.testing.assert_allclose(middle, expected, rtol=0.0, atol=2e-3 * np.abs(expected).max())


GRID_SIDE, KEPT = 9, 7


def columns(shift: float = 0.0) -> tuple[ColumnMatrix, FloatArray]:
    """A grid of nodes with 1 to 4 unknowns each, its last nodes kept; the matrix dense too."""
    rng = np.random.default_rng(2)
    nodes = np.arange(GRID_SIDE * GRID_SIDE).reshape(GRID_SIDE, GRID_SIDE)
    pairs = [(nodes[:-1], nodes[1:]), (nodes[:, :-1], nodes[:, 1:]), (nodes[:-1, :-1], nodes[1:, 1:])]
    rows, others = (np.concatenate([pair[k].ravel() for pair in pairs]) for k in range(2))
    graph = sp.coo_array((np.ones(len(rows)), (rows, others)), shape=(GRID_SIDE**2, GRID_SIDE**2))
    graph = sp.csr_array(graph + graph.T + sp.eye_array(GRID_SIDE**2))
    order = np.concatenate([dissected(graph, np.arange(GRID_SIDE**2 - KEPT)), nodes.ravel()[-KEPT:]])
    graph = sp.csr_array(graph[order][:, order])
    counts = rng.integers(1, 5, GRID_SIDE**2)
    starts = np.concatenate([[0], np.cumsum(counts)])
    owner = np.repeat(np.arange(GRID_SIDE**2), counts)
    dense = rng.normal(size=(starts[-1], starts[-1])) * (graph.toarray()[np.ix_(owner, owner)] > 0.0)
    dense = dense + dense.T
    dense += (np.abs(dense).sum(axis=1).max() - shift) * np.eye(len(dense))
    return ColumnMatrix(sp.csc_array(np.tril(dense)), starts, graph), dense


def test_it_is_that_of_dense_algebra():
    matrix, dense = columns()
    first = matrix.starts[-1 - KEPT]
    inner, across, outer = dense[:first, :first], dense[:first, first:], dense[first:, first:]
    expected = outer - across.T @ np.linalg.solve(inner, across)
    found = schur_complement(matrix, KEPT)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
    assert np.array_equal(found, found.T)
    matrix, _ = columns(shift=100.0)
    with pytest.raises(SolveError, match="over the face"):
        schur_complement(matrix, KEPT)
