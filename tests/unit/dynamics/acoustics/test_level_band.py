"""Bands of a level: monotone in the ranges, and coverage of random cases."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.acoustics import LevelBand, Range, level_bands
from dynamics.errors import InputError


def resonance(values) -> float:
    """Level of an oscillator driven at 1.02 of its nominal frequency."""
    ratio = 1.02 / values["frequency"]
    return -10.0 * np.log10((1.0 - ratio**2) ** 2 + (2.0 * values["damping"] * ratio) ** 2)


def level_band(level, ranges) -> LevelBand:
    """Return the band of one level."""
    return level_bands(lambda values: np.array([level(values)]), ranges)[0]


DAMPING, FREQUENCY = Range(0.005, 0.01, 0.02), Range(0.97, 1.0, 1.0)


def test_damping_at_resonance_moves_the_level_by_its_ratio() -> None:
    at = {"damping": DAMPING, "frequency": Range(1.02, 1.02, 1.02)}
    band = level_band(resonance, at)
    assert band.nominal == pytest.approx(-20.0 * np.log10(0.02))
    assert (band.high - band.nominal, band.nominal - band.low) == pytest.approx((6.0206, 6.0206), abs=1e-4)


def test_a_wider_range_never_narrows_the_band() -> None:
    low, high = np.inf, -np.inf
    for width in (0.0, 0.2, 0.5, 1.0):
        span = Range(0.01 - 0.005 * width, 0.01, 0.01 + 0.01 * width)
        band = level_band(resonance, {"damping": span, "frequency": FREQUENCY})
        assert band.low <= low
        assert band.high >= high
        low, high = band.low, band.high
    wider = band.with_error("boundary elements", 1.0, 2.0)
    assert wider.low < band.low < band.nominal == wider.nominal < band.high < wider.high


def test_a_band_of_several_guesses_holds_nine_of_ten_cases() -> None:
    ranges = {
        name: Range(-size, 0.0, size) for name, size in zip("abcde", (1.0, 2.0, 3.0, 2.0, 1.5), strict=True)
    }
    band = level_band(lambda values: sum(values.values()), ranges)
    rng = np.random.default_rng(10)
    cases = sum(rng.uniform(span.low, span.high, 20_000) for span in ranges.values())
    inside = np.mean((cases >= band.low) & (cases <= band.high))
    assert 0.9 < inside < 0.95
    assert band.high < sum(span.high for span in ranges.values())


def test_a_range_without_its_nominal_value_is_refused() -> None:
    with pytest.raises(InputError, match="nominal"):
        Range(0.1, 0.05, 0.2)
    with pytest.raises(InputError, match="model"):
        level_band(resonance, {"damping": DAMPING, "frequency": FREQUENCY}).with_error("model", -1.0, 0.0)
