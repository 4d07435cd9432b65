"""The compiled contact solver against the independent one, and its laws, over random problems.

The problems are nastier than gears make them: compliances from nearly diagonal to nearly singular, gaps of
any size beside zero, edges of every angle, identical contacts, arms that differ between the gears, loads from
1e-4 to 1e3 of nominal.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fe_contact.contact.edge_strip import no_edges
from fe_contact.contact.local_law import REFERENCE_LENGTH, local_law
from fe_contact.contact.newton import CONVERGED, solve_point
from fe_contact.contact.point_problem import PointProblem
from fe_contact.contact.strip import Gap, gap_table
from lineofaction.hardcases.contact.interior_point import GapAbout, Problem, solve

MODULUS = 115e9
NOMINAL = 2660.0


def compliance(rng: np.random.Generator, kind: str, n: int) -> np.ndarray:
    if kind == "smooth":  # neighbors along a face
        place = rng.uniform(size=n)
        matrix = 0.5 * np.exp(-np.abs(place[:, None] - place) * rng.uniform(1.0, 30.0)) + 0.1
    elif kind == "dense":  # either sign off the diagonal
        basis = rng.normal(size=(n, n))
        matrix = basis @ basis.T / n + 1e-3 * np.eye(n)
    elif kind == "singular":  # half the rank
        basis = rng.normal(size=(n, max(1, n // 2)))
        matrix = basis @ basis.T / n
    else:  # teeth on a common body
        matrix = 0.2 * np.ones((n, n)) + np.diag(rng.uniform(0.5, 2.0, n))
    return 3e-9 * matrix


def random_problem(seed: int, n: int, kind: str, gaps: str, twins: bool, arms: bool) -> Problem:
    """Return the problem that `seed` picks."""
    rng = np.random.default_rng(seed)
    size = {"none": [0.0], "mixed": [0.0, 1e-8, 1e-6, 1e-5, 1e-4], "wide": [1e-3]}[gaps]
    motion = rng.uniform(0.97, 1.0, n) if arms else np.ones(n)
    length = rng.uniform(1e-4, 4e-4)
    problem = Problem(
        compliance=compliance(rng, kind, n),
        gap=rng.choice(size, n) * rng.uniform(size=n),
        motion_arm=motion,
        torque_arm=motion * rng.uniform(0.98, 1.02, n) if arms else motion,
        gap_about=random_gaps(rng, n),
        width=np.full(n, 25e-3 / max(1, n // 5)),
        length=length,
        reference_length=np.full(n, length),
        modulus=MODULUS / rng.choice([1.0, 1.44], n),
    )
    return with_twins(problem) if twins and n > 1 else problem


def random_gaps(rng: np.random.Generator, n: int) -> GapAbout:
    """Return gaps about touching points: on edges, beside them, with reliefs that begin there or nowhere."""
    low = -rng.choice([np.inf, 1e-3, 2e-4, 3e-5, 0.0], n)
    place = rng.choice([np.inf, 1e-4, 2e-5, 0.0, -5e-5, -3e-4], (n, 2))
    return GapAbout(
        slope=np.where(low == 0.0, rng.choice([0.05, 0.003, 0.0], n), 0.0),
        curvature=1.0 / rng.uniform(2e-3, 15e-3, n),
        low=low,
        high=rng.choice([np.inf, 1e-3, 1e-4], n),
        coordinate=place,
        jump=rng.choice([0.0, 3e-3, 0.02], (n, 2)),
        bend=rng.choice([0.0, -5.0, 20.0], (n, 2)),
    )


def with_twins(problem: Problem) -> Problem:
    index = np.arange(problem.gap.size)
    index[1] = 0
    return picked(problem, index)


def picked(problem: Problem, index: np.ndarray) -> Problem:
    names = ("gap", "motion_arm", "torque_arm", "width", "modulus", "reference_length")
    arrays = {name: getattr(problem, name)[index] for name in names}
    arrays["gap_about"] = GapAbout(*(part[index] for part in vars(problem.gap_about).values()))
    return replace(problem, compliance=problem.compliance[np.ix_(index, index)], **arrays)


def untilted(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return np.zeros((0, 0)), np.zeros(n), no_edges(n)[0]


class Solved:
    """What the compiled solver says, from a cold start unless `force` is given."""

    def __init__(self, problem: Problem, load: float, force: np.ndarray | None = None) -> None:
        p, n = problem, problem.gap.size
        gap = Gap(*vars(p.gap_about).values())
        there = np.flatnonzero(np.isfinite(p.gap))
        law = local_law(gap_table(gap)[there], p.width[there], p.modulus[there], p.length)
        law.strip[:, REFERENCE_LENGTH] = p.reference_length[there]
        point = PointProblem(
            p.compliance,
            *untilted(n),
            np.ones((there.size, 1)),
            there,
            p.gap[there],
            p.motion_arm[there],
            p.torque_arm[there],
            law,
        )
        found = np.zeros(there.size) if force is None else force[there]
        self.residual = np.full(4, np.nan)
        self.deflection, self.tangent, self.status, self.iterations, self.beyond = solve_point(
            point, load, found, self.residual
        )
        self.force = np.zeros(n)
        self.force[there] = found


kinds = st.sampled_from(["smooth", "dense", "singular", "body"])
problems = st.builds(
    random_problem,
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 12),
    kind=kinds,
    gaps=st.sampled_from(["none", "mixed", "wide"]),
    twins=st.booleans(),
    arms=st.booleans(),
)
loads = st.floats(-4.0, 3.0).map(lambda power: NOMINAL * 10.0**power)


def assert_agreement(problem: Problem, load: float, solved: Solved) -> None:
    answer = solve(problem, load)
    assert answer.violation < 1e-11, "the oracle itself must solve the problem"
    assert solved.status == CONVERGED
    assert solved.deflection == pytest.approx(answer.deflection, rel=1e-9, abs=0.0)
    assert solved.force == pytest.approx(answer.force, abs=1e-7 * load)
    assert np.all(solved.residual < 1e-9)


@pytest.mark.law
@pytest.mark.parametrize("kind", ["smooth", "body"])
def test_two_solvers_agree_on_four_contacts_near_free_ends(kind):
    problem = random_problem(76, 4, kind, "mixed", False, True)
    near = replace(problem, reference_length=problem.length * np.array([1.0, 1.3, 1.8, 1.0]))
    assert_agreement(near, NOMINAL, Solved(near, NOMINAL))
    assert Solved(near, NOMINAL).deflection > Solved(problem, NOMINAL).deflection  # ends yield more


@pytest.mark.law
@given(problem=problems, load=loads)
def test_two_solvers_agree(problem, load):
    solved = Solved(problem, load)
    assert_agreement(problem, load, solved)
    assert solved.iterations <= 40


@pytest.mark.law
@settings(max_examples=6)
@given(seed=st.integers(0, 2**32 - 1), kind=kinds, twins=st.booleans(), arms=st.booleans(), load=loads)
def test_two_solvers_agree_on_sixty_contacts(seed, kind, twins, arms, load):
    problem = random_problem(seed, 60, kind, "mixed", twins, arms)
    assert_agreement(problem, load, Solved(problem, load))


def test_a_handful_of_iterations():
    # of a cold start on the nasty problems
    kinds_of = ("smooth", "dense", "singular", "body")
    counts = [
        Solved(random_problem(seed, 12, kinds_of[seed % 4], "mixed", False, True), NOMINAL).iterations
        for seed in range(200)
    ]
    assert np.mean(counts) < 9.0
    assert max(counts) <= 24


@pytest.mark.law
@given(seed=st.integers(0, 2**32 - 1), kind=kinds, arms=st.booleans(), load=loads, slices=st.integers(1, 5))
def test_contacts_that_press_on_few_slices(seed, kind, arms, load, slices):
    # what moves the contacts is a curve through the slices: the same problem as with the whole compliance
    problem = random_problem(seed, 12, kind, "mixed", False, arms)
    blend = np.random.default_rng(seed).normal(0.3, 0.5, (12, slices))
    bodies = compliance(np.random.default_rng(seed + 1), "body", slices)
    whole = replace(problem, compliance=blend @ bodies @ blend.T)
    gap = Gap(*vars(problem.gap_about).values())
    law = local_law(gap_table(gap), problem.width, problem.modulus, problem.length)
    point = PointProblem(
        bodies,
        *untilted(slices),
        blend,
        np.zeros(12, dtype=int),
        problem.gap,
        problem.motion_arm,
        problem.torque_arm,
        law,
    )
    force, residual = np.zeros(12), np.zeros(4)
    deflection, _, status, *_ = solve_point(point, load, force, residual)
    assert status == CONVERGED
    answer = solve(whole, load)
    assert answer.violation < 1e-11, "the oracle itself must solve the problem"
    # a strip that two edges hold is exact to 1e-9 in either
    assert deflection == pytest.approx(answer.deflection, rel=1e-8, abs=0.0)
    assert np.all(residual < 1e-9)


@given(problem=problems, load=loads, seed=st.integers(0, 2**32 - 1))
def test_the_start_does_not_matter(problem, load, seed):
    start = load * np.random.default_rng(seed).uniform(-1.0, 1.0, problem.gap.size)
    cold, warm = Solved(problem, load), Solved(problem, load, start)
    assert warm.status == CONVERGED
    assert warm.deflection == pytest.approx(cold.deflection, rel=1e-12, abs=0.0)


@given(problem=problems, load=loads, factor=st.floats(1.0 + 1e-6, 10.0))
def test_deflection_grows_with_load(problem, load, factor):
    assert Solved(problem, factor * load).deflection > Solved(problem, load).deflection


@given(problem=problems, load=loads)
def test_tangent_is_the_derivative_in_load(problem, load):
    # touch is subtracted from the gaps, or a wide gap would swallow the digits of the difference
    touch = np.min(problem.gap / problem.motion_arm)
    near = replace(problem, gap=problem.gap - touch * problem.motion_arm)
    step = 1e-5
    lower, here, upper = (Solved(near, load * factor) for factor in (1.0 - step, 1.0, 1.0 + step))
    secants = (
        (here.deflection - lower.deflection) / (step * load),
        (upper.deflection - here.deflection) / (step * load),
    )
    # between the two one-sided slopes: a contact may come in just here
    assert min(secants) * (1.0 - 1e-3) <= here.tangent <= max(secants) * (1.0 + 1e-3)


@given(problem=problems, load=loads, offset=st.floats(-1e-3, 1e-3))
def test_rigid_offset_is_added(problem, load, offset):
    solved = Solved(problem, load)
    shifted = Solved(replace(problem, gap=problem.gap + offset * problem.motion_arm), load)
    assert shifted.deflection == pytest.approx(solved.deflection + offset, rel=1e-12, abs=1e-15)
    assert shifted.tangent == pytest.approx(solved.tangent, rel=1e-6, abs=0.0)


@given(problem=problems, load=loads, scale=st.floats(0.01, 100.0))
def test_lengths_scale_and_forces_scale_with_their_square(problem, load, scale):
    names, here = ("gap", "width", "length", "reference_length"), problem.gap_about
    larger = replace(
        problem,
        compliance=problem.compliance / scale,
        gap_about=GapAbout(
            here.slope, here.curvature / scale, here.low * scale, here.high * scale,
            here.coordinate * scale, here.jump, here.bend / scale,
        ),
        **{name: scale * getattr(problem, name) for name in names},
    )  # fmt: skip
    solved, scaled = Solved(problem, load), Solved(larger, scale**2 * load)
    assert scaled.deflection == pytest.approx(scale * solved.deflection, rel=1e-10, abs=0.0)
    assert scaled.force == pytest.approx(scale**2 * solved.force, abs=1e-8 * scale**2 * load)


@given(problem=problems, load=loads, seed=st.integers(0, 2**32 - 1))
def test_the_order_of_contacts_does_not_matter(problem, load, seed):
    order = np.random.default_rng(seed).permutation(problem.gap.size)
    assert Solved(picked(problem, order), load).deflection == pytest.approx(
        Solved(problem, load).deflection, rel=1e-12, abs=0.0
    )


@given(problem=problems, load=loads)
def test_a_contact_out_of_reach_changes_nothing(problem, load):
    # one more candidate whose gap is infinite, coupled to the others or not
    n = problem.gap.size
    wider = np.zeros((n + 1, n + 1))
    wider[:n, :n] = problem.compliance
    more = picked(problem, np.append(np.arange(n), 0))
    more = replace(more, compliance=wider, gap=np.append(problem.gap, np.inf))
    solved = Solved(more, load)
    assert solved.force[-1] == 0.0
    assert solved.deflection == pytest.approx(Solved(problem, load).deflection, rel=1e-14, abs=0.0)
