"""Ball bearings whose ring slides in its seat: no axial force, and the laws of an elastic contact."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from dynamics.bearings import BallBearing, RollerBearing, RollingBearing
from dynamics.bearings.loaded_bearing import LoadedBearing, Reaction
from dynamics.errors import InputError

ROW = BallBearing(count=8, diameter=11.5e-3, pitch_diameter=43.5e-3, clearance=1e-5)
OTHERS = [0, 1, 3, 4]
LEVER = ROW.pitch_diameter / 2.0
SCALE = np.array([1.0, 1.0, 1.0, 1.0 / LEVER, 1.0 / LEVER])
ANGLE, AWAY = 0.3, np.array([0.0, 0.0, 3e-3, 0.0, 0.0])
SIDES = {"positive": 1.0, "negative": -1.0}


def displacements(number: int) -> np.ndarray:
    """Displacements of tens of um across, hundreds along, tilts up to some mrad; balls press at all."""
    drawn = np.random.default_rng(4).normal(size=(number, 5))
    return drawn * np.array([2e-5, 2e-5, 2e-4, 1e-3, 1e-3]) + np.array([3e-5, 0.0, 0.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def fixed():
    return LoadedBearing(ROW)


@pytest.fixture(scope="module")
def floating():
    return LoadedBearing(ROW, locating="none")


def unpressed(fixed: LoadedBearing, d: np.ndarray) -> np.ndarray:
    """Return the displacement with z where the locating bearing carries no axial force."""
    far = 2.0 * LEVER * float(np.hypot(d[3], d[4]))

    def thrust(z):
        return float(fixed.evaluate((*d[:2], z, *d[3:]), ANGLE).force[2])

    return np.array([*d[:2], brentq(thrust, -far, far, xtol=1e-20, rtol=1e-15), *d[3:]])


def condensed(at: Reaction) -> np.ndarray:
    """Return the tangent of the other four displacements while the axial force stays 0."""
    across = at.tangent[np.ix_(OTHERS, [2])]
    return np.asarray(at.tangent[np.ix_(OTHERS, OTHERS)] - across @ across.T / at.tangent[2, 2])


def test_a_floating_ring_stands_where_the_locating_bearing_has_no_axial_force(fixed, floating):
    for d in displacements(30):
        free, at = floating.evaluate(d, ANGLE), fixed.evaluate(unpressed(fixed, d), ANGLE)
        radial = float(np.hypot(*free.force[:2]))
        assert radial > 10.0
        assert abs(at.force[2]) < 1e-9 * radial
        assert free.force[2] == 0.0
        assert free.load == pytest.approx(at.load, rel=1e-8, abs=1e-8 * radial)
        assert free.force[OTHERS] * SCALE[OTHERS] == pytest.approx(
            at.force[OTHERS] * SCALE[OTHERS], abs=1e-8 * radial
        )
        assert free.energy == pytest.approx(at.energy, rel=1e-9)
        assert free.slope == pytest.approx(at.slope, rel=1e-6, abs=1e-9)
        square = np.outer(SCALE[OTHERS], SCALE[OTHERS])
        wanted = square * condensed(at)
        found = square * free.tangent[np.ix_(OTHERS, OTHERS)]
        assert found == pytest.approx(wanted, abs=1e-7 * np.abs(wanted).max())


def test_the_axial_displacement_of_a_floating_bearing_changes_nothing(floating):
    for d in displacements(5):
        at, moved = floating.evaluate(d), floating.evaluate(d + AWAY)
        np.testing.assert_array_equal(moved.force, at.force)
        np.testing.assert_array_equal(moved.tangent, at.tangent)
        assert moved.energy == at.energy


@pytest.mark.parametrize("locating", ["none", "positive", "negative"])
def test_force_and_tangent_are_derivatives_of_the_energy(locating):
    loaded, slid = LoadedBearing(ROW, locating=locating), 0
    unit, h = np.diag(SCALE), 2e-9
    for d in displacements(10):
        at = loaded.evaluate(d, ANGLE)
        ahead, back = ([loaded.evaluate(d + s * h * row, ANGLE) for row in unit] for s in (1.0, -1.0))
        slopes = np.array([(a.force - b.force) for a, b in zip(ahead, back, strict=True)]) / (2.0 * h)
        gained = np.array([(a.energy - b.energy) for a, b in zip(ahead, back, strict=True)]) / (2.0 * h)
        tangent = unit @ at.tangent @ unit
        assert slopes @ unit == pytest.approx(tangent, abs=1e-6 * np.abs(tangent).max())
        assert gained == pytest.approx(unit @ at.force, abs=1e-6 * np.abs(unit @ at.force).max())
        assert tangent == pytest.approx(tangent.T, abs=1e-9 * np.abs(tangent).max())
        turned = [loaded.evaluate(d, ANGLE + s).energy for s in (-1e-6, 1e-6)]
        assert at.slope == pytest.approx((turned[1] - turned[0]) / 2e-6, rel=1e-3, abs=1e-6)
        slid += at.force[2] == 0.0
    assert slid == 10 if locating == "none" else 0 < slid < 10


def test_the_tangent_pushes_back(floating):
    """The energy has no hollows: every motion is resisted, or none."""
    for d in displacements(30):
        tangent = np.diag(SCALE) @ floating.evaluate(d).tangent @ np.diag(SCALE)
        minimum, maximum = np.linalg.eigvalsh(tangent)[[0, -1]]
        assert minimum > -1e-12 * maximum


def test_across_the_axis_a_floating_bearing_is_the_locating_one(fixed, floating):
    for d in displacements(5):
        across = (*d[:2], 0.0, 0.0, 0.0)
        at, free = fixed.evaluate(across, ANGLE), floating.evaluate(across, ANGLE)
        np.testing.assert_array_equal(free.force, at.force)
        np.testing.assert_array_equal(free.load, at.load)
        np.testing.assert_array_equal(free.tangent[:2, :2], at.tangent[:2, :2])
        assert at.tangent[2, 2] > 0.0
        assert not free.tangent[2].any()


@pytest.mark.parametrize("side", SIDES)
def test_a_seat_holds_in_its_direction_alone(side, fixed, floating):
    seat, held = LoadedBearing(ROW, locating=side), 0
    for d in displacements(20):
        at = seat.evaluate(d, ANGLE)
        pressed = SIDES[side] * fixed.evaluate(d, ANGLE).force[2] > 0.0
        like = (fixed if pressed else floating).evaluate(d, ANGLE)
        np.testing.assert_allclose(at.force, like.force, rtol=1e-12)
        np.testing.assert_allclose(at.tangent, like.tangent, rtol=1e-9, atol=1e-6)
        assert at.energy == like.energy
        assert at.viscous[2, 2] == pytest.approx(abs(at.force[2]), rel=1e-12)  # at 1 s/m
        held += pressed
    assert 3 < held < 17


@pytest.mark.parametrize("side", SIDES)
def test_the_mirrored_seat_answers_with_the_mirrored_force(side):
    other, mirror = {"positive": "negative", "negative": "positive"}[side], np.array([1, 1, -1, -1, -1])
    seats = [LoadedBearing(ROW, locating=name) for name in (side, other)]
    for d in displacements(10):
        force, image = (
            seat.evaluate(way, ANGLE).force for seat, way in zip(seats, (d, mirror * d), strict=True)
        )
        assert image == pytest.approx(mirror * force, rel=1e-9, abs=1e-9)


def test_a_floating_bearing_carries_a_radial_load_and_a_moment(floating):
    load = np.array([3000.0, -500.0, 0.0, 4.0, 6.0])
    d = floating.displacement(load, ANGLE)
    assert d[2] == 0.0  # nothing resists it
    assert floating.evaluate(d, ANGLE).force == pytest.approx(load, rel=1e-9, abs=1e-8)


def test_a_row_with_a_contact_angle_does_not_float():
    angular = replace(ROW, contact_angle=math.radians(25.0))
    tapered = RollerBearing(17, 9e-3, 13.6e-3, 65e-3, contact_angle=0.25)
    for row in (angular, tapered):
        for make in (
            lambda row=row: LoadedBearing(row, locating="none"),
            lambda row=row: RollingBearing("a", "rotor", row, 0.1, locating="positive"),
        ):
            with pytest.raises(InputError, match="whose sign") as caught:
                make()
            assert caught.value.field == "locating"
    with pytest.raises(InputError, match="a ring slides"):
        RollingBearing("a", "rotor", ROW, 0.1, 200.0, locating="none")
    for make in (
        lambda: RollingBearing("a", "rotor", ROW, 0.1, locating="left"),
        lambda: LoadedBearing(ROW, locating="left"),
    ):
        with pytest.raises(InputError, match='"both", "positive", "negative", "none"') as caught:
            make()
        assert caught.value.field == "locating"
