"""Motion over time: steady states, transients against an integrator, rigid motions, a run's own housing."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table
from reduced_housings import PAIR, PER_SEAT, random_housing
from scipy.integrate import solve_ivp

from dynamics import Outputs, simulate
from dynamics.errors import InputError
from dynamics.housings import scene_housing
from dynamics.mechanism.bodies import modal_housing
from dynamics.vibration import MotionQuantity, housing_motion, motion_pieces, point_signal, run_seat_forces

RATE = 20e3
ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
MOTIONS = tuple(MotionQuantity)


def settled(housing, hertz, count=10000, cycles=40):
    """Amplitude of the points' displacement in the last cycles under a sine on all seats, and its force."""
    force = np.random.default_rng(5).normal(size=housing.motions) * 100.0
    time = np.arange(count) / RATE
    signal = point_signal(housing, time, np.outer(np.sin(2 * np.pi * hertz * time), force), None, MOTIONS[0])
    last = slice(count - round(cycles * RATE / hertz), None)
    wave = np.exp(-2j * np.pi * hertz * time[last])
    return 2j * np.mean(signal[last] * wave[:, None, None], axis=0), force


def exact(housing, hertz, force):
    motion = housing_motion(housing, np.array([hertz]), force[None] + 0j)[0]
    return np.stack([point.motion @ motion for point in housing.points])


def spline_gain(hertz):
    """Of a harmonic in the cubic spline through its samples."""
    return np.sinc(hertz / RATE) ** 4 * 3.0 / (2.0 + np.cos(2.0 * np.pi * hertz / RATE))


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize(("hertz", "stated"), [(1000.0, 1.4e-5), (2000.0, 2.2e-4), (5000.0, 1.5e-2)])
def test_a_harmonic_force_settles_to_the_steady_state_within_the_stated_error(coupled, hertz, stated):
    housing = random_housing(coupled=coupled)
    found, force = settled(housing, hertz)
    right = exact(housing, hertz, force)
    assert abs(spline_gain(hertz) - 1.0) == pytest.approx(stated, rel=0.1)
    images = [hertz + k * RATE for k in range(-40, 41)]
    gains = [spline_gain(hertz) * (hertz / image) ** 4 for image in images]
    carried = sum(
        gain * (exact(housing, image, force) if image > 0 else exact(housing, -image, force).conj())
        for gain, image in zip(gains, images, strict=True)
    )
    scale = np.abs(right).max()
    assert np.abs(found - carried).max() < 1e-6 * scale
    assert np.abs(found - right).max() < 1.3 * stated * scale


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize("quantity", MOTIONS)
def test_a_transient_is_that_of_a_direct_integration(quantity, coupled):
    housing = random_housing(coupled=coupled)
    time = np.arange(200) / RATE
    shape = np.random.default_rng(6).normal(size=(2, housing.motions)) * 100.0

    def force(t):
        return np.cos(2 * np.pi * 300.0 * t) * shape[0] + t / 0.01 * shape[1]

    found = point_signal(housing, time, np.array([force(t) for t in time]), ("b",), quantity)[:, 0]
    inverse, size = np.linalg.inv(housing.mass), len(housing.mass)
    padded = np.zeros(size - housing.motions)

    def rate(t, state):
        load = np.concatenate([force(t), padded])
        moved, moving = state[:size], state[size:]
        pull = load - housing.stiffness @ moved - housing.damping @ moving
        return np.concatenate([moving, inverse @ pull])

    start = np.linalg.solve(housing.stiffness, np.concatenate([force(0.0), padded]))
    state = np.concatenate([start, np.zeros(size)])
    path = solve_ivp(rate, (0.0, time[-1]), state, "DOP853", time, rtol=1e-9, atol=1e-14).y
    every = np.array([rate(t, column) for t, column in zip(time, path.T, strict=True)]).T
    whole = (path[:size], path[size:], every[size:])[quantity.rate]
    expected = (housing.points[1].motion @ whole).T
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-5 * np.abs(expected).max())


def test_a_loose_housing_accelerates_by_its_mass():
    housing = random_housing()
    loose = replace(housing, stiffness=np.zeros_like(housing.mass), damping=np.zeros_like(housing.mass))
    time = np.arange(5000) / RATE  # more than one piece of states
    force = np.random.default_rng(7).normal(size=housing.motions)
    signals = [point_signal(loose, time, np.tile(force, (time.size, 1)), ("a",), q) for q in MOTIONS]
    whole = np.concatenate([force, np.zeros(len(housing.mass) - force.size)])
    pull = housing.points[0].motion @ np.linalg.solve(housing.mass, whole)
    for signal, powers in zip(signals, (0.5 * time**2, time, np.ones_like(time)), strict=True):
        expected = np.outer(powers, pull)
        np.testing.assert_allclose(signal[:, 0], expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


def test_motions_of_forces_add_up():
    housing = random_housing()
    time = np.arange(300) / RATE
    first, second = np.random.default_rng(8).normal(size=(2, time.size, housing.motions))
    both = point_signal(housing, time, first - 3.0 * second)
    parts = point_signal(housing, time, first) - 3.0 * point_signal(housing, time, second)
    np.testing.assert_allclose(both, parts, rtol=0.0, atol=1e-9 * np.abs(both).max())


def test_forces_of_a_run_move_the_housing_as_the_run_does():
    housing = random_housing()
    part = replace(scene_housing(housing, "case"), seat_positions=None)
    scene = gear_pair_scene(square_wave_table(), effects=ON)
    outputs = Outputs(sample_rate=4.0 * RATE, displacements=True, anti_alias=False)
    run = simulate(replace(scene, housings=(part,), duration=0.02, outputs=outputs))
    modal = modal_housing(part)
    rate = run.velocity[[run.freedom.index(f"case.{kind}") for kind in modal.kinds]]
    turn = np.kron(np.eye(2), housing.seats[1].axes.T)[:PER_SEAT, :PER_SEAT]
    expected = (turn @ modal.seat(PAIR[1]) @ rate)[:3].T
    seat = np.eye(len(housing.mass))[PER_SEAT : PER_SEAT + 3]
    found = np.concatenate(list(motion_pieces(housing, run.time, run_seat_forces(run, housing), seat)))
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=2e-3 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"time": np.array([0.0, 1.0, 3.0])}, "uniform grid"),
        ({"time": np.zeros(3)}, "uniform grid"),
        ({"time": np.array([0.0])}, "at least two samples"),
        ({"force": np.zeros((3, 2))}, "force"),
        ({"force": np.full((3, 20), np.nan)}, "finite"),
        ({"points": ("c",)}, "one of a, b"),
    ],
)
def test_what_is_asked_without_sense_is_refused(changes, words):
    given = {"time": np.arange(3.0), "force": np.zeros((3, 20)), **changes}
    with pytest.raises(InputError, match=words):
        point_signal(random_housing(), **given)
