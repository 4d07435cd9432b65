"""Curves: mean, peak-to-peak, harmonics, load shares, error bands, and errors by source."""

import math
from dataclasses import replace

import h5netcdf
import numpy as np
import pytest

from fe_contact import Status, SteDatabase
from fe_contact.errors import DatabaseError, InputError, SolveError
from fe_contact.ste.curve_errors import AT_NODES, METHOD, SOURCES
from fe_contact.ste.curve_quantities import (
    FIRST_HARMONIC,
    MEAN,
    OFF_MESH,
    PEAK_TO_PEAK,
    QUANTITIES,
    peak_excess,
    quantity_changes,
)

AMPLITUDES = np.array([2e-6, 5e-7, 3e-7])
PHASES = np.array([0.4, 2.0, 5.0])
LEVEL = 1e-5


def wave(position):
    """A transmission error of three known harmonics."""
    n = np.arange(1, 4)
    return LEVEL + (AMPLITUDES * np.cos(2 * np.pi * n * position[:, None] + PHASES)).sum(axis=1)


@pytest.fixture(scope="module")
def harmonic(make):
    """The wave on uneven knots, at two loads in proportion."""
    rng = np.random.default_rng(5)
    position = (np.arange(400) + rng.uniform(-0.3, 0.3, 400) + 0.4) / 400
    force = np.array([1000.0, 2000.0])
    ste = wave(position)[:, None, None, None] * force[:, None, None] / 2000.0
    return make(
        position=position,
        force=force,
        static_transmission_error=ste,
        tangent_compliance=np.broadcast_to(ste / force[:, None, None], ste.shape),
        no_load_transmission_error=np.zeros((400, 1, 1)),
        error_estimate=np.full(ste.shape, 2e-9),
    )


def test_a_known_wave_has_its_mean_swing_and_harmonics_and_their_bands(harmonic):
    curve = harmonic.curve(force=2000.0)
    sizes = [float(estimate) for estimate in curve.harmonics]
    assert float(curve.mean) == pytest.approx(LEVEL, rel=1e-6)
    assert sizes[:3] == pytest.approx(AMPLITUDES, rel=3e-4)
    assert curve.harmonic_phases[:3] == pytest.approx(PHASES, abs=1e-3)
    assert max(sizes[3:]) < 1e-4 * AMPLITUDES[0]
    assert len(sizes) >= 10
    stored = harmonic.static_transmission_error[:, 1, 0, 0]
    assert float(harmonic.peak_to_peak(force=2000.0)) == pytest.approx(np.ptp(stored), rel=1e-12)
    # A constant band e bounds: mean e, peak-to-peak 2 e, each harmonic 2 e.
    curve = harmonic.curve(torque=float(harmonic.torque[1]))
    assert curve.error == pytest.approx(np.full(400, 2e-9))
    assert curve.mean.error == pytest.approx(2e-9)
    assert curve.peak_to_peak.error == pytest.approx(4e-9)
    assert {estimate.unit for estimate in (curve.mean, curve.peak_to_peak, *curve.harmonics)} == {"m"}
    assert all(estimate.error == pytest.approx(4e-9) for estimate in curve.harmonics)


@pytest.mark.parametrize("n", [1, 2, 7])
def test_harmonics_are_fourier_integrals_of_the_curve(spur, n):
    """Against Gauss quadrature of the interpolant, piece by piece."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    edges = np.r_[spur.position, 1.0]
    half = np.diff(edges) / 2
    x = edges[:-1, None] + half[:, None] * (1.0 + nodes)
    turned = spur.ste(x, 2660.0) * np.exp(2j * np.pi * n * x)
    expected = 2.0 * abs((half[:, None] * weights * turned).sum())
    assert float(spur.harmonics(force=2660.0)[n - 1]) == pytest.approx(expected, rel=2e-5)


def test_the_bands_hold_for_any_error_inside_the_pointwise_band(make):
    """Change every stored value within its band: no figure moves by more than it says."""
    database = make(error=5e-9)
    rng = np.random.default_rng(3)
    before = database.curve(force=2660.0)
    for _ in range(10):
        moved = database.static_transmission_error + rng.choice([-5e-9, 5e-9], (64, 5, 1, 1))
        after = make(static_transmission_error=moved).curve(force=2660.0)
        assert abs(float(after.mean) - float(before.mean)) <= before.mean.error * 1.05
        assert (
            abs(float(after.peak_to_peak) - float(before.peak_to_peak)) <= before.peak_to_peak.error * 1.0001
        )
        for one, other in zip(before.harmonics, after.harmonics, strict=True):
            assert abs(float(other) - float(one)) <= one.error * 1.05


def test_below_the_smallest_load_the_band_holds_the_true_curve(make):
    """There the law is a convention; the band says so."""
    sparse, truth = make(error=0.0), make(force=[26.6, 133.0, 266.0], error=0.0)
    for force in (26.6, 133.0):
        guess = sparse.curve(force=force)
        exact = truth.curve(force=force)
        assert np.all(np.abs(guess.ste - exact.ste) <= guess.error)
        assert abs(float(guess.mean) - float(exact.mean)) <= guess.mean.error
        assert abs(float(guess.peak_to_peak) - float(exact.peak_to_peak)) <= guess.peak_to_peak.error


def test_torque_and_force_name_the_same_curve(helical):
    by_torque = helical.curve(torque=float(helical.torque[2]))
    by_force = helical.curve(force=float(helical.force[2]))
    assert np.array_equal(by_torque.ste, by_force.ste)
    assert by_torque.torque == pytest.approx(helical.torque[2], rel=1e-14)
    assert np.array_equal(by_torque.ste, helical.static_transmission_error[:, 2, 0, 0])
    curve = helical.curve(torque=200.0)
    expected = helical.ste(helical.position, 200.0 / (60.3e-3 * np.cos(np.radians(24.0))))
    assert curve.ste == pytest.approx(expected, rel=1e-13)


def test_figures_are_those_of_the_curve_wherever_it_is_asked(spur):
    curve = spur.curve(force=3000.0)
    assert spur.mean(force=3000.0) == curve.mean
    assert spur.peak_to_peak(force=3000.0) == curve.peak_to_peak
    assert spur.harmonics(force=3000.0) == curve.harmonics
    everywhere, somewhere = spur.curve(force=2660.0), spur.curve(force=2660.0, at=[0.1, 0.2])
    assert somewhere.ste.shape == (2,)
    assert (somewhere.mean, somewhere.peak_to_peak) == (everywhere.mean, everywhere.peak_to_peak)


def test_stored_shares_come_back_and_follow_a_pair_across_the_seam(spur):
    curve = spur.curve(force=2660.0)
    assert curve.pair.tolist() == spur.pair.tolist()
    assert curve.load_share == pytest.approx(spur.load_share[:, 2, 0, 0], abs=1e-14)
    # Pair j at position 1 is pair j + 1 at position 0.
    curve = spur.curve(force=2660.0, at=[-0.3, 0.7])
    column = {int(pair): curve.load_share[:, i] for i, pair in enumerate(curve.pair)}
    assert column[0][0] == pytest.approx(column[-1][1], abs=1e-14)
    assert column[1][0] == pytest.approx(column[0][1], abs=1e-14)
    assert column[0][0] > 0.4
    curve = spur.curve(force=2660.0, at=np.linspace(0.9, 1.1, 2001))
    assert np.abs(np.diff(curve.load_share, axis=0)).max() < 5e-3
    curve = spur.curve(force=2660.0, at=[0.5])
    assert curve.load_share[0, curve.pair == 0] == pytest.approx(0.5, abs=1e-12)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({}, "exactly one of the two"),
        ({"torque": 10.0, "force": 10.0}, "exactly one of the two"),
        ({"torque": 1000.0}, "torque = 1000.0: must be at most 399.9363 N m"),
        ({"force": 2e4}, "force = 20000.0: must be at most 10640 N"),
        ({"force": 0.0}, "force = 0.0: must be above 0"),
        ({"torque": -5.0}, "torque = -5.0: must be above 0"),
        ({"torque": np.nan}, "torque = nan: must be a finite number"),
        ({"force": 266.0, "misalignment": 1e-6}, "misalignment = 1e-06.*no such axis"),
        ({"force": 266.0, "center_distance_change": 1e-6}, "center_distance_change"),
        ({"force": 266.0, "at": []}, "at = "),
        ({"force": 266.0, "at": [0.0, np.nan]}, "at = "),
        ({"force": 266.0, "at": [1e9]}, "at = "),
    ],
)
def test_questions_outside_the_table_are_refused(spur, asked, message):
    with pytest.raises(InputError, match=message):
        spur.curve(**asked)


def test_a_table_with_failed_points_answers_only_on_request(make):
    whole = make()
    ste, status = whole.static_transmission_error.copy(), whole.status.copy()
    ste[10, 2], status[10, 2] = np.nan, Status.SINGULAR
    failed = make(static_transmission_error=ste, status=status)
    with pytest.raises(SolveError, match="1 of 320 points FAILED"):
        failed.curve(force=2660.0)
    curve = failed.curve(force=2660.0, allow_failed=True)
    assert curve.position.size == 63
    assert float(curve.mean) == pytest.approx(float(whole.mean(force=2660.0)), rel=1e-3)


X = np.arange(64) / 64
TWO_WAVES = (8e-6 + 2e-6 * np.cos(2.0 * np.pi * X) + 0.5e-6 * np.cos(6.0 * np.pi * X))[:, None]


def test_changes_are_measured_by_quantity():
    assert not quantity_changes(X, TWO_WAVES, TWO_WAVES, 1).any()
    change = quantity_changes(X, TWO_WAVES, TWO_WAVES + 1e-7, 1)[:, 0]
    assert change[MEAN] == pytest.approx(1e-7, rel=1e-9)
    assert change[1:].max() < 1e-19
    bend = 1e-8 * np.cos(2.0 * np.pi * X)[:, None]
    one = quantity_changes(X, TWO_WAVES, TWO_WAVES + bend, 1)
    three = quantity_changes(X, TWO_WAVES, TWO_WAVES + 3.0 * bend, 1)
    assert three[:3] == pytest.approx(3.0 * one[:3], rel=1e-6, abs=1e-18)
    assert one[FIRST_HARMONIC, 0] == pytest.approx(1e-8, rel=1e-3)
    assert one[PEAK_TO_PEAK, 0] == pytest.approx(2e-8, rel=1e-2)
    moved = (8e-6 + 2e-6 * np.cos(2.0 * np.pi * (X - 0.01)))[:, None]
    still = (8e-6 + 2e-6 * np.cos(2.0 * np.pi * X))[:, None]
    change = quantity_changes(X, still, moved, 1)[FIRST_HARMONIC, 0]
    assert change == pytest.approx(2e-6 * 2.0 * math.sin(0.01 * math.pi), rel=1e-2)
    moved = TWO_WAVES + 1e-8 * np.sin(2.0 * np.pi * X)[:, None]
    change = quantity_changes(X, TWO_WAVES, moved, 1)[PEAK_TO_PEAK, 0]
    assert change == pytest.approx(1e-8, rel=1e-2)


def test_rows_that_failed_are_left_out_and_too_few_are_unknown():
    holed = np.tile(TWO_WAVES, 2)
    holed[5, 0] = np.nan
    holed[4:, 1] = np.nan
    change = quantity_changes(X, np.tile(TWO_WAVES, 2), holed + 1e-7, 1)
    assert change[MEAN, 0] == pytest.approx(1e-7, rel=1e-9)
    assert np.isnan(change[:, 1]).all()


@pytest.mark.parametrize("apex", [0.3 / 64, 0.5 / 64, 0.5 + 0.8 / 64])
def test_the_peak_of_a_tent_between_two_knots_is_found(apex):
    tent = np.abs((X - apex + 0.5) % 1.0 - 0.5)[:, None]
    missed = 0.5 - np.ptp(tent)
    assert missed > 1e-3
    assert peak_excess(X, tent, 1)[0] == pytest.approx(missed, rel=1e-9)
    assert peak_excess(X, -tent, 1)[0] == pytest.approx(missed, rel=1e-9)


def test_a_step_between_flat_parts_misses_nothing():
    step = np.where((X > 0.2) & (X < 0.7), 1.0, 0.0)[:, None]
    assert peak_excess(X, step, 1)[0] == 0.0


def test_harmonics_of_a_longer_period_are_those_of_the_mesh():
    position = np.arange(192) / 64
    other = np.tile(TWO_WAVES, (3, 1)) + 1e-8 * np.cos(2.0 * np.pi * position)[:, None]
    change = quantity_changes(position, np.tile(TWO_WAVES, (3, 1)), other, 3)[:, 0]
    assert change[FIRST_HARMONIC] == pytest.approx(1e-8, rel=1e-3)
    assert change[FIRST_HARMONIC + 1 :].max() < 1e-10
    assert change[OFF_MESH] < 1e-18


def test_what_differs_from_pitch_to_pitch_is_beside_the_mesh_orders():
    position = np.arange(192) / 64
    curve = np.tile(TWO_WAVES, (3, 1))
    other = curve + 1e-8 * np.cos(2.0 * np.pi / 3.0 * position)[:, None]
    change = quantity_changes(position, curve, other, 3)[:, 0]
    assert change[OFF_MESH] == pytest.approx(1e-8, rel=1e-3)
    assert change[FIRST_HARMONIC:].max() < 1e-10


@pytest.fixture
def assessed(spur):
    """The fake table with errors of every source: source number in nm, times the load's number."""
    shape = spur.static_transmission_error.shape[1:]
    errors = np.zeros((len(SOURCES), QUANTITIES, *shape))
    errors[:5] = np.arange(1, 6).reshape(5, 1, 1, 1, 1) * 1e-9
    errors *= np.arange(1, shape[0] + 1)[:, None, None]
    errors[SOURCES.index("force"), :, :-1] = 7e-9
    return replace(spur, curve_error=errors)


def test_stated_errors_join_their_sources(assessed):
    for k, force in enumerate(assessed.force):
        curve = assessed.curve(force=float(force))
        for found in (curve.mean, curve.peak_to_peak, *curve.harmonics):
            assert found.error == pytest.approx(math.sqrt(55.0) * 1e-9 * (k + 1), rel=1e-12, abs=0.0)
    middle = 0.5 * float(assessed.force[0] + assessed.force[1])
    expected = math.hypot(1.5 * math.sqrt(55.0), 7.0) * 1e-9
    assert assessed.mean(force=middle).error == pytest.approx(expected, rel=1e-9, abs=0.0)
    errors = assessed.curve_error.copy()
    errors[1] = np.nan
    assert math.isnan(
        replace(assessed, curve_error=errors).peak_to_peak(force=float(assessed.force[0])).error
    )
    with pytest.raises(DatabaseError, match="curve_error must be >= 0"):
        replace(assessed, curve_error=-assessed.curve_error)
    with pytest.raises(DatabaseError, match="curve_error must have the dimensions"):
        replace(assessed, curve_error=assessed.curve_error[:, :, :1])


def test_files_keep_the_errors_of_every_schema(assessed, spur, tmp_path):
    assessed.to_netcdf(tmp_path / "new.nc")
    spur.to_netcdf(tmp_path / "old.nc")
    assert SteDatabase.from_netcdf(tmp_path / "new.nc").identical(assessed)
    old = SteDatabase.from_netcdf(tmp_path / "old.nc")
    assert old.curve_error.size == 0
    assert old.mean(force=float(old.force[0])) == spur.mean(force=float(old.force[0]))
    assert not assessed.identical(spur)
    source = AT_NODES.index(METHOD)
    before = replace(assessed, curve_error=np.delete(assessed.curve_error, source, axis=0))
    before.to_netcdf(tmp_path / "one.nc")
    found = SteDatabase.from_netcdf(tmp_path / "one.nc")
    assert not found.curve_error[source].any()
    assert np.array_equal(np.delete(found.curve_error, source, axis=0), before.curve_error)
    found.to_netcdf(tmp_path / "again.nc")
    assert SteDatabase.from_netcdf(tmp_path / "again.nc").identical(found)
    assessed.to_netcdf(tmp_path / "ste.nc")
    with h5netcdf.File(tmp_path / "ste.nc", "a") as file:
        file.variables["curve_error"][0, 0, 0, 0, 0] = 1.0
    with pytest.raises(DatabaseError, match="checksum"):
        SteDatabase.from_netcdf(tmp_path / "ste.nc")
