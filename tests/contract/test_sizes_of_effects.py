"""The size of an effect is one number: in the plan, on the command line, in the report, on the page, in an
ablation, in the receipt of a run."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import loa
from geared_scenes import RPM, gear_pair_scene, with_gear

from bounds import engineering
from dynamics import Outputs, Scene, TimeLaw, simulate
from dynamics import ablate as ablate_scene
from dynamics.acoustics import a_weighting
from dynamics.influence.level_change import LevelChange
from fe_contact import SteDatabase
from fe_contact.analysis.studies import ablation
from fe_contact.analysis.studies.ablation import Figures
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.scene_effects import scene_table
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.studied import OverOrders
from lineofaction.gearbox.studies.ablate import Inputs
from lineofaction.gearbox.studies.ablate.run import RUN
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.housings import sized_response
from lineofaction.gearbox.units import boundary_ledger
from lineofaction.report.document import page_of, read_inputs, stored_figures
from lineofaction.report.drawing.figure import Table
from lineofaction.report.drawing.page import html
from lineofaction.report.drawing.tables import ledger_section
from lineofaction.report.effects.ablate import PAGE
from lineofaction.report.presentation import effect_text
from service.live.work import live_plan

pytestmark = pytest.mark.usefixtures("coarse_sectors")

Json = dict[str, Any]
SPUR = {"teeth": 20, "face_width_mm": 10.0, "bore_diameter_mm": 40.0}
RING = {
    "internal": True,
    "teeth": 60,
    "face_width_mm": 10.0,
    "rim_diameter_mm": 280.0,
    "addendum_coefficient": 0.8,
}
HELICAL = {"teeth": 18, "face_width_mm": 8.0, "bore_diameter_mm": 36.0}
RELIEF = {"tip_relief_um": 15.0, "tip_relief_length_mm": 1.2}


def pair(pinion: Json, wheel: Json, **more: Any) -> Json:
    """Gears of module 4 mm, 80 mm apart if nothing else is said."""
    return {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": pinion, "wheel": wheel, **more}


PLAIN = pair(SPUR, SPUR)
RELIEVED = pair(SPUR | RELIEF, SPUR | RELIEF)
INTERNAL = pair(SPUR, RING)
SLANT = {"helix_angle_deg": 20.0, "center_distance_mm": 76.63}
SHORT = {"tip_relief_um": 12.0, "tip_relief_length_mm": 0.3}
SLANTED = pair(HELICAL, HELICAL, **SLANT)
QUIET = pair(HELICAL | RELIEF | {"helix_crowning_um": 6.0}, HELICAL | RELIEF, **SLANT)
CASES: dict[str, tuple[Json, list[float], Json]] = {
    "spur": (PLAIN, [10.0, 50.0, 160.0], {}),
    "spur, relieved": (RELIEVED, [20.0, 100.0], {}),
    "spur, coupling off": (PLAIN, [10.0, 160.0], {"effects": {"tooth_coupling": "off"}}),
    "spur, a relief too small for the tolerance": (
        pair(SPUR | RELIEF | {"tip_relief_um": 0.3}, SPUR), [20.0, 100.0], {"tolerance": 0.1},
    ),
    "internal": (INTERNAL, [20.0, 100.0], {}),
    "internal, profile crowning": (
        pair(SPUR | {"profile_crowning_um": 8.0}, RING), [50.0, 100.0], {},
    ),
    "helical": (SLANTED, [20.0, 60.0], {}),
    "helical, quiet": (QUIET, [20.0, 60.0], {}),
    "helical, misaligned": (SLANTED, [60.0], {"misalignment_um": [-10.0, 10.0]}),
    "spur, misaligned, repeated with corner contact": (
        pair(SPUR | SHORT, SPUR | SHORT), [22.0], {"misalignment_um": [150.0]},
    ),
}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def _one_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


def boundary_case(name: str) -> Json:
    made, torques, more = CASES[name]
    more = dict(more)
    accuracy = {"tolerance": more.pop("tolerance")} if "tolerance" in more else {"level": "draft"}
    errors = {"errors": {"misalignment_um": more.pop("misalignment_um")}} if "misalignment_um" in more else {}
    load = {"torque_n_m": torques}
    return {"pair": made, "load": load, "accuracy": {**accuracy, "positions": 8}, **errors, **more}


def invoked(*words: object) -> str:
    run = loa(*words)
    assert run.exit_code == 0, run.output
    return run.stdout


def terminal_changes(text: str) -> dict[str, list[str]]:
    """The changes of mean and peak-to-peak of every effect in the table of the terminal."""
    rows = re.findall(r"^([a-z ]+?) +(?:yes|no) +(\S+) +% +(\S+) +% ", text, re.M)
    return {name.replace(" ", "_"): [f"{change} %" for change in changes] for name, *changes in rows}


def table_words(tables: list[Json]) -> dict[str, str]:
    (table,) = [one for one in tables if one["caption"] == "Effects"]
    column = table["head"].index("without it")
    return {row[0].replace(" ", "_"): row[column] for row in table["rows"]}


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("name", CASES)
def test_five_outputs_tell_one_number(name, tmp_path, monkeypatch):
    case = boundary_case(name)
    file, table = tmp_path / "case.json", tmp_path / "ste.nc"
    file.write_text(json.dumps(case), encoding="utf-8")
    plan = json.loads(invoked("plan", file, "--json"))["effect_ledger"]
    page_plan = live_plan({"case": case, "time_budget_s": None, "cache": str(tmp_path)})["effect_ledger"]
    changes = terminal_changes(invoked("analyze", file, "-o", table))
    assert bool(SteDatabase.from_netcdf(table).metadata.receipt["repeated"]) == ("repeated" in name)
    report = page_of(read_inputs([table]))
    page = next(
        s
        for s in stored_figures({"kind": "database", "file": str(table)})["sections"]
        if s["title"] == "Effects"
    )
    estimated = {entry["name"]: entry for entry in ablated(case, tmp_path, monkeypatch)["effects"]}

    text = html(report, {figure.key: b"" for section in report.sections for figure in section.figures})
    shown = table_words(page["tables"])
    place = f"at {case['load']['torque_n_m'][-1]:g} N m"
    assert place in page["text"]
    sized = 0
    for entry, on_page in zip(plan, page_plan, strict=True):
        influence = entry["influence"]
        assert on_page["influence"] == influence
        if influence is None:
            continue
        assert influence["torque_n_m"] == pytest.approx(case["load"]["torque_n_m"][-1], rel=1e-12)
        if entry["name"] in estimated:
            check_ablation(estimated[entry["name"]]["estimate"], influence)
        if influence["trifle"]:
            assert entry["name"] not in {**changes, **shown}
            continue
        sized += 1
        words = influence["words"]
        assert shown[entry["name"]] == words
        relative = influence["relative_mean"], influence["relative_peak_to_peak"]
        if None not in relative:
            assert changes[entry["name"]] == [f"{engineering(100.0 * part, 2, '+')} %" for part in relative]
        assert words in text
        for key, unit in (("mean_um", 1.0), ("relative_mean", 100.0), ("peak_to_peak_um", 1.0)):
            assert any(np.isclose(unit * influence[key], value, rtol=0.06) for value in numbers(words))
    assert sized >= 2


def ablated(case: Json, home: Path, monkeypatch: pytest.MonkeyPatch) -> Json:
    """The JSON of an ablation of all effects; what it computes is not of interest here, and is not."""
    one = np.ones(len(case["load"]["torque_n_m"]))
    figures = Figures(1e-5 * one, 1e-6 * one, 1.0, np.ones((one.size, 5)), 1.0)
    monkeypatch.setattr(ablation, "_figures", lambda *_: figures)
    means = Means(home, lambda *_: None)
    found = RUN.compute(CheckedCase(Case.model_validate_json(json.dumps(case))), Inputs(), means)
    rows = {row[0]: row for row in next(PAGE.text(found)).rows}
    content = RUN.figures(found)
    for entry in content["effects"]:
        if entry["estimate"] is not None and not entry["estimate"]["trifle"]:
            assert rows[entry["name"]][3] in entry["estimate"]["words"]
    return content


def check_ablation(estimate: Json, influence: Json) -> None:
    for key, value in influence.items():
        if key.endswith("_um"):
            assert estimate[key] == pytest.approx(value, rel=1e-12)
        else:
            assert estimate[key] == value


def numbers(words: str) -> list[float]:
    return [float(text) for text in re.findall(r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?", words)]


OFF = {"tilt": "off"}


@pytest.mark.law
@pytest.mark.parametrize("sound", [False, True], ids=["bearing forces", "sound"])
def test_outputs_of_a_run_tell_one_number(sound):
    scene = tilting_pair(effects=OFF, outputs=Outputs(energy_audit=False))
    scene = replace(scene, quantity=FirstBearing() if sound else None)
    run = simulate(scene)
    ledger, levels = boundary_ledger(run.effect_ledger), run.receipt["error"]["left_out_effects"]["effects"]
    lines = {row[0].replace(" ", "_"): row[2] for row in scene_table(ledger)[1]}
    section = ledger_section(ledger)
    rows_shown = [row for table in (*section.tables, *section.folded) for row in table.rows if len(row) == 5]
    shown = {row[0].replace(" ", "_"): row[3] for row in rows_shown}
    ablation = ablate_scene(replace(scene, outputs=Outputs(energy_audit=False, receipt="minimal")))
    rows = {row[0]: row[2] for row in next(PAGE.text(ablation)).rows}
    document = {entry["name"]: entry for entry in RUN.figures(ablation)["effects"]}
    sizes = run.effect_ledger["influences"]
    assert {"lateral", "axial", "tilt"} <= set(sizes)
    for name, size in sizes.items():
        level = LevelChange(**size["level"])
        assert level.unit == ("dB(A)" if sound else "dB")
        assert size["words"].startswith(f"{level.text}, ")
        assert shown[name] == lines.get(name, level.text) == level.text
        assert rows[name] == level.text
        assert document[name]["level"] == size["level"]
        assert levels.get(name, level.decibels) == level.decibels
    assert "lateral" in lines and levels["tilt"] != 0.0


@pytest.mark.law
def test_a_response_tells_the_number_of_a_run_at_its_speed():
    scene = tilting_pair(outputs=Outputs(energy_audit=False))
    run = simulate(scene).effect_ledger["influences"]
    speed = scene.drives[0].speed.extreme / RPM
    inputs = OverOrders(speed_rpm=[speed], orders=5)
    response, _ = sized_response(scene, inputs, Means(Path(), lambda *_: None))
    sizes = response.metadata["effect_ledger"]["influences"]
    assert set(sizes) == set(run)
    (table,) = [
        part
        for part in effect_text(boundary_ledger(response.metadata["effect_ledger"]))
        if isinstance(part, Table)
    ]
    lines = {row[0].replace(" ", "_"): row[2] for row in table.rows}
    for name, size in sizes.items():
        assert size["level"]["decibels"] == pytest.approx(run[name]["level"]["decibels"], abs=0.05)
        words = LevelChange(**size["level"]).text
        assert lines.get(name) == words or abs(size["level"]["relative"]) < 1e-3


class FirstBearing:
    """Force along x on the first bearing, A-weighted."""

    name, unit = "force on the first bearing", "dB(A)"

    def squares(self, forces: Any) -> np.ndarray:
        own = np.abs(forces.bearing_force[0, 0]) ** 2
        return np.asarray(10.0 ** (a_weighting(forces.frequency) / 10.0) * own)


def tilting_pair(**changes: Any) -> Scene:
    """A helical pair at 2000 rpm that moves axially and tilts."""
    scene = gear_pair_scene(
        speed=TimeLaw.constant(2000.0 * RPM), duration=0.06, on_violation="report", **changes
    )
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.2), 1, base_helix_angle=-0.2)
    return replace(scene, bushings=tuple(replace(part, axial_stiffness=1e8) for part in scene.bushings))
