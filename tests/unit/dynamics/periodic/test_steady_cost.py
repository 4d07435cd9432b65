"""What steady states cost before they are looked for: the periods counted are those that are integrated."""

from collections import Counter
from functools import partial

import numpy as np
import pytest
from backlash_oscillator import oscillator
from geared_scenes import RPM, gear_pair_scene, spring_table, with_bushings, with_mesh

from dynamics.assembly.assemble import assemble
from dynamics.periodic import continuation, find_orbit, follow_branch, periodic_problem, steady_states
from dynamics.periodic.period_map import PeriodMap
from dynamics.periodic.steady_cost import (
    expected_iterations,
    motion_periods,
    period_seconds,
    point_periods,
    steady_cost,
    steps_share,
)

SPEEDS = np.array([600.0, 750.0, 900.0]) * RPM
SETTLING, USUAL = 5, 64


@pytest.fixture
def pair():
    return assemble(with_bushings(gear_pair_scene(spring_table(4e8, 1e-7))))


@pytest.fixture
def marched(monkeypatch):
    steps, whole = Counter(), PeriodMap._one_period

    def counted(self, y, path, part=None):
        if part is None:
            steps[float(self.speed)] += self.problem.grid.level.size
        return whole(self, y, path, part)

    monkeypatch.setattr(PeriodMap, "_one_period", counted)
    return steps


@pytest.mark.parametrize("repeat", [1, 2])
def test_the_periods_of_sweeps_are_those_counted(pair, marched, repeat):
    states = steady_states(pair, SPEEDS, branch=False, repeat=repeat, periods=SETTLING)
    problem = periodic_problem(pair, SPEEDS[0], repeat)
    n = problem.rest.size // 2
    series = 1  # of a motion that was found its figures are taken from one more
    periods = [motion_periods(n, SETTLING, int(own)) + series for own in states.iterations]
    steps = [repeat * problem.at(speed).grid.level.size for speed in states.speed]
    assert np.all(states.status == 0)
    assert marched.total() == np.dot(periods, steps)
    expected = steps_share(problem, SPEEDS) * repeat * problem.grid.level.size
    assert np.mean(steps) == pytest.approx(expected, rel=1e-12)


def test_the_periods_of_a_branch_are_those_counted(pair, marched, monkeypatch):
    problem = periodic_problem(pair, SPEEDS[0])
    n, steps = problem.rest.size // 2, problem.grid.level.size
    start = find_orbit(problem, SPEEDS[0])
    derived, jacobian = [], continuation._jacobian
    monkeypatch.setattr(continuation, "_jacobian", lambda *args: derived.append(1) or jacobian(*args))
    marched.clear()
    branch = follow_branch(problem, SPEEDS[0], SPEEDS[-1], guess=start.state)
    first, *others = (orbit.iterations for orbit in branch.orbits)
    by_speed, again = 2, len(derived) - len(branch.orbits)
    counted = motion_periods(n, 0, first) + by_speed + sum(point_periods(n, own, 1) for own in others)
    assert marched.total() == (counted + again * (4 * n + 2)) * steps


LIGHT = np.linspace(11000.0, 13500.0, 5) * RPM


def parting_pair():
    """The 20/20 pair at 20 N m: its branch has four folds about the resonance near 12 000 rpm."""
    return assemble(with_mesh(gear_pair_scene(torque=20.0), damping_ratio=0.07, damping=None))


@pytest.mark.parametrize(
    ("scene", "speeds"),
    [
        pytest.param(partial(oscillator, 1.0), np.array([0.3, 0.7]) / 20.0, id="in contact"),
        pytest.param(parting_pair, LIGHT, id="around folds"),
        pytest.param(
            partial(oscillator, 1.0), np.array([0.5, 1.0]) / 20.0, id="lifting off", marks=pytest.mark.nightly
        ),
    ],
)
def test_a_branch_has_the_points_announced(scene, speeds, monkeypatch):
    """Within half as many again; where flanks lift off the state changes more than the speed."""
    monkeypatch.setattr("dynamics.periodic.steady_cost.AFFORDED", np.inf)
    start = find_orbit(problem := periodic_problem(system := scene(), speeds[0]), speeds[0])
    branch = follow_branch(problem, speeds[0], speeds[-1], guess=start.state)
    announced = steady_cost(system, speeds, periods=SETTLING).points
    assert 1.0 / 1.5 < announced / len(branch.orbits) < 1.5, (announced, len(branch.orbits))


def test_the_periods_announced_around_folds_are_integrated(marched, monkeypatch):
    """Those of sweeps and branch, within half as many again: folds are searched for between points."""
    monkeypatch.setattr("dynamics.periodic.steady_cost.AFFORDED", np.inf)
    cost = steady_cost(system := parting_pair(), LIGHT, periods=USUAL)
    iterations = expected_iterations(periodic_problem(system, LIGHT[0]), LIGHT[-1], USUAL)
    motions = cost.motions * motion_periods(cost.freedoms, USUAL, iterations)
    announced = motions + cost.points * point_periods(cost.freedoms)
    marched.clear()
    states = steady_states(system, LIGHT, periods=USUAL)
    taken = marched.total() / states.metadata["steps_per_period"]
    assert np.sum(states.bifurcation_kind == 1) > 1
    assert 1.0 / 1.5 < announced / taken < 1.5, (announced, taken, cost)


@pytest.mark.parametrize(("damping", "settling"), [(0.05, 2), (0.05, 64), (0.002, 20), (0.002, 64)])
def test_iterations_are_expected_where_settling_leaves_something(damping, settling):
    """By the mode that is damped least; at most one more than they are, as contact may not be linear."""
    scene = with_bushings(gear_pair_scene(spring_table(4e8, 1e-7)), damping_ratio=damping)
    system = assemble(with_mesh(scene, damping_ratio=2.0 * damping))
    states = steady_states(system, SPEEDS, branch=False, periods=settling)
    problem = periodic_problem(system, SPEEDS[0])
    expected = np.array([expected_iterations(problem, speed, settling) for speed in states.speed])
    assert np.all(states.status == 0)
    assert np.array_equal(expected > 0, states.iterations > 0)
    assert np.all(np.abs(expected - states.iterations) <= 1)


def test_a_prediction_is_linear_in_speeds_settling_and_repetitions(pair, monkeypatch):
    monkeypatch.setattr("dynamics.periodic.steady_cost.period_seconds", lambda problem, _: problem.repeat)
    monkeypatch.setattr("dynamics.periodic.steady_cost.expected_iterations", lambda *_: 2)
    n = periodic_problem(pair, SPEEDS[0]).rest.size // 2
    few = steady_cost(pair, SPEEDS, periods=SETTLING)
    assert few.motions == 2 * SPEEDS.size
    problem, speeds = periodic_problem(pair, SPEEDS[0]), np.linspace(SPEEDS[0], SPEEDS[-1], 30)
    assert few.motion == motion_periods(n, SETTLING, 2) * steps_share(problem, SPEEDS)
    assert few.point == pytest.approx(point_periods(n), rel=0.02)  # beside them maps are laid out
    many = steady_cost(pair, speeds, periods=SETTLING + 7, repeat=3)
    assert many.motions == 60
    assert many.points == few.points
    assert many.motion == 3 * motion_periods(n, SETTLING + 7, 2) * steps_share(problem, speeds)
    assert steady_cost(pair, SPEEDS[:1], periods=SETTLING).motions == 1
    assert steady_cost(pair, SPEEDS, branch=False, periods=SETTLING).points == 0


def test_a_probe_marches_no_whole_period_where_a_part_tells(marched, monkeypatch):
    problem = periodic_problem(oscillator(1.0), 0.05)
    monkeypatch.setattr("dynamics.periodic.steady_cost.ENOUGH", 0.0)
    assert period_seconds(problem, 0.05) > 0.0
    assert marched.total() == 0
