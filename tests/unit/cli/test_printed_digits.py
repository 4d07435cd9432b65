"""No verb and no report prints a digit beyond the error of its number, and none contradicts itself.

Day: one case in the plane. Night: twelve kinds of cases, all verbs that print results.
"""

import json
import shutil
import tomllib
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import loa
from drawn_cases import turn
from printed_numbers import contradictions, faults, text_of_page
from repository import EXAMPLES

from lineofaction.gearbox.schemas.toml import toml_text

Json = dict[str, Any]
DRAFT: Json = {"level": "draft", "positions": 16}
PLANE: Json = {"level": "draft", "model": "plane_strain"}
STANDARD: Json = {"level": "standard", "model": "plane_strain"}
"""A planet in its ring: its draft solves no misalignment of 45 um."""


def example(name: str, **tables: Any) -> Json:
    return {**tomllib.loads((EXAMPLES / name).read_text("utf-8")), **tables}


def pair(module: float, teeth: tuple[int, int], width: float, helix: float = 0.0, **more: Any) -> Json:
    """Return a case of unshifted gears; `more` has tables of the case, and fields of `pinion` and `wheel`."""
    one, other = teeth
    distance = 0.5 * module * (one + other) / np.cos(np.radians(helix))
    gears = {
        name: {"teeth": z, "face_width_mm": width, "bore_diameter_mm": round(0.4 * module * z, 1)}
        for name, z in (("pinion", one), ("wheel", other))
    }
    gears = {
        name: gear | {"thickness_allowance_um": 40.0} | more.pop(name, {}) for name, gear in gears.items()
    }
    sizes = {
        "normal_module_mm": module,
        "helix_angle_deg": helix,
        "center_distance_mm": round(float(distance), 6),
    }
    return {"pair": sizes | gears, "accuracy": PLANE, **more}


def drawn() -> Json:
    """Return a helical pair that every version draws anew."""
    rng = np.random.default_rng(turn())
    one, module = int(rng.integers(17, 30)), float(rng.choice([1.0, 1.75, 2.5, 4.0]))
    teeth, helix = (one, int(one * rng.uniform(1.0, 3.0))), float(rng.choice([8.0, 15.0, 25.0]))
    load = {"torque_n_m": [float(np.round(20.0 * module**3, 1))]}
    return pair(module, teeth, 8.0 * module, helix, load=load, accuracy=DRAFT)


STEEL_ON_POM: Json = {"material": {"youngs_modulus_gpa": 2.8, "poissons_ratio": 0.35}}
RELIEF: Json = {"tip_relief_um": 12.0, "tip_relief_length_mm": 1.0, "helix_crowning_um": 5.0}
DEVIATIONS: Json = {"single_pitch_deviation_um": [4.0, -3.0, 1.0, -2.0] * 5}
CASES: dict[str, Json] = {
    "spur": pair(4.5, (16, 24), 14.0, load={"torque_n_m": [60.0, 140.0]}),
    "internal": example("internal_gear.toml", load={"torque_n_m": [20.0, 100.0]}, accuracy=STANDARD),
    "polymer": pair(1.0, (19, 43), 8.0, wheel=STEEL_ON_POM, load={"torque_n_m": [0.5, 1.0]}),
    "wind": pair(16.0, (21, 80), 290.0, 10.0, pinion=RELIEF, load={"torque_n_m": [4e4]}, accuracy=DRAFT),
    "ev": example("helical_ev_23_67.toml", load={"torque_n_m": [40.0, 120.0]}, accuracy=DRAFT),
    "misaligned": pair(
        3.0, (22, 51), 30.0, 15.0, pinion=RELIEF, load={"torque_n_m": [92.0, 180.0]},
        errors={"misalignment_um": [-20.0, 0.0, 20.0]}, accuracy=DRAFT,
    ),
    "unloaded": pair(2.5, (20, 40), 20.0, load={"torque_n_m": [0.01, 7.5]}),
    "measured": pair(2.5, (20, 20), 20.0, pinion=DEVIATIONS, load={"torque_n_m": [20.0, 75.0]}),
    "drawn": drawn(),
}  # fmt: skip
DAY = ("spur",)
QUICK = (("plan",), ("analyze", "-o", "ste.nc"))
SLOW = (
    ("flank", "-o", "flank.nc"),
    ("root-stress", "-o", "root.nc"),
    ("sensitivity", "-o", "sensitivity.nc"),
)


def idler() -> Json:
    """Return a train of three gears on one axis after the other, the middle one an idler."""
    teeth, module = (20, 30, 40), 2.0
    places = np.cumsum([0.0, *(0.5 * module * (a + b) for a, b in pairwise(teeth))])
    names = ("input", "idler", "output")
    load = {"torque_n_m": [10.0, 40.0, 90.0]}
    return {
        "run": {"duration_s": 0.1},
        "effects": {"flexible_shafts": "off"},
        "shafts": [
            {"name": name, "length_mm": 60.0, "diameter_mm": 20.0, "origin_mm": [float(x), 0.0, 0.0]}
            for name, x in zip(names, places, strict=True)
        ],
        "gears": [
            {"name": f"gear {name}", "shaft": name, "position_mm": 30.0, "bore_diameter_mm": 16.0}
            for name in names
        ],
        "bushings": [
            {"name": f"bearing {name}", "shaft": name, "position_mm": 30.0, "radial_stiffness_n_per_m": 2e8}
            for name in names
        ],
        "meshes": [
            {
                "name": f"{one} and {other}",
                "driver": f"gear {one}",
                "driven": f"gear {other}",
                "damping_ratio": 0.05,
                "case": pair(module, (a, b), 20.0, load=load),
            }
            for one, other, a, b in zip(names, names[1:], teeth, teeth[1:], strict=False)
        ],
        "drives": [{"name": "motor", "shaft": "input", "speed_rpm": [1500.0]}],
        "loads": [{"name": "brake", "shaft": "output", "torque_n_m": [80.0]}],
    }


def printed(verb: str, *arguments: object) -> Iterator[str]:
    shown, answer = loa(verb, *arguments), loa(verb, *arguments, "--json")
    assert shown.exit_code == 0, shown.output
    for text in (*faults(shown.stdout, json.loads(answer.stdout)), *contradictions(shown.stdout)):
        yield f"{verb}: {text}"


def reported(folder: Path, files: list[Path]) -> Iterator[str]:
    made = loa("report", *files, "--still", "-o", folder / "report.html")
    assert made.exit_code == 0, made.output
    yield from (
        f"report: {text}" for text in faults(text_of_page((folder / "report.html").read_text("utf-8")))
    )


@pytest.mark.law
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in DAY else pytest.mark.nightly) for name in CASES]
)
def test_a_case_prints_no_digit_beyond_its_error(name, tmp_path):
    case = tmp_path / "case.toml"
    case.write_text(toml_text(CASES[name]), encoding="utf-8")
    found = []
    slow = SLOW[:-1] if name == "measured" else SLOW  # 20 tables of all pitches take half an hour
    for verb, *options in QUICK if name in DAY else (*QUICK, *slow):
        files = [tmp_path / option if option.endswith(".nc") else option for option in options]
        found += printed(verb, case, *files)
    found += printed("ste", tmp_path / "ste.nc")
    teeth = CASES[name]["pair"]["pinion"]["teeth"]
    found += printed("complaint", case, "--order", str(1.01 * teeth), "--speed-rpm", "1500")
    found += reported(tmp_path, sorted(tmp_path.glob("*.nc")))
    assert found == [], "\n".join(found)


@pytest.mark.nightly
@pytest.mark.law
@pytest.mark.parametrize("name", ["planetary", "idler", "rexs"])
def test_a_unit_prints_no_digit_beyond_its_error(name, tmp_path):
    scene = tmp_path / "scene.toml"
    if name == "rexs":
        opened = loa("open", EXAMPLES / "two_stage_gearbox.rexs", "-o", tmp_path)
        assert opened.exit_code == 0, opened.output
        for file in tmp_path.glob("cylindrical_stage_*.toml"):
            content = tomllib.loads(file.read_text("utf-8")) | {"accuracy": DRAFT}
            file.write_text(toml_text(content), encoding="utf-8")
    elif name == "planetary":
        for file in ("planetary_scene.toml", "planetary_sun_planet.toml", "internal_gear.toml"):
            shutil.copy(EXAMPLES / file, tmp_path)
        shutil.move(tmp_path / "planetary_scene.toml", scene)
    else:
        scene.write_text(toml_text(idler()), encoding="utf-8")
    speeds, found = ("--speed-rpm", "600:1200:300"), []
    found += printed("complaint", scene, "--order", "20", "--speed-rpm", "900", "--tolerance-percent", "20")
    for verb in ("modes", "response"):
        found += printed(verb, scene, *speeds, "-o", tmp_path / f"{verb}.nc")
    if name != "planetary":
        found += printed("deflect", scene, "-o", tmp_path / "deflect.nc")
    found += reported(tmp_path, sorted(tmp_path.glob("*.nc")))
    assert found == [], "\n".join(found)
