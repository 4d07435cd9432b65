"""Numbers for people: as plain as can be, and exponents of engineers."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from repository import ROOT

from bounds import engineering, leftover

NUMBERS = st.floats(-1e308, 1e308).filter(lambda value: abs(value) > 1e-290)
"""What is rounded up beyond the largest float is none to read back."""


@given(NUMBERS, st.integers(1, 4))
def test_it_is_the_number_to_its_digits(value, digits):
    text = engineering(value, digits)
    assert float(text) == pytest.approx(value, rel=0.5000001 * 10.0 ** (1 - digits))
    mantissa, _, exponent = text.partition("e")
    if exponent:
        assert int(exponent) % 3 == 0
        assert 1.0 <= abs(float(mantissa)) < 1000.0
        assert not 1e-6 <= abs(value) < 9.4e6
    else:
        assert abs(value) >= 0.9e-6 and abs(value) < 1e7


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (140.0, 2, "140"),
        (-1.6e-8, 2, "-16e-9"),
        (99.6, 2, "100"),
        (0.5, 2, "0.5"),
        (1234.5, 3, "1230"),
        (0.0, 2, "0"),
        (2.5e-5, 2, "0.000025"),
        (2e-5, 2, "0.00002"),
        (1.23e8, 3, "123e6"),
        (math.inf, 2, "inf"),
    ],
)
def test_how_it_reads(value, digits, text):
    assert engineering(value, digits) == text


def test_a_sign_is_written_where_it_is_wanted():
    assert [engineering(value, 2, "+") for value in (140.0, -0.5, 3e9)] == ["+140", "-0.5", "+3e9"]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (19e-18, "below 1e-12"),
        (-3e-13, "below 1e-12"),
        (0.0, "below 1e-12"),
        (-2.4e-8, "20e-9"),
        (0.3, "0.3"),
    ],
)
def test_what_rounding_leaves_has_no_digits(value, text):
    assert leftover(value) == text


def test_no_other_way_of_writing_one_or_two_digits_is_left():
    """One or two digits by ``%g`` would have an exponent from 10 or 100 on."""
    written = re.compile(r"\{[^{}]+:\+?\.[12]g\}")
    for package in (
        "bounds",
        "fe_contact",
        "dynamics",
        "model_studies",
        "lineofaction",
        "service",
        "verification",
    ):
        for file in (ROOT / package).rglob("*.py"):
            for line in file.read_text(encoding="utf-8").splitlines():
                assert not written.search(line) or 'float(f"' in line, f"{file}: {line.strip()}"
