"""Substructures and cyclic harmonics against dense algebra, orderings, and what rounding leaves."""

import gc
import math
import weakref

import numpy as np
import pytest
import scipy.sparse as sp
from analysis_requests import table_request
from scipy.sparse.linalg import splu

from fe_contact import STEEL, Gear, GearPair
from fe_contact.analysis.request.request_check import check_request
from fe_contact.compliance import ComplianceChecks, flank_compliance_3d
from fe_contact.compliance.cyclic_ring import close_ring, hold_sector
from fe_contact.compliance.elimination_tree import EliminationTree, bisected_tree
from fe_contact.compliance.factorization import factorise, fill_reducing_order
from fe_contact.compliance.rounding import (
    EPSILON,
    LARGEST_ROUNDING,
    disc_rounding,
    least_face_width,
    left_by_rounding,
)
from fe_contact.compliance.sector_stiffness import ElementStiffness
from fe_contact.compliance.substructure import condense
from fe_contact.errors import InputError, SolveError
from fe_contact.mesh import SectorRecipe

RANDOM = np.random.default_rng(7)
COLUMNS, ROWS = 7, 5
KEPT = np.array([40, 3, 17, 9])


def sheet(floor: float = 0.1) -> tuple[np.ndarray, np.ndarray, np.ndarray, ElementStiffness]:
    """Four-node elements with one freedom per node; node 0 is held. Nodes, freedoms, places, matrices."""
    number = np.arange((COLUMNS + 1) * (ROWS + 1)).reshape(ROWS + 1, COLUMNS + 1)
    cells = [(i, j) for j in range(ROWS) for i in range(COLUMNS)]
    nodes = np.array([number[j : j + 2, i : i + 2].ravel() for i, j in cells])
    half = RANDOM.normal(size=(6, 4, 4))
    matrices = half @ half.transpose(0, 2, 1) + floor * np.eye(4)
    return nodes, nodes - 1, np.array(cells, float), ElementStiffness(matrices, np.arange(len(cells)) % 6)


def dense(freedoms: np.ndarray, stiffness: ElementStiffness) -> np.ndarray:
    matrix = np.zeros((freedoms.max() + 1,) * 2)
    for dofs, which in zip(freedoms, stiffness.of_element, strict=True):
        free = dofs >= 0
        matrix[np.ix_(dofs[free], dofs[free])] += stiffness.matrices[which][np.ix_(free, free)]
    return matrix


@pytest.mark.parametrize("leaf", [1, 3, 100])
def test_condensation_is_the_schur_complement(leaf):
    nodes, freedoms, place, stiffness = sheet()
    tree = bisected_tree(nodes, freedoms, place, KEPT, leaf)
    condensed, found = condense(tree, freedoms, stiffness)
    matrix = dense(freedoms, stiffness)
    others = np.setdiff1d(np.arange(len(matrix)), KEPT)
    exact = matrix[np.ix_(KEPT, KEPT)] - matrix[np.ix_(KEPT, others)] @ np.linalg.solve(
        matrix[np.ix_(others, others)], matrix[np.ix_(others, KEPT)]
    )
    assert np.array_equal(found.retained, KEPT)
    assert np.tril(condensed) == pytest.approx(np.tril(exact), abs=1e-12)
    values = RANDOM.normal(size=(len(KEPT), 2))
    field = found.expand(values)
    assert np.array_equal(field[KEPT], values)
    assert np.abs((matrix @ field)[others]).max() < 1e-12
    assert (matrix @ field)[KEPT] == pytest.approx(exact @ values, abs=1e-12)


def test_factors_go_with_their_condensation():
    """They are the largest part of a gear's memory: waiting for the collector doubles its peak."""
    nodes, freedoms, place, stiffness = sheet()
    _, condensation = condense(bisected_tree(nodes, freedoms, place, KEPT, 3), freedoms, stiffness)
    factor = weakref.ref(condensation.factors[0].factor)
    collecting = gc.isenabled()
    gc.disable()
    try:
        del condensation
        assert factor() is None
    finally:
        if collecting:
            gc.enable()


def test_every_freedom_is_eliminated_once_and_counted():
    nodes, freedoms, place, _ = sheet()
    tree: EliminationTree = bisected_tree(nodes, freedoms, place, KEPT, 3)
    inner = np.concatenate([front.inner for front in tree.root.fronts()])
    assert sorted(np.concatenate([inner, KEPT])) == list(range(len(tree.order)))
    assert np.array_equal(np.argsort(tree.order)[: len(inner)], inner)
    assert sorted(np.concatenate([f.elements for f in tree.root.fronts()])) == list(range(COLUMNS * ROWS))
    alone = bisected_tree(nodes, freedoms, place, KEPT, 100)
    n, k = len(inner), len(KEPT)
    assert alone.operations == pytest.approx(n**3 / 6 + n * n * k / 2 + n * k * k / 2)
    assert (alone.factor_entries, alone.front_entries) == (n * (n + k), (n + k) ** 2)
    assert alone.working_entries() == n * (n + k) + k**2
    assert tree.operations < alone.operations
    assert tree.factor_entries < alone.factor_entries


def test_an_indefinite_structure_is_a_solve_error():
    nodes, freedoms, place, stiffness = sheet(floor=-50.0)
    with pytest.raises(SolveError, match="not positive definite"):
        condense(bisected_tree(nodes, freedoms, place, KEPT, 3), freedoms, stiffness)


FLANK, CUT = 9, 4


def random_sector() -> np.ndarray:
    half = RANDOM.normal(size=(FLANK + 2 * CUT, 40))
    return half @ half.T


@pytest.mark.parametrize("teeth", [2, 3, 7, 8])
def test_ring_equals_the_dense_ring(teeth):
    matrix = random_sector()
    own = FLANK + CUT  # flank and left cut of each sector
    ring = np.zeros((teeth * own, teeth * own))
    for j in range(teeth):
        mine = np.arange(j * own, (j + 1) * own)
        right = (j - 1) % teeth * own + FLANK + np.arange(CUT)
        at = np.concatenate([mine, right])
        ring[np.ix_(at, at)] += matrix
    inverse = np.linalg.inv(ring)
    probes = RANDOM.normal(size=(FLANK, 2))
    reach = teeth // 2
    junk = matrix + np.triu(np.full_like(matrix, 1e6), 1)  # only the lower triangle may count
    held = hold_sector(np.asfortranarray(junk), FLANK)
    found = close_ring(held, teeth, reach, probes)
    flank = [slice(j * own, j * own + FLANK) for j in range(teeth)]
    for m in range(reach + 1):
        assert found.blocks[m] == pytest.approx(inverse[flank[m], flank[0]], rel=1e-9, abs=1e-12)
        assert pytest.approx(inverse[flank[-m % teeth], flank[0]], rel=1e-9, abs=1e-12) == found.blocks[m].T
    for j in range(teeth):
        left = slice(j * own + FLANK, (j + 1) * own)
        assert found.left[j] == pytest.approx(inverse[left, flank[0]] @ probes, rel=1e-9, abs=1e-12)


def test_an_unsupported_ring_is_a_solve_error():
    spring = np.array([[2.0, -2.0], [-2.0, 2.0]])
    matrix = np.zeros((FLANK + 2 * CUT,) * 2)
    matrix[:FLANK, :FLANK] = np.eye(FLANK)
    matrix[FLANK:, FLANK:] = np.kron(spring, np.eye(CUT))
    matrix[FLANK:, :FLANK] = 0.0
    held = hold_sector(np.asfortranarray(matrix), FLANK)
    with pytest.raises(SolveError, match="harmonic 0"):
        close_ring(held, 6, 1, np.ones((FLANK, 1)))
    with pytest.raises(SolveError, match="flank"):
        hold_sector(np.asfortranarray(-matrix), FLANK)


def grid(n: int) -> sp.csc_array:
    """Positive definite matrix of a square grid of n x n nodes with two freedoms each."""
    line = sp.diags_array([-1.0, 2.5, -1.0], offsets=[-1, 0, 1], shape=(n, n))
    eye = sp.eye_array(n)
    nodes = sp.kron(line, eye) + sp.kron(eye, line)
    return sp.csc_array(sp.kron(nodes, np.array([[2.0, 1.0], [1.0, 2.0]])))


def fill(matrix: sp.csc_array, order: np.ndarray) -> int:
    permuted = sp.csc_array(matrix[order][:, order])
    factor = splu(permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return int(factor.L.nnz)


@pytest.mark.parametrize("ordering", ["METIS", "minimum-degree"])
def test_the_order_is_of_whole_nodes_saves_fill_and_solves(ordering, monkeypatch):
    monkeypatch.setattr("host.graph_order.ORDERING", ordering)
    matrix = grid(60)
    order = fill_reducing_order(matrix, 2)
    assert np.array_equal(np.sort(order), np.arange(matrix.shape[0]))
    assert np.array_equal(order[1::2], order[::2] + 1)
    assert np.all(order[::2] % 2 == 0)
    assert fill(matrix, order) < 0.5 * fill(matrix, np.arange(matrix.shape[0]))
    assert fill(matrix, order) < 0.5 * fill(matrix, np.argsort(order))  # the inverse order is a trap
    matrix = grid(12)
    exact = np.random.default_rng(1).standard_normal((matrix.shape[0], 7))
    assert factorise(matrix, block=2)(matrix @ exact) == pytest.approx(exact, abs=1e-12)


def disc(modules: float, helix: float = 0.3, teeth: int = 40) -> Gear:
    """Teeth on a small bore, this wide."""
    return Gear(teeth, 4e-3, modules * 4e-3, teeth * 0.4e-3, helix_angle=helix)


def slenderness(gear: Gear) -> float:
    return (gear.root_radius - gear.seat_radius) / gear.face_width


def test_a_chain_of_springs_keeps_what_it_must():
    """Springs k between stiff ones, moved as a whole: K_ii u_i^2 is large, what is strained is little."""
    stiff, soft, count = 1e6, 1.0, 40
    matrix = stiff * (2.0 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1))
    matrix[0, 0], matrix[-1, -1] = stiff + soft, stiff
    load = np.zeros(count)
    load[-1] = 1.0
    u = np.linalg.solve(matrix, load)
    residual, energy = left_by_rounding(np.diag(matrix), u, load, float(u @ load))
    assert energy == pytest.approx(EPSILON * 2.0 * stiff / soft * (count - 1), rel=1e-3)
    assert np.linalg.norm(load - matrix @ u) < residual
    assert abs(float(u @ matrix @ u - u @ load)) / float(u @ load) < energy
    # the closed form: the soft spring, and the stiff ones in series
    assert u[-1] == pytest.approx(1.0 / soft + (count - 1) / stiff, rel=energy)


@pytest.mark.law
@pytest.mark.parametrize(("helix", "modules", "power"), [(0.3, 0.5, 4.0), (0.0, 0.1, 2.0)])
def test_rounding_grows_as_a_helical_disc_bends_as_a_plate(helix, modules, power):
    """(D/w)^4 with a helix, whose axial force bends the disc; (D/w)^2 without."""
    wide, thin = disc(modules, helix, 20), disc(0.5 * modules, helix, 20)
    found = [flank_compliance_3d(gear, SectorRecipe.draft(gear), reach=0).checks for gear in (wide, thin)]
    quotient = found[1].energy_rounding / found[0].energy_rounding
    assert math.log2(quotient) == pytest.approx(power, abs=0.3)
    layers = SectorRecipe.draft(thin).layers
    predicted = disc_rounding(slenderness(thin), helix, layers, STEEL)
    assert 1.0 / 3.0 < predicted / found[1].energy_rounding < 3.0


@pytest.mark.law
def test_a_disc_as_thin_as_allowed_is_computed_and_a_thinner_one_refused():
    layers = SectorRecipe.draft(disc(1.0)).layers
    minimum = least_face_width(disc(1.0), layers) / 4e-3
    assert disc_rounding(slenderness(disc(minimum)), 0.3, layers, STEEL) == pytest.approx(LARGEST_ROUNDING)
    allowed, thinner = disc(1.001 * minimum), disc(0.999 * minimum)
    check_request(
        GearPair(allowed, mate_of(allowed)), *table_request(torques=[1.0], model="3d", level="draft")
    )
    assert flank_compliance_3d(allowed, SectorRecipe.draft(allowed), reach=0).checks.energy < LARGEST_ROUNDING
    with pytest.raises(InputError, match="bends as a plate under the axial force") as refusal:
        check_request(
            GearPair(thinner, mate_of(thinner)), *table_request(torques=[1.0], model="3d", level="draft")
        )
    assert refusal.value.field == "pinion.face_width"


def mate_of(gear: Gear) -> Gear:
    return disc(gear.face_width / 4e-3, -gear.helix_angle)


@pytest.mark.law
def test_a_body_beyond_the_bound_names_rounding():
    gear = disc(0.1, teeth=20)
    with pytest.raises(SolveError, match=r"rounding may change it by .* Widen the face"):
        flank_compliance_3d(gear, SectorRecipe.draft(gear), reach=0)


def test_energy_may_round_by_the_order_of_its_sums_and_no_more():
    """Linear algebra on two threads rounded the energy of a helical gear to 1.2 of the bound of one term."""
    checks = ComplianceChecks(0.0, 0.0, 0.0, 1.0e-11, 1.0, 1e-12, 8.3e-12)
    assert checks.energy < checks.limits["energy"] < 5.0 * checks.energy_rounding
