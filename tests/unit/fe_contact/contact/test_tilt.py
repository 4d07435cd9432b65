"""Flanks that tilt under load: how compliance changes along the flank, and the energy it belongs to."""

import math
from dataclasses import replace

import numpy as np
import pytest
from compliance_gears import coarse_plane

from fe_contact import Gear, GearPair, Status
from fe_contact.compliance import flank_compliances
from fe_contact.contact import (
    ContactModel,
    ContactProblem,
    PatchRule,
    Slices,
    contact_candidates,
    contact_problem,
    solve_contact,
)
from fe_contact.contact.assembly import _tooth_blocks
from fe_contact.contact.edge_strip import SIDE, edge_motion, edge_position
from fe_contact.contact.newton import solve_point
from fe_contact.contact.point_problem import PointProblem, State, point_problems, problem_at
from fe_contact.contact.tilted_bodies import fill_yielding, move

MODULE = 3e-3
SHAPE = {"normal_module": MODULE, "face_width": 20e-3}
PAIR = GearPair(
    Gear(teeth=25, bore_diameter=30e-3, **SHAPE), Gear(teeth=35, bore_diameter=40e-3, **SHAPE), 90e-3
)
POSITION = np.array([0.1, 0.45])
LOADS = np.array([300.0, 3000.0, 9000.0])


@pytest.fixture(scope="module")
def bodies():
    gears = (PAIR.pinion, PAIR.wheel)
    return flank_compliances(gears, [coarse_plane(gear) for gear in gears])


@pytest.fixture(scope="module")
def problem(bodies):
    rule = PatchRule(0.25 * MODULE, 0.02 * MODULE, 1e-6)
    plain = contact_candidates(
        PAIR, ContactModel(corner_contact=True), POSITION, rule, Slices.of_pair(PAIR, 1)
    )
    return contact_problem(plain, bodies)


def test_teeth_without_candidates_leave_the_compliance_to_the_last_bit(problem, bodies):
    """It is read in place: the condensed flanks are not copied."""
    fewer = []
    for flank in bodies:
        k, last = flank.s.size, flank.teeth.size - 1
        used = np.abs(flank.teeth) <= 1
        part = flank.matrix.reshape(last + 1, k, last + 1, k)[used][:, :, used]
        size = k * np.count_nonzero(used)
        fewer.append(replace(flank, teeth=flank.teeth[used], matrix=part.reshape(size, size).copy()))
        blocks, rows = _tooth_blocks(flank, np.array([1, 0, -1]))
        assert np.shares_memory(blocks, flank.matrix) and flank.teeth[rows].tolist() == [1, 0, -1]
    other = contact_problem(problem.candidates, tuple(fewer))
    np.testing.assert_array_equal(other.compliance, problem.compliance)
    np.testing.assert_array_equal(other.tilt, problem.tilt)


def displaced(problem: ContactProblem, bodies, ways: np.ndarray) -> np.ndarray:
    """The compliance assembled with the patches of every pair moved so far towards tip 1."""
    slices = problem.candidates.slices
    first = replace(slices.patch_1, center=slices.patch_1.center + ways)
    second = replace(slices.patch_2, center=slices.patch_2.center - ways)
    moved = replace(problem.candidates, slices=replace(slices, patch_1=first, patch_2=second))
    return contact_problem(moved, bodies).compliance


def test_what_pressure_and_deflection_ask_of_the_bodies_is_computed_once(problem):
    kept = problem.bodies.copy()
    problem.displacement(np.ones((POSITION.size, 1, problem.candidates.pair.size)))
    assert problem.bodies is problem.bodies
    assert np.array_equal(problem.bodies, kept)


def test_compliance_changes_along_the_flank_as_its_tilt_says_to_second_order(problem, bodies):
    inside = (problem.candidates.slices.patch_1.edge_share == 0.0) & (
        problem.candidates.slices.patch_2.edge_share == 0.0
    )
    ways = np.where(inside, np.random.default_rng(3).uniform(-1.0, 1.0, inside.shape), 0.0)
    assert (inside.sum(axis=1) > 1).any()
    change = ways[:, :, None] * problem.tilt
    change = change + np.swapaxes(change, 1, 2)
    left = []
    for step in (4e-5, 2e-5):
        found = displaced(problem, bodies, step * ways)
        left.append(np.abs(found - problem.compliance - step * change).max())
        assert left[-1] < 0.1 * step * np.abs(change).max()
    assert left[1] < 0.4 * left[0]  # a quarter is that of the square


@pytest.mark.law
def test_compliance_changes_at_edges_as_patches_grow_from_them_less_the_logarithm_of_the_law(problem, bodies):
    """To third order, as other patches grow too."""
    slices = problem.candidates.slices
    first, second, side = slices.patch_1, slices.patch_2, slices.edge_side
    planes = np.where(side < 0.0, *problem.half_planes)
    distance = np.where(side < 0.0, first.edge_distance, second.edge_distance)
    for p, i in zip(*np.nonzero(side), strict=True):
        only = np.zeros(side.shape)
        only[p, i] = 1.0
        ends = []
        for part in (0.25, -0.25):
            one, other = (
                replace(
                    patch,
                    center=np.where(only, longer.center, patch.center),
                    half_width=np.where(only, longer.half_width, patch.half_width),
                )
                for patch, longer in (
                    (first, first.stretched(part, second)),
                    (second, second.stretched(part, first)),
                )
            )
            moved = replace(problem.candidates, slices=replace(slices, patch_1=one, patch_2=other))
            ends.append(contact_problem(moved, bodies).compliance[p, i])
        change = side[p, i] * (ends[0] - ends[1]) / (0.5 * distance[p, i])
        logarithm = math.log(1.25 / 0.75) / (0.5 * distance[p, i])
        change[i] += side[p, i] * planes[p, i] * logarithm / slices.width
        change[i] *= 0.5
        assert problem.tilt[p, i] == pytest.approx(change, rel=1e-3, abs=0.02 * np.abs(change).max())
    assert (side > 0.0).any() or (side < 0.0).any()


def test_the_compliance_of_modified_flanks_is_that_of_patches_displaced_to_them(problem, bodies):
    slices = problem.candidates.slices
    ways = np.where((slices.patch_1.edge_share + slices.patch_2.edge_share) == 0.0, 3e-5, 0.0)
    touch = replace(problem.candidates.touch, shift=ways)
    found = problem.touching(problem.candidates.touching(touch)).bodies - problem.bodies
    exact = displaced(problem, bodies, ways) - problem.compliance
    assert np.abs(found - exact).max() < 0.05 * np.abs(exact).max()
    assert np.array_equal(found, np.swapaxes(found, 1, 2))


def tilted(problem: ContactProblem) -> PointProblem:
    """Bodies that tilt a lot, at one contact on flanks so flat that it moves as far as it may."""
    point, _ = problem_at(point_problems(problem), 0)
    n, rng = len(point.bodies), np.random.default_rng(5)
    radius = np.where(np.arange(n) == 2, 0.5, 6e-3)
    gap = 2e-6 * rng.uniform(size=n)
    return point._replace(tilt=2e-6 * rng.normal(size=(n, n)), radius=radius, gap=gap)


def energy(problem: PointProblem, held: np.ndarray) -> float:
    """h'K h/2, what is least of the tilted gaps, from samples of the place, and that of strips at edges."""
    tilt = problem.tilt @ held
    y = np.linspace(-problem.law.length, problem.law.length, 1_000_001)[:, None]
    minimum = (y * tilt + 0.5 * y**2 / problem.radius).min(axis=0)
    at_edges = 0.0
    for j in np.flatnonzero(problem.edge[:, SIDE]):
        side, offset, radius, softness, patch, *_ = problem.edge[j]
        place = edge_position(offset - 0.5 * radius * side * tilt[j], radius, softness, held[j])[0]
        forces = held[j] * (np.arange(2000) + 0.5) / 2000.0
        corner = np.mean([edge_motion(problem.edge, j, force, 0.0).corner for force in forces])
        at_edges += held[j] * (side * tilt[j] * (place - patch) + corner)
        minimum[j] = 0.0
    return float(0.5 * held @ problem.bodies @ held + held @ minimum + at_edges)


def state_of(problem: PointProblem, held: np.ndarray) -> State:
    n = held.size
    state = State(held, np.zeros(n), np.zeros((n, n)), np.zeros(n), np.zeros(n), np.zeros(n))
    move(problem, state)
    fill_yielding(problem, state)
    return state


@pytest.mark.law
def test_motions_are_the_gradient_of_one_energy_and_yield_as_its_second_derivative(problem):
    point = tilted(problem)
    n = len(point.bodies)
    forces = np.linspace(2000.0, 800.0, n)
    here = state_of(point, forces)
    assert point.edge[:, SIDE].any()
    far = np.abs(point.tilt @ forces * point.radius) > point.law.length
    assert far.tolist() == [k == 2 for k in range(n)]
    for j, one in enumerate(np.eye(n)):
        ends = [energy(point, forces + way * one) for way in (1.0, -1.0)]
        assert here.displacement[j] == pytest.approx(0.5 * (ends[0] - ends[1]), rel=1e-4)
        moved = [state_of(point, forces + way * one).displacement for way in (1e-2, -1e-2)]
        assert here.yielding[j] == pytest.approx((moved[0] - moved[1]) / 2e-2, rel=1e-5, abs=1e-14)
    assert here.yielding == pytest.approx(here.yielding.T, rel=1e-12)
    assert not np.allclose(here.yielding, point.bodies, rtol=1e-2, atol=0.0)


def test_the_tangent_is_the_change_of_the_deflection_with_the_load(problem):
    point, total = tilted(problem), 4000.0
    point = point._replace(radius=np.full(len(point.bodies), 6e-3))

    def solve(load, point=point):
        residual, force = np.zeros(4), np.zeros(point.gap.size)
        deflection, tangent, status, *_ = solve_point(point, load, force, residual)
        assert status == Status.CONVERGED
        assert residual.max() < 1e-9
        return deflection, tangent

    deflection, tangent = solve(total)
    difference = (solve(total + 0.1)[0] - solve(total - 0.1)[0]) / 0.2
    assert tangent == pytest.approx(difference, rel=1e-6)
    straight = solve(total, point._replace(tilt=0.0 * point.tilt))[0]
    assert straight - deflection > 1e-3 * straight  # flanks that roll give way more easily


def test_without_tilt_nothing_rolls(problem):
    straight = replace(problem, tilt=0.0 * problem.tilt)
    modified = replace(problem.candidates.touch, shift=np.full(problem.candidates.touch.gap.shape, 5e-5))
    elsewhere = straight.touching(problem.candidates.touching(modified))
    found, expected = solve_contact(elsewhere, LOADS), solve_contact(straight, LOADS)
    assert np.array_equal(found.deflection, expected.deflection)
    tilts = solve_contact(problem, LOADS)
    assert (tilts.deflection < expected.deflection).all()
    assert np.abs(tilts.deflection / expected.deflection - 1.0).max() < 2e-3
    moved = problem.displacement(tilts.force)
    closer = problem.candidates.motion_arm[:, None] * (
        tilts.deflection[..., None] - problem.candidates.gap[:, None]
    )
    carried = tilts.force > 0.0
    assert carried.any()
    assert (closer - moved)[carried].min() > 0.0
    assert (closer - moved)[~carried & np.isfinite(closer)].max() < 0.0
