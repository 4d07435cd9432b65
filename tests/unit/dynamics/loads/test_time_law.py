"""Laws of time: values, exact integrals, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dynamics.arrays.arrays import revolutions
from dynamics.errors import InputError
from dynamics.loads import TimeLaw

LAWS = [
    TimeLaw.constant(7.0),
    TimeLaw.ramp(0.0, 100.0, 5.0),
    TimeLaw.ramp(-20.0, 80.0, 2.0, begin=1.0, shape="smooth"),
    TimeLaw((-1.0, 0.5, 2.0, 4.0), (3.0, -5.0, 40.0, 0.0)),
]


def test_a_ramp_runs_straight_and_holds():
    law = TimeLaw.ramp(10.0, 30.0, 4.0, begin=1.0)
    np.testing.assert_allclose(law(np.array([-9.0, 1.0, 3.0, 5.0, 99.0])), [10, 10, 20, 30, 30])


def test_a_smooth_ramp_has_no_corner():
    law = TimeLaw.ramp(0.0, 1.0, 1.0, shape="smooth")
    step = 1e-5
    for knot in (0.0, 1.0):
        slopes = [(law(knot + step) - law(knot)) / step, (law(knot) - law(knot - step)) / step]
        np.testing.assert_allclose(slopes, 0.0, atol=1e-4)
    assert law(0.5) == pytest.approx(0.5)


@pytest.mark.parametrize("law", LAWS)
def test_revolutions_are_the_integral_from_time_zero(law):
    whole, fraction = revolutions(law)
    start, _ = law.polynomials()
    for piece, begin in enumerate(start):
        grid = np.linspace(0.0, begin, 400_001)
        angle = np.trapezoid(law(grid), grid)
        assert whole[piece] + fraction[piece] == pytest.approx(angle / (2 * math.pi), abs=1e-8)
    assert np.all((fraction >= 0.0) & (fraction < 1.0))


@pytest.mark.parametrize(
    ("time", "value", "shape", "field"),
    [
        ((1.0, 1.0), (0.0, 1.0), "linear", "time"),
        ((0.0, 1.0), (0.0,), "linear", "value"),
        ((0.0, 1.0), (0.0, math.nan), "linear", "value[1]"),
        ((0.0, 1.0), (0.0, 1.0), "cubic", "shape"),
        ((), (), "linear", "time"),
    ],
)
def test_bad_laws_are_refused_by_name(time, value, shape, field):
    with pytest.raises(InputError) as caught:
        TimeLaw(time, value, shape)
    assert caught.value.field == field
