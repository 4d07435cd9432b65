"""Values of REXS in SI: mixed units read the same, other quantities and doubt are refused by name."""

import math

import pytest

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Component, Value
from lineofaction.gearbox.rexs.vocabulary import quantities, quantity, si_value

VALUES = [
    (3.0, "mm", "mm", 3e-3),
    (3.0, "mum", "mm", 3e-6),
    (180.0, "°", "deg", math.pi),
    (180.0, "deg", "°", math.pi),
    (1.0, "rad", "deg", 1.0),
    (60.0, "1 / min", "rad / s", 2.0 * math.pi),
    (20.0, "C", "K", 293.15),
    (20.0, "N / (mm mum)", "N / (mm mum)", 2e10),
    (5.0, "N mm / rad", "N mm / rad", 5e-3),
    (2.0, "MPa", "N / mm^2", 2e6),
    (40.0, "%", "%", 0.4),
    (0.5, None, "none", 0.5),
    (0.5, "", "none", 0.5),
    (1.0, "MRev", "MRev", 2e6 * math.pi),
]


@pytest.mark.parametrize(("value", "unit", "expected", "si"), VALUES)
def test_values_in_si(value, unit, expected, si):
    assert si_value(value, unit, expected, "here") == pytest.approx(si, rel=1e-15)


OTHERS = [
    ("N", "mm"),
    (None, "mm"),
    ("none", "deg"),
    ("inch", "mm"),
    ("MPa", "N / (mm mum)"),
    ("HV", "HB"),
]


@pytest.mark.parametrize(("unit", "expected"), OTHERS)
def test_a_unit_of_another_quantity_is_refused_by_name(unit, expected):
    with pytest.raises(BadInput, match="component 4, face_width, unit"):
        si_value(1.0, unit, expected, "component 4, face_width")


def gear(name: str, value: Value, unit: str | None, *others: Attribute) -> Component:
    return Component(4, "cylindrical_gear", (Attribute(name, "floating_point", value, unit), *others))


@pytest.mark.parametrize(("value", "unit"), [(20.0, "mm"), (20_000.0, "mum"), (20, "mm")])
def test_units_of_a_length_may_be_mixed(value, unit):
    assert quantity(gear("face_width", value, unit), "face_width", "component 4") == pytest.approx(
        0.02, rel=1e-15
    )


def test_both_spellings_of_a_degree_are_one():
    name = "helix_angle_reference_diameter"
    values = [quantity(gear(name, -21.0, unit), name, "component 4") for unit in ("°", "deg")]
    assert values == [math.radians(-21.0)] * 2


def test_what_the_file_does_not_give_is_none():
    assert quantity(gear("face_width", None, "mm"), "face_width", "component 4") is None
    assert quantity(gear("face_width", 1.0, "mm"), "tip_diameter", "component 4") is None
    assert quantities(gear("face_width", 1.0, "mm"), "support_vector", "component 4") is None


def test_an_array_is_in_si():
    part = gear("support_vector", (1.0, 0.0, -2.0), "mm")
    assert quantities(part, "support_vector", "component 4") == (1e-3, 0.0, -2e-3)


@pytest.mark.parametrize(
    ("value", "unit", "words"),
    [(20.0, "N", "unit"), (20.0, None, "unit"), ("wide", "mm", "a number"), (True, "mm", "a number")],
)
def test_doubt_is_refused_by_name(value, unit, words):
    with pytest.raises(BadInput, match=f"component 4, face_width.*{words}"):
        quantity(gear("face_width", value, unit), "face_width", "component 4")


def test_a_value_given_twice_is_refused():
    part = gear("face_width", 20.0, "mm", Attribute("face_width", "floating_point", 21.0, "mm"))
    with pytest.raises(BadInput, match="given once"):
        quantity(part, "face_width", "component 4")


def test_an_array_is_no_number_and_a_number_no_array():
    with pytest.raises(BadInput, match="a number"):
        quantity(gear("face_width", (1.0,), "mm"), "face_width", "component 4")
    with pytest.raises(BadInput, match="an array"):
        quantities(gear("support_vector", 1.0, "mm"), "support_vector", "component 4")
