"""`import lineofaction as loa`: its names, what they load, and that they compute without a server."""

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from faulty_units import LEFT_OUT, TWO_STAGE
from repository import ROOT

import lineofaction as loa
from bounds.brief import MAX_LINES, WIDTH
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, validated

EXAMPLES = ROOT / "examples"
MAX_NAMES = 60
FUNCTIONS = {study.package: study for study in STUDIES.values()}


def blocks(page: Path) -> list[ast.Module]:
    return [
        ast.parse(block) for block in re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    ]


def test_every_name_is_there_and_they_are_few():
    assert len(loa.__all__) == len(set(loa.__all__)) <= MAX_NAMES
    for name in loa.__all__:
        assert getattr(loa, name) is not None
    with pytest.raises(AttributeError, match="no_such"):
        _ = loa.no_such


def test_the_import_loads_nothing():
    code = "import json, sys, lineofaction; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in json.loads(done.stdout)}
    assert not loaded & {"numpy", "scipy", "pydantic", "fe_contact", "dynamics", "service"}


def test_every_study_is_a_function():
    for study in STUDIES.values():
        function = getattr(loa, study.package)
        assert study.description in (function.__doc__ or "")


def test_a_case_is_read_with_values_over_it_and_refused_by_field():
    case = loa.read(EXAMPLES / "palermo_spur_20_20.toml", {"pair.pinion.tip_relief_um": 7})
    assert isinstance(case, Case) and case.pair.pinion.tip_relief_um == 7
    with pytest.raises(loa.BadInput, match=r"pair\.pinion\.teeth"):
        loa.read(EXAMPLES / "palermo_spur_20_20.toml", {"pair.pinion.teeth": 2})


def test_every_file_is_read_by_one_function(tmp_path):
    result = loa.modes(EXAMPLES / "jeffcott_scene.toml")
    loa.write(result, tmp_path / "modes.nc")
    again = loa.read(tmp_path / "modes.nc")
    assert type(again) is type(result)
    assert again.frequency.tolist() == result.frequency.tolist()
    assert isinstance(loa.read(EXAMPLES / "two_stage" / "two_stage.rexs"), loa.Unit)
    assert isinstance(loa.read(EXAMPLES / "jeffcott_scene.toml"), loa.Scene)
    (tmp_path / "damaged.nc").write_bytes((tmp_path / "modes.nc").read_bytes()[:400])
    for name in ("damaged.nc", "missing.nc", "missing.toml"):
        with pytest.raises(loa.BadInput, match=name):
            loa.read(tmp_path / name)
    with pytest.raises(loa.BadInput, match="overrides"):
        loa.read(tmp_path / "modes.nc", {"duration": 1})


def test_a_content_of_another_kind_is_refused_by_name(tmp_path):
    file = loa.write(loa.modes(EXAMPLES / "jeffcott_scene.toml"), tmp_path / "modes.nc")
    assert loa.read(file, kind=loa.modes) == loa.read(file)
    assert isinstance(loa.read(EXAMPLES / "jeffcott_scene.toml", kind=loa.Scene), loa.Scene)
    for kind, name in ((loa.SteDatabase, "SteDatabase"), (loa.response, r"loa\.response")):
        with pytest.raises(loa.BadInput, match=rf"kind = '{name}': .* modes\.nc, which holds ModalAnalysis"):
            loa.read(file, kind=kind)


def test_a_folder_is_its_files_each_read_on_request(tmp_path):
    unit = loa.read(EXAMPLES / "two_stage" / "two_stage.rexs")
    for name, text in unit.files().items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    result = loa.modes(EXAMPLES / "jeffcott_scene.toml")
    (tmp_path / "modes").mkdir()
    for name in ("modes/modes.nc", "modes.json"):
        loa.write(result, tmp_path / name)
    (tmp_path / "notes.md").write_text("no file of ours", encoding="utf-8")
    folder = loa.read(tmp_path)
    assert folder["modes/modes.nc"] == result
    assert folder["modes.json"] == loa.facts(result)
    assert [row["name"] for row in folder["load_cases.toml"]["load_cases"]]
    assert isinstance(folder["scene.toml"], loa.Scene) and isinstance(folder["first_stage.toml"], loa.Case)
    assert set(folder["import.csv"]) >= {"fate", "component"}
    assert folder["housing_stiffness.csv"].shape == (36, 36)
    assert "notes.md" not in folder and len(folder) == len(list(folder))
    assert re.search(r"scene\.toml +scene$", repr(folder), re.MULTILINE)
    with pytest.raises(KeyError):
        folder["notes.md"]


def test_recordings_are_read_and_what_cannot_be_is_refused_by_name(tmp_path):
    (tmp_path / "run.csv").write_text("time_s,force_n\n0,1\n0.1,2\n0.2,3\n", encoding="utf-8")
    recording = loa.read(tmp_path / "run.csv")
    assert [channel.name for channel in recording.channels] == ["force_n"]
    for name in ("none.csv", "none.wav", "none.unv", "none", "none.toml"):
        with pytest.raises(loa.BadInput, match=name):
            loa.read(tmp_path / name)


SUBJECTS = sorted(
    file.name
    for file in EXAMPLES.glob("*.toml")
    if re.search(r"^\[(pair|\[shafts)\]", file.read_text("utf-8"), re.MULTILINE)
)


@pytest.mark.parametrize("name", SUBJECTS)
def test_cases_and_scenes_show_what_they_state_in_a_dozen_lines(name):
    subject = loa.read(EXAMPLES / name)
    lines = str(subject).split("\n")
    assert lines[0] in ("Case", "Scene")
    assert 3 < len(lines) <= MAX_LINES and max(map(len, lines)) <= WIDTH
    assert lines == repr(subject).split("\n") and "<table>" in subject._repr_html_()


def test_results_show_the_main_figures_of_their_report():
    result = loa.modes(EXAMPLES / "jeffcott_scene.toml")
    lines = repr(result).split("\n")
    assert lines[0] == "ModalAnalysis: modes"
    assert any(line.split()[:3] == ["lowest", "natural", "frequency"] for line in lines)
    assert len(lines) <= MAX_LINES
    assert "lowest natural frequency" in result._repr_html_()
    assert result.to_xarray()["natural_frequency"].attrs["units"] == "Hz"


def test_the_text_of_a_gear_pair_is_its_call():
    relief = loa.FlankModification(tip_relief=1e-5, tip_relief_length=1e-3)
    gear = loa.Gear(20, 4e-3, 0.025, 0.04, modification=relief)
    pair = loa.GearPair(gear, gear, 0.08)
    names = {name: getattr(loa, name) for name in ("Gear", "GearPair", "FlankModification")}
    assert len(repr(pair)) < 400 and eval(repr(pair), names) == pair


def test_modes_of_a_scene_equal_those_of_dynamics(tmp_path):
    """The function converts, checks and computes as the parts do one by one."""
    from dynamics.assembly.assemble import assemble  # noqa: PLC0415
    from dynamics.linearize import modal_analysis  # noqa: PLC0415
    from lineofaction.gearbox.workbench import tabled  # noqa: PLC0415

    scene = EXAMPLES / "jeffcott_scene.toml"
    found = loa.modes(scene)
    assert found.frequency.tolist() == modal_analysis(assemble(tabled(scene).scene)).frequency.tolist()
    assert "modes" in loa.facts(found)
    loa.write(found, tmp_path / "modes.nc")
    loa.write(found, tmp_path / "modes.json")
    assert json.loads((tmp_path / "modes.json").read_text()) == loa.facts(found)
    with pytest.raises(loa.BadInput, match="ending"):
        loa.write(found, tmp_path / "modes.xyz")


def test_a_unit_without_a_scene_is_refused():
    unit = loa.Unit((), None, (), (), ())
    with pytest.raises(loa.BadInput, match="scene"):
        loa.modes(unit)


def test_warnings_reach_a_caller_whose_code_has_no_name(tmp_path):
    """Code that is executed in a table of its own, as in a template, is of no module."""
    file = tmp_path / "unit.rexs"
    file.write_text(LEFT_OUT["center distance"][1](TWO_STAGE), encoding="utf-8")
    with pytest.warns(loa.InputWarning, match="left out of the scene: cylindrical_stage 22"):
        exec("unit = open_unit(file)", {"open_unit": loa.open_unit, "file": file})


def test_every_study_has_an_example_whose_inputs_are_accepted():
    called = set()
    for call in (node for block in blocks(ROOT / "docs/studies.md") for node in ast.walk(block)):
        if isinstance(call, ast.Call) and (name := ast.unparse(call.func).removeprefix("loa.")) in FUNCTIONS:
            inputs = {k.arg: eval(ast.unparse(k.value)) for k in call.keywords if k.arg and k.arg != "run"}
            named = {"run": "0" * 64} if any(k.arg == "run" for k in call.keywords) else {}
            validated(FUNCTIONS[name].inputs, named | inputs)
            called.add(name)
    assert called == set(FUNCTIONS)
