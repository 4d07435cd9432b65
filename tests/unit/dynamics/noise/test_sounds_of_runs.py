"""Sound of runs: of their orders, over time, from recordings of a housing, and where it is loudest."""

import tracemalloc
from dataclasses import replace
from functools import cache
from importlib import import_module
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table
from hulls import box, sphere
from reduced_housings import PAIR, bare_housing, random_housing
from sounding_housings import part_of_scene, rigid_housing, smooth_motion, with_surface
from sounding_scene import ON, SPEEDS, housing, oscillating, radiation, response, sound
from swept_runs import BEARINGS, RATE, drawn_amplitudes, order_forces, swept_run

from dynamics import Outputs, RunResult, TimeLaw, forced_response, simulate
from dynamics.acoustics import Air, ElementalRadiators, EquivalentRadiatedPower, a_weighting
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.noise import (
    RadiatedSound,
    SoundOverTime,
    cached_radiation,
    housing_radiation,
    loudest,
    models_at,
    pressure_recording,
    pressure_transfer,
    radiated_sound,
    sound_limit,
    sound_over_time,
    velocity_recording,
)
from dynamics.orders import bearing_orders
from dynamics.vibration import (
    analyze_vibration,
    housing_motion,
    housing_vibration,
    motion_pieces,
    run_seat_forces,
    seat_forces,
    time_signal,
)

# Sound power over the time of a run: that of its orders, Parseval, impacts that no order holds, bands.


ORDERS, TOLERANCE = 3, 0.3  # dB
FORCE = order_forces(drawn_amplitudes(ORDERS))


@cache
def swept_radiation():
    return housing_radiation(housing(), EquivalentRadiatedPower(), [25.0, 7800.0])


def levels(run):
    """Over time, and of the orders at the same times, dB and dB(A)."""
    found = sound_over_time(run, housing(), None, swept_radiation())
    orders = bearing_orders(run, ORDERS)
    by_order = radiated_sound(orders, housing(), None, swept_radiation()).orders
    rising = np.argsort(orders.time)
    inside = (found.time > orders.time.min()) & (found.time < orders.time.max())
    both = zip(
        (found.total_level, found.total_weighted_level),
        (by_order.total_level, by_order.total_weighted_level),
        strict=True,
    )
    return [
        (own[inside], np.interp(found.time[inside], orders.time[rising], other[rising]))
        for own, other in both
    ]


@pytest.mark.law
@pytest.mark.parametrize(("start", "end"), [(620.0, 620.0), (700.0, 760.0), (760.0, 700.0)])
def test_where_only_orders_exist_it_is_their_sum(start, end):
    for own, of_orders in levels(swept_run(start, end, 3.0, FORCE)):
        np.testing.assert_allclose(own[3:], of_orders[3:], atol=TOLERANCE)


def test_bands_hold_the_orders_in_them():
    """630 Hz, 1260 Hz and 1890 Hz lie within the bands of 630, 1250 and 2000 Hz."""
    run = swept_run(630.0, 630.0, 1.0, FORCE)
    found = sound_over_time(run, housing(), None, swept_radiation())
    center, power = radiated_sound(
        bearing_orders(run, ORDERS), housing(), None, swept_radiation()
    ).orders.third_octaves()
    for nominal in (630.0, 1250.0, 2000.0):
        own = found.power[5:, found.nominal == nominal]
        expected = power[center == nominal].mean()
        np.testing.assert_allclose(10.0 * np.log10(own / expected), 0.0, atol=TOLERANCE)
    assert np.all(found.power[5:, found.nominal == 4000.0] < 1e-6 * found.total[5:, None])
    np.testing.assert_allclose(found.power[5:].sum(axis=1), found.total[5:], rtol=1e-3)


def test_parseval():
    """By the equivalent radiated power a block's is the mean of v^T R v under the squared window."""
    noise = 100.0 * np.random.default_rng(5).normal(size=(4, 3, int(RATE) + 1))
    kernel = np.hanning(24) / np.hanning(24).sum()  # leaves little above 2 kHz
    smooth = np.apply_along_axis(np.convolve, -1, noise, kernel, "same")
    run = swept_run(500.0, 500.0, 1.0, lambda *_: smooth)
    body = housing()
    found = sound_over_time(run, body, None, swept_radiation(), 0.25)
    every = np.eye(len(body.stiffness))
    velocity = np.concatenate(list(motion_pieces(body, run.time, run_seat_forces(run, body), every)))
    samples = round(0.25 * RATE)
    matrix = swept_radiation().impedance * swept_radiation().surface
    for row, start in enumerate(range(0, velocity.shape[0] - samples + 1, samples // 2)):
        part = velocity[start : start + samples]
        weight = np.hanning(samples + 1)[:-1] ** 2
        mean = np.sum(weight * np.einsum("ti,ij,tj->t", part, matrix, part)) / weight.sum()
        assert found.total[row] == pytest.approx(mean, rel=0.01)


def test_an_impact_that_no_order_holds_is_heard():
    def knock(cycles, hertz, time):
        made = FORCE(cycles, hertz, time)
        made[0, 1] += 10_000.0 * np.exp(-(((time - 0.5) / 2e-4) ** 2))
        return made

    quiet, knocked = (
        sound_over_time(swept_run(620.0, 620.0, 1.0, force), housing(), None, swept_radiation())
        for force in (FORCE, knock)
    )
    near = np.abs(quiet.time - 0.5) < 0.03
    more = knocked.total_level - quiet.total_level
    assert np.all(more[near] > 3.0) and np.all(np.abs(more[quiet.time < 0.44]) < 0.01)
    remainder = bearing_orders(swept_run(620.0, 620.0, 1.0, knock), ORDERS).remainder
    assert remainder[0].max() > 0.5 and remainder[1:].max() < 1e-9


def test_it_goes_with_the_square_of_the_load_and_is_weighted_by_lines():
    once, twice = (
        sound_over_time(
            swept_run(1000.0, 1000.0, 0.5, order_forces(drawn_amplitudes(1), scale)),
            housing(),
            None,
            swept_radiation(),
        )
        for scale in (1.0, 2.0)
    )
    np.testing.assert_allclose(twice.power, 4.0 * once.power, rtol=1e-6)
    weighting = once.total_weighted_level - once.total_level
    np.testing.assert_allclose(weighting[2:], a_weighting(1000.0), atol=0.02)


def test_a_block_longer_than_the_run_is_refused():
    run = swept_run(620.0, 620.0, 0.2, FORCE)
    with pytest.raises(InputError, match="block"):
        sound_over_time(run, housing(), None, swept_radiation(), 0.3)


def test_housings_of_one_run_add_up_in_power():
    found = sound_over_time(swept_run(620.0, 620.0, 0.3, FORCE), housing(), None, swept_radiation())
    both = SoundOverTime.of_all([found, found])
    np.testing.assert_allclose(both.total_level - found.total_level, 10.0 * np.log10(2.0))
    np.testing.assert_allclose(both.total_weighted_level - found.total_weighted_level, 10.0 * np.log10(2.0))
    np.testing.assert_allclose(both.power, 2.0 * found.power)
    shorter = sound_over_time(swept_run(620.0, 620.0, 0.2, FORCE), housing(), None, swept_radiation())
    with pytest.raises(InputError, match=r"sounds\[1\]"):
        SoundOverTime.of_all([found, shorter])
    with pytest.raises(InputError, match="sounds"):
        SoundOverTime.of_all([])


@pytest.mark.parametrize("block", [0.05, 0.25])
def test_pieces_in_which_it_is_computed_do_not_show(monkeypatch, block):
    """Blocks are shorter and longer than a piece of 0.1 s."""
    run = swept_run(620.0, 700.0, 1.0, FORCE)
    found = sound_over_time(run, housing(), None, swept_radiation(), block)
    monkeypatch.setattr(time_signal, "PIECE", 2 * run.time.size)
    whole = sound_over_time(run, housing(), None, swept_radiation(), block)
    np.testing.assert_allclose(found.total, whole.total, rtol=1e-12)
    np.testing.assert_allclose(found.power, whole.power, rtol=1e-9, atol=1e-12 * whole.power.max())


def test_of_a_longer_run_only_forces_are_held():
    """Those of the run, and at twice its rate; velocities of 80 coordinates would be four times as much."""
    bare, hull = bare_housing(modal=60), box((0.36, 0.24, 0.18), (4, 3, 2))
    body = with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness)))
    air = housing_radiation(body, EquivalentRadiatedPower(), [25.0, 7800.0])
    peaks = []
    for seconds in (1.0, 2.0):
        run = swept_run(620.0, 620.0, seconds, FORCE)
        tracemalloc.start()
        sound_over_time(run, body, None, air)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] - peaks[0] < 1.2 * RATE * 8.0 * body.motions * (1 + 2)


# Sound power of the orders of a run: that of the linear response where the scene is linear; scaling.


RIPPLE_ORDERS = 3
ERRORS = ((0.5e-6, 0.3), (0.3e-6, 1.1), (0.2e-6, -0.8))  # m and rad, by order


def linear_table():
    """A constant stiffness, so that the linear response is the whole answer; an error of three orders."""
    table = spring_table(3e8)
    angle = 2.0 * np.pi * np.outer(np.arange(1, RIPPLE_ORDERS + 1), table.position)
    size, phase = (np.array(column)[:, None] for column in zip(*ERRORS, strict=True))
    error = np.sum(size * np.cos(angle + phase), axis=0)
    slope = np.sum(
        -size * 2.0 * np.pi * np.arange(1, RIPPLE_ORDERS + 1)[:, None] * np.sin(angle + phase), axis=0
    )
    return replace(
        table,
        deflection=table.deflection + error[:, None],
        deflection_slope=0.0 * table.deflection + slope[:, None],
    )


def linear_scene(speed: TimeLaw, duration: float):
    scene = gear_pair_scene(linear_table(), effects=ON, speed=speed, duration=duration)
    return replace(scene, housings=(part_of_scene(housing()),))


@cache
def wide_radiation():
    return housing_radiation(housing(), EquivalentRadiatedPower(), [50.0, 3000.0])


def level_difference(scene, found, rows):
    """Levels of the orders of a run less those of the linear response at the same speeds, (S, H), dB."""
    linear = forced_response(assemble(scene), found.speed[rows], orders=RIPPLE_ORDERS)
    body = housing()
    by_run, by_response = (radiated_sound(each, body, None, wide_radiation()) for each in (found, linear))
    return by_run.orders.level.T[rows] - by_response.orders.level.T


def test_a_run_at_constant_speed_sounds_as_the_linear_response():
    """With the phases of the forces, those of all bearings and orders."""
    scene = linear_scene(TimeLaw.constant(150.0), 0.4)
    found = bearing_orders(simulate(scene), RIPPLE_ORDERS)
    settled = slice(-3, None)
    expected = forced_response(assemble(scene), [150.0], orders=RIPPLE_ORDERS).bearing_force
    near = np.broadcast_to(expected, found.bearing_force[..., settled, :].shape)
    np.testing.assert_allclose(found.bearing_force[..., settled, :], near, atol=1e-4 * np.abs(near).max())
    even = replace(found, speed=found.speed + 1e-6 * np.arange(found.speed.size))
    assert np.abs(level_difference(scene, even, settled)).max() < 0.01
    assert found.remainder[:, settled].max() < 1e-6


def test_a_slow_run_up_sounds_as_the_linear_response_at_its_speeds():
    scene = linear_scene(TimeLaw.ramp(100.0, 110.0, 2.0), 2.0)
    found = bearing_orders(simulate(scene), RIPPLE_ORDERS)
    settled = slice(found.time.size // 4, None, 20)
    assert found.smearing.max() < 10.0 ** (0.1 / 20.0) - 1.0
    assert np.abs(level_difference(scene, found, settled)).max() < 0.1


def test_power_goes_with_the_square_of_the_load_and_bearings_superpose():
    amplitudes = drawn_amplitudes(RIPPLE_ORDERS)
    sounds = [
        radiated_sound(
            bearing_orders(swept_run(300.0, 900.0, 1.0, order_forces(amplitudes, scale)), RIPPLE_ORDERS),
            housing(),
            None,
            wide_radiation(),
        )
        for scale in (1.0, 2.0)
    ]
    np.testing.assert_allclose(sounds[1].power, 4.0 * sounds[0].power, rtol=1e-6)
    np.testing.assert_allclose(sounds[0].bearing_share.sum(axis=0), sounds[0].power, rtol=1e-9)


def test_forces_that_go_with_the_speed_as_in_a_steady_state():
    """A sweep of constant amplitudes: at each speed the power of these forces at that frequency."""
    amplitudes = drawn_amplitudes(RIPPLE_ORDERS)
    found = bearing_orders(swept_run(300.0, 900.0, 1.0, order_forces(amplitudes)), RIPPLE_ORDERS)
    exact = np.broadcast_to(amplitudes[:, :, None], found.bearing_force.shape)
    expected = radiated_sound(replace(found, bearing_force=exact), housing(), None, wide_radiation())
    np.testing.assert_allclose(
        radiated_sound(found, housing(), None, wide_radiation()).power, expected.power, rtol=1e-5
    )
    vibration = housing_vibration(found, housing())
    assert vibration.mean_square_velocity.shape == found.frequency.shape
    analysis = analyze_vibration(found, housing(), "case")
    assert analysis.metadata["pitches"] == found.metadata["pitches"]


def test_bearings_of_the_run_that_are_not_those_of_the_seats_are_refused():
    names = ("input left", *BEARINGS[1:])
    run = swept_run(300.0, 900.0, 0.2, order_forces(drawn_amplitudes(RIPPLE_ORDERS)), bearings=names)
    with pytest.raises(InputError, match=r"bearings\[0\] = 'input.left'.*one of input left"):
        radiated_sound(bearing_orders(run, RIPPLE_ORDERS), housing(), None, wide_radiation())


# What a housing makes of a run, as recordings: the force through transfer functions.


RECORDING_RATE, HERTZ = 25_600.0, (400.0, 800.0, 2000.0, 10_000.0)  # the last: 2.56 samples per period
TENTH_DB = 10.0 ** (0.1 / 20.0) - 1.0
AXIS = np.array([2.0, -1.0, 0.5])
MICROPHONE = np.array([0.6, 0.8, -0.2])


def run_of(scale: float = 1.0) -> RunResult:
    """A run of 1 s at constant speed; orders, their amplitudes and phases random on each bearing."""
    time = np.arange(round(RECORDING_RATE) + 1) / RECORDING_RATE
    draw = np.random.default_rng(3).normal(size=(len(HERTZ), len(PAIR), 3, 2)) @ np.array([1.0, 1j])
    waves = np.exp(2j * np.pi * np.outer(HERTZ, time))
    force = 50.0 * scale * np.real(np.einsum("fbc,ft->bct", draw, waves))
    run = SimpleNamespace(
        time=time,
        sample_rate=RECORDING_RATE,
        bearing=PAIR,
        bearing_force=force,
        bearing_moment=np.empty((0, 3, time.size)),
        receipt={"sampling": {"pass_frequency": 0.4 * RECORDING_RATE}},
    )
    return cast(RunResult, run)


def amplitude(samples: np.ndarray, rate: float, hertz: float) -> np.ndarray:
    """Complex peak amplitudes (...,) over the middle of a signal (..., T), a whole number of periods."""
    time = np.arange(samples.shape[-1]) / rate
    inner = slice(round(0.4 * rate), round(0.8 * rate))
    return np.asarray(2.0 * np.mean(samples[..., inner] * np.exp(-2j * np.pi * hertz * time[inner]), axis=-1))


@pytest.mark.parametrize("coupled", [False, True])
def test_its_orders_are_those_of_the_force_through_the_transfer_function(coupled):
    housing, run = random_housing(coupled=coupled), run_of()
    heard = velocity_recording(housing, run, "b", AXIS)
    assert heard.unit == "m/s"
    assert heard.quantity == "velocity of point b along (0.873, -0.436, 0.218); no sound pressure"
    force = run_seat_forces(run, housing).T
    for hertz in HERTZ:
        motion = housing_motion(housing, np.array([hertz]), amplitude(force, RECORDING_RATE, hertz)[None])[0]
        velocity = 2j * np.pi * hertz * (housing.points[1].motion @ motion)
        expected = abs(AXIS @ velocity) / np.linalg.norm(AXIS)
        found = abs(amplitude(heard.samples, heard.sample_rate, hertz))
        assert found == pytest.approx(expected, rel=TENTH_DB), hertz


@pytest.mark.law
def test_it_scales_with_the_load_and_is_heard_where_it_varies_most():
    housing = random_housing()
    once, twice = (velocity_recording(housing, run_of(scale), "a") for scale in (1.0, 2.0))
    np.testing.assert_allclose(twice.samples, 2.0 * once.samples, atol=1e-9 * twice.peak)
    along = [velocity_recording(housing, run_of(), "a", axis).samples for axis in np.eye(3)]
    assert np.std(once.samples) >= max(np.std(samples) for samples in along)


def test_what_the_housing_or_the_run_does_not_have_is_refused():
    housing, run = random_housing(), run_of()
    with pytest.raises(InputError, match="one of a, b"):
        velocity_recording(housing, run, "lid")
    with pytest.raises(InputError, match="one per seat"):
        velocity_recording(housing, run, "a", bearings=PAIR[:2])
    with pytest.raises(InputError, match="not all zero"):
        velocity_recording(housing, run, "a", np.zeros(3))


@cache
def sounding():
    """A box valid up to some 2100 Hz."""
    bare, hull = random_housing(), box((0.36, 0.24, 0.18), (9, 6, 5))
    return with_surface(bare, hull, smooth_motion(hull, len(bare.stiffness)))


def test_orders_of_the_sound_pressure_are_those_of_the_force_through_the_transfer_function():
    housing, run = sounding(), run_of()
    heard = pressure_recording(housing, run, MICROPHONE)
    assert heard.unit == "Pa"
    where = "sound pressure at (0.600, 0.800, -0.200) m in the free field, panels as monopoles"
    assert heard.quantity == f"{where}, up to {sound_limit(housing):.0f} Hz"
    force = run_seat_forces(run, housing).T
    for hertz in HERTZ:
        found = abs(amplitude(heard.samples, heard.sample_rate, hertz))
        transfer = pressure_transfer(housing, MICROPHONE, np.array([hertz]))[0]
        expected = abs(transfer @ amplitude(force, RECORDING_RATE, hertz))
        if hertz < sound_limit(housing):
            assert found == pytest.approx(expected, rel=TENTH_DB), hertz
        else:
            assert found < 1e-4 * expected


def test_a_run_at_constant_speed_sounds_as_its_forced_response():
    """Flanks of 1 um at 1500 rpm: 500 Hz, 0.2 s after the start; simulated, and by linear theory."""
    housing, speed = sounding(), 1500.0 * RPM
    scene = gear_pair_scene(spring_table(3e8, 1e-6), effects=ON, speed=TimeLaw.constant(speed), duration=0.5)
    outputs = Outputs(sample_rate=20e3, bearing_forces=True)
    scene = replace(scene, housings=(part_of_scene(housing),), outputs=outputs)
    heard = pressure_recording(housing, simulate(scene), MICROPHONE)
    settled = slice(round(0.2 * heard.sample_rate), round(0.4 * heard.sample_rate))
    time = np.arange(heard.samples.size)[settled] / heard.sample_rate
    found = abs(2.0 * np.mean(heard.samples[settled] * np.exp(-2j * np.pi * 500.0 * time)))
    response = forced_response(assemble(scene), np.array([speed]), orders=1)
    transfer = pressure_transfer(housing, MICROPHONE, response.frequency[0])[0]
    assert found == pytest.approx(abs(transfer @ seat_forces(response, housing)[0, 0]), rel=0.1 * TENTH_DB)


@pytest.mark.law
def test_the_sound_pressure_of_bearings_adds_up_with_its_phase():
    housing, run = sounding(), run_of()
    parts = []
    for silent in (slice(0, 1), slice(1, None)):
        alone = run_of()
        alone.bearing_force[silent] = 0.0
        parts.append(pressure_recording(housing, alone, MICROPHONE).samples)
    whole = pressure_recording(housing, run, MICROPHONE)
    np.testing.assert_allclose(whole.samples, np.sum(parts, axis=0), atol=1e-9 * whole.peak)


def test_housings_that_do_not_sound_are_refused():
    run = run_of()
    with pytest.raises(InputError, match="with a surface"):
        pressure_recording(random_housing(), run, MICROPHONE)
    stiff = replace(sounding(), frequency=np.empty(0))
    with pytest.raises(InputError, match="valid_frequency"):
        pressure_recording(stiff, run, MICROPHONE)


# The loudest points, models side by side, several housings, the cache of resistances.


AIR = Air()


def test_the_first_point_is_the_loudest_order_and_speed():
    points, level = loudest(sound()), sound().orders.weighted_level
    assert points[0].weighted_level == pytest.approx(level.max())
    assert [point.weighted_level for point in points] == sorted(
        (point.weighted_level for point in points), reverse=True
    )
    for point in points:
        s, h = point.speed_index, point.order_index
        assert point.weighted_level == pytest.approx(level[h, s])
        assert (point.speed, point.frequency) == (SPEEDS[s], sound().frequency[s, h])
        assert point.mode_share == pytest.approx(sound().mode_share[:, s, h].max() / sound().power[s, h])
        assert sound().natural_frequency[point.mode - 1] == point.natural_frequency
        assert point.bearing == sound().bearing[int(sound().bearing_share[:, s, h].argmax())]


def test_silence_has_no_loudest_point():
    quiet = replace(response(), bearing_force=0.0 * response().bearing_force)
    assert loudest(radiated_sound(quiet, housing(), None, radiation())) == ()


@pytest.mark.law
def test_a_mode_in_resonance_carries_the_sound():
    body, driven, _, _ = oscillating(5.0, 5.0 * (2.0 * np.pi * 300.0) ** 2)
    plane = cached_radiation(body, EquivalentRadiatedPower(), driven.frequency)
    (point, *_) = loudest(radiated_sound(driven, body, None, plane))
    assert point.frequency == 300.0 and point.natural_frequency == pytest.approx(300.0)
    assert (point.bearing, point.mode_share) == ("seat", pytest.approx(1.0))


def test_models_at_a_point_are_those_of_the_map():
    at = loudest(sound(), 1)[0]
    where = at.speed_index, at.order_index
    ladder = models_at(response(), housing(), None, where, (EquivalentRadiatedPower(), ElementalRadiators()))
    assert ladder.results["monopoles"].level == pytest.approx(at.level, abs=0.5)


def test_two_housings_alike_are_3_db_louder_than_one():
    both = RadiatedSound.of_all([sound(), sound()])
    np.testing.assert_allclose(both.power, 2.0 * sound().power, rtol=1e-12)
    np.testing.assert_allclose(both.efficiency, sound().efficiency, rtol=1e-12)
    np.testing.assert_allclose(both.bearing_share.sum(axis=0), both.power, rtol=1e-9)
    assert loudest(both, 1)[0].mode == loudest(sound(), 1)[0].mode
    with pytest.raises(InputError, match="frequency"):
        RadiatedSound.of_all([sound(), replace(sound(), frequency=2.0 * sound().frequency)])
    with pytest.raises(InputError, match="sounds"):
        RadiatedSound.of_all([])


def test_the_second_time_comes_from_the_cache_to_the_last_bit(tmp_path, monkeypatch):
    module = import_module("dynamics.noise.housing_radiation")
    monkeypatch.setattr(module, "MIN_COST", 0.0)
    body = rigid_housing(1.0, 1e6, 0.02, sphere(6, 0.1))
    first = cached_radiation(body, ElementalRadiators(), [200.0, 400.0], cache=tmp_path)
    monkeypatch.setattr(module, "housing_radiation", None)
    again = cached_radiation(body, ElementalRadiators(), [200.0, 400.0], cache=tmp_path)
    np.testing.assert_array_equal(again.matrix, first.matrix)
    assert (again.area, again.impedance, again.metadata) == (first.area, first.impedance, first.metadata)
    others = (
        (replace(body, mass=2.0 * body.mass), ElementalRadiators(), [200.0, 400.0], AIR),
        (body, EquivalentRadiatedPower(), [200.0, 400.0], AIR),
        (body, ElementalRadiators(), [200.0, 401.0], AIR),
        (body, ElementalRadiators(), [200.0, 400.0], Air(density=1.0)),
    )
    for other in others:
        with pytest.raises(TypeError):  # computed anew
            cached_radiation(*other, cache=tmp_path)
