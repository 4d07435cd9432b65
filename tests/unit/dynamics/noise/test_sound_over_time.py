"""Sound power over the time of a run: that of its orders, Parseval, impacts that no order holds, bands."""

from __future__ import annotations

import tracemalloc
from functools import cache

import numpy as np
import pytest
from hulls import box
from reduced_housings import bare_housing
from sounding_housings import smooth_motion, with_surface
from sounding_scene import housing
from swept_runs import RATE, drawn_amplitudes, order_forces, swept_run

from dynamics.acoustics import EquivalentRadiatedPower, a_weighting
from dynamics.errors import InputError
from dynamics.noise import SoundOverTime, housing_radiation, radiated_sound, sound_over_time
from dynamics.orders import bearing_orders
from dynamics.vibration import motion_pieces, run_seat_forces, time_signal

ORDERS, TOLERANCE = 3, 0.3  # dB
FORCE = order_forces(drawn_amplitudes(ORDERS))


@cache
def radiation():
    return housing_radiation(housing(), EquivalentRadiatedPower(), [25.0, 7800.0])


def levels(run):
    """Over time, and of the orders at the same times, dB and dB(A)."""
    found = sound_over_time(run, housing(), None, radiation())
    orders = bearing_orders(run, ORDERS)
    by_order = radiated_sound(orders, housing(), None, radiation()).orders
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
    found = sound_over_time(run, housing(), None, radiation())
    center, power = radiated_sound(
        bearing_orders(run, ORDERS), housing(), None, radiation()
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
    found = sound_over_time(run, body, None, radiation(), 0.25)
    every = np.eye(len(body.stiffness))
    velocity = np.concatenate(list(motion_pieces(body, run.time, run_seat_forces(run, body), every)))
    samples = round(0.25 * RATE)
    matrix = radiation().impedance * radiation().surface
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
        sound_over_time(swept_run(620.0, 620.0, 1.0, force), housing(), None, radiation())
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
            radiation(),
        )
        for scale in (1.0, 2.0)
    )
    np.testing.assert_allclose(twice.power, 4.0 * once.power, rtol=1e-6)
    weighting = once.total_weighted_level - once.total_level
    np.testing.assert_allclose(weighting[2:], a_weighting(1000.0), atol=0.02)


def test_a_block_longer_than_the_run_is_refused():
    run = swept_run(620.0, 620.0, 0.2, FORCE)
    with pytest.raises(InputError, match="block"):
        sound_over_time(run, housing(), None, radiation(), 0.3)


def test_housings_of_one_run_add_up_in_power():
    found = sound_over_time(swept_run(620.0, 620.0, 0.3, FORCE), housing(), None, radiation())
    both = SoundOverTime.of_all([found, found])
    np.testing.assert_allclose(both.total_level - found.total_level, 10.0 * np.log10(2.0))
    np.testing.assert_allclose(both.total_weighted_level - found.total_weighted_level, 10.0 * np.log10(2.0))
    np.testing.assert_allclose(both.power, 2.0 * found.power)
    shorter = sound_over_time(swept_run(620.0, 620.0, 0.2, FORCE), housing(), None, radiation())
    with pytest.raises(InputError, match=r"sounds\[1\]"):
        SoundOverTime.of_all([found, shorter])
    with pytest.raises(InputError, match="sounds"):
        SoundOverTime.of_all([])


@pytest.mark.parametrize("block", [0.05, 0.25])
def test_pieces_in_which_it_is_computed_do_not_show(monkeypatch, block):
    """Blocks are shorter and longer than a piece of 0.1 s."""
    run = swept_run(620.0, 700.0, 1.0, FORCE)
    found = sound_over_time(run, housing(), None, radiation(), block)
    monkeypatch.setattr(time_signal, "PIECE", 2 * run.time.size)
    whole = sound_over_time(run, housing(), None, radiation(), block)
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
