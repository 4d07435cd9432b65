"""Nonsense cases and scenes are refused or warned of by name; ordinary ones pass without a word."""

import math
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from changed_scenes import By, changed
from repository import EXAMPLES

from bounds import engineering
from dynamics.plausibility import CHECKS as SCENE_CHECKS
from fe_contact.plausibility import CHECKS as PAIR_CHECKS
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.case_plausibility import case_warnings
from lineofaction.gearbox.convert.checked_case import CheckedCase, check_case
from lineofaction.gearbox.convert.plausibility import scene_warnings
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.units import DEGREE, GPA, MM, UM

CASE_FILES = [file for file in sorted(EXAMPLES.rglob("*.toml")) if "[pair]" in file.read_text("utf-8")]
SPUR = {
    "pair": {
        "normal_module_mm": 4.0,
        "center_distance_mm": 80.0,
        "pinion": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
        "wheel": {"teeth": 20, "face_width_mm": 25.0, "bore_diameter_mm": 40.0},
    },
    "load": {"torque_n_m": [100.0, 400.0]},
}
METRES = {
    "pair.normal_module_mm": 0.004,
    "pair.center_distance_mm": 0.08,
    **{
        f"pair.{gear}.{field}": value
        for gear in ("pinion", "wheel")
        for field, value in (("face_width_mm", 0.025), ("bore_diameter_mm", 0.04))
    },
}
RELIEF = "pair.pinion.tip_relief_um"
LENGTH = "pair.pinion.tip_relief_length_mm"
SHAFT = {"length_mm": 200.0, "diameter_mm": 40.0, "position_mm": 100.0}
WIDE = {"pair.pinion.face_width_mm": 1000.0, "pair.wheel.face_width_mm": 1000.0}

# field, check (None: refused), unit asked about, value there or what is changed
NONSENSE_CASES: dict[str, tuple[str, str | None, str, Any]] = {
    "the whole case in meters": ("pair.normal_module_mm", "module", "meters", By(METRES)),
    "the module in meters": ("pair.pinion.bore_diameter_mm", None, "", By({"pair.normal_module_mm": 0.004})),
    "the module in inches": ("pair.pinion.bore_diameter_mm", None, "", By({"pair.normal_module_mm": 0.157})),
    "the center distance in meters": ("pair.center_distance_mm", None, "", 0.08),
    "torque in kN m": ("load.torque_n_m[1]", "light_load", "kN m", [0.01, 0.1]),
    "torque in N mm": ("load.torque_n_m[1]", "line_load", "N mm", [10000.0, 100000.0]),
    "a rated torque that no gear has": ("load.torque_n_m[0]", "hertz_pressure", "", [3000.0]),
    "a torque that breaks the teeth": ("load.torque_n_m[0]", "root_stress", "", [3000.0]),
    "force in kN": ("load.normal_force_n[0]", "light_load", "kN", By({"load": {"normal_force_n": [2.66]}})),
    "a face of 1000 mm": ("pair.pinion.face_width_mm", "face_width", "", By(WIDE)),
    "a face in meters": ("pair.pinion.face_width_mm", "face_width", "meters", By(dict.fromkeys(WIDE, 0.025))),
    "Young's modulus in MPa": ("material.youngs_modulus_gpa", None, "", 210e3),
    "Young's modulus in Pa": ("material.youngs_modulus_gpa", None, "", 210e9),
    "Young's modulus of a plastic in MPa": ("material.youngs_modulus_gpa", "youngs_modulus", "MPa", 1500.0),
    "relief in mm": (RELIEF, "relief_amount", "millimeters", By({RELIEF: 0.02, LENGTH: 1.5})),
    "relief in m": (RELIEF, "relief_amount", "meters", By({RELIEF: 2e-05, LENGTH: 1.5})),
    "relief in tenths of um": (RELIEF, "relief_over_module", "", By({RELIEF: 900.0, LENGTH: 1.5})),
    "length of the relief in m": (LENGTH, "relief_length", "meters", By({RELIEF: 20.0, LENGTH: 0.0015})),
    "allowance in mm": ("pair.pinion.thickness_allowance_um", "relief_amount", "millimeters", 0.05),
    "crowning in mm": ("pair.wheel.helix_crowning_um", "relief_amount", "millimeters", 0.01),
    "misalignment in mm": ("errors.misalignment_um[1]", "misalignment", "millimeters", [0.0, 0.02]),
    "misalignment in nm": ("errors.misalignment_um[1]", "misalignment_over_face", "", [0.0, 9000.0]),
    "center distance change in m": (
        "errors.center_distance_change_mm[1]",
        "center_distance_change",
        "meters",
        [0.0, 5e-05],
    ),
    "center distance change in um": ("errors.center_distance_change_mm[1]", None, "", [0.0, 50.0]),
    "a bore beyond the root": ("pair.pinion.bore_diameter_mm", None, "", 72.0),
    "a bore in meters": ("pair.pinion.bore_diameter_mm", "bore", "meters", 0.04),
    "helix in radians": (
        "pair.helix_angle_deg",
        "helix_angle",
        "radians",
        By({"pair.helix_angle_deg": 0.35, "pair.center_distance_mm": 80.0015}),
    ),
    "pressure angle in radians": ("pair.normal_pressure_angle_deg", None, "", 0.349),
    "shaft length in m": (
        "pair.pinion.shaft.length_mm",
        "shaft_slenderness",
        "meters",
        By({"pair.pinion.shaft": SHAFT | {"length_mm": 0.2, "position_mm": 0.1}}),
    ),
    "bearing stiffness in N/mm": (
        "pair.pinion.shaft.bearing_stiffness_n_per_um",
        "bearing_stiffness",
        "N/mm",
        By({"pair.pinion.shaft": SHAFT | {"bearing_stiffness_n_per_um": 4e5}}),
    ),
    "bearing stiffness in N/m": (
        "pair.pinion.shaft.bearing_stiffness_n_per_um",
        "bearing_stiffness",
        "N/m",
        By({"pair.pinion.shaft": SHAFT | {"bearing_stiffness_n_per_um": 4e8}}),
    ),
}


SCENE = tomllib.loads((EXAMPLES / "palermo_scene.toml").read_text(encoding="utf-8"))
del SCENE["meshes"][0]["case_file"]
SCENE["meshes"][0]["case"] = tomllib.loads((EXAMPLES / "palermo_spur_20_20.toml").read_text(encoding="utf-8"))
HELICAL = {
    "meshes[0].case.pair.helix_angle_deg": 15.0,
    "meshes[0].case.pair.center_distance_mm": 82.8225,
    "meshes[0].case.accuracy.model": "auto",
    "shafts[1].origin_mm": [82.8225, 0.0, 0.0],
}
NOTHING = {"mass_kg": 0.0, "polar_kg_m2": 0.0, "transverse_kg_m2": 0.0}
OUTPUT = {"name": "output", "length_mm": 200.0, "origin_mm": [80.0, 0.0, 0.0]}
WEIGHTLESS = {"shafts[1]": OUTPUT | {"inertia": NOTHING}, "gears[1].inertia": NOTHING}


def stepped(**material: float) -> By:
    section = {"length_mm": 200.0, "outer_diameter_mm": 40.0} | material
    return By({"shafts[0]": {"name": "input", "length_mm": 200.0, "sections": [section]}})


NONSENSE_SCENES: dict[str, tuple[str, str | None, str, Any]] = {
    "a gear off its shaft": ("gears[0].position_mm", None, "", 250.0),
    "a gear before its shaft": ("gears[1].position_mm", None, "", -5.0),
    "a bearing off its shaft": ("bushings[3].position_mm", None, "", 200.5),
    "a helical gear that nothing holds axially": (
        "gears[0]",
        None,
        "",
        By({f"bushings[{i}].axial_stiffness_n_per_m": 0.0 for i in (0, 1)} | HELICAL),
    ),
    "shafts without mass": ("shafts[1].inertia.polar_kg_m2", None, "", By(WEIGHTLESS)),
    "inertia without mass": (
        "shafts[1].inertia.mass_kg",
        "mass",
        "",
        By(WEIGHTLESS | {"gears[1].inertia": NOTHING | {"polar_kg_m2": 0.001}}),
    ),
    "a torque that no bearing carries": ("shafts[1]", "support", "", By({"bushings": SCENE["bushings"][:2]})),
    "bearing stiffness in N/mm": (
        "bushings[0].radial_stiffness_n_per_m",
        "support_stiffness",
        "N/mm",
        100000.0,
    ),
    "bearing stiffness in N/µm": ("bushings[2].radial_stiffness_n_per_m", "support_stiffness", "N/µm", 100.0),
    "duration in ms": ("run.duration_s", "duration", "milliseconds", 500.0),
    "duration in ms, too many samples": ("run.duration_s", None, "", 5000.0),
    "a damping ratio of 5": ("bushings[1].damping_ratio", "damping_ratio", "per cent", 5.0),
    "a mesh damping ratio of 7": ("meshes[0].damping_ratio", "damping_ratio", "per cent", 7.0),
    "load in N mm": ("loads[0].torque_n_m", "mesh_overload", "N mm", [100000.0]),
    "load in kN m": ("loads[0].torque_n_m", "mesh_load", "kN m", [0.1]),
    "speed in degrees per second": (
        "drives[0].speed_rpm",
        "pitch_line_speed",
        "degrees per second",
        [0.0, 300000.0],
    ),
    "density in g/cm^3": (
        "shafts[0].sections[0].density_kg_per_m3",
        "shaft_density",
        "g/cm^3",
        stepped(density_kg_per_m3=7.85),
    ),
    "Young's modulus of a shaft in MPa": (
        "shafts[0].sections[0].youngs_modulus_gpa",
        "shaft_modulus",
        "MPa",
        stepped(youngs_modulus_gpa=210e3),
    ),
    "inertia in kg mm^2": (
        "gears[0].inertia.polar_kg_m2",
        "gear_inertia",
        "kg mm^2",
        By({"gears[0].inertia": {"mass_kg": 0.6, "polar_kg_m2": 700.0, "transverse_kg_m2": 400.0}}),
    ),
    "shaft length in m": ("gears[0].position_mm", None, "", By({"shafts[0].length_mm": 0.2})),
    "clearance in mm": (
        "bushings[0].rolling_contact.radial_clearance_um",
        "clearance",
        "millimeters",
        By({"bushings[0].rolling_contact": {"stiffness_n_per_m_n": 5e8, "radial_clearance_um": 0.02}}),
    ),
    "backlash in mm": (
        "meshes[0].coast_flank.backlash_um",
        "backlash",
        "millimeters",
        By({"meshes[0].coast_flank": {"backlash_um": 0.1}}),
    ),
    "misalignment in mm": ("meshes[0].misalignment_um", "mesh_misalignment", "millimeters", 0.02),
    "friction in per cent": ("meshes[0].friction", "friction", "per cent", 0.9),
}

EVERY = [(SPUR, *row) for row in NONSENSE_CASES.values()] + [
    (SCENE, *row) for row in NONSENSE_SCENES.values()
]
NAMES = [*NONSENSE_CASES, *(f"scene, {name}" for name in NONSENSE_SCENES)]


def warnings_of(content: dict[str, Any]) -> list[dict[str, Any]]:
    case = validated(Case, content)
    check_case(case)
    return case_warnings(CheckedCase(case))


def warnings_of_scene(content: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the warnings of a scene, by the cases of its meshes: no table is computed."""
    scene = validated(SceneInput, content)
    meshes = [mesh for mesh in scene.meshes if mesh.case is not None]
    geometry = {mesh.name: PairGeometry.of(gear_pair(mesh.case)) for mesh in meshes}
    return scene_warnings(scene, check_scene(scene, geometry))


@pytest.mark.parametrize(("example", "field", "check", "asked", "value"), EVERY, ids=NAMES)
def test_nonsense_is_refused_or_warned_of_by_name(example, field, check, asked, value):
    """By the caller's field, in the caller's unit, with the unit that was most likely meant."""
    place = field.removesuffix("[0]").removesuffix("[1]")
    content = changed(example, value if isinstance(value, By) else {place: value})
    warn = warnings_of if example is SPUR else warnings_of_scene
    if check is None:
        with pytest.raises(BadInput) as refusal:
            warn(content)
        assert field in [fault.field for fault in refusal.value.faults]
        return
    message = {(warning["check"], warning["field"]): warning for warning in warn(content)}[check, field][
        "message"
    ]
    assert message.startswith(f"{field} = ")
    question = message.partition("Did you give ")[2]
    assert question.startswith(asked) if asked else not question


def test_much_is_nonsense():
    assert len(NONSENSE_CASES) >= 25 and len(NONSENSE_SCENES) >= 15


def test_a_case_in_meters_is_one_warning_for_all_its_lengths():
    """Loads and faces follow from the lengths: they would hide the cause."""
    (warning,) = case_warnings(CheckedCase(validated(Case, changed(SPUR, METRES))))
    assert warning["message"].endswith("Did you give meters, here and in all other lengths?")
    assert (warning["value"], warning["unit"]) == (0.004, "mm")


def test_the_spur_pair_itself_is_plausible():
    assert warnings_of(SPUR) == []


@pytest.mark.parametrize("file", CASE_FILES, ids=lambda file: file.stem)
def test_examples_are_plausible(file):
    assert case_warnings(CheckedCase(read_model(Case, file))) == []


def ordinary(
    module: float,
    teeth: tuple[int, int],
    *,
    ratio: float,
    helix: float = 0.0,
    stress: float = 50.0,
    modulus: float = 210.0,
    **pair: Any,
) -> Case:
    """Return a pair whose largest load is `stress` N/mm^2 over face width and module."""
    cosine, internal = math.cos(math.radians(helix)), pair.pop("internal", False)
    width, diameter = ratio * module, module * teeth[0] / cosine
    distance = 0.5 * module * (teeth[1] - teeth[0] if internal else sum(teeth)) / cosine
    wheel: dict[str, Any] = {"teeth": teeth[1], "face_width_mm": width}
    if internal:
        wheel |= {"internal": True, "rim_diameter_mm": module * (teeth[1] + 10), "addendum_coefficient": 0.9}
    else:
        wheel["bore_diameter_mm"] = 0.5 * module * teeth[1]
    torque = stress * width * module * 0.5 * diameter * 1e-3
    content = {
        "pair": {
            "normal_module_mm": module,
            "helix_angle_deg": helix,
            "center_distance_mm": distance,
            "pinion": {"teeth": teeth[0], "face_width_mm": width, "bore_diameter_mm": 0.5 * module * teeth[0]}
            | pair,
            "wheel": wheel,
        },
        "material": {"youngs_modulus_gpa": modulus},
        "load": {"torque_n_m": [torque]},
    }
    return validated(Case, content)


@pytest.mark.parametrize("module", [0.3, 0.5, 1.0, 2.5, 6.0, 12.0, 25.0])
@pytest.mark.parametrize("stress", [0.2, 10.0, 150.0, 300.0], ids=lambda value: f"{value} N/mm^2")
def test_ordinary_pairs_are_plausible(module, stress):
    """From module 0.3 to 25, spur and helical, nearly idle, rated and raced."""
    for helix, ratio in ((0.0, 10.0), (15.0, 20.0), (30.0, 35.0)):
        assert (
            case_warnings(CheckedCase(ordinary(module, (23, 61), ratio=ratio, helix=helix, stress=stress)))
            == []
        )


@pytest.mark.parametrize(("modulus", "stress"), [(1.2, 4.0), (3.0, 12.0), (10.0, 20.0), (110.0, 40.0)])
def test_plastics_and_bronze_are_plausible(modulus, stress):
    assert (
        case_warnings(CheckedCase(ordinary(1.0, (25, 40), ratio=8.0, stress=stress, modulus=modulus))) == []
    )


@pytest.mark.parametrize("stress", [0.2, 100.0])
def test_internal_pairs_are_plausible(stress):
    assert case_warnings(CheckedCase(ordinary(2.0, (36, 96), ratio=10.0, stress=stress, internal=True))) == []


def test_fine_modifications_and_deviations_are_plausible():
    """1 um of crowning on a small gear, 60 um of relief and 2 mrad on a large one."""
    small = ordinary(
        0.5, (23, 40), ratio=10.0, helix_crowning_um=1.0, tip_relief_um=2.0, tip_relief_length_mm=0.1
    )
    large = ordinary(
        12.0,
        (23, 61),
        ratio=20.0,
        tip_relief_um=120.0,
        tip_relief_length_mm=6.0,
        thickness_allowance_um=200.0,
    )
    assert case_warnings(CheckedCase(small)) == case_warnings(CheckedCase(large)) == []


def test_a_choice_holds_helical_gears():
    """Who switches the axial freedom off says that something else holds the shafts."""
    loose = {f"bushings[{i}].axial_stiffness_n_per_m": 0.0 for i in range(4)}
    assert warnings_of_scene(changed(SCENE, loose | {"effects.axial": "off"} | HELICAL)) == []


def test_the_end_of_a_shaft_is_on_it():
    """To the rounding of added lengths: 0.1 + 0.2 is not 0.3."""
    at_end = {"shafts[0].length_mm": 0.3e3, "bushings[1].position_mm": (0.1 + 0.2) * 1e3}
    assert warnings_of_scene(changed(SCENE, at_end)) == []


@pytest.mark.parametrize(
    "name",
    ["palermo_scene", "flexible_shafts_scene", "planetary_scene", "wind_turbine_scene"],
)
def test_example_scenes_are_plausible(name):
    file = EXAMPLES / f"{name}.toml"
    content = tomllib.loads(file.read_text(encoding="utf-8"))
    for mesh in content["meshes"]:
        mesh["case"] = tomllib.loads((file.parent / mesh.pop("case_file")).read_text(encoding="utf-8"))
        assert validated(Case, mesh["case"])
    assert warnings_of_scene(content) == []


DOCS = Path(__file__).parents[3] / "docs"
PAGE = (DOCS / "plausibility.md").read_text(encoding="utf-8")


def limits(check: Any) -> str:
    low, high = limit_text(check.low, check.unit), limit_text(check.high, check.unit)
    if low and high:
        return f"{low} to {high} ({check.source})."
    if not low + high:
        return f"{check.source[0].upper()}{check.source[1:]}."
    return f"{f'At least {low}' if low else f'At most {high}'} ({check.source})."


@pytest.mark.parametrize(
    "check", [*PAIR_CHECKS.values(), *SCENE_CHECKS.values()], ids=lambda check: check.name
)
def test_every_check_is_on_the_page(check):
    assert f"`{check.name}`: {check.quantity} : {limits(check)}" in " ".join(PAGE.split())


def test_the_page_has_no_check_that_is_gone():
    listed = re.findall(r"^`(\w+)`: ", PAGE, re.MULTILINE)
    assert sorted(listed) == sorted([*PAIR_CHECKS, *SCENE_CHECKS])


def test_the_page_is_linked():
    assert "(plausibility.md)" in (DOCS / "cli.md").read_text(encoding="utf-8")


def limit_text(limit: float | None, unit: str) -> str:
    """Return a limit of a check as people read it; empty for none."""
    if limit is None:
        return ""
    small, soft = limit < 1e-3, limit < 1e9
    scales = {
        "m": (UM, "µm") if small else (MM, "mm"),
        "Pa": (1e6, "MPa") if soft else (GPA, "GPa"),
        "rad": (DEGREE, "deg"),
        "1": (1.0, ""),
    }
    scale, name = scales.get(unit, (1.0, unit))
    return f"{engineering(limit / scale, 3)} {name}".strip()
