"""Orders of a stretch of a run by least squares: exact on what is periodic, whatever the speed does."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.results.order_fit import order_amplitudes, orders_seen, unwrapped

TIME = np.linspace(0.0, 1.0, 700)
POSITION = 0.3 + 5.0 * TIME + 9.7 * TIME**2  # a ramp over a broken number of pitches


def test_amplitudes_of_a_ramp_over_a_broken_number_of_pitches_are_exact():
    angle = 2.0 * np.pi * POSITION
    values = 7.0 - 2.0 * TIME + 3.0 * np.cos(angle + 0.4) + 0.2 * np.sin(3 * angle - 1.0)
    found = order_amplitudes(POSITION, np.stack([values, 2.0 * values]), 4)
    np.testing.assert_allclose(found, np.outer([1.0, 2.0], [3.0, 0.0, 0.2, 0.0]), atol=1e-12)


@pytest.mark.parametrize("period", [1, 7])
def test_wrapped_positions_run_on(period):
    np.testing.assert_allclose(np.diff(unwrapped(POSITION % period)), np.diff(POSITION), atol=1e-12)
    backwards = unwrapped(-POSITION % period)
    np.testing.assert_allclose(np.diff(backwards), -np.diff(POSITION), atol=1e-12)


def test_orders_with_fewer_than_four_samples_a_period_are_left_out():
    assert orders_seen(np.arange(50) / 8.1, 5) == 2
    assert orders_seen(np.arange(50) / 3.9, 5) == 0
    assert orders_seen(np.arange(50) / 100.0, 5) == 5
    assert orders_seen(np.zeros(50), 5) == 0
