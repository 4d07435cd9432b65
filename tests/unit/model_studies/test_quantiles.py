"""The band between two quantiles of a sample holds the share of the population that it says."""

import numpy as np
import pytest
from scipy.stats import norm

from model_studies.spread import quantiles

DRAWN = 4000


@pytest.mark.parametrize("samples", [32, 64, 200])
def test_nine_of_ten_further_members_lie_within_the_band(samples):
    drawn = np.random.default_rng(9).uniform(size=(samples, DRAWN))
    low, high = quantiles(drawn, (0.05, 0.95))
    error = 4.0 * float(np.std(high - low)) / DRAWN**0.5
    assert float(np.mean(high - low)) == pytest.approx(0.9, abs=error)
    assert error < 0.005


@pytest.mark.parametrize("samples", [32, 200])
def test_a_long_tail_is_not_cut(samples):
    drawn = np.random.default_rng(8).normal(size=(samples, DRAWN)) ** 3
    low, high = (norm.cdf(np.cbrt(end)) for end in quantiles(drawn, (0.05, 0.95)))
    assert 0.895 < float(np.mean(high - low)) < 0.92


def test_what_is_missing_is_left_out():
    sample = np.array([[1.0, np.nan], [np.nan, np.nan], [3.0, np.nan], [2.0, np.nan]])
    np.testing.assert_array_equal(quantiles(sample, 0.5), [2.0, np.nan])
    assert np.isnan(quantiles(np.array([]), (0.1, 0.9))).all()
