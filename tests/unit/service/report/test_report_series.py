"""Long series are thinned without losing what is seen, and windows lie where the speed is passed."""

from itertools import pairwise

import numpy as np
import pytest

from lineofaction.report.drawing.placing import envelope
from lineofaction.report.run.view import Travel, window_speeds


def test_the_envelope_keeps_every_peak() -> None:
    rng = np.random.default_rng(7)
    time = np.linspace(0.0, 5.0, 100_001)
    values = rng.normal(size=time.size)
    values[[333, 77_777]] = [9.0, -9.0]
    thin_time, thin = envelope(time, values, 500)
    assert len(thin) <= 1002
    assert np.all(np.diff(thin_time) > 0)
    assert (thin.max(), thin.min()) == (9.0, -9.0)
    stretches = np.linspace(0, time.size, 501).astype(int)
    for first, last in pairwise(stretches):
        inside = (thin_time >= time[first]) & (thin_time <= time[last - 1])
        assert thin[inside].max() == values[first:last].max()


def test_a_short_series_stays_whole() -> None:
    time = np.arange(10.0)
    np.testing.assert_array_equal(envelope(time, time**2)[1], time**2)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("target", [100.0, 400.0, 900.0])
def test_a_window_holds_whole_pitches_around_the_speed(target: float, sign: float) -> None:
    time = np.linspace(0.0, 5.0, 100_001)
    speed = sign * 191.0 * time
    position = sign * 20 * 191.0 / 60 * time**2 / 2
    chosen = Travel(speed, position).window(target)
    traveled = np.abs(position[chosen])
    assert np.ptp(traveled) == pytest.approx(3.0, abs=0.02)
    assert traveled[0] % 1.0 == pytest.approx(0.0, abs=0.02)
    assert np.abs(speed[chosen]).min() <= target <= np.abs(speed[chosen]).max()


def test_a_window_at_the_end_of_the_run_stays_inside() -> None:
    time = np.linspace(0.0, 1.0, 1001)
    chosen = Travel(np.ones_like(time), 10 * time).window(5.0)
    assert chosen.stop <= time.size
    assert np.ptp(10 * time[chosen]) >= 2.9


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_run_at_one_speed_is_shown_at_that_speed_at_its_end(sign: float) -> None:
    time = np.linspace(0.0, 1.0, 1001)
    speed = sign * (3000.0 + np.cos(400.0 * time))
    (shown,) = window_speeds(speed)
    assert shown == pytest.approx(3000.0, abs=1.0)
    chosen = Travel(speed, sign * 50.0 * time).window(shown)
    assert 50.0 * time[chosen][0] == pytest.approx(47.0) and chosen.stop == time.size


def test_speeds_that_a_run_does_not_pass_are_not_shown() -> None:
    assert window_speeds(np.array([500.0, 1000.0])) == (900.0,)
    assert window_speeds(np.array([350.0, 1000.0])) == (400.0, 900.0)
    assert window_speeds(np.array([940.0, 820.0])) == (820.0,)  # 846 is rounded to 800


def test_speeds_are_round() -> None:
    assert window_speeds(np.array([0.0, 955.0])) == (100.0, 400.0, 900.0)
    assert window_speeds(np.array([-167.0, 0.0])) == (20.0, 70.0, 150.0)
