"""Units of REXS: values in SI, other quantities refused by name."""

from __future__ import annotations

import math

import pytest

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.vocabulary import si_value

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
def test_values_in_si(value: float, unit: str | None, expected: str, si: float) -> None:
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
def test_a_unit_of_another_quantity_is_refused_by_name(unit: str | None, expected: str) -> None:
    with pytest.raises(BadInput, match="component 4, face_width, unit"):
        si_value(1.0, unit, expected, "component 4, face_width")
