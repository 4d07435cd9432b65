"""What is heard of other flanks by transfer functions, against a whole response of the scene with them."""

from functools import cache

import numpy as np
import pytest
from transferred_scenes import SPEEDS, far_table, housing, sound_model, table, unit

from dynamics.acoustics import sound_power_level
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import HarmonicResponse, harmonic_response
from dynamics.linearize.transfer import FlankTransfer, flank_transfer
from dynamics.noise import SoundModel, forced_power, pressure_transfer
from dynamics.noise.transferred_quantities import (
    BearingForce,
    PointVelocity,
    Quantity,
    SoundPower,
    SoundPressure,
    SurfaceVelocity,
)
from dynamics.vibration import housing_motion, mean_square, seat_forces, surface_weight

ORDERS = 4
FAR = ((far_table(), table()), (far_table(), far_table()), (table(), table()))


@cache
def transfer() -> FlankTransfer:
    return flank_transfer(assemble(unit()), SPEEDS, ORDERS)


def levels(quantity: Quantity, tables) -> np.ndarray:
    own = transfer()
    form = quantity.form(own, sound_model(unit()))
    return form.decibels(form.weighted(own.inputs(own.excitation(assemble(unit(*tables))))))


@cache
def direct(index: int) -> HarmonicResponse:
    return harmonic_response(assemble(unit(*FAR[index])), SPEEDS, ORDERS)


@pytest.mark.parametrize("index", range(len(FAR)))
def test_flanks_sound_as_a_scene_with_them(index):
    """Helical flanks far from those of the transfer, elastic shafts, rolling bearings, a housing."""
    _, power = forced_power(sound_model(unit(*FAR[index])), SPEEDS, ORDERS)
    heard = levels(SoundPower(), FAR[index])
    expected = power.weighted_level.T
    loud = expected > expected.max() - 60.0
    np.testing.assert_allclose(heard[loud], expected[loud], rtol=0.0, atol=1e-6)
    if index < 2:
        nominal = levels(SoundPower(), FAR[2])
        assert np.abs(heard - nominal)[loud].max() > 3.0


def test_a_bearing_and_the_surface_move_as_in_the_response():
    response, index = direct(0), direct(0).bearing.index("mid.right")
    force = response.bearing_force[index, :3]
    size = 10.0 * np.log10(0.5 * np.sum(np.abs(force) ** 2, axis=0))
    np.testing.assert_allclose(levels(BearingForce("mid.right"), FAR[0]), size, rtol=0.0, atol=1e-5)
    along = 20.0 * np.log10(np.sqrt(0.5) * np.abs(force[1]))
    np.testing.assert_allclose(levels(BearingForce("mid.right", "y"), FAR[0]), along, rtol=0.0, atol=1e-5)
    seats = seat_forces(response, housing())
    motion = housing_motion(housing(), response.frequency, seats)
    velocity = 2j * np.pi * response.frequency[..., None] * motion
    square = mean_square(velocity, surface_weight(housing()))
    np.testing.assert_allclose(
        levels(SurfaceVelocity("case"), FAR[0]), 10.0 * np.log10(square / 1e-18), rtol=0.0, atol=1e-5
    )
    (top,) = housing().points
    moved = 20.0 * np.log10(np.sqrt(0.5) * np.abs(velocity @ top.motion[2]) / 1e-9)
    np.testing.assert_allclose(levels(PointVelocity("case", "top", "z"), FAR[0]), moved, rtol=0.0, atol=1e-5)


def test_a_microphone_hears_the_forces_on_all_seats():
    response, place = direct(0), (1.0, 0.4, 0.2)
    hertz = response.frequency
    path = pressure_transfer(housing(), np.array(place), hertz.ravel()).reshape(*hertz.shape, -1)
    pressure = np.sum(path * seat_forces(response, housing()), axis=-1)
    own = transfer()
    form = SoundPressure("case", place).form(own, sound_model(unit()))
    flanks = own.excitation(assemble(unit(*FAR[0])))
    np.testing.assert_allclose(form.of(own.inputs(flanks)), 0.5 * np.abs(pressure) ** 2, rtol=1e-6)
    assert form.decibels(np.array([4e-10]))[0] == pytest.approx(0.0)


def test_louder_by_the_square_of_what_excites():
    own = transfer()
    form = SoundPower().form(own, sound_model(unit()))
    inputs = own.inputs(own.excitation(assemble(unit(*FAR[0]))))
    np.testing.assert_allclose(form.of(3.0 * inputs), 9.0 * form.of(inputs), rtol=1e-9)
    np.testing.assert_allclose(form.decibels(form.of(inputs)), sound_power_level(form.of(inputs)))


def test_parts_that_are_not_there_are_refused():
    silent = SoundModel(unit(), {}, {})
    for quantity, words in (
        (BearingForce("none"), "in.left"),
        (BearingForce("in.left", "w"), "direction"),
        (SurfaceVelocity("none"), "housing"),
        (PointVelocity("case", "bottom"), "points"),
    ):
        with pytest.raises(InputError, match=words):
            quantity.form(transfer(), sound_model(unit()))
    with pytest.raises(InputError, match="at least one that radiates"):
        SoundPower().form(transfer(), silent)
