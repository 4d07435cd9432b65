"""Where a solution starts does not decide where it ends, but how soon."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numba import typeof

from fe_contact import Gear, GearPair
from fe_contact.contact import (
    Candidates,
    ContactModel,
    ContactProblem,
    PatchRule,
    Slices,
    Start,
    contact_candidates,
    solve_contact,
)
from fe_contact.contact.point_problem import point_problems
from fe_contact.effects.influence.deflection_budget import Springs

M = 3e-3
GEAR = Gear(teeth=24, normal_module=M, face_width=8 * M, bore_diameter=12 * M, helix_angle=0.3)
PAIR = GearPair(GEAR, replace(GEAR, helix_angle=-0.3))
LOADS = np.array([200.0, 1500.0, 6000.0])
MODEL = ContactModel(across_face=True)


def candidates(slices: int, corner: bool = True) -> Candidates:
    position, rule = np.arange(6) / 6, PatchRule(0.15 * M, 0.0125 * M)
    model = replace(MODEL, corner_contact=corner)
    return contact_candidates(PAIR, model, position, rule, Slices.of_pair(PAIR, slices))


@pytest.fixture(scope="module")
def problem() -> ContactProblem:
    return Springs(PAIR)._springs(MODEL)


def test_compiled_code_sees_one_order_in_memory(problem: ContactProblem) -> None:
    """Candidates column by column or row by row: compiled once for both."""
    touch, width = problem.candidates.touch, problem.candidates.width
    kinds = set()
    for order in "CF":
        arrays = {name: np.copy(value, order) for name, value in vars(touch).items() if np.ndim(value) == 2}
        here = replace(problem.candidates, touch=replace(touch, **arrays), width=np.copy(width, order))
        kinds.add(typeof(point_problems(replace(problem, candidates=here))))
    assert len(kinds) == 1


def test_the_solution_is_the_same_wherever_it_starts(problem: ContactProblem) -> None:
    """There is one alone: from its own forces, from others by far, and from none."""
    cold = solve_contact(problem, LOADS)
    rng = np.random.default_rng(3)
    for force in (cold.force, 0.9 * cold.force[:, [1, 2, 0]], rng.uniform(-1.0, 1.0, cold.force.shape) * 1e3):
        warm = solve_contact(problem, LOADS, Start(problem.candidates, force))
        assert warm.converged
        assert warm.deflection == pytest.approx(cold.deflection, rel=1e-11, abs=0.0)
        assert warm.force == pytest.approx(cold.force, abs=1e-8 * LOADS[0])
        assert warm.residuals.max() < 1e-9


def test_a_misleading_start_is_given_up(problem: ContactProblem) -> None:
    """Where bodies are barely definite, forces on a few points may lead nowhere: a guess of its own does."""
    present = problem.candidates.slices.present
    least = np.linalg.eigvalsh(problem.bodies[0][np.ix_(present[0], present[0])])[0]
    compliance, at = problem.compliance.copy(), np.arange(present.shape[1])
    compliance[:, at, at] -= np.where(present, 2.7 * least, 0.0)
    barely = replace(problem, compliance=compliance)
    cold = solve_contact(barely, LOADS)
    assert cold.converged
    few = np.where(np.random.default_rng(3).uniform(size=cold.force.shape) > 0.99, 3e4, 0.0)
    warm = solve_contact(barely, LOADS, Start(barely.candidates, few))
    assert warm.converged
    assert warm.deflection == pytest.approx(cold.deflection, rel=1e-9, abs=0.0)


def test_a_start_beside_the_solution_spares_iterations(problem: ContactProblem) -> None:
    cold = solve_contact(problem, LOADS)
    rng = np.random.default_rng(4)
    beside = cold.force * (1.0 + 0.02 * rng.uniform(-1.0, 1.0, cold.force.shape))
    warm = solve_contact(problem, LOADS, Start(problem.candidates, beside))
    assert warm.iterations.mean() < cold.iterations.mean() - 0.5
    own = solve_contact(problem, LOADS, Start(problem.candidates, cold.force))
    assert own.iterations.max() <= 2


def test_a_start_leaves_the_other_arrays_alone(problem: ContactProblem) -> None:
    force = np.full((problem.candidates.position.size, LOADS.size, problem.candidates.pair.size), 100.0)
    solve_contact(problem, LOADS, Start(problem.candidates, force))
    assert np.all(force == 100.0)


def test_forces_carried_to_other_slices_keep_the_line_load_of_their_pair() -> None:
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


def test_pairs_that_were_not_there_start_unloaded() -> None:
    here = candidates(5)
    points = len(here.blend)
    fewer = replace(here, pair=here.pair[points:], face_position=here.face_position[points:])
    carried = Start(fewer, np.ones((1, 1, fewer.pair.size))).on(here)[0, 0]
    assert np.all(carried[:points] == 0.0)
    assert np.all(carried[points:] == 1.0)
