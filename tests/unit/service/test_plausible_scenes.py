"""Nonsense scenes are refused or warned of by name; the examples are let through without a word."""

from __future__ import annotations

import copy
import tomllib
from pathlib import Path
from typing import Any

import pytest

from fe_contact.ste import PairFacts
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.plausibility import scene_warnings
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.scene import SceneInput

EXAMPLES = Path(__file__).parents[3] / "examples"
HELIX = {"pair.helix_angle_deg": 15.0, "pair.center_distance_mm": 82.8225}
STEPPED = {"length_mm": 200.0, "outer_diameter_mm": 40.0}

# name, changes of the scene, of the case, field, check (None: refused), unit asked about
NONSENSE: list[tuple[str, dict[str, Any], dict[str, Any], str, str | None, str]] = [
    ("a gear off its shaft", {"gears.0.position_mm": 250.0}, {}, "gears[0].position_mm", None, ""),
    ("a gear before its shaft", {"gears.1.position_mm": -5.0}, {}, "gears[1].position_mm", None, ""),
    ("a bearing off its shaft", {"bushings.3.position_mm": 200.5}, {}, "bushings[3].position_mm", None, ""),
    (
        "a helical gear that nothing holds axially",
        {f"bushings.{i}.axial_stiffness_n_per_m": 0.0 for i in (0, 1)},
        HELIX,
        "gears[0]",
        None,
        "",
    ),
    ("shafts without mass", {"weightless": True}, {}, "shafts[1].inertia.polar_kg_m2", None, ""),
    (
        "inertia without mass",
        {"weightless": True, "gears.1.inertia.polar_kg_m2": 1e-3},
        {},
        "shafts[1].inertia.mass_kg",
        "mass",
        "",
    ),
    (
        "a torque that no bearing carries",
        {"bushings": [0, 1]},
        {},
        "shafts[1]",
        "support",
        "",
    ),
    (
        "bearing stiffness in N/mm",
        {"bushings.0.radial_stiffness_n_per_m": 1e5},
        {},
        "bushings[0].radial_stiffness_n_per_m",
        "support_stiffness",
        "N/mm",
    ),
    (
        "bearing stiffness in N/um",
        {"bushings.2.radial_stiffness_n_per_m": 100.0},
        {},
        "bushings[2].radial_stiffness_n_per_m",
        "support_stiffness",
        "N/um",
    ),
    ("duration in ms", {"run.duration_s": 500.0}, {}, "run.duration_s", "duration", "milliseconds"),
    ("duration in ms, too many samples", {"run.duration_s": 5000.0}, {}, "run.duration_s", None, ""),
    (
        "a damping ratio of 5",
        {"bushings.1.damping_ratio": 5.0},
        {},
        "bushings[1].damping_ratio",
        "damping_ratio",
        "per cent",
    ),
    (
        "a mesh damping ratio of 7",
        {"meshes.0.damping_ratio": 7.0},
        {},
        "meshes[0].damping_ratio",
        "damping_ratio",
        "per cent",
    ),
    ("load in N mm", {"loads.0.torque_n_m": [1e5]}, {}, "loads[0].torque_n_m", "mesh_overload", "N mm"),
    ("load in kN m", {"loads.0.torque_n_m": [0.1]}, {}, "loads[0].torque_n_m", "mesh_load", "kN m"),
    (
        "speed in degrees per second",
        {"drives.0.speed_rpm": [0.0, 300e3]},
        {},
        "drives[0].speed_rpm",
        "pitch_line_speed",
        "degrees per second",
    ),
    (
        "density in g/cm^3",
        {"shafts.0": {"sections": [STEPPED | {"density_kg_per_m3": 7.85}]}},
        {},
        "shafts[0].sections[0].density_kg_per_m3",
        "shaft_density",
        "g/cm^3",
    ),
    (
        "Young's modulus of a shaft in MPa",
        {"shafts.0": {"sections": [STEPPED | {"youngs_modulus_gpa": 210e3}]}},
        {},
        "shafts[0].sections[0].youngs_modulus_gpa",
        "shaft_modulus",
        "MPa",
    ),
    (
        "inertia in kg mm^2",
        {"gears.0.inertia": {"mass_kg": 0.6, "polar_kg_m2": 700.0, "transverse_kg_m2": 400.0}},
        {},
        "gears[0].inertia.polar_kg_m2",
        "gear_inertia",
        "kg mm^2",
    ),
    ("shaft length in m", {"shafts.0.length_mm": 0.2}, {}, "gears[0].position_mm", None, ""),
    (
        "clearance in mm",
        {"bushings.0.rolling_contact": {"stiffness_n_per_m_n": 5e8, "radial_clearance_um": 0.02}},
        {},
        "bushings[0].rolling_contact.radial_clearance_um",
        "clearance",
        "millimeters",
    ),
    (
        "backlash in mm",
        {"meshes.0.coast_flank": {"backlash_um": 0.1}},
        {},
        "meshes[0].coast_flank.backlash_um",
        "backlash",
        "millimeters",
    ),
    (
        "misalignment in mm",
        {"meshes.0.misalignment_um": 0.02},
        {},
        "meshes[0].misalignment_um",
        "mesh_misalignment",
        "millimeters",
    ),
    ("friction in per cent", {"meshes.0.friction": 0.9}, {}, "meshes[0].friction", "friction", "per cent"),
]


def written_into(content: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """Return a copy with values at dotted places; numbers are places in lists."""
    content = copy.deepcopy(content)
    for path, value in changes.items():
        *places, last = path.split(".")
        table: Any = content
        for place in places:
            table = table[int(place)] if place.isdigit() else table.setdefault(place, {})
        table[int(last) if last.isdigit() else last] = value
    return content


def scene_of(changes: dict[str, Any], case: dict[str, Any]) -> SceneInput:
    content = tomllib.loads((EXAMPLES / "palermo_scene.toml").read_text(encoding="utf-8"))
    pair = tomllib.loads((EXAMPLES / "palermo_spur_20_20.toml").read_text(encoding="utf-8"))
    changes = dict(changes)
    if changes.pop("weightless", False):
        nothing = {"mass_kg": 0.0, "polar_kg_m2": 0.0, "transverse_kg_m2": 0.0}
        content["shafts"][1] = {
            "name": "output",
            "length_mm": 200.0,
            "origin_mm": [80.0, 0.0, 0.0],
            "inertia": nothing,
        }
        content["gears"][1]["inertia"] = dict(nothing)
    if "bushings" in changes:
        content["bushings"] = [content["bushings"][i] for i in changes.pop("bushings")]
    for name in [name for name in changes if name == "shafts.0"]:
        content["shafts"][0] = {"name": "input", "length_mm": 200.0} | changes.pop(name)
    if case:
        content["shafts"][1]["origin_mm"] = [case["pair.center_distance_mm"], 0.0, 0.0]
        case = case | {"accuracy.model": "auto"}
    content["meshes"][0] = {
        name: value for name, value in content["meshes"][0].items() if name != "case_file"
    } | {"case": written_into(pair, case)}
    return validated(SceneInput, written_into(content, changes))


def warnings_of(scene: SceneInput) -> list[dict[str, Any]]:
    """Return the warnings of a scene, by the cases of its meshes: no table is computed."""
    facts = {mesh.name: PairFacts.of(gear_pair(mesh.case)) for mesh in scene.meshes if mesh.case is not None}
    return scene_warnings(scene, check_scene(scene, facts))


@pytest.mark.parametrize("nonsense", NONSENSE, ids=[row[0] for row in NONSENSE])
def test_nonsense_is_refused_or_warned_of_by_name(
    nonsense: tuple[str, dict[str, Any], dict[str, Any], str, str | None, str],
) -> None:
    """By the field of the scene file, in its unit, with the unit that was most likely meant."""
    _, changes, case, field, check, asked = nonsense
    scene = scene_of(changes, case)
    if check is None:
        with pytest.raises(BadInput) as refusal:
            warnings_of(scene)
        assert field in [fault.field for fault in refusal.value.faults]
        return
    found = {(warning["check"], warning["field"]): warning for warning in warnings_of(scene)}
    message = found[check, field]["message"]
    assert message.startswith(f"{field} = ")
    question = message.partition("Did you give ")[2]
    assert question.startswith(asked) if asked else not question


def test_at_least_15_scenes_are_nonsense() -> None:
    assert len(NONSENSE) >= 15


def test_a_choice_holds_helical_gears() -> None:
    """Who switches the axial freedom off says that something else holds the shafts."""
    loose = {f"bushings.{i}.axial_stiffness_n_per_m": 0.0 for i in range(4)}
    assert warnings_of(scene_of(loose | {"effects.axial": "off"}, HELIX)) == []


def test_the_end_of_a_shaft_is_on_it() -> None:
    """To the rounding of added lengths: 0.1 + 0.2 is not 0.3."""
    at_end = {"shafts.0.length_mm": 0.3e3, "bushings.1.position_mm": (0.1 + 0.2) * 1e3}
    assert warnings_of(scene_of(at_end, {})) == []


@pytest.mark.parametrize(
    "name",
    ["palermo_scene", "flexible_shafts_scene", "planetary_scene", "wind_turbine_scene"],
)
def test_examples_are_plausible(name: str) -> None:
    file = EXAMPLES / f"{name}.toml"
    content = tomllib.loads(file.read_text(encoding="utf-8"))
    for mesh in content["meshes"]:
        mesh["case"] = tomllib.loads((file.parent / mesh.pop("case_file")).read_text(encoding="utf-8"))
        assert validated(Case, mesh["case"])
    assert warnings_of(validated(SceneInput, content)) == []
