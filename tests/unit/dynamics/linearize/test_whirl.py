"""Whirl, terms of speed, modes left out, and motions that stiffness excites."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import (
    BASE_RADIUS,
    RPM,
    gear_pair_scene,
    repeated,
    spring_table,
    square_wave_table,
    with_mesh,
)
from housed_pair import ON, housed_pair
from planetary_scenes import driven_scene, planetary_scene, published_set
from two_stage_scenes import two_stages

from dynamics import Bushing, Coupling, Inertia, Integration, Outputs, Shaft, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.linearize import (
    harmonic_response,
    linearize,
    natural_modes,
    steady_vibration,
    varying_stiffness,
    whirl_modes,
)
from dynamics.linearize.harmonic_response import extremes
from dynamics.linearize.modal_elimination import modal_elimination
from dynamics.linearize.operating_speeds import law_speeds
from dynamics.linearize.parametric_response import parametric_response
from dynamics.linearize.steady_vibration import excited, gyroscopic_terms, swept_vibration
from dynamics.linearize.whirl_modes import terms_at

# Whirl: closed forms of a disc on bearings, the same from a fixed and from a rotating frame.


SPIN = 300.0  # rad/s
DISC = Inertia(4.0, 0.02, 0.0104)
STIFFNESS, DAMPING, LENGTH = 1e6, 200.0, 0.2
TILT_STIFFNESS = 2.0 * STIFFNESS * (LENGTH / 2.0) ** 2


def disc_scene(frame):
    """A disc on two bearings, turned through a soft coupling, in the fixed or its own rotating frame."""
    scene = gear_pair_scene(
        spring_table(4e8), speed=TimeLaw.constant(SPIN), effects={"tilt": "on", "lateral": "on"}
    )
    disc = Shaft("disc", LENGTH, (0.0, 0.0, 0.4), DISC, frame)
    ends = tuple(Bushing(f"disc.{z}", "disc", z, STIFFNESS, radial_damping=DAMPING) for z in (0.0, LENGTH))
    joint = Coupling("joint", "input", "disc", 100.0)
    return replace(scene, shafts=(*scene.shafts, disc), bushings=(*scene.bushings, *ends), couplings=(joint,))


def of_the_disc(frame, kinds):
    """Frequencies (rad/s) and decay rates (1/s) of the modes of the disc's freedoms `kinds`."""
    modes = whirl_modes(assemble(disc_scene(frame)))
    columns = [modes.freedom.index(f"disc.{kind}") for kind in kinds]
    size = np.abs(modes.shape * modes.scale)
    chosen = np.max(size[:, columns], axis=1) > 0.5 * np.max(size, axis=1)
    omega = 2.0 * np.pi * modes.frequency[chosen]
    ratio = modes.damping_ratio[chosen]
    return omega, ratio * omega / np.sqrt(1.0 - ratio**2)


def test_a_tilting_disc_whirls_forward_and_backward_as_the_closed_form_says():
    omega, decay = of_the_disc(None, ("tilt_x", "tilt_y"))
    damping = 2.0 * DAMPING * (LENGTH / 2.0) ** 2
    spin = DISC.polar * SPIN
    # I_t a'' + (c - i I_p w) a' + k a = 0 for the complex tilt a = a_x + i a_y
    roots = np.roots([DISC.transverse, damping - 1j * spin, TILT_STIFFNESS])
    np.testing.assert_allclose(np.sort(omega), np.sort(np.abs(roots.imag)), rtol=1e-9)
    np.testing.assert_allclose(np.sort(decay), np.sort(-roots.real), rtol=1e-7)
    assert omega.max() > 1.3 * omega.min()


@pytest.mark.parametrize("kinds", [("x", "y"), ("tilt_x", "tilt_y")])
def test_a_rotating_frame_shifts_frequencies_by_its_speed_and_nothing_else(kinds):
    fixed, decay = of_the_disc(None, kinds)
    rotating, decay_rotating = of_the_disc("disc", kinds)
    backward, forward = np.sort(fixed)
    np.testing.assert_allclose(np.sort(rotating), np.sort([forward - SPIN, backward + SPIN]), rtol=1e-8)
    np.testing.assert_allclose(np.sort(decay_rotating), np.sort(decay), rtol=1e-6)


def test_at_standstill_they_are_the_natural_modes():
    scene = driven_scene(published_set(3), speed=TimeLaw((0.0, 1.0), (0.0, 100.0)))
    system = assemble(without_damping(scene))
    still, plain = whirl_modes(system, 0.0), natural_modes(system)
    np.testing.assert_allclose(still.frequency, plain.frequency, rtol=1e-9)
    np.testing.assert_allclose(still.damping_ratio, 0.0, atol=1e-9)


def without_damping(scene):
    bearings = tuple(replace(part, damping_ratio=0.0) for part in scene.bushings)
    pins = tuple(replace(part, damping_ratio=0.0) for part in scene.planet_bearings)
    meshes = tuple(replace(mesh, damping=0.0) for mesh in scene.meshes)
    return replace(scene, bushings=bearings, planet_bearings=pins, meshes=meshes)


def test_speed_splits_the_double_modes_of_a_planetary_set():
    """Translational modes of equally spaced planets are double at rest; Coriolis terms split them."""
    scene = driven_scene(published_set(3), speed=TimeLaw.constant(2000.0))
    system = assemble(scene)
    at_rest, rotating = natural_modes(system).frequency, whirl_modes(system).frequency
    gaps = np.diff(at_rest)
    doubles = np.flatnonzero(gaps < 1e-6 * at_rest[1:])
    assert doubles.size == 6
    carrier = 2000.0 * 27 / 126 / (2.0 * math.pi)
    lowest = np.sort(rotating)[:2]
    assert lowest[1] - lowest[0] > 0.2 * carrier


# Gyroscopic and frame terms over speed, from those at two speeds.


def test_terms_at_every_speed_are_those_of_that_speed_alone():
    system = assemble(planetary_scene(published_set(3), duration=0.01))
    speeds = np.array([3.0, -40.0, 250.0])
    for speed, (damping, stiffness) in zip(speeds, gyroscopic_terms(system, speeds), strict=True):
        gyroscopic, stiffening = terms_at(system, law_speeds(system, abs(float(speed))))
        assert np.abs(gyroscopic).max() > 0.0 < np.abs(stiffening).max()
        np.testing.assert_allclose(damping, gyroscopic, rtol=1e-12, atol=1e-12 * np.abs(gyroscopic).max())
        scale = np.abs(stiffening).max()
        np.testing.assert_allclose(stiffness, stiffening, rtol=1e-10, atol=1e-10 * scale)


# Modal freedoms eliminated from forced vibration: the response of the whole matrices, or none.


@pytest.mark.parametrize("gyroscopic", ["off", "on"])
def test_a_response_with_the_modes_eliminated_is_that_of_the_whole_matrices(monkeypatch, gyroscopic):
    table = spring_table(4e8, amplitude=1e-6)
    scene = housed_pair(effects=ON | {"gyroscopic": gyroscopic})
    system = assemble(replace(scene, meshes=gear_pair_scene(table).meshes))
    speeds = np.linspace(50.0, 400.0, 40)
    small = harmonic_response(system, speeds)
    eliminated = steady_vibration.modal_elimination
    seen = []
    monkeypatch.setattr(steady_vibration, "modal_elimination", lambda *given: seen.append(eliminated(*given)))
    whole = harmonic_response(system, speeds)
    assert all(part is not None for part in seen) and seen
    for name in ("dynamic_transmission_error", "bearing_force", "displacement"):
        ours, theirs = getattr(small, name), getattr(whole, name)
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-11 * np.max(np.abs(theirs)), err_msg=name)
    assert small.residual < 1e-10


def test_gyroscopic_terms_turn_what_is_left():
    """Without them the same response is another one: they are not left out with the modes."""
    table, speeds = spring_table(4e8, amplitude=1e-6), np.linspace(50.0, 400.0, 10)
    answers = []
    for gyroscopic in ("off", "on"):
        scene = housed_pair(effects=ON | {"gyroscopic": gyroscopic})
        system = assemble(replace(scene, meshes=gear_pair_scene(table).meshes))
        answers.append(harmonic_response(system, speeds).displacement)
    without, turning = answers
    assert np.max(np.abs(turning - without)) > 1e-6 * np.max(np.abs(without))


def test_what_the_rows_of_elements_do_not_explain_is_not_eliminated():
    system = assemble(housed_pair())
    linear, modal = linearize(system), system.arrays.sparse.modal
    unit = np.ones(linear.scale.size)
    assert modal_elimination(modal, unit, linear.stiffness, linear.damping, linear.mass) is not None
    coupled = linear.stiffness.copy()
    coupled[-1, -2] = coupled[-2, -1] = 1e-6 * np.max(np.abs(coupled))
    assert modal_elimination(modal, unit, coupled, linear.damping, linear.mass) is None
    twice = modal._replace(shape=np.repeat(modal.shape[:1], len(modal.shape), axis=0))
    assert modal_elimination(twice, unit, linear.stiffness, linear.damping, linear.mass) is None


# Response with a stiffness that varies along the pitch: linear limit, time domain, swept resonances.


MEAN_STIFFNESS, RIPPLE = 4e8, 1e-7
MASS = 1.1344291072112745e-3 / BASE_RADIUS**2
NATURAL = np.sqrt(MEAN_STIFFNESS / MASS)


def test_a_constant_stiffness_leaves_the_harmonic_response():
    system = assemble(gear_pair_scene(spring_table(MEAN_STIFFNESS, RIPPLE)))
    speed = np.array([60.0, 300.0])
    found, shift = parametric_response(excited(system, 0.0, 4), speed, np.zeros(2), 4)
    plain = harmonic_response(system, speed, 4)
    first = found.dynamic_transmission_error[:, :, :1]
    largest = np.max(np.abs(plain.dynamic_transmission_error))
    np.testing.assert_allclose(first, plain.dynamic_transmission_error, atol=1e-9 * largest, rtol=0.0)
    np.testing.assert_allclose(shift, 0.0, atol=1e-9 * largest)
    np.testing.assert_allclose(found.bearing_force[..., :1], plain.bearing_force, rtol=1e-6)


def test_a_table_that_repeats_a_pitch_vibrates_as_the_pitch():
    """Its lines between the mesh orders are those of rounding alone, and the mean shifts as much."""
    speed, found = np.array([60.0, 300.0]), []
    for table in (square_wave_table(), repeated(square_wave_table(), 2)):
        at = excited(assemble(gear_pair_scene(table)), 0.0, 4)
        found.append(parametric_response(at, speed, np.zeros(2), 4))
    (once, shift), (twice, shifted) = found
    of_mesh = np.isin(twice.order, once.order)
    size = np.abs(once.displacement).max()
    np.testing.assert_allclose(
        twice.displacement[..., of_mesh], once.displacement, rtol=0.0, atol=1e-8 * size
    )
    assert np.abs(twice.displacement[..., ~of_mesh]).max() < 1e-8 * size
    np.testing.assert_allclose(shifted, shift, rtol=1e-6)


@pytest.mark.parametrize("scene", ["pair", "two stages"])
def test_factorized_and_iterated_balances_agree(scene, monkeypatch):
    """Of one flank and of two whose lines meet, at speeds through resonances."""
    made = gear_pair_scene(square_wave_table()) if scene == "pair" else two_stages(square_wave_table())
    at, found = excited(assemble(made), 0.0, 6), []
    speed = np.linspace(20.0, 600.0, 7)
    for limit in (10_000, 0):
        monkeypatch.setattr(varying_stiffness, "DIRECT", limit)
        found.append(parametric_response(at, speed, np.zeros(7), 6))
    (direct, shift), (iterated, shifted) = found
    size = np.max(np.abs(iterated.dynamic_transmission_error))
    np.testing.assert_allclose(
        direct.dynamic_transmission_error, iterated.dynamic_transmission_error, rtol=0.0, atol=1e-8 * size
    )
    np.testing.assert_allclose(shift, shifted, rtol=0.0, atol=1e-8 * size)
    assert np.max(np.abs(shift)) > 1e-3 * size
    assert direct.residual < 1e-12


@pytest.mark.parametrize("rpm", [700.0, 2300.0, 6000.0])
def test_a_varying_stiffness_is_that_of_the_time_domain(rpm):
    """The 20/20 pair, one or two teeth in contact; with the mean stiffness alone it is far off."""
    scene = gear_pair_scene(
        square_wave_table(), speed=TimeLaw.constant(rpm * RPM), duration=0.3, on_violation="report"
    )
    scene = with_mesh(scene, damping_ratio=0.1)
    at = excited(assemble(scene), 0.0, 24, 256)
    found, shift = parametric_response(at, np.array([rpm * RPM]), np.zeros(1), 24)
    minimum, maximum = extremes(found.dynamic_transmission_error, found.order)
    outputs = Outputs(sample_rate=1e5, energy_audit=False, receipt="minimal")
    run = simulate(replace(scene, outputs=outputs, integration=Integration(tolerance=1e-10)))
    error = run.dynamic_transmission_error[0, run.time.size // 2 :]
    assert (maximum - minimum)[0, 0] == pytest.approx(np.ptp(error), rel=0.05)
    mean = np.mean(at.cycles[0].static_error) + shift[0, 0]
    assert mean == pytest.approx(np.mean(error), rel=2e-3)
    force = run.bearing_force[0, 1, run.time.size // 2 :]
    low, high = extremes(found.bearing_force[:1, 1], found.order)
    assert (high - low)[0, 0] == pytest.approx(np.ptp(force), rel=0.1)
    assert found.least_mesh_force[0, 0] == pytest.approx(
        np.min(run.mesh_force[0, run.time.size // 2 :]), abs=0.06 * 2660.0
    )


@pytest.mark.law
def test_a_swept_resonance_is_as_high_as_it_can_grow():
    """One freedom hardly damped, driven through its resonance in 0.4 s (Lewis, 1932)."""
    top = 2.0 * NATURAL / 20
    scene = replace(
        gear_pair_scene(spring_table(MEAN_STIFFNESS, RIPPLE), duration=0.4), bushings=(), effects={}
    )
    scene = with_mesh(scene, damping=2e-4 * MASS * NATURAL)
    scene = replace(
        scene,
        drives=(replace(scene.drives[0], speed=TimeLaw((0.0, 0.4), (0.02 * top, top))),),
        outputs=Outputs(sample_rate=1e5, energy_audit=False, receipt="minimal"),
    )
    run = simulate(scene)
    swing = np.ptp(run.dynamic_transmission_error[0]) / 2.0
    speed, rate = np.array([NATURAL / 20]), np.array([0.98 * top / 0.4])
    at = excited(assemble(scene), 0.0, 4)
    found = swept_vibration(at, speed, rate, np.array([1]))
    amplitude = np.abs(found.displacement @ at.system.arrays.direction[0])[0, 0]
    assert amplitude == pytest.approx(swing, rel=0.15)
    standing = swept_vibration(at, speed, np.zeros(1), np.array([1]))
    assert np.abs(standing.displacement @ at.system.arrays.direction[0])[0, 0] > 4.0 * amplitude
