"""Tables over several base pitches: equal pitches are one pitch; differences show between mesh harmonics."""

from __future__ import annotations

from dataclasses import replace

import h5netcdf
import numpy as np
import pytest

from fe_contact.errors import DatabaseError
from fe_contact.ste import SteDatabase

FORCE = 3000.0


@pytest.fixture(scope="module")
def uneven(make):
    """Knots of no pattern, the first not at 0."""
    knots = np.sort(np.random.default_rng(4).uniform(0.0, 1.0, 40))
    return make(position=knots, relief=3e-6)


@pytest.mark.parametrize("period", [2, 7])
def test_equal_pitches_written_out_answer_as_one(uneven, repeat, period):
    many = repeat(uneven, period)
    x = np.random.default_rng(5).uniform(0.0, 1.0, 300)
    for turns in (0, 1, period - 1, 3 * period + 1, -2):
        np.testing.assert_allclose(many.ste(x + turns, FORCE), uneven.ste(x, FORCE), rtol=1e-12)
        one, same = uneven.force_at(x, 9e-6), many.force_at(x + turns, 9e-6)
        np.testing.assert_allclose(same.force, one.force, rtol=1e-11)
        np.testing.assert_allclose(same.position_slope, one.position_slope, rtol=1e-9, atol=1e-3)


def test_equal_pitches_have_the_figures_of_one_and_no_sidebands(uneven, repeat):
    one, many = uneven.curve(force=FORCE), repeat(uneven, 7).curve(force=FORCE)
    assert float(many.mean) == pytest.approx(float(one.mean), rel=1e-12, abs=0.0)
    assert float(many.peak_to_peak) == pytest.approx(float(one.peak_to_peak), rel=1e-12, abs=0.0)
    np.testing.assert_allclose(
        [float(a) for a in many.harmonics], [float(a) for a in one.harmonics], atol=1e-18
    )
    between = many.spectrum.order % 1.0 != 0.0
    assert many.spectrum.order[-1] == 20.0
    assert many.spectrum.amplitude[between].max() < 1e-12 * float(one.mean)


def test_equal_pitches_share_the_load_as_one(uneven, repeat):
    """Also beside the knots, and at the seams between pitches."""
    x = np.concatenate([np.random.default_rng(6).uniform(0.0, 1.0, 200), [0.0, 1.0 - 1e-12]])
    one = uneven.curve(force=FORCE, at=x)
    many = repeat(uneven, 5)
    for turns in (0, 4, 11, -3):
        curve = many.curve(force=FORCE, at=x + turns)
        assert np.array_equal(curve.pair, one.pair)
        np.testing.assert_allclose(curve.load_share, one.load_share, atol=1e-9)


def test_the_share_of_a_pair_of_teeth_is_continuous_over_its_mesh(uneven, repeat):
    """Every pair of teeth has a share of its own; what is pair j becomes pair j + 1 at a whole pitch."""
    many = repeat(uneven, 5)
    share = many.load_share.copy()
    teeth = (many.pair - np.floor(many.position).astype(int)[:, None]) % 5
    share *= (1.0 + 0.3 * np.cos(teeth * 2.0))[:, None, None, None, :]
    share /= share.sum(axis=-1, keepdims=True)
    table = replace(many, load_share=share)
    for seam in (1.0, 3.0, 5.0):
        before, after = (table.curve(force=FORCE, at=[seam + s]).load_share[0] for s in (-1e-9, 1e-9))
        np.testing.assert_allclose(before[:-1], after[1:], atol=1e-6)
    stored = table.curve(force=float(table.force[2])).load_share
    np.testing.assert_allclose(stored, table.load_share[:, 2, 0, 0], atol=1e-12)


def test_a_long_wave_is_an_order_between_the_mesh_harmonics(make, repeat):
    """One cycle in four pitches: order 1/4 of the mesh, 5 of a gear of 20 teeth, besides what was there."""
    one = make(position=np.arange(96) / 96)
    many = repeat(one, 4)
    wave = 2e-7 * np.cos(2 * np.pi * many.position / 4 + 1.1)[:, None, None, None]
    waving = replace(
        many,
        static_transmission_error=many.static_transmission_error + wave,
        no_load_transmission_error=many.no_load_transmission_error + wave[:, 0],
    )
    spectrum = waving.spectrum(force=float(one.force[1]))
    assert spectrum.order[0] == 0.25
    assert spectrum.pinion_order[0] == spectrum.wheel_order[0] == 5.0
    assert spectrum.amplitude[0] == pytest.approx(2e-7, rel=1e-3, abs=0.0)
    assert spectrum.phase[0] == pytest.approx(1.1, abs=2e-3)
    assert spectrum.amplitude[3] == pytest.approx(
        float(one.harmonics(force=float(one.force[1]))[0]), rel=3e-3
    )


def test_a_hunting_cycle_is_answered_within_memory(make, repeat):
    """39 on 40 teeth: 1560 pitches, whose load shares keep the columns of one pitch."""
    cycle = repeat(make(position=[0.1, 0.4, 0.8], force=(1000.0, 3000.0)), 1560)
    curve = cycle.curve(force=2000.0)
    assert curve.load_share.shape == (3 * 1560, 4)
    assert curve.spectrum.order.size == 20 * 1560


def test_the_file_keeps_the_period(uneven, repeat, tmp_path):
    many = repeat(uneven, 7)
    many.to_netcdf(tmp_path / "many.nc")
    back = SteDatabase.from_netcdf(tmp_path / "many.nc")
    assert back.identical(many)
    assert not replace(many, period=8).identical(many)
    assert back.force_table().period == 7
    assert "7 base pitches" in back.summary()


def test_a_file_without_a_period_holds_one_pitch(uneven, tmp_path):
    path = tmp_path / "old.nc"
    uneven.to_netcdf(path)
    with h5netcdf.File(path, "a") as file:
        del file.attrs["period"]
    assert SteDatabase.from_netcdf(path).identical(uneven)


@pytest.mark.parametrize("value", [2, 1.5, "many"])
def test_a_changed_period_is_noticed(uneven, tmp_path, value):
    path = tmp_path / "changed.nc"
    uneven.to_netcdf(path)
    with h5netcdf.File(path, "a") as file:
        del file.attrs["period"]
        file.attrs["period"] = value
    with pytest.raises(DatabaseError, match="damaged"):
        SteDatabase.from_netcdf(path)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"period": 0}, "period must be a whole number"),
        ({"period": 2.0}, "period must be a whole number"),
        ({"period": 1}, r"position must lie in \[0, 1\)"),
    ],
)
def test_positions_and_period_must_fit(uneven, repeat, changes, message):
    with pytest.raises(DatabaseError, match=message):
        replace(repeat(uneven, 2), **changes)
