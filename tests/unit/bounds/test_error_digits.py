"""A number ends with the second digit of its error, and reads back within half of its last place."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bounds.error_digits import change_text, error_text, to_error, with_error

numbers = st.floats(1e-3, 1e6).flatmap(lambda size: st.sampled_from([size, -size]))


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (9.7861, 0.0347, "9.786 ± 0.035 µm"),
        (9.7861, 0.0996, "9.79 ± 0.10 µm"),  # rounds up to a further digit
        (12345.0, 123.4, "12340 ± 120 µm"),
        (1238.9, 4321.0, "1200 ± 4300 µm"),
        (-1.98e-12, 1e-3, "0.0000 ± 0.0010 µm"),  # no -0, no 1.98e-12
        (3.1, 0.0, "3.1 ± 0 µm"),
        (3.1, math.nan, "3.100 µm"),
        (5.0, 1e-14, "5.000000 ± 10e-15 µm"),
        (math.nan, 0.1, "none"),
    ],
)
def test_a_number_is_written_to_its_error(value, error, text):
    assert with_error(value, error, "µm") == text


@given(numbers, st.floats(1e-3, 1e3))
def test_both_texts_end_at_one_place_and_read_back(value, share):
    error = abs(value) * share
    number, band = to_error(value, error), error_text(value, error)
    assert len(number.partition(".")[2]) == len(band.partition(".")[2])
    assert float(band) == pytest.approx(error, rel=0.05)
    assert abs(float(number) - value) <= 0.051 * error


@given(numbers)
def test_a_number_has_no_more_than_seven_digits(value):
    digits = to_error(value, abs(value) * 1e-12).lstrip("-").replace(".", "").lstrip("0")
    assert len(digits.partition("e")[0]) <= 7


@pytest.mark.law
@pytest.mark.parametrize(
    ("change", "error", "written"),
    [
        (0.048, 0.059, "no change"),
        (-0.048, 0.0059, "-0.0480"),
        (12.34, 1.2, "+12.3"),
        (0.0, math.nan, "no change"),
        (0.5, math.nan, "+0.5000"),
        (math.nan, 1.0, "none"),
    ],
)
def test_a_change_below_its_error_is_none(change, error, written):
    assert change_text(change, error) == written
