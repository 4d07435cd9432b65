from __future__ import annotations

import math

import pytest

from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.geometry import BasicRack


def test_full_fillet_of_the_standard_rack() -> None:
    # (pi/4 - 1.25 tan 20) cos 20 / (1 - sin 20), by hand
    assert BasicRack(4e-3).full_fillet_coefficient == pytest.approx(0.4719109, abs=5e-7)


def test_full_fillet_is_accepted_and_more_is_refused() -> None:
    limit = BasicRack(4e-3).full_fillet_coefficient
    assert BasicRack(4e-3, root_radius_coefficient=limit).root_radius == pytest.approx(limit * 4e-3)
    with pytest.raises(InfeasibleGeometry) as caught:
        BasicRack(4e-3, root_radius_coefficient=limit + 1e-6)
    assert caught.value.name == "root radius"
    assert caught.value.field == "root_radius_coefficient"


def test_flanks_that_cross_above_the_root_are_refused_even_without_rounding() -> None:
    with pytest.raises(InfeasibleGeometry) as caught:
        BasicRack(4e-3, dedendum_coefficient=2.3, root_radius_coefficient=0.0)
    assert caught.value.name == "root radius"


@pytest.mark.parametrize(
    ("field", "value", "named"),
    [
        ("normal_module", 0.0, "normal_module"),
        ("normal_module", math.nan, "normal_module"),
        ("normal_pressure_angle", 20.0, "normal_pressure_angle"),
        ("addendum_coefficient", -1.0, "addendum_coefficient"),
        ("dedendum_coefficient", 0.0, "dedendum_coefficient"),
        ("root_radius_coefficient", -0.1, "root_radius_coefficient"),
    ],
)
def test_values_out_of_bounds_are_named(field: str, value: float, named: str) -> None:
    with pytest.raises(InputError) as caught:
        BasicRack(**({"normal_module": 4e-3} | {field: value}))
    assert caught.value.field == named
