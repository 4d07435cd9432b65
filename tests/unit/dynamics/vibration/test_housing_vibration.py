"""Vibration of housings: motion under forces, and which mode or bearing it is of."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table
from reduced_housings import PAIR, PER_SEAT, random_housing
from tubular_housings import GROUND, cantilever, two_seats

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.housings import Mount, receptance, scene_housing
from dynamics.linearize import forced_response
from dynamics.mechanism.bodies import modal_housing
from dynamics.vibration import (
    MotionQuantity,
    Parts,
    analyze_vibration,
    housing_motion,
    housing_vibration,
    mean_square,
    mode_shape,
    operating_deflection,
    overall,
    seat_forces,
    surface_weight,
)

# Vibration of a housing in a forced response, and how far the modes kept carry it.


ON = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
SPEEDS = np.array([60.0, 150.0, 420.0])


@pytest.fixture(scope="module")
def response():
    part = replace(scene_housing(random_housing(), "case"), seat_positions=None)
    scene = replace(gear_pair_scene(square_wave_table(), effects=ON), housings=(part,))
    return forced_response(assemble(scene), SPEEDS, orders=4)


def test_points_move_under_the_forces_of_the_bearings(response):
    housing = random_housing()
    found = housing_vibration(response, housing, points=("b",))
    motion = housing_motion(housing, response.frequency, seat_forces(response, housing))
    moved = motion[2, 1] @ housing.points[1].motion.T
    omega = 2.0 * np.pi * response.frequency[2, 1]
    assert found.point == ("b",)
    np.testing.assert_allclose(found.velocity[0, :, 2, 1], 1j * omega * moved, rtol=1e-9)
    np.testing.assert_allclose(found.of(MotionQuantity.DISPLACEMENT)[0, :, 2, 1], moved, rtol=1e-9)
    acceleration = found.of(MotionQuantity.ACCELERATION)[0, :, 2, 1]
    np.testing.assert_allclose(acceleration, -(omega**2) * moved, rtol=1e-9)
    assert found.rms[0, 2, 1] == pytest.approx(np.linalg.norm(found.velocity[0, :, 2, 1]) / np.sqrt(2.0))
    assert overall([3.0, 4.0]) == pytest.approx(5.0)


def test_harmonics_above_seven_tenths_of_the_highest_mode_are_not_valid_nor_the_largest(response):
    housing = random_housing()
    highest = float(response.frequency[2, 1]) / 0.7 + 1.0
    few = replace(housing, frequency=np.array([0.5 * highest, highest]))
    found = housing_vibration(response, few)
    assert found.highest_valid_frequency == pytest.approx(0.7 * highest)
    assert np.array_equal(found.valid, response.frequency <= 0.7 * highest)
    assert not found.valid[2, 2]
    loud = replace(found, velocity=np.where(found.valid, found.velocity, 1e3))
    assert loud.valid[loud.largest()]
    assert found.rms.max(axis=0)[found.largest()] == np.max(found.rms.max(axis=0)[found.valid])
    assert found.largest(speed=500.0, order=3.0) == (2, 2)  # what is asked for may be beyond
    assert found.largest(speed=100.0)[0] == 0


def test_a_point_that_is_not_there_is_refused(response):
    with pytest.raises(InputError, match="one of a, b"):
        housing_vibration(response, random_housing(), points=("c",))
    with pytest.raises(InputError, match="named point"):
        housing_vibration(response, replace(random_housing(), points=()), points=("c",))
    assert housing_vibration(response, replace(random_housing(), points=())).velocity.shape == (0, 3, 3, 4)


def test_an_analysis_looks_where_the_motion_is_largest_and_says_what_makes_it(response):
    housing = random_housing()
    found = analyze_vibration(response, housing, "case")
    at = found.at_speed, found.at_order
    assert at == found.vibration.largest()
    hertz = response.frequency[at]
    moved = np.einsum("ns,s->n", found.mobilities.point[1, 2], found.vibration.seat_force[at])
    nearest = np.argmin(np.abs(found.mobilities.frequency - hertz))
    assert abs(found.mobilities.frequency[nearest] - hertz) < hertz / 400.0
    assert abs(moved[nearest]) == pytest.approx(abs(found.vibration.velocity[1, 2][at]), rel=0.1)
    assert found.mobilities.seat[5] == "input.right x"
    for shares in (found.bearings, found.modes):
        np.testing.assert_allclose(shares.point.sum(axis=1), 1.0)
        assert np.all(np.isnan(shares.surface))
    assert found.bearings.name == PAIR
    assert found.deflection is None
    at_other = analyze_vibration(response, housing, "case", speed=61.0, order=2.2, points=("b",))
    assert (at_other.at_speed, at_other.at_order) == (0, 1)
    assert at_other.bearings.point.shape == (1, 4)
    with pytest.raises(InputError, match="surface or named points"):
        analyze_vibration(response, replace(housing, points=()), "case")


# Motion of a housing under its bearings: statics, resonance in closed form, the motion within a scene.


def scene_in(housing):
    scene = gear_pair_scene(square_wave_table(), effects=ON)
    part = replace(scene_housing(housing, "case"), seat_positions=None)
    return replace(scene, housings=(part,))


def test_forces_on_the_seats_move_the_housing_as_the_scene_does():
    housing = random_housing()
    system = assemble(scene_in(housing))
    response = forced_response(system, SPEEDS, orders=4)
    force = seat_forces(response, housing)
    motion = housing_motion(housing, response.frequency, force)
    modal = modal_housing(system.scene.housings[0])
    amplitude = response.displacement[[response.freedom.index(f"case.{kind}") for kind in modal.kinds]]
    for index, seat in enumerate(housing.seats):
        own = np.kron(np.eye(2), seat.axes.T)[:PER_SEAT, :PER_SEAT] @ modal.seat(seat.name)
        expected = np.einsum("cm,msh->shc", own, amplitude)
        found = motion[..., PER_SEAT * index : PER_SEAT * (index + 1)]
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


def test_a_steady_force_deflects_by_the_compliance():
    housing = random_housing()
    force = np.random.default_rng(3).normal(size=housing.motions)
    whole = np.concatenate([force, np.zeros(len(housing.stiffness) - housing.motions)])
    found = housing_motion(housing, np.zeros(()), force + 0j)
    np.testing.assert_allclose(found, np.linalg.solve(housing.stiffness, whole), rtol=1e-9)


def test_motions_add_up_and_are_those_of_the_receptance():
    housing = random_housing()
    hertz = np.array([300.0, 900.0, 2500.0])
    draw = np.random.default_rng(4)
    first, second = draw.normal(size=(2, 3, housing.motions)) + 1j * draw.normal(size=(2, 3, housing.motions))
    both = housing_motion(housing, hertz, first + 2.0 * second)
    parts = housing_motion(housing, hertz, first) + 2.0 * housing_motion(housing, hertz, second)
    np.testing.assert_allclose(both, parts, rtol=1e-9)
    by_receptance = np.einsum("nrs,ns->nr", receptance(housing, hertz), first)
    found = housing_motion(housing, hertz, first)
    np.testing.assert_allclose(found, by_receptance, rtol=1e-7)


def test_what_is_asked_without_sense_is_refused():
    housing = random_housing()
    with pytest.raises(InputError, match="force"):
        housing_motion(housing, np.array([100.0]), np.zeros((2, housing.motions), dtype=complex))
    massless = replace(housing, mass=np.zeros_like(housing.mass))
    with pytest.raises(InputError, match="housing with mass"):
        housing_motion(massless, np.array([100.0]), np.zeros((1, housing.motions), dtype=complex))
    response = forced_response(assemble(scene_in(housing)), SPEEDS[:1], orders=2)
    with pytest.raises(InputError, match=r"bearings\[1\]"):
        seat_forces(response, housing, ("input.left", "none", *PAIR[2:]))
    with pytest.raises(InputError, match="one per seat"):
        seat_forces(response, housing, PAIR[:3])


# Contributions of bearings and modes, operating deflections, mode shapes.


def forces(housing, seed=2):
    draw = np.random.default_rng(seed)
    return draw.normal(size=housing.motions) + 1j * draw.normal(size=housing.motions)


def assurance(first, second):
    """MAC of two shapes."""
    a, b = (shape.motion.ravel() for shape in (first, second))
    return abs(np.vdot(a, b)) ** 2 / (np.vdot(a, a) * np.vdot(b, b)).real


def nearest_other(frequency, index):
    """Relative distance to the nearest other frequency."""
    return np.min(np.abs(np.delete(frequency, index) / frequency[index] - 1.0))


def pushed(housing, mode, force):
    """Part of the forces that a mode feels."""
    shape = housing.modes[1][: housing.motions, mode]
    return abs(shape @ force) / (np.linalg.norm(shape) * np.linalg.norm(force))


@pytest.mark.parametrize("parts", [Parts.of_bearings, Parts.of_modes])
@pytest.mark.parametrize("hertz", [500.0, 4000.0])
def test_parts_add_up_to_the_motion_and_shares_to_one(parts, hertz):
    housing = two_seats()
    force = forces(housing)
    whole = housing_motion(housing, np.array(hertz), force)
    found = parts(housing, hertz, force)
    np.testing.assert_allclose(found.motion.sum(axis=0), whole, rtol=0.0, atol=1e-9 * np.abs(whole).max())
    rows = housing.points[0].motion
    for weight in (surface_weight(housing), rows.T @ rows):
        assert found.shares(weight).sum() == pytest.approx(1.0, abs=1e-12)


def test_the_share_of_a_bearing_is_what_its_force_adds_to_the_mean_square():
    """With twice a force the mean square grows by its share and its own square alone."""
    housing, hertz = random_housing(coupled=True), 900.0
    force = forces(housing)
    rows = housing.points[0].motion
    weight = rows.T @ rows
    found = Parts.of_bearings(housing, hertz, force)
    step = 1e-6
    for seat, share in enumerate(found.shares(weight)):
        grown = force.copy()
        grown[PER_SEAT * seat : PER_SEAT * (seat + 1)] *= 1.0 + step
        before, after = (
            mean_square(housing_motion(housing, np.array(hertz), each), weight) for each in (force, grown)
        )
        assert (after / before - 1.0) / (2.0 * step) == pytest.approx(share, abs=1e-5)


def test_at_a_resonance_apart_the_surface_moves_in_that_mode_which_has_all_of_it():
    uneven = np.diag([4e6, 3e7, 2e8, 1e6, 4e6, 3e7])
    housing = two_seats(replace(GROUND, mount=Mount(tuple(map(tuple, uneven.tolist())))))
    force = forces(housing)
    apart = [k for k in range(6) if nearest_other(housing.frequency, k) > 0.2]
    excited = [mode for mode in apart if pushed(housing, mode, force) > 0.05][:3]
    assert len(excited) == 3
    for mode in excited:
        hertz = float(housing.frequency[mode])
        motion = housing_motion(housing, np.array(hertz), force)
        deflection = operating_deflection(housing, motion)
        assert assurance(deflection, mode_shape(housing, mode + 1)) > 0.99
        assert Parts.of_modes(housing, hertz, force).shares(surface_weight(housing))[mode] > 0.98


def test_modes_are_scaled_to_their_largest_motion_and_orthogonal():
    housing = cantilever()
    first, third = mode_shape(housing, 1), mode_shape(housing, 3)
    assert np.linalg.norm(first.motion, axis=1).max() == pytest.approx(1.0)
    assert assurance(first, first) == pytest.approx(1.0)
    assert assurance(first, third) < 0.1


def test_a_shape_that_moves_as_a_whole_has_the_normals_as_its_normal_motion():
    housing = two_seats()
    shape = operating_deflection(housing, np.zeros(len(housing.mass)))
    whole = replace(shape, motion=np.tile([0.0, 0.0, 2.0 + 1.0j], (len(shape.points), 1)))
    end = np.all(np.isclose(shape.points[shape.facets][:, :, 2], 0.1), axis=1)
    side = np.ptp(shape.points[shape.facets][:, :, 2], axis=1) > 0.01
    np.testing.assert_allclose(whole.normal_motion[end], 2.0 + 1.0j)
    np.testing.assert_allclose(whole.normal_motion[side], 0.0, atol=1e-9)
    assert end.any()
    assert side.any()


def test_what_has_no_answer_is_refused():
    housing = random_housing()
    with pytest.raises(InputError, match="surface"):
        mode_shape(housing, 1)
    with pytest.raises(InputError, match="number"):
        mode_shape(two_seats(), 13)
    with pytest.raises(InputError, match="No force"):
        Parts.of_bearings(housing, 100.0, np.zeros(housing.motions, dtype=complex)).shares(housing.mass)
