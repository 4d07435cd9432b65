"""Temperatures of a scene file: what they make, and attacks on their fields."""

import copy
import math
import tomllib
from pathlib import Path

import pytest
from changed_scenes import DROP, By, changed_scene, check_refused

from dynamics.assembly.assemble import assemble
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput

EXAMPLE = tomllib.loads((Path(__file__).parents[3] / "examples" / "palermo_scene.toml").read_text())
BALLS = {"count": 8, "diameter_mm": 11.5, "pitch_diameter_mm": 43.5, "contact_angle_deg": 40.0}
FITS = {"bore_mm": 25.0, "outside_diameter_mm": 62.0, "housing_diameter_mm": 90.0}


def row(shaft, end, position, sign):
    balls = BALLS | {"contact_angle_deg": sign * BALLS["contact_angle_deg"]}
    rings = {"inner_temperature_degc": 70.0, "outer_temperature_degc": 60.0, "axial_preload_n": sign * 400.0}
    return {"name": f"{shaft} {end}", "shaft": shaft, "position_mm": position, "ball": balls, **rings}


BEARINGS = [
    row(shaft["name"], end, part["position_mm"], sign)
    for shaft in EXAMPLE["shafts"]
    for (end, sign), part in zip((("left", 1.0), ("right", -1.0)), EXAMPLE["bushings"], strict=False)
]
BEARINGS[0]["fits"] = FITS
WARM = {
    "temperatures": {"housing_degc": 60.0, "housing_material": "cast_aluminum"},
    "bushings": DROP,
    "rolling_bearings": BEARINGS,
    **{f"shafts[{k}].temperature_degc": 70.0 for k in (0, 1)},
    **{f"gears[{k}].temperature_degc": 80.0 for k in (0, 1)},
}


def warm(changes):
    """The example at temperature with `changes`; what they drop of it is not there."""
    left = {
        place: value
        for place, value in copy.deepcopy(WARM | {"bushings": 0}).items()
        if changes.get(place) is not DROP
    }
    return By(
        left
        | {"bushings": DROP}
        | {place: value for place, value in changes.items() if place not in WARM or value is not DROP}
    )


def test_temperatures_reach_the_scene_and_decide_the_preload():
    scene = changed_scene(EXAMPLE, warm({}))
    own = scene.temperatures
    assert (own.housing, own.reference, own.housing_material.thermal_expansion) == (60.0, 20.0, 21e-6)
    assert scene.rolling_bearings[0].fits.bore == pytest.approx(0.025)
    entries = [entry for entry in assemble(scene).ledger.of("bearing_temperature") if entry.on]
    assert len(entries) == 2
    assert all("preload 400 N to " in entry.reason for entry in entries)


def test_a_file_without_temperatures_says_nothing_of_them():
    text = validated(SceneInput, EXAMPLE).model_dump_json()
    assert not any(word in text for word in ("degc", "temperature", "thermal", "fits"))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, -273.16, 1e9, "warm", True, [20.0]])
@pytest.mark.parametrize(
    "field",
    [
        "temperatures.housing_degc",
        "temperatures.reference_degc",
        "shafts[0].temperature_degc",
        "gears[1].temperature_degc",
        "rolling_bearings[2].inner_temperature_degc",
        "rolling_bearings[2].outer_temperature_degc",
        "rolling_bearings[2].seat_temperature_degc",
    ],
)
def test_a_temperature_is_one(field, value):
    check_refused(EXAMPLE, field, warm({field: value}))


@pytest.mark.parametrize("value", [math.nan, math.inf, -1e-6, 1e9, 0.0011, "steel"])
@pytest.mark.parametrize("part", ["shafts[0]", "gears[0]", "rolling_bearings[0]"])
def test_an_expansion_is_one(part, value):
    field = f"{part}.thermal_expansion_per_k"
    check_refused(EXAMPLE, field, warm({field: value}))


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"temperatures": DROP}, "shafts[0].temperature_degc"),
        ({"shafts[1].temperature_degc": DROP}, "shafts[1].temperature_degc"),
        ({"gears[0].temperature_degc": DROP}, "gears[0].temperature_degc"),
        (
            {"rolling_bearings[3].outer_temperature_degc": DROP},
            "rolling_bearings[3].outer_temperature_degc",
        ),
        ({"temperatures.housing_material": "gold"}, "temperatures.housing_material"),
        (
            {
                "temperatures.housing_material": {
                    "youngs_modulus_gpa": 70.0,
                    "poissons_ratio": 0.3,
                    "density_kg_per_m3": 2700.0,
                }
            },
            "temperatures.housing_material.thermal_expansion_per_k",
        ),
        ({"rolling_bearings[0].fits.bore_mm": 40.0}, "rolling_bearings[0].fits.bore_mm"),
        (
            {"rolling_bearings[0].fits.housing_diameter_mm": 62.0},
            "rolling_bearings[0].fits.housing_diameter_mm",
        ),
        (
            {"rolling_bearings[0].fits.shaft_interference_um": 1e9},
            "rolling_bearings[0].fits.shaft_interference_um",
        ),
        (
            {
                "meshes[0].coast_flank": {"backlash_um": 20.0},
                "gears[0].temperature_degc": 1000.0,
            },
            "meshes[0].coast_flank.backlash_um",
        ),
        (
            {
                "rolling_bearings[0].inner_temperature_degc": 1000.0,
                "rolling_bearings[0].thermal_expansion_per_k": 1e-3,
            },
            "rolling_bearings[0].ball.clearance_um",
        ),
    ],
)
def test_what_cannot_be_is_named(changes, field):
    check_refused(EXAMPLE, field, warm(changes))
