"""Bounds and quantities: written for their reader, and accepted when they are typed as they are written."""

import math
import pickle
import re
from dataclasses import dataclass
from typing import ClassVar

import pytest

from bounds import (
    Bound,
    Checks,
    Quantity,
    Reader,
    RefusedValue,
    SiNote,
    Text,
    Unit,
    above,
    at_least,
    at_most,
    below,
    exactly,
    from_to,
    integers,
    one_of,
)

CHECKS = Checks(RefusedValue)
UNITS = [Unit("m", 1.0), Unit("mm", 1e-3), Unit("deg", math.pi / 180.0), Unit("N/mm^3", 1e9)]
NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


@dataclass(frozen=True)
class InMillimeters(Reader):
    """A reader whose fields are lengths in mm."""

    knows_si: ClassVar[bool] = False

    @property
    def name(self) -> str:
        return f"{self.field}_mm"

    def field_unit(self, unit: str) -> Unit:
        return Unit("mm" if unit else "", 1e-3)

    def unit(self, value: float, unit: str) -> Unit:
        return Unit("mm", 1e-3) if unit == "m" else Unit(unit)


@pytest.mark.parametrize("unit", UNITS, ids=[unit.name for unit in UNITS])
@pytest.mark.parametrize("limit", [0.087361258749, 1.0 / 3.0, -2.0 / 3.0, 123456.78, 2.116665e-3, 0.0])
def test_limits_are_rounded_to_the_side_that_is_accepted_in_any_unit(limit, unit):
    low, high = (float(text.split()[0]) * unit.factor for text in (unit.low(limit), unit.high(limit)))
    slack = 1e-12 * abs(limit)
    assert low + slack >= limit >= high - slack
    assert low - high <= 1.1e-6 * abs(limit)


def test_a_limit_with_few_digits_is_written_with_few():
    meter = Unit()
    written = (
        meter.low(0.07),
        meter.high(0.07),
        meter.low(0.1 + 0.2),
        meter.high(60.0),
        Unit("mm", 1e-3).low(5e-4),
    )
    assert written == ("0.07", "0.07", "0.3", "60", "0.5 mm")


def test_integers_are_written_out():
    assert str(Bound.of(integers(0, 2**62), integer=True)) == f"an integer from 0 to {2**62}"


@pytest.mark.parametrize("reader", [Reader("length"), InMillimeters("length")], ids=["si", "mm"])
def test_both_ends_of_a_range_are_accepted_as_written(reader):
    low, high = 1.0 / 3.0, 4.2333e-3 * 0.5 * 1e3
    with pytest.raises(RefusedValue) as caught:
        CHECKS.within("length", 5.0, low, high)
    factor = reader.field_unit("").factor
    ends = [float(end) * factor for end in re.findall(NUMBER, caught.value.bound.worded(reader))]
    assert len(ends) == 2
    for end, outside in zip(ends, (1.0 - 1e-5, 1.0 + 1e-5), strict=True):
        CHECKS.within("length", end, low, high)
        with pytest.raises(RefusedValue):
            CHECKS.within("length", end * outside, low, high)


@pytest.mark.parametrize(
    ("bound", "si", "millimeters"),
    [
        (above(0.0), "above 0", "above 0"),
        (
            at_least(5e-4, "m", "the bore", ", so"),
            "at least the bore 0.0005 m, so",
            "at least the bore 0.5 mm, so",
        ),
        (below(0.07, "m"), "below 0.07 m", "below 70 mm"),
        (at_most(0.07), "at most 0.07", "at most 70"),
        (from_to(-5e-4, 1.0), "from -0.0005 to 1", "from -0.5 to 1000"),
        (Bound(0.0, 1.0, high_open=True), "from 0 to below 1", "from 0 to below 1000"),
        (Bound(0.0, 1.0, low_open=True), "above 0 and at most 1", "above 0 and at most 1000"),
        (exactly(0.025, ", to fit"), "0.025, to fit", "25, to fit"),
        (from_to(-0.0, 0.0, "m", note=", in the middle"), "0 m, in the middle", "0 mm, in the middle"),
        (at_least(-0.0), "at least 0", "at least 0"),
        (one_of(("on", "off")), 'one of "on", "off"', 'one of "on", "off"'),
        (one_of(()), "absent", "absent"),
    ],
)  # fmt: skip
def test_a_bound_is_written_in_the_unit_of_its_field(bound, si, millimeters):
    assert (str(bound), bound.worded(InMillimeters())) == (si, millimeters)


def test_numbers_in_words_are_converted_and_remarks_on_si_left_out():
    text = Text.of(
        "A key of ", Quantity(8e-3, "m"), " has ", Quantity(2.0 / 3.0, digits=2), ". ", SiNote("In m.")
    )
    assert str(text) == "A key of 0.008 m has 0.67. In m."
    assert text.worded(InMillimeters()) == "A key of 8 mm has 0.67. "


def test_an_error_speaks_to_its_reader_also_inside_another():
    inner = RefusedValue("width", Quantity(0.03, "m"), at_most(0.025, "m"), SiNote("In m."))
    outer = RefusedValue("case", "a file", Text.of("free of: ", inner))
    assert str(outer) == "case = 'a file': must be free of: width = '0.03 m': must be at most 0.025 m. In m."
    said = "case_mm = 'a file': must be free of: width_mm = '30 mm': must be at most 25 mm"
    assert outer.worded(InMillimeters()) == said


def test_an_error_crosses_process_boundaries_as_data():
    error = RefusedValue("width", 0.03, at_most(0.025, "m"), Text.of("Try ", Quantity(0.02, "m"), "."))
    copy = pickle.loads(pickle.dumps(error)).within("seat")
    assert (copy.field, copy.value, copy.bound, copy.suggestion) == (
        "seat.width",
        0.03,
        error.bound,
        error.suggestion,
    )
    assert copy.worded(InMillimeters()) == "seat.width_mm = 0.03: must be at most 25 mm. Try 20 mm."
