"""Mesh orders of bearing forces along a run: exact at any sweep, phases, smearing, what orders leave."""

import numpy as np
import pytest
from swept_runs import BEARINGS, TEETH, drawn_amplitudes, order_forces, swept_run

from dynamics.errors import InputError
from dynamics.orders import bearing_orders

AMPLITUDES = drawn_amplitudes(3)


@pytest.mark.parametrize(("start", "end"), [(300.0, 900.0), (900.0, 300.0), (-300.0, -900.0), (500.0, 500.0)])
def test_orders_of_constant_amplitude_are_found_with_their_phases_at_any_sweep(start, end):
    """Turning backwards, the phasor is that of the angle that rises: the conjugate."""
    found = bearing_orders(swept_run(start, end, 1.0, order_forces(AMPLITUDES)), 3)
    expected = AMPLITUDES if start > 0.0 else AMPLITUDES.conj()
    assert found.bearing == BEARINGS
    np.testing.assert_array_equal(found.order, [1.0, 2.0, 3.0])
    np.testing.assert_allclose(
        found.bearing_force, np.broadcast_to(expected[:, :, None], found.bearing_force.shape), rtol=1e-6
    )
    np.testing.assert_allclose(found.frequency, np.outer(found.frequency[:, 0], [1.0, 2.0, 3.0]))
    np.testing.assert_allclose(found.speed, 2.0 * np.pi * found.frequency[:, 0] / TEETH)
    assert found.remainder.max() < 1e-9 and np.all(found.in_contact)


def test_windows_go_by_speed_in_a_run_up_and_a_run_down_and_by_time_at_constant_speed():
    up, down, even = (
        bearing_orders(swept_run(*ends, 1.0, order_forces(AMPLITUDES)), 3)
        for ends in ((300.0, 900.0), (900.0, 300.0), (500.0, 500.0))
    )
    assert np.all(np.diff(up.speed) > 0.0) and np.all(np.diff(up.time) > 0.0)
    assert np.all(np.diff(down.speed) > 0.0) and np.all(np.diff(down.time) < 0.0)
    assert np.ptp(even.speed) < 1e-9 * even.speed[0] and np.all(np.diff(even.time) > 0.0)
    at = np.interp(up.time, [0.0, 1.0], [300.0, 900.0])
    np.testing.assert_allclose(up.frequency[:, 0], at, rtol=1e-9)
    np.testing.assert_allclose(up.sweep, 600.0 * 16 / at**2, rtol=0.05)  # pitches, rate of the frequency


def test_a_resonance_is_rounded_off_as_stated():
    """An amplitude 1/(1 + i x) along the sweep: its loss is the smearing stated, up to its square."""
    center, ratio = 700.0, 0.02

    def force(cycles, hertz, _time):
        gain = 1.0 / (1.0 + 1j * (hertz[0] - center) / (ratio * center))
        return np.broadcast_to((gain * np.exp(2j * np.pi * cycles[0])).real, (4, 3, hertz.shape[1]))

    modes = {"frequency": [center, 5000.0], "damping_ratio": [ratio, 0.02]}
    seen = []
    for pitches in (24, 48, 96):
        found = bearing_orders(swept_run(400.0, 1000.0, 4.0, force, modes=modes), 1, pitches)
        hertz = found.frequency[:, 0]
        gain = 1.0 / (1.0 + 1j * (hertz - center) / (ratio * center))
        error = np.abs(found.bearing_force[0, 0, :, 0] - gain) / np.abs(gain)
        near = np.abs(hertz - center) < 60.0
        stated = found.smearing[near, 0]
        assert np.all(error[near] < 1.1 * stated + 1e-3)
        assert error[near].max() > 0.7 * stated.max()
        seen.append(stated.max())
    assert seen[1] / seen[0] == pytest.approx(4.0, rel=0.15)
    assert 0.02 < seen[2] < 0.2


def test_without_modes_nothing_is_stated():
    assert np.all(np.isnan(bearing_orders(swept_run(300.0, 900.0, 1.0, order_forces(AMPLITUDES))).smearing))


@pytest.mark.parametrize("share", [0.1, 0.4])
def test_what_belongs_to_no_order_is_stated_as_its_share_of_the_variance(share):
    """A tone half way between two orders in one bearing alone; one above the band is not counted."""
    single = np.zeros((4, 3, 3), dtype=complex)
    single[:, 0, 1] = 100.0

    def force(cycles, hertz, time):
        made = order_forces(single)(cycles, hertz, time)
        other = 100.0 * np.sqrt(share / (1.0 - share))
        made[2, 1] += other * np.cos(2.0 * np.pi * 1.5 * cycles[0])
        made[2, 2] += 80.0 * np.cos(2.0 * np.pi * 5.0 * cycles[0])
        return made

    found = bearing_orders(swept_run(500.0, 900.0, 1.0, force), 3)
    np.testing.assert_allclose(found.remainder[2], share, rtol=0.02)
    assert found.remainder[[0, 1, 3]].max() < 1e-6


def test_orders_of_a_second_mesh_are_told_apart_in_windows_that_are_long_enough():
    ratio = 21.0 / 40.0
    second = 30.0 * np.exp(0.7j)

    def force(cycles, hertz, time):
        made = order_forces(AMPLITUDES)(cycles, hertz, time)
        return made + (second * np.exp(2j * np.pi * 2.0 * cycles[1])).real

    run = swept_run(600.0, 660.0, 1.0, force, ratios=(1.0, ratio))
    found = bearing_orders(run, 3)
    orders = np.sort([1.0, 2.0, 3.0, *(ratio * np.arange(1, 6))])
    np.testing.assert_allclose(found.order, orders)
    np.testing.assert_allclose(found.frequency, np.outer(found.frequency[:, 1], orders))
    assert found.metadata["pitches"] == 40  # 2 cycles of the distance 0.05
    np.testing.assert_allclose(found.bearing_force[1, 2, :, 2], second, rtol=1e-6)
    np.testing.assert_allclose(found.bearing_force[1, 2, :, 4], AMPLITUDES[1, 2, 1], rtol=1e-6)
    with pytest.raises(InputError, match="at least 40"):
        bearing_orders(run, 3, pitches=30)
    same = bearing_orders(swept_run(600.0, 660.0, 1.0, force, ratios=(1.0, 0.5)), 2)
    np.testing.assert_allclose(same.order, [0.5, 1.0, 1.5, 2.0])  # shared harmonics once


def test_a_window_in_which_flanks_part_is_marked():
    run = swept_run(
        500.0, 500.0, 1.0, order_forces(AMPLITUDES), parted=lambda time: np.abs(time - 0.5) < 1e-4
    )
    found = bearing_orders(run, 3)
    half = 0.5 * 16 / 500.0
    np.testing.assert_array_equal(found.in_contact, np.abs(found.time - 0.5) > half)
    assert 1 <= np.sum(~found.in_contact) <= 2


def test_standstill_and_reversal_have_no_windows():
    found = bearing_orders(swept_run(-600.0, 900.0, 2.0, order_forces(AMPLITUDES)), 3)
    assert found.metadata["windows_left_out"] > 0
    assert found.frequency.min() > 0.0 and found.sweep.max() <= 0.2
    np.testing.assert_allclose(found.bearing_force[..., -1, :], AMPLITUDES, rtol=1e-6)


def test_force_scales_and_superposes():
    run = swept_run(300.0, 900.0, 1.0, order_forces(AMPLITUDES))
    other = swept_run(300.0, 900.0, 1.0, order_forces(drawn_amplitudes(3, seed=9)))
    both = swept_run(300.0, 900.0, 1.0, lambda *at: 2.0 * run.bearing_force - other.bearing_force)
    first, second, sum_of = (bearing_orders(each, 3).bearing_force for each in (run, other, both))
    np.testing.assert_allclose(sum_of, 2.0 * first - second, atol=1e-9 * np.abs(first).max())


def test_what_a_run_does_not_hold_is_refused():
    run = swept_run(300.0, 900.0, 1.0, order_forces(AMPLITUDES))
    with pytest.raises(InputError, match=r"orders = 9.*at most 8.*outputs\.mesh_orders = 9"):
        bearing_orders(run, 9)
    with pytest.raises(InputError, match="bearing_force"):
        bearing_orders(swept_run(300.0, 900.0, 0.1, lambda *_: np.empty((0, 3, 0)), bearings=()), 3)
    with pytest.raises(InputError, match="at least 16, the length of a window"):
        bearing_orders(swept_run(300.0, 310.0, 0.04, order_forces(AMPLITUDES)), 3)
    with pytest.raises(InputError, match="Run up more slowly"):
        bearing_orders(swept_run(100.0, 900.0, 0.05, order_forces(AMPLITUDES)), 3)
    with pytest.raises(InputError, match="a mesh that turns"):
        bearing_orders(swept_run(0.0, 0.0, 0.1, order_forces(AMPLITUDES)), 3)
