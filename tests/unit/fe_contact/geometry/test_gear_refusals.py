"""Gears that cannot exist are refused by the name of what is wrong; their neighbors that can are not."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.geometry import FlankModification, Gear

SHIFT = "profile_shift_coefficient"
INFEASIBLE: list[tuple[str, str, dict[str, Any], dict[str, Any]]] = [
    # name, field, refused, and its feasible neighbor
    ("pointed tooth", "tip_diameter", {"tip_diameter": 0.0925}, {"tip_diameter": 0.0922}),
    ("pointed tooth", "tip_diameter", {"teeth": 8, SHIFT: 0.6}, {"teeth": 8, SHIFT: 0.5}),
    ("bore", "bore_diameter", {"bore_diameter": 0.07}, {"bore_diameter": 0.0699}),
    ("bore", "bore_diameter", {"teeth": 4, SHIFT: -0.7}, {"teeth": 4, SHIFT: -0.3}),
    (
        "root radius",
        "root_radius_coefficient",
        {"root_radius_coefficient": 0.472},
        {"root_radius_coefficient": 0.4719},
    ),
    ("tip diameter", "tip_diameter", {"tip_diameter": 0.0699}, {"tip_diameter": 0.0765}),
    ("tip diameter", "tip_diameter", {"tip_diameter": 0.07528}, {"tip_diameter": 0.07529}),
    (
        "undercut",
        "tip_diameter",
        {"teeth": 6, SHIFT: -0.5, "addendum_coefficient": 0.5},
        {"teeth": 6, SHIFT: -0.4, "addendum_coefficient": 0.5},
    ),
]


@pytest.mark.parametrize(("name", "field", "refused", "feasible"), INFEASIBLE)
def test_infeasible_gear_is_refused_by_name(
    make_gear: Callable[..., Gear], name: str, field: str, refused: dict[str, Any], feasible: dict[str, Any]
) -> None:
    with pytest.raises(InfeasibleGeometry) as caught:
        make_gear(**refused)
    assert caught.value.name == name
    assert caught.value.field == field
    assert str(caught.value.suggestion)
    make_gear(**feasible)


def test_undercut_that_cuts_the_tooth_off_is_refused(make_gear: Callable[..., Gear]) -> None:
    with pytest.raises(InfeasibleGeometry, match="cut the tooth off") as caught:
        make_gear(
            teeth=5,
            profile_shift_coefficient=-0.3,
            bore_diameter=1e-4,
            normal_pressure_angle=math.radians(14.5),
            dedendum_coefficient=1.6,
            root_radius_coefficient=0.1,
        )
    assert caught.value.name == "undercut"


def test_undercut_pinion_is_computed(make_gear: Callable[..., Gear]) -> None:
    gear = make_gear(teeth=9)
    assert gear.form_point.undercut
    assert gear.base_radius < gear.form_radius < gear.tip_radius


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("teeth", 3),
        ("teeth", 20.0),
        ("teeth", True),
        ("face_width", 0.0),
        ("face_width", math.inf),
        ("bore_diameter", -1.0),
        ("normal_module", "4"),
        ("normal_pressure_angle", 20.0),
        ("helix_angle", 15.0),
        ("profile_shift_coefficient", math.nan),
        ("tip_diameter", 0.0),
        ("thickness_allowance", -1e-6),
        ("thickness_allowance", 0.1),
        ("addendum_coefficient", 0.0),
    ],
)
def test_value_out_of_bounds_names_its_field(
    make_gear: Callable[..., Gear], field: str, value: object
) -> None:
    with pytest.raises(InputError) as caught:
        make_gear(**{field: value})
    assert caught.value.field == field
    assert not isinstance(caught.value, InfeasibleGeometry)


@pytest.mark.parametrize(
    ("modification", "field"),
    [
        (FlankModification(tip_relief=1e-5, tip_relief_length=9e-3), "modification.tip_relief_length"),
        (FlankModification(root_relief=1e-5, root_relief_length=9e-3), "modification.root_relief_length"),
        (FlankModification(end_relief=1e-5, end_relief_length=0.0126), "modification.end_relief_length"),
    ],
)
def test_relief_longer_than_the_flank_is_refused(
    make_gear: Callable[..., Gear], modification: FlankModification, field: str
) -> None:
    with pytest.raises(InputError) as caught:
        make_gear(modification=modification)
    assert caught.value.field == field
