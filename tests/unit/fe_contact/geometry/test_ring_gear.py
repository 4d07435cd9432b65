from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.geometry import FlankModification
from fe_contact.geometry.ring_gear import RingGear


def ring(teeth: int = 60, **fields: Any) -> RingGear:
    defaults = {"normal_module": 4e-3, "face_width": 25e-3, "rim_diameter": 5e-3 * teeth}
    return RingGear(teeth=teeth, **(defaults | fields))


@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"teeth": 97, "helix_angle": 0.3, "profile_shift_coefficient": -0.4, "thickness_allowance": 5e-5},
        {"teeth": 80, "profile_shift_coefficient": 0.2, "addendum_coefficient": 0.7},
    ],
)
def test_closed_forms_are_the_standards_with_a_negative_tooth_number(fields: dict[str, Any]) -> None:
    gear = ring(**fields)
    module, x = gear.normal_module, gear.profile_shift_coefficient
    transverse = math.atan(math.tan(gear.normal_pressure_angle) / math.cos(gear.helix_angle))
    d = -gear.teeth * module / math.cos(gear.helix_angle)
    d_b = d * math.cos(transverse)
    d_a = d + 2.0 * module * (gear.addendum_coefficient + x)
    d_f = d - 2.0 * module * (gear.dedendum_coefficient - x)
    s_t = module * (0.5 * math.pi + 2.0 * x * math.tan(gear.normal_pressure_angle)) - gear.thickness_allowance
    s_t /= math.cos(gear.helix_angle)
    inv_a = math.tan(math.acos(d_b / d_a)) - math.acos(d_b / d_a)
    s_a = d_a * (s_t / d + math.tan(transverse) - transverse - inv_a)
    assert gear.base_radius == pytest.approx(-0.5 * d_b, rel=1e-14)
    assert gear.tip_radius == pytest.approx(-0.5 * d_a, rel=1e-14)
    assert gear.root_radius == pytest.approx(-0.5 * d_f, rel=1e-14)
    assert gear.tooth_thickness == pytest.approx(s_t, rel=1e-14)
    assert gear.tip_tooth_thickness == pytest.approx(s_a, rel=1e-11)
    assert gear.base_pitch == pytest.approx(math.pi * d_b / -gear.teeth, rel=1e-14)
    assert gear.tip_radius < gear.form_radius < gear.root_radius
    assert gear.tip_roll_length < gear.form_roll_length


def test_cutter_and_ring_fill_the_pitch_on_their_generating_circles() -> None:
    gear = ring(
        profile_shift_coefficient=-0.4, cutter_profile_shift_coefficient=0.1, thickness_allowance=6e-5
    )
    cutter = gear.cutter
    angle = cutter.working_pressure_angle
    involute = math.tan(angle) - angle
    ring_circle = cutter.pitch_radius / cutter.ratio
    assert ring_circle - cutter.pitch_radius == pytest.approx(cutter.center_distance, rel=1e-12)
    arcs = 2.0 * cutter.pitch_radius * (cutter.base_half_angle - involute)
    arcs += 2.0 * ring_circle * (gear.base_thickness_half_angle + involute)
    assert arcs == pytest.approx(2.0 * math.pi * ring_circle / gear.teeth, rel=1e-12)
    assert cutter.center_distance + cutter.tip_radius == pytest.approx(gear.root_radius, rel=1e-14)


def test_every_number_of_the_shape_is_in_the_macro_geometry_and_no_other() -> None:
    gear = ring()
    changed = {
        "teeth": 61,
        "normal_module": 4.1e-3,
        "face_width": 26e-3,
        "rim_diameter": 0.31,
        "normal_pressure_angle": math.radians(21.0),
        "helix_angle": 0.1,
        "profile_shift_coefficient": -0.1,
        "addendum_coefficient": 0.9,
        "dedendum_coefficient": 1.2,
        "root_radius_coefficient": 0.15,
        "cutter_teeth": 26,
        "cutter_profile_shift_coefficient": -0.05,
        "tip_diameter": 0.2325,
        "thickness_allowance": 1e-5,
    }
    for name, value in changed.items():
        assert dataclasses.replace(gear, **{name: value}).macro_geometry() != gear.macro_geometry(), name
    relieved = dataclasses.replace(gear, modification=FlankModification(profile_crowning=5e-6))
    assert relieved.macro_geometry() == gear.macro_geometry()
    assert gear.macro_geometry()["teeth"] == -60  # never the hash of an external gear


def test_modification_counts_from_the_tip_inwards_as_on_an_external_gear() -> None:
    relief = FlankModification(
        tip_relief=20e-6,
        tip_relief_length=1e-3,
        root_relief=10e-6,
        root_relief_length=5e-4,
        profile_slope=4e-6,
    )
    gear = ring(modification=relief)
    plain = dataclasses.replace(relief, profile_slope=0.0)
    tip, form = gear.tip_roll_length, gear.form_roll_length
    start = gear.roll_length(gear.tip_radius + 1e-3)
    removed = plain.material_removed(gear, np.array([tip, start, 0.5 * (start + form), form]))
    assert removed == pytest.approx([20e-6, 0.0, 0.0, 10e-6], rel=1e-12, abs=1e-20)
    assert plain.material_removed(gear, 0.5 * (tip + start)) == pytest.approx(10e-6, rel=1e-9, abs=0.0)
    sloped = relief.material_removed(gear, np.array([tip, form]))
    assert sloped - np.array([20e-6, 10e-6]) == pytest.approx([2e-6, -2e-6], rel=1e-9, abs=0.0)
    with pytest.raises(InputError) as caught:
        ring(modification=FlankModification(tip_relief=1e-6, tip_relief_length=9e-3))
    assert caught.value.field == "modification.tip_relief_length"


@pytest.mark.parametrize(
    ("name", "field", "fields"),
    [
        ("rim", "rim_diameter", {"rim_diameter": 0.249}),
        ("tip diameter", "tip_diameter", {"tip_diameter": 0.251}),
        ("tip diameter", "tip_diameter", {"tip_diameter": 0.249}),
        ("tip diameter", "tip_diameter", {"tip_diameter": 0.2255}),
        ("tip diameter", "tip_diameter", {"addendum_coefficient": 2.2}),
        ("interference", "tip_diameter", {"cutter_teeth": 20}),
        ("root radius", "root_radius_coefficient", {"root_radius_coefficient": 0.6}),
        ("trimming interference", "cutter_teeth", {"cutter_teeth": 44}),
        (
            "profile shift sum",
            "cutter_profile_shift_coefficient",
            {"cutter_profile_shift_coefficient": 0.8},
        ),
        (
            "pointed tooth",
            "tip_diameter",
            {
                "teeth": 200,
                "cutter_teeth": 100,
                "profile_shift_coefficient": -1.0,
                "dedendum_coefficient": 0.5,
                "tip_diameter": 0.788,
            },
        ),
    ],
)
def test_impossible_rings_are_refused_by_name(name: str, field: str, fields: dict[str, Any]) -> None:
    with pytest.raises(InfeasibleGeometry) as caught:
        ring(**fields)
    assert (caught.value.name, caught.value.field) == (name, field)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("teeth", -60),
        ("cutter_teeth", 60),
        ("rim_diameter", 0.0),
        ("helix_angle", 1.0),
        ("face_width", math.nan),
        ("thickness_allowance", -1e-6),
        ("root_radius_coefficient", -0.1),
        ("profile_shift_coefficient", 4.0),
        ("tip_diameter", -0.2),
    ],
)
def test_single_values_out_of_bounds_are_refused(field: str, value: float) -> None:
    with pytest.raises(InputError) as caught:
        ring(**{field: value})
    assert caught.value.field == field
