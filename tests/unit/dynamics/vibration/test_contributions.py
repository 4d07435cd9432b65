"""Contributions of bearings and modes, operating deflections, mode shapes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reduced_housings import PER_SEAT, random_housing
from tubular_housings import GROUND, cantilever, two_seats

from dynamics.errors import InputError
from dynamics.housings import Mount
from dynamics.vibration import (
    Parts,
    housing_motion,
    mean_square,
    mode_shape,
    operating_deflection,
    surface_weight,
)


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
