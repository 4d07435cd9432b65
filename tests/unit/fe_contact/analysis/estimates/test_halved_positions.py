"""What even positions miss is told from half of them: never less than is true, and falling as it does."""

from __future__ import annotations

import numpy as np
import pytest

from fe_contact.analysis.estimates.position_errors import errors_by_halves
from fe_contact.ste.curve_quantities import PEAK_TO_PEAK, quantity_changes
from fe_contact.types import FloatArray

FINE = np.arange(8192) / 8192


def knots(count: int, period: int = 1) -> FloatArray:
    """Return even positions."""
    return np.arange(count * period) / count


def kinked(position: FloatArray) -> FloatArray:
    """Return a curve of straight lines with corners at odd places, one peak narrower than a sixteenth."""
    corners, heights = [0.0, 0.137, 0.411, 0.463, 0.871, 1.0], [1.0, 1.2, 1.1, 1.7, 0.6, 1.0]
    return np.interp(position % 1.0, corners, heights)[:, None]


def smooth(position: FloatArray) -> FloatArray:
    """Return a curve whose harmonics fall slowly."""
    turn = 2.0 * np.pi * position
    return (1.0 + 0.3 * np.cos(turn) / (1.3 - np.sin(turn + 0.4)))[:, None]


@pytest.mark.parametrize("count", [32, 64, 192])
def test_errors_hold_for_corners_wherever_they_stand(count: int) -> None:
    """Straight lines between corners at random places, a few positions apart: misses are few."""
    random, position, ratio = np.random.default_rng(7), knots(count), []
    for _ in range(60):
        corners = (np.arange(5) + 0.6 * random.random(5)) / 5.0
        heights = 1.0 + random.random(5)
        closed = np.concatenate([[corners[-1] - 1.0], corners, [corners[0] + 1.0]])
        around = np.concatenate([heights[-1:], heights, heights[:1]])
        values, true = (np.interp(where, closed, around)[:, None] for where in (position, FINE))
        change = quantity_changes(position, values, true, 1, FINE)[:3, 0]
        ratio.append(errors_by_halves(position, values, 1).curves[:3, 0] / np.maximum(change, 1e-9))
    held = np.mean(np.array(ratio) >= 1.0, axis=0)
    assert held.mean() >= 0.9
    assert np.median(ratio) < 6.0


@pytest.mark.parametrize("count", [16, 32, 64])
def test_errors_hold_for_a_smooth_curve(count: int) -> None:
    position, values = knots(count), smooth(knots(count))
    true = quantity_changes(position, values, smooth(FINE), 1, FINE)[:3, 0]
    assert np.all(errors_by_halves(position, values, 1).curves[:3, 0] >= true)


def test_of_a_smooth_curve_they_fall_at_least_with_the_square_of_the_spacing() -> None:
    coarse, fine = (errors_by_halves(knots(n), smooth(knots(n)), 1).curves[:3, 0] for n in (32, 64))
    assert np.all(coarse / fine > [4.0, 3.0, 4.0])  # a peak stands anywhere between two positions


def test_a_corner_between_two_positions_counts_in_peak_to_peak() -> None:
    position = knots(32)
    peaked = np.maximum(0.0, 1.0 - np.abs(position - (8.5 / 32)) * 8.0)[:, None]
    missed = 1.0 - peaked.max()
    assert missed > 0.1
    assert errors_by_halves(position, peaked, 1).curves[PEAK_TO_PEAK, 0] >= missed


def test_errors_scale_with_the_curve_and_ignore_its_level() -> None:
    position, values = knots(32), kinked(knots(32))
    plain = errors_by_halves(position, values, 1)
    moved = errors_by_halves(position, 3.0 * values + 7.0, 1)
    assert moved.curves[1:] == pytest.approx(3.0 * plain.curves[1:], rel=1e-9, abs=1e-14)
    assert moved.band == pytest.approx(3.0 * plain.band, rel=1e-9, abs=1e-14)


def test_a_curve_repeated_over_three_pitches_has_the_errors_of_one() -> None:
    one, three = (errors_by_halves(knots(32, n), kinked(knots(32, n)), n) for n in (1, 3))
    assert three.curves[:3] == pytest.approx(one.curves[:3], rel=1e-6, abs=1e-12)
    assert three.band[:32] == pytest.approx(one.band, rel=1e-9, abs=1e-14)


def test_the_band_holds_what_a_position_in_the_middle_would_show() -> None:
    position = knots(64)
    band = errors_by_halves(position, smooth(position), 1).band[:, 0]
    middle = smooth(position + 0.5 / 64)[:, 0]
    ahead = 0.5 * (smooth(position) + smooth(position + 1.0 / 64))[:, 0]
    assert np.mean(band > 0.0) > 0.9 and band.max() < np.abs(middle - ahead).max()
