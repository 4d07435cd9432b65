"""Contact state, dynamic factor, load sharing and accelerations of runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene
from planetary_scenes import planetary_scene, published_set

from dynamics.errors import InputError
from dynamics.loads import TimeLaw
from dynamics.results import RunResult
from dynamics.results.mesh_figures import (
    ContactState,
    contact_shares,
    dynamic_factor,
    planet_load_sharing,
)
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate


def test_the_dynamic_factor_is_one_in_the_quasi_static_limit():
    slow = simulate(gear_pair_scene(speed=TimeLaw.constant(10.0 * RPM), duration=1.0))
    quiet = dynamic_factor(slow, pitches=1)
    np.testing.assert_allclose(quiet.mean, 1.0, rtol=2e-3)
    assert 1.0 < quiet.largest.max() < 1.02
    loud = dynamic_factor(simulate(gear_pair_scene(duration=0.1)), pitches=1)
    assert loud.largest.max() > 1.1
    assert np.all(loud.least <= loud.mean)
    assert np.all(loud.mean <= loud.largest)


def test_blocks_of_the_dynamic_factor_cover_whole_pitches():
    run = simulate(gear_pair_scene(duration=0.1))
    found = dynamic_factor(run, pitches=4)
    assert found.time.size == 7  # 30 pitches
    np.testing.assert_allclose(np.diff(found.time), 4.0 / 300.0, rtol=0.01)
    np.testing.assert_allclose(found.mesh_frequency, 300.0)
    with pytest.raises(InputError, match="pitches"):
        dynamic_factor(run, pitches=31)


@pytest.mark.parametrize("planets", [3, 5])
def test_load_sharing_sums_to_the_number_of_planets(planets):
    errors = tuple((0.0, 5e-5 if index == 0 else 0.0) for index in range(planets))
    scene = planetary_scene(published_set(planets, pin_errors=errors), duration=0.01)
    found = planet_load_sharing(simulate(scene))
    assert [sharing.central for sharing in found] == ["sun", "ring"]
    for sharing in found:
        assert len(sharing.mesh) == planets
        np.testing.assert_allclose(sharing.ratio.sum(axis=0), planets, rtol=1e-12)
        assert sharing.mean.sum() == pytest.approx(planets, rel=1e-12)
        assert sharing.mean[0] > 1.05 or sharing.mean[0] < 0.95
        assert sharing.mesh_load_factor == sharing.mean.max() > 1.0


def test_planets_without_errors_share_equally_and_a_pair_has_none():
    (sun, _) = planet_load_sharing(simulate(planetary_scene(published_set(3), duration=0.005)))
    np.testing.assert_allclose(sun.ratio, 1.0, atol=1e-6)
    assert planet_load_sharing(simulate(gear_pair_scene(duration=0.001))) == ()


def test_contact_states_tell_the_flanks_that_carry():
    run = simulate(gear_pair_scene(duration=0.002))
    contact = np.zeros((1, 41))
    contact[0, 10:20] += 1.0
    contact[0, 15:30] += 2.0
    state = replace(run, contact=contact).contact[0]
    assert [int(state[k]) for k in (0, 12, 17, 25)] == [
        ContactState.OFF,
        ContactState.DRIVING,
        ContactState.BOTH,
        ContactState.COAST,
    ]
    (shares,) = contact_shares(replace(run, contact=contact))
    assert shares == pytest.approx({"off": 21 / 41, "driving": 5 / 41, "coast": 10 / 41, "both": 5 / 41})


@pytest.fixture(scope="module")
def moved():
    """A run with everything stored, at a rate at which differences show accelerations."""
    scene = replace(gear_pair_scene(duration=0.02), integration=Integration(tolerance=1e-11))
    return simulate(replace(scene, outputs=Outputs(400e3, displacements=True, accelerations=True)))


def test_accelerations_are_the_rates_of_velocities(moved):
    rates = (moved.velocity[:, 2:] - moved.velocity[:, :-2]) * 400e3 / 2.0
    for row, rate in zip(moved.acceleration[:, 1:-1], rates, strict=True):
        assert np.ptp(row) > 1.0
        np.testing.assert_allclose(row, rate, atol=2e-3 * np.ptp(row))


def test_bearing_seats_move_with_their_shaft(moved):
    row = moved.acceleration[moved.freedom.index("input.x")]
    for bearing, name in enumerate(moved.bearing):
        if name.startswith("input"):
            np.testing.assert_allclose(moved.bearing_acceleration[bearing, 0], row, rtol=1e-12)


def test_accelerations_are_off_unless_requested_and_change_nothing(moved, tmp_path):
    scene = replace(gear_pair_scene(duration=0.02), integration=Integration(tolerance=1e-11))
    plain = simulate(replace(scene, outputs=Outputs(400e3, displacements=True)))
    assert plain.acceleration.shape == (0, 8001)
    assert plain.bearing_acceleration.shape == (0, 3, 8001)
    assert plain.displacement.tobytes() == moved.displacement.tobytes()
    moved.to_netcdf(tmp_path / "run.nc")
    back = RunResult.from_netcdf(tmp_path / "run.nc")
    assert back.bearing_acceleration.tobytes() == moved.bearing_acceleration.tobytes()


def test_a_run_knows_the_modes_of_its_scene(moved):
    assert moved.modes["frequency"] == sorted(moved.modes["frequency"])
    assert len(moved.modes["frequency"]) == len(moved.freedom)
    assert set(moved.modes["freedom"]) <= set(moved.freedom)
    assert max(moved.modes["damping_ratio"]) > 0.01
