"""The contact solver on problems with known answers: outcomes, sweeps, and where it starts."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numba import typeof

from fe_contact import Gear, GearPair, Status
from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    LoadedSlices,
    PatchRule,
    Slices,
    Start,
    contact_candidates,
    solve_contact,
)
from fe_contact.contact.edge_strip import no_edges
from fe_contact.contact.elimination import eliminate
from fe_contact.contact.local_law import approach, local_law
from fe_contact.contact.newton import _residuals, solve_point
from fe_contact.contact.patch import Patches
from fe_contact.contact.point_problem import PointProblem, State, point_problems, problem_at
from fe_contact.contact.strip import Gap, gap_table
from fe_contact.effects.influence.estimated_curve import Springs

MODULUS = 115e9
HALF_PLANE = 1.0 / (math.pi * MODULUS)
RADIUS, WIDTH, LENGTH = 6e-3, 25e-3, 3e-4
STIFF = 3e-9  # m/N, a tooth pair


def point(compliance, gap, motion_arm=None, torque_arm=None, edge_slope=math.nan) -> PointProblem:
    n = len(gap)
    ones = np.ones(n)
    gap_about = beside_an_edge(edge_slope, n)
    motion = ones if motion_arm is None else np.asarray(motion_arm)
    torque = motion if torque_arm is None else np.asarray(torque_arm)
    there = np.flatnonzero(np.asarray(gap) != math.inf)
    widths, moduli = np.full((2, there.size), [[WIDTH], [MODULUS]])
    law = local_law(gap_table(gap_about)[there], widths, moduli, LENGTH)
    bodies, gaps = np.asarray(compliance, float), np.asarray(gap, float)[there]
    return PointProblem(
        bodies,
        np.zeros((0, 0)),
        np.zeros(n),
        no_edges(n)[0],
        np.ones((there.size, 1)),
        there,
        gaps,
        motion[there],
        torque[there],
        law,
    )


def beside_an_edge(slope, *shape) -> Gap:
    """Gap of flanks that open by a slope > 0 at an edge, or are -slope R away from one; NaN is no edge."""
    ones = np.ones(shape)
    edge = math.inf if math.isnan(slope) else max(-slope, 0.0) * RADIUS
    opening, none = max(np.nan_to_num(slope), 0.0), np.zeros((*shape, 0))
    return Gap(opening * ones, ones / RADIUS, -edge * ones, math.inf * ones, none, none, none)


def solve(problem, load, force=None):
    force = np.zeros(problem.gap.size) if force is None else force
    residual = np.full(4, np.nan)
    return *solve_point(problem, load, force, residual), force, residual


@pytest.mark.parametrize("edge_slope", [math.nan, 0.03, -0.01])
def test_one_contact_in_closed_form(edge_slope):
    # F = T/n, and what it moves follows; m scales the deflection
    problem = point([[STIFF]], [2e-6], [0.98], [0.95], edge_slope)
    d, tangent, status, _, _, force, residual = solve(problem, 1000.0)
    local, slope, _ = approach(problem.law, 0, 1000.0 / 0.95)
    assert status == Status.CONVERGED
    assert force[0] == pytest.approx(1000.0 / 0.95, rel=1e-12, abs=0.0)
    assert d == pytest.approx((2e-6 + STIFF * force[0] + local) / 0.98, rel=1e-12, abs=0.0)
    assert tangent == pytest.approx((STIFF + slope) / (0.98 * 0.95), rel=1e-9, abs=0.0)  # as the strip
    assert residual.max() < 1e-12


def test_contacts_share_by_their_balance():
    compliance = STIFF * (np.eye(4) + 0.3)
    *_, force, _ = solve(point(compliance, np.zeros(4)), 4000.0)
    assert force == pytest.approx(np.full(4, 1000.0), rel=1e-12, abs=0.0)
    compliance = STIFF * np.array([[1.0, 0.2], [0.2, 1.4]])
    problem = point(compliance, [0.0, 1e-6])
    d, *_, force, _ = solve(problem, 3000.0)
    for i in (0, 1):
        local, _, _ = approach(problem.law, i, force[i])
        assert problem.gap[i] + compliance[i] @ force + local == pytest.approx(d, rel=1e-12, abs=0.0)
    assert force.sum() == pytest.approx(3000.0, rel=1e-12, abs=0.0)


def test_a_contact_enters_when_its_gap_closes():
    # alone, contact 0 moves contact 1 by C_10 F; the second enters where d reaches gap + C_10 F
    compliance = STIFF * np.array([[1.0, 0.25], [0.25, 1.0]])
    load = 2000.0
    alone = point(compliance, [0.0, math.inf])
    d_alone = solve(alone, load)[0]
    reach = d_alone - compliance[1, 0] * load
    apart = solve(point(compliance, [0.0, reach * (1.0 + 1e-9)]), load)
    touching = solve(point(compliance, [0.0, reach * (1.0 - 1e-3)]), load)
    # from the solution without it: nothing but its own penetration brings it in
    barely = solve(point(compliance, [0.0, reach * (1.0 - 1e-9)]), load, np.array([load, 0.0]))
    assert apart[5][1] == 0.0
    assert apart[0] == pytest.approx(d_alone, rel=1e-15, abs=0.0)
    assert 0.0 < touching[5][1] < 0.01 * load
    assert touching[0] < d_alone
    assert 0.0 < barely[5][1] < 1e-8 * load


def test_what_has_no_solution_or_outgrows_its_patch_is_said():
    d, tangent, status, iterations, _, force, residual = solve(point([[STIFF]], [math.inf]), 1.0)
    assert status == Status.OUT_OF_MODEL
    assert math.isnan(d)
    assert math.isnan(tangent)
    assert iterations == 0
    assert force.size == 0
    assert not np.any(residual < 1.0)
    d, _, status, *_ = solve(point(STIFF * np.eye(2), [0.0, math.nan]), 1000.0)
    assert status == Status.SINGULAR
    assert math.isnan(d)
    strip_load = WIDTH * math.pi * MODULUS * (0.66 * LENGTH) ** 2 / (4.0 * RADIUS)
    assert [solve(point([[STIFF]], [0.0]), factor * strip_load)[4] for factor in (0.99, 1.01)] == [
        False,
        True,
    ]


@pytest.mark.parametrize("entry", [-1e-6, math.nan])
def test_a_compliance_without_a_solution_is_reported(entry):
    d, _, status, *_, residual = solve(point([[entry]], [0.0]), 1000.0)
    assert status == Status.SINGULAR
    assert math.isnan(d)
    assert not np.any(residual < 1.0)


@pytest.mark.law
def test_residuals_measure_what_they_say():
    # a state that violates each condition by a known amount
    problem = point([[STIFF, 0.0], [0.0, STIFF]], [0.0, 5e-6])
    force, elastic, total = np.array([2000.0, -20.0]), 4e-6, 2200.0
    residual, zeros, square = np.full(4, np.nan), np.zeros(2), np.zeros((2, 2))
    _residuals(
        problem,
        total,
        elastic,
        problem.gap,
        State(zeros, zeros.copy(), square, force, zeros, force),
        residual,
    )
    moved = [STIFF * f + (approach(problem.law, i, f)[0] if f > 0.0 else 0.0) for i, f in enumerate(force)]
    slack = [(problem.gap[i] - elastic + moved[i]) / elastic for i in range(2)]
    assert slack[0] > 0.0
    assert residual[0] == pytest.approx((2200.0 - 1980.0) / total, rel=1e-12, abs=0.0)
    assert residual[1] == max(0.0, -min(slack))
    assert residual[2] == pytest.approx(20.0 / total, rel=1e-12, abs=0.0)
    assert residual[3] == pytest.approx(
        max(2000.0 * abs(slack[0]), 20.0 * abs(slack[1])) / total, rel=1e-12, abs=0.0
    )


def test_elimination_solves_and_refuses():
    rng = np.random.default_rng(7)
    matrix, right = rng.normal(size=(9, 9)), rng.normal(size=(2, 9))
    matrix[0, 0] = 0.0  # only with pivots
    solution = right.copy()
    assert eliminate(matrix.copy(), solution, 7)
    assert matrix[:7, :7] @ solution[:, :7].T == pytest.approx(right[:, :7].T, abs=1e-12)
    assert np.array_equal(solution[:, 7:], right[:, 7:])
    for bad in (np.zeros((2, 2)), np.array([[1.0, 2.0], [2.0, 4.0]]), np.full((2, 2), math.nan)):
        assert not eliminate(bad, np.ones((1, 2)), 2)


ARM = 0.98


def two_position_problem() -> ContactProblem:
    """One contact at the first position, two at the second."""
    full = np.ones((2, 2))
    patches = Patches(full, LENGTH * full, 0.0 * full)
    slices = LoadedSlices(
        pair=np.array([0, 1]),
        face_position=np.zeros(2),
        present=full > 0.0,
        touch=None,
        patch_1=patches,
        patch_2=patches,
        slice_width=WIDTH,
        base_helix_angle=0.0,
        corner_1=1.0,
        corner_2=1.0,
        tip_inclinations=(0.5, 0.5),
        law_length=LENGTH,
        edge_load=0.0,
        lateral_shares=(0.0, 0.0),
        turned_normals=0.0 * full,
    )
    candidates = SimpleNamespace(  # what the sweep reads of its candidates
        position=np.array([0.0, 0.5]),
        pair=np.array([0, 1]),
        slices=slices,
        touch=SimpleNamespace(slope_1=0.0 * full, slope_2=0.0 * full),
        curves=np.ones((1, 1)),
        heights=np.ones((1, 1)),
        gap=np.array([[1e-6, math.inf], [0.0, 0.0]]),
        motion_arm=ARM * full,
        torque_share=full,
        gap_about=beside_an_edge(math.nan, 2, 2),
        width=WIDTH * full,
    )
    compliance = np.broadcast_to(STIFF * np.array([[1.0, 0.2], [0.2, 1.0]]), (2, 2, 2)).copy()
    return ContactProblem(candidates, compliance, MODULUS, HALF_PLANE, HALF_PLANE)


LOADS = np.array([10.0, 1000.0, 5000.0])


def test_sweep_equals_single_solves_and_a_failure_stays_alone():
    problem = two_position_problem()
    solution = solve_contact(problem, LOADS)
    assert solution.converged
    assert solution.no_load.tolist() == [1e-6, 0.0]
    for p in range(2):
        for k, load in enumerate(LOADS):
            # the gap of the candidates is a deflection, that of a point is normal to the flank
            gap = ARM * problem.candidates.gap[p]
            single = point(problem.compliance[p], gap, [ARM, ARM], [1.0, 1.0])
            d, tangent, *_, force, _ = solve(single, load)
            assert solution.deflection[p, k] == pytest.approx(d, rel=1e-12, abs=0.0)
            assert solution.tangent[p, k] == pytest.approx(tangent, rel=1e-9, abs=0.0)
            assert solution.force[p, k, single.first] == pytest.approx(force, rel=1e-9, abs=0.0)
    broken = problem.candidates.gap.copy()
    broken[0] = math.inf
    candidates = SimpleNamespace(**(vars(problem.candidates) | {"gap": broken}))
    solution = solve_contact(replace(problem, candidates=candidates), LOADS)
    assert not solution.converged
    assert np.all(solution.status[0] == Status.OUT_OF_MODEL)
    assert np.isnan(solution.deflection[0]).all()
    assert np.all(solution.force[0] == 0.0)
    assert np.array_equal(solution.deflection[1], solve_contact(problem, LOADS).deflection[1])
    all_loads, one_load = solve_contact(problem, LOADS), solve_contact(problem, LOADS[1:2])
    assert one_load.deflection[:, 0] == pytest.approx(all_loads.deflection[:, 1], rel=1e-12, abs=0.0)


MODULE = 3e-3
GEAR = Gear(teeth=24, normal_module=MODULE, face_width=8 * MODULE, bore_diameter=12 * MODULE, helix_angle=0.3)
PAIR = GearPair(GEAR, replace(GEAR, helix_angle=-0.3))
THREE_LOADS = np.array([200.0, 1500.0, 6000.0])
MODEL = ContactModel(across_face=True)


def candidates(slices: int, corner: bool = True) -> Candidates:
    position, rule = np.arange(6) / 6, PatchRule(0.15 * MODULE, 0.0125 * MODULE)
    model = replace(MODEL, corner_contact=corner)
    return contact_candidates(PAIR, model, position, rule, Slices.of_pair(PAIR, slices))


@pytest.fixture(scope="module")
def springs():
    return Springs(PAIR)._springs(MODEL)


def test_compiled_code_sees_one_order_in_memory(springs):
    """Candidates column by column or row by row: compiled once for both."""
    touch, width = springs.candidates.touch, springs.candidates.width
    kinds = set()
    for order in "CF":
        arrays = {name: np.copy(value, order) for name, value in vars(touch).items() if np.ndim(value) == 2}
        here = replace(springs.candidates, touch=replace(touch, **arrays), width=np.copy(width, order))
        kinds.add(typeof(point_problems(replace(springs, candidates=here))))
    assert len(kinds) == 1


@pytest.mark.law
def test_the_solution_is_the_same_wherever_it_starts_and_nearer_is_sooner(springs):
    """There is one alone: from its own forces, from others by far, and from none."""
    cold = solve_contact(springs, THREE_LOADS)
    rng = np.random.default_rng(3)
    for force in (cold.force, 0.9 * cold.force[:, [1, 2, 0]], rng.uniform(-1.0, 1.0, cold.force.shape) * 1e3):
        warm = solve_contact(springs, THREE_LOADS, Start(springs.candidates, force))
        assert warm.converged
        assert warm.deflection == pytest.approx(cold.deflection, rel=1e-11, abs=0.0)
        assert warm.force == pytest.approx(cold.force, abs=1e-8 * THREE_LOADS[0])
        assert warm.residuals.max() < 1e-9
    rng = np.random.default_rng(4)
    beside = cold.force * (1.0 + 1e-3 * rng.uniform(-1.0, 1.0, cold.force.shape))
    warm = solve_contact(springs, THREE_LOADS, Start(springs.candidates, beside))
    assert warm.iterations.mean() < cold.iterations.mean() - 0.5
    own = solve_contact(springs, THREE_LOADS, Start(springs.candidates, cold.force))
    assert own.iterations.max() <= 2
    force = np.full((springs.candidates.position.size, THREE_LOADS.size, springs.candidates.pair.size), 100.0)
    solve_contact(springs, THREE_LOADS, Start(springs.candidates, force))
    assert np.all(force == 100.0)


@pytest.mark.law
def test_curves_move_the_contacts_as_the_means_of_their_slices_do():
    here, rng = candidates(7), np.random.default_rng(2)
    root = rng.normal(size=(here.position.size, here.slices.pair.size, 60))
    bodies = root @ root.transpose(0, 2, 1)
    problem = ContactProblem(here, bodies, MODULUS, HALF_PLANE, HALF_PLANE)
    for p in range(here.position.size):
        point, present = problem_at(point_problems(problem), p)
        parts = np.zeros((present.size, len(point.bodies)))
        for q, (first, curve) in enumerate(zip(point.first, point.curve, strict=True)):
            parts[q, first : first + curve.size] = curve
        assert point.curve.shape[1] == 3
        unit = np.eye(here.pair.size)[present]
        blend = here.on_slices(unit)
        expected = blend @ problem.bodies[p] @ blend.T
        assert parts @ point.bodies @ parts.T == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


def test_a_misleading_start_is_given_up(springs):
    """Where bodies are barely definite, forces on a few points may lead nowhere: a guess of its own does."""
    present = springs.candidates.slices.present
    minimum = np.linalg.eigvalsh(springs.bodies[0][np.ix_(present[0], present[0])])[0]
    compliance, at = springs.compliance.copy(), np.arange(present.shape[1])
    compliance[:, at, at] -= np.where(present, 2.7 * minimum, 0.0)
    barely = replace(springs, compliance=compliance)
    cold = solve_contact(barely, THREE_LOADS)
    assert cold.converged
    few = np.where(np.random.default_rng(3).uniform(size=cold.force.shape) > 0.99, 3e4, 0.0)
    warm = solve_contact(barely, THREE_LOADS, Start(barely.candidates, few))
    assert warm.converged
    assert warm.deflection == pytest.approx(cold.deflection, rel=1e-9, abs=0.0)


def test_forces_carried_to_other_slices_keep_the_line_load_of_their_pair():
    fine, coarse = candidates(21), candidates(7)
    load = np.arange(1.0, fine.pair.size + 1.0)[None, None, :]
    carried = Start(fine, load).on(coarse)[0, 0]
    for i in range(coarse.pair.size):
        beside = np.flatnonzero(fine.pair == coarse.pair[i])
        k = beside[np.argmin(np.abs(fine.face_position[beside] - coarse.face_position[i]))]
        assert carried[i] / coarse.point_width == pytest.approx(
            load[0, 0, k] / fine.point_width, rel=1e-12, abs=0.0
        )
    back = Start(coarse, carried[None, None]).on(fine)
    for pair in np.unique(fine.pair):
        whole = carried[coarse.pair == pair].sum()
        assert back[0, 0, fine.pair == pair].sum() == pytest.approx(whole, rel=1e-12, abs=0.0)
    here = candidates(5)
    points = len(here.curves)
    fewer = replace(here, pair=here.pair[points:], face_position=here.face_position[points:])
    carried = Start(fewer, np.ones((1, 1, fewer.pair.size))).on(here)[0, 0]
    assert np.all(carried[:points] == 0.0)
    assert np.all(carried[points:] == 1.0)
