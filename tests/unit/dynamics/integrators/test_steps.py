"""Steps of the integrators: tableaus, step control, choice of method, blocks, and the filter of samples."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, square_wave_table

from dynamics import Integration, Outputs, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, march, static_equilibrium
from dynamics.integrators import tableaus as t
from dynamics.integrators.advance import Control, next_level
from dynamics.integrators.method_choice import EVALUATIONS, LIMIT, choose_method
from dynamics.integrators.start_value import Trail
from dynamics.integrators.workspace import Count, Power, geometric_steps
from dynamics.motion.observation import observe
from dynamics.results.histories import filtered

# Order conditions of the Runge-Kutta methods (Butcher), and the implicit method's stability at infinity.


METHODS = {
    "implicit": (t.IMPLICIT_STAGES, t.IMPLICIT_NODES, t.IMPLICIT_WEIGHTS, t.IMPLICIT_EMBEDDED, 4, 3),
    "explicit": (t.EXPLICIT_STAGES, t.EXPLICIT_NODES, t.EXPLICIT_WEIGHTS, t.EXPLICIT_EMBEDDED, 5, 4),
}


def trees(a, c):
    """(order, elementary weight vector, 1/density) of all rooted trees up to order 5."""
    one = np.ones_like(c)
    ac, ac2, ac3, aac = a @ c, a @ c**2, a @ c**3, a @ (a @ c)
    return [
        (1, one, 1.0),
        (2, c, 1 / 2),
        (3, c**2, 1 / 3),
        (3, ac, 1 / 6),
        (4, c**3, 1 / 4),
        (4, c * ac, 1 / 8),
        (4, ac2, 1 / 12),
        (4, aac, 1 / 24),
        (5, c**4, 1 / 5),
        (5, c**2 * ac, 1 / 10),
        (5, c * ac2, 1 / 15),
        (5, c * aac, 1 / 30),
        (5, ac**2, 1 / 20),
        (5, ac3, 1 / 20),
        (5, a @ (c * ac), 1 / 40),
        (5, a @ ac2, 1 / 60),
        (5, a @ aac, 1 / 120),
    ]


@pytest.mark.parametrize("name", METHODS)
def test_order_conditions(name):
    a, c, weights, embedded, order, embedded_order = METHODS[name]
    np.testing.assert_allclose(a.sum(axis=1), c, atol=1e-14)
    for b, upto in ((weights, order), (embedded, embedded_order)):
        residual = {n: max(abs(b @ w - d) for k, w, d in trees(a, c) if k == n) for n in range(1, upto + 1)}
        assert max(residual.values()) < 1e-13
        if upto < 5:  # and no higher: otherwise the error estimate would vanish
            assert max(abs(b @ w - d) for k, w, d in trees(a, c) if k == upto + 1) > 1e-5


@pytest.mark.parametrize("name", METHODS)
def test_the_last_stage_is_the_end_of_the_step(name):
    a, c, weights, *_ = METHODS[name]
    np.testing.assert_array_equal(a[-1], weights)
    assert c[-1] == 1.0


def test_the_implicit_method_is_l_stable():
    a, b = t.IMPLICIT_STAGES, t.IMPLICIT_WEIGHTS

    def growth(z):
        return 1.0 + z * (b @ np.linalg.solve(np.eye(6) - z * a, np.ones(6)))

    for frequency in np.geomspace(1e-2, 1e4, 200):
        assert abs(growth(1j * frequency)) <= 1.0 + 1e-12
    assert abs(growth(-1e9)) < 1e-6
    np.testing.assert_array_equal(np.diag(a)[1:], t.IMPLICIT_DIAGONAL)


# The step levels are left by a rejected step of the smallest size alone.


STEP_SIZES = geometric_steps(1e-3, 1e-8)
SMALLEST = STEP_SIZES.size - 2  # behind it the step that lands on a law's knot
CONTROL = Control(True, True, False, 3, 1e-9, 1e-4, 100)


def test_columns_that_loops_name_are_integers():
    """Members of an enumeration are integers too, but no index to numba before 0.68."""
    for columns in (Power, Count):
        assert columns == tuple(range(len(columns)))
        assert {type(column) for column in columns} == {int}


def after(level: int, error: float, accepted: bool, last: float = 1e-4) -> int:
    counts = np.zeros(len(Count), dtype=np.int64)
    counts[Count.LEVEL] = level
    work = SimpleNamespace(step_sizes=STEP_SIZES, counts=counts, error=np.array([last]))
    return next_level.py_func(work, CONTROL, error, accepted)


@pytest.mark.parametrize("error", [0.0, 1e-6, 0.5, 1.0])
@pytest.mark.parametrize("last", [1e-4, 1.0])
def test_an_accepted_step_has_a_step_size(error, last):
    """At the smallest a step just within the tolerance requires a smaller one, which is not there."""
    for level in (0, 5, SMALLEST - 1, SMALLEST):
        assert 0 <= after(level, error, True, last) <= SMALLEST


@pytest.mark.parametrize("error", [1.0001, 1e3, 1e10])
def test_a_rejected_step_falls_by_a_level_at_least_and_one_below_the_smallest_at_most(error):
    for level in (0, 5, SMALLEST - 1, SMALLEST):
        assert level < after(level, error, False) <= SMALLEST + 1


# The choice of the method: explicit where accuracy sets the step, implicit where stability would.


SCENE = replace(gear_pair_scene(duration=0.05), effects={"lateral": "on", "tilt": "on"})


def on_stiff_bushings():
    """The pair on bushings whose motions are a hundred times faster than that of the mesh."""
    bushings = tuple(
        replace(bushing, radial_stiffness=1e4 * bushing.radial_stiffness) for bushing in SCENE.bushings
    )
    return replace(SCENE, bushings=bushings)


def choice(scene, **integration):
    system = assemble(scene)
    start = static_equilibrium(system)
    return choose_method(system, start.displacement, replace(scene.integration, **integration))


def evaluations(scene, method):
    """Evaluations of the laws over a run."""
    system = assemble(scene)
    run = integrate(system, static_equilibrium(system), replace(scene.integration, method=method))
    return EVALUATIONS[method] * int(run.count[Count.ACCEPTED] + run.count[Count.REJECTED])


@pytest.mark.parametrize("scene", [SCENE, on_stiff_bushings()], ids=["accuracy", "stability"])
def test_the_method_chosen_takes_fewer_evaluations(scene):
    chosen = choice(scene)
    costs = {method: evaluations(scene, method) for method in EVALUATIONS}
    assert costs[chosen.method] < costs[chosen.other]


def test_stiff_bushings_ask_for_the_implicit_method():
    assert choice(SCENE).method == "explicit"
    assert choice(on_stiff_bushings()).method == "implicit"


def test_a_fixed_step_is_what_stability_is_asked_for():
    rate = choice(SCENE).rate
    assert choice(SCENE, fixed_step=0.9 * LIMIT / rate).method == "explicit"
    assert choice(SCENE, fixed_step=1.1 * LIMIT / rate).method == "implicit"


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_a_method_that_is_stated_is_taken(method):
    for scene in (SCENE, on_stiff_bushings()):
        assert choice(scene, method=method).method == method


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_the_receipt_predicts_what_the_other_method_costs(method):
    run = simulate(replace(SCENE, integration=Integration(method)))
    said = run.receipt["method"]
    assert (said["used"], said["requested"]) == (method, method)
    predicted = said["other_seconds_predicted"] / run.receipt["seconds"]["integration"]
    actual = evaluations(SCENE, said["other"]) / evaluations(SCENE, method)
    assert predicted == pytest.approx(actual, rel=0.3)


def test_auto_runs_as_the_method_it_names():
    by_default = simulate(SCENE)
    said = by_default.receipt["method"]
    assert said["requested"] == "auto"
    assert said["rate_times_step"] <= said["explicit_up_to"]
    stated = simulate(replace(SCENE, integration=choice(SCENE).settings(SCENE.integration)))
    np.testing.assert_array_equal(by_default.mesh_force, stated.mesh_force)


# Blocks of a run: between them the interpreter looks at it.


def test_blocks_leave_every_sample_as_it_is(monkeypatch):
    system = assemble(gear_pair_scene(spring_table(4e8), duration=0.02))
    start, settings = static_equilibrium(system), system.scene.integration
    runs, early = [], []
    for work in (0, march.BLOCK_WORK):
        monkeypatch.setattr(march, "BLOCK_WORK", work)
        trail = Trail(system)
        runs.append(integrate(system, start, settings, trail=trail))
        early.append(trail.before(0.5 * system.scene.duration) is not None)
    for name in ("q", "v", "work", "stored"):
        np.testing.assert_array_equal(getattr(runs[0], name), getattr(runs[1], name))
    assert early == [True, False]


def test_whoever_waits_is_told_fifty_times():
    system = assemble(gear_pair_scene(spring_table(4e8), duration=0.02))
    seen: list[float] = []
    integrate(
        system,
        static_equilibrium(system),
        system.scene.integration,
        progress=lambda fraction, _: seen.append(fraction),
    )
    assert len(seen) >= 0.9 * march.CHUNKS


# What a run stores is its points on the inner grid behind the filter's taps.


RATE = 30e3


@pytest.fixture(scope="module")
def made():
    scene = gear_pair_scene(square_wave_table(), speed=TimeLaw.constant(3000.0 * RPM))
    return assemble(replace(scene, duration=0.02, outputs=Outputs(RATE, energy_audit=False)))


@pytest.fixture(scope="module")
def stored(made):
    return integrate(made, static_equilibrium(made), made.scene.integration)


@pytest.fixture(scope="module")
def points(made):
    """Every point of the inner grid: the steps do not know how they are sampled."""
    every = replace(made.sampling, rate=made.sampling.inner_rate, stop_band=0.0, taps=3)
    return integrate(replace(made, sampling=every), static_equilibrium(made), made.scene.integration)


def behind_the_filter(sampling, values):
    """Every output sample of the values (T, c) on the inner grid that the whole filter sees."""
    taps, half = sampling.filter_taps(), sampling.taps // 2
    whole = np.stack([np.convolve(column, taps, mode="valid") for column in values.T], axis=-1)
    first = -half % sampling.factor
    return whole[first :: sampling.factor], (half + first) // sampling.factor


def test_channels_are_points_behind_the_filter(made, stored, points):
    steps = Count.ACCEPTED, Count.REJECTED
    assert [stored.count[k] for k in steps] == [points.count[k] for k in steps]
    expected, first = behind_the_filter(made.sampling, points.states.filtered)
    ours = stored.states.filtered[first : first + expected.shape[0]]
    scale = np.max(np.abs(expected), axis=0)
    assert expected.shape[0] > 400
    assert np.max(np.abs(ours - expected) / np.where(scale > 0.0, scale, 1.0)) < 1e-12


def test_local_coordinates_follow_from_the_filtered_state(made, stored, points):
    """Transmission errors are not filtered by themselves: they are linear in displacements that are."""
    seen = observe(made.arrays, points.time, points.q, points.v, points.states.quanta)
    expected, first = behind_the_filter(made.sampling, seen.coordinate.T)
    there = observe(made.arrays, stored.time, stored.q, stored.v, stored.states.quanta)
    ours = filtered(made, stored.states, there).coordinate.T[first : first + expected.shape[0]]
    assert np.ptp(expected[:, 0]) > 1e-7
    assert np.max(np.abs(ours - expected)) < 1e-12 * np.max(np.abs(expected))


def test_what_the_filter_takes_away_is_what_it_leaves_of_the_points(made, stored, points):
    factor = made.sampling.factor
    removed = points.states.filtered[::factor, 0][: stored.time.size] - stored.states.filtered[:, 0]
    assert stored.figures.removed[0] == pytest.approx(np.sqrt(np.mean(removed**2)), rel=1e-9)
