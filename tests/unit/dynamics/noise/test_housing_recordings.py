"""What a housing makes of a run, as recordings: the force through transfer functions."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table
from hulls import box
from reduced_housings import PAIR, random_housing
from sounding_housings import part_of_scene, smooth_motion, with_surface
from sounding_scene import ON

from dynamics import simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import forced_response
from dynamics.loads import TimeLaw
from dynamics.noise import pressure_recording, pressure_transfer, sound_limit, velocity_recording
from dynamics.results import RunResult
from dynamics.scene import Outputs
from dynamics.vibration import housing_motion, run_seat_forces, seat_forces

RATE, HERTZ = 25_600.0, (400.0, 800.0, 2000.0, 10_000.0)  # the last: 2.56 samples per period
TENTH_DB = 10.0 ** (0.1 / 20.0) - 1.0
AXIS = np.array([2.0, -1.0, 0.5])
MICROPHONE = np.array([0.6, 0.8, -0.2])


def run_of(scale: float = 1.0) -> RunResult:
    """A run of 1 s at constant speed; orders, their amplitudes and phases random on each bearing."""
    time = np.arange(round(RATE) + 1) / RATE
    draw = np.random.default_rng(3).normal(size=(len(HERTZ), len(PAIR), 3, 2)) @ np.array([1.0, 1j])
    waves = np.exp(2j * np.pi * np.outer(HERTZ, time))
    force = 50.0 * scale * np.real(np.einsum("fbc,ft->bct", draw, waves))
    run = SimpleNamespace(
        time=time,
        sample_rate=RATE,
        bearing=PAIR,
        bearing_force=force,
        bearing_moment=np.empty((0, 3, time.size)),
        receipt={"sampling": {"pass_frequency": 0.4 * RATE}},
    )
    return cast(RunResult, run)


def amplitude(samples: np.ndarray, rate: float, hertz: float) -> np.ndarray:
    """Complex peak amplitudes (...,) over the middle of a signal (..., T), a whole number of periods."""
    time = np.arange(samples.shape[-1]) / rate
    inner = slice(round(0.4 * rate), round(0.8 * rate))
    return np.asarray(2.0 * np.mean(samples[..., inner] * np.exp(-2j * np.pi * hertz * time[inner]), axis=-1))


@pytest.mark.parametrize("coupled", [False, True])
def test_its_orders_are_those_of_the_force_through_the_transfer_function(coupled: bool) -> None:
    housing, run = random_housing(coupled=coupled), run_of()
    heard = velocity_recording(housing, run, "b", AXIS)
    assert heard.unit == "m/s"
    assert heard.quantity == "velocity of point b along (0.873, -0.436, 0.218); no sound pressure"
    force = run_seat_forces(run, housing).T
    for hertz in HERTZ:
        motion = housing_motion(housing, np.array([hertz]), amplitude(force, RATE, hertz)[None])[0]
        velocity = 2j * np.pi * hertz * (housing.points[1].motion @ motion)
        expected = abs(AXIS @ velocity) / np.linalg.norm(AXIS)
        found = abs(amplitude(heard.samples, heard.sample_rate, hertz))
        assert found == pytest.approx(expected, rel=TENTH_DB), hertz


@pytest.mark.law
def test_it_scales_with_the_load_and_is_heard_where_it_varies_most() -> None:
    housing = random_housing()
    once, twice = (velocity_recording(housing, run_of(scale), "a") for scale in (1.0, 2.0))
    np.testing.assert_allclose(twice.samples, 2.0 * once.samples, atol=1e-9 * twice.peak)
    along = [velocity_recording(housing, run_of(), "a", axis).samples for axis in np.eye(3)]
    assert np.std(once.samples) >= max(np.std(samples) for samples in along)


def test_what_the_housing_or_the_run_does_not_have_is_refused() -> None:
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


def test_orders_of_the_sound_pressure_are_those_of_the_force_through_the_transfer_function() -> None:
    housing, run = sounding(), run_of()
    heard = pressure_recording(housing, run, MICROPHONE)
    assert heard.unit == "Pa"
    where = "sound pressure at (0.600, 0.800, -0.200) m in the free field, panels as monopoles"
    assert heard.quantity == f"{where}, up to {sound_limit(housing):.0f} Hz"
    force = run_seat_forces(run, housing).T
    for hertz in HERTZ:
        found = abs(amplitude(heard.samples, heard.sample_rate, hertz))
        transfer = pressure_transfer(housing, MICROPHONE, np.array([hertz]))[0]
        expected = abs(transfer @ amplitude(force, RATE, hertz))
        if hertz < sound_limit(housing):
            assert found == pytest.approx(expected, rel=TENTH_DB), hertz
        else:
            assert found < 1e-4 * expected


def test_a_run_at_constant_speed_sounds_as_its_forced_response() -> None:
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
def test_the_sound_pressure_of_bearings_adds_up_with_its_phase() -> None:
    housing, run = sounding(), run_of()
    parts = []
    for silent in (slice(0, 1), slice(1, None)):
        alone = run_of()
        alone.bearing_force[silent] = 0.0
        parts.append(pressure_recording(housing, alone, MICROPHONE).samples)
    whole = pressure_recording(housing, run, MICROPHONE)
    np.testing.assert_allclose(whole.samples, np.sum(parts, axis=0), atol=1e-9 * whole.peak)


def test_housings_that_do_not_sound_are_refused() -> None:
    run = run_of()
    with pytest.raises(InputError, match="with a surface"):
        pressure_recording(random_housing(), run, MICROPHONE)
    stiff = replace(sounding(), frequency=np.empty(0))
    with pytest.raises(InputError, match="valid_frequency"):
        pressure_recording(stiff, run, MICROPHONE)
