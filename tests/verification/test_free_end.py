"""The closed form of a free end against finite elements of a quarter space, and its laws."""

import math

import numpy as np
import pytest

from benchmarks.quarter_space import QuarterDisc, largest_difference, quarter_space_excess
from fe_contact.contact.free_end import ENDLESS, FreeEnds, end_excess, end_softness

COARSE = QuarterDisc(radius=16.0, under_strip=4, angles=5)


@pytest.mark.law
@pytest.mark.parametrize("poissons_ratio", [0.2, 0.3])
def test_the_closed_form_is_that_of_a_quarter_space(poissons_ratio):
    """Of an excess of 0.3 and 0.6 between the end and five half strips from it."""
    assert largest_difference(COARSE, poissons_ratio, layers=10) < 0.03


@pytest.mark.law
def test_without_lateral_contraction_an_end_is_as_stiff_as_the_middle():
    _, excess = quarter_space_excess(COARSE, 0.0, layers=6)
    assert np.abs(excess).max() < 1e-9
    assert end_softness(0.0) == 0.0


ENDS = FreeEnds(-5e-3, 5e-3, end_softness(0.3))
FACE = np.linspace(-4.9e-3, 4.9e-3, 50)


def test_the_excess_fades_within_some_strips_and_is_alike_at_both_ends():
    excess = end_excess(ENDS, FACE, 0.2e-3, np.array(0.1e-3), 0.4e-3)
    assert excess == pytest.approx(excess[::-1], rel=1e-12)
    assert np.all(np.diff(excess[:25]) < 0.0)
    assert excess[0] > 20.0 * excess[10] > 0.0
    assert end_excess(ENDLESS, FACE, 0.2e-3, np.array(0.1e-3), 0.4e-3).tolist() == [0.0] * 50


def test_at_the_end_it_is_the_logarithm_of_the_strips():
    (excess,) = end_excess(ENDS, np.array([-5e-3]), 1e-12, np.array(0.1e-3), 0.4e-3)
    assert excess == pytest.approx(ENDS.softness * math.log(4.0), rel=1e-4)


def test_the_mean_over_a_stretch_is_that_of_its_parts():
    parts = end_excess(ENDS, -5e-3 + 0.1e-3 * np.arange(0.5, 4.0), 0.1e-3, np.array(0.05e-3), 0.4e-3)
    (whole,) = end_excess(ENDS, np.array([-4.8e-3]), 0.4e-3, np.array(0.05e-3), 0.4e-3)
    assert parts.mean() == pytest.approx(whole, rel=1e-12)


def test_a_strip_of_no_load_is_a_number():
    assert np.isfinite(end_excess(ENDS, FACE, 0.2e-3, np.array(0.0), 0.4e-3)).all()
