"""loa open: what it prints and writes; what it leaves out of a scene is named first and last."""

import base64
import json
import re
import tomllib
from base64 import b64encode
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import Result
from command_line import loa
from fastapi.testclient import TestClient
from faulty_units import LEFT_OUT, REFUSED, TWO_STAGE
from repository import EXAMPLES
from rexs_reference import examples, needs_reference

from lineofaction.gearbox.from_rexs.unit_answer import unit_of_rexs
from lineofaction.gearbox.input_file import InputFile, Override
from lineofaction.gearbox.result_files import stamped
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_text
from service.app import create_app
from service.schemas.answers import UnitBody
from service.settings import Settings

GEARBOX = Path(__file__).parents[3] / "examples" / "two_stage_gearbox.rexs"
STAGES = ("cylindrical_stage_21", "cylindrical_stage_22")


def printed(file: Path, folder: Path, *options: str) -> str:
    result = loa("open", file, "-o", folder, *options)
    assert result.exit_code == 0, result.output
    return result.output


def test_the_files_are_read_back_as_cases_and_scene(tmp_path):
    output = printed(GEARBOX, tmp_path)
    assert "239 components and values: 199 taken" in output
    for name in STAGES:
        validated(Case, tomllib.loads((tmp_path / f"{name}.toml").read_text(encoding="utf-8")))
    scene = validated(SceneInput, tomllib.loads((tmp_path / "scene.toml").read_text("utf-8")))
    assert [mesh.case_file for mesh in scene.meshes] == [f"{name}.toml" for name in STAGES]
    cases = tomllib.loads((tmp_path / "load_cases.toml").read_text(encoding="utf-8"))["load_cases"]
    assert [case["torque_n_m"] for case in cases] == [50.0, 80.0, 30.0]
    rows = (tmp_path / "import.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == 1 + 239


def test_as_json_the_report_is_an_object(tmp_path):
    facts = json.loads(printed(GEARBOX, tmp_path, "--json"))
    assert facts["cases"] == list(STAGES) and facts["scene"] is True
    assert facts["account"]["taken"] == 199
    assert any("means rigid" in line for line in facts["lines"])


def test_a_file_that_is_none_is_refused_in_one_line(tmp_path):
    file = tmp_path / "gearbox.rexs"
    file.write_text("<model", encoding="utf-8")
    result = loa("open", file, "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert not (tmp_path / "out").exists()


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    folder = tmp_path_factory.mktemp("data")
    with TestClient(create_app(Settings(data_directory=folder))) as found:
        yield found


def test_the_service_answers_with_cases_scene_and_account(client):
    text = base64.b64encode(GEARBOX.read_bytes()).decode()
    answer = client.post("/v1/units/open", json={"rexs_base64": text})
    assert answer.status_code == 200
    unit = answer.json()
    assert [stage["name"] for stage in unit["cases"]] == list(STAGES)
    scene = validated(SceneInput, unit["scene"])
    assert [mesh.case is not None for mesh in scene.meshes] == [True, True]
    assert len(unit["lines"]) == 239 and unit["load_cases"][1]["share"] == 0.7


def test_the_service_takes_assumptions(client):
    text = base64.b64encode(GEARBOX.read_bytes()).decode()
    body = {"rexs_base64": text, "assume": ["14.face_width=25"]}
    unit = client.post("/v1/units/open", json=body).json()
    (line,) = (line for line in unit["lines"] if line["fate"] == "assumed")
    assert (line["component"], line["item"]) == (14, "face_width") and line["line"] > 1
    assert unit["left_out"] == [] and "left_out" not in unit["scene"]
    refused = client.post("/v1/units/open", json=body | {"assume": ["14.face_width"]})
    assert refused.status_code == 422 and "of the form" in refused.json()["detail"]


@pytest.mark.parametrize(("text", "bound"), [("????", "base64"), ("AAAA", "")])
def test_the_service_refuses_what_is_no_file(client, text, bound):
    answer = client.post("/v1/units/open", json={"rexs_base64": text})
    assert answer.status_code == 422
    assert bound in answer.json()["detail"]


@needs_reference
@pytest.mark.parametrize("file", examples(), ids=lambda file: file.name)
def test_the_reference_files_open(file, tmp_path):
    answer = loa("open", file, "-o", tmp_path, "--strict", "--json")
    facts = json.loads(answer.stdout)
    assert facts["cases"]
    # the planetary set accounts for gravity, which its scene cannot have
    assert answer.exit_code == (3 if "Planetary" in file.name else 0), facts["warnings"]
    # the writer of the JSON file lost its vectors and switches: its ring gear is held by nothing
    assert facts["scene"] is not file.name.endswith(".rexsj")


HAND = LEFT_OUT["hand of a wheel"][1](TWO_STAGE)


def opened(text: str, folder: Path, *options: str) -> Result:
    file = folder / "unit.rexs"
    file.write_text(text, encoding="utf-8")
    return loa("open", file, "-o", folder / "out", "--strict", *options)


@pytest.mark.drawn
@pytest.mark.parametrize("fault", LEFT_OUT)
def test_a_unit_with_one_fault_names_what_is_left_out_first_and_last(fault, tmp_path):
    file, edit, parts = LEFT_OUT[fault]
    answer = opened(edit(file), tmp_path)
    assert answer.exit_code == 3, answer.output
    lines = answer.stdout.splitlines()
    assert lines[0] == lines[-1]
    for part in parts:
        assert part in lines[0], lines[0]
    scene = tmp_path / "out" / "scene.toml"
    if scene.is_file():
        marks = tomllib.loads(scene.read_text("utf-8"))["left_out"]
        warned = [line for line in lines if line.startswith("warning (left_out)")]
        assert warned == [f"warning (left_out): left out of the scene: {mark}" for mark in marks]
        assert all("(line " in mark for mark in marks)


@pytest.mark.parametrize("fault", REFUSED)
def test_a_file_that_is_no_model_is_refused_with_one_error(fault, tmp_path):
    file, edit, word = REFUSED[fault]
    answer = opened(edit(file), tmp_path)
    assert answer.exit_code == 2
    assert answer.stdout == "" and not (tmp_path / "out").exists()
    lines = answer.stderr.splitlines()
    assert lines and all(line.startswith("error: ") and word in line for line in lines)


def test_as_json_each_reason_is_a_warning(tmp_path):
    answer = opened(HAND, tmp_path, "--json")
    assert answer.exit_code == 3
    warnings = json.loads(answer.stdout)["warnings"]
    assert [warning["check"] for warning in warnings] == ["left_out"] * len(warnings)
    stage = warnings[0]["message"]
    assert 'cylindrical_stage 22 "second stage" (line 326)' in stage
    assert "13 pinion 2: left hand, 16 deg" in stage and "14 wheel 2: left hand, 16 deg" in stage


def test_an_assumption_that_the_message_names_mends_the_unit(tmp_path):
    mends = re.findall(r"--assume (\S+=\d+)", opened(HAND, tmp_path).stdout)
    assert sorted(set(mends)) == [f"{gear}.helix_angle_reference_diameter=16" for gear in (13, 14)]
    answer = opened(HAND, tmp_path, "--assume", mends[-1])
    assert answer.exit_code == 0, answer.output
    assert (
        "assumed   cylindrical_gear 14" in answer.stdout and "16.0 deg instead of -16.0 deg" in answer.stdout
    )
    whole = tmp_path / "whole"
    whole.mkdir()
    assert opened(TWO_STAGE, whole).exit_code == 0
    assert (tmp_path / "out" / "scene.toml").read_text() == (whole / "out" / "scene.toml").read_text()
    rows = (tmp_path / "out" / "import.csv").read_text("utf-8")
    assert "component 14,14,cylindrical_gear,wheel 2,helix_angle_reference_diameter,assumed" in rows


def test_an_assumption_counts_in_load_cases_that_state_the_value(tmp_path):
    assert opened(TWO_STAGE, tmp_path, "--assume", "41.torque_around_u_axis=33").exit_code == 0
    cases = tomllib.loads((tmp_path / "out" / "load_cases.toml").read_text("utf-8"))["load_cases"]
    assert [case["torque_n_m"] for case in cases] == [33.0] * 4


def test_an_assumed_place_is_an_array(tmp_path):
    file, edit, _ = LEFT_OUT["shafts too far apart"]
    assert opened(edit(file), tmp_path, "--assume", "5.support_vector=0,95.5,149").exit_code == 0


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("13.face_width", "of the form"),
        ("99.face_width=3", "the id of a component"),
        ("13.face_width=wide", "a finite number"),
    ],
)
def test_an_assumption_that_is_none_is_refused(text, word, tmp_path):
    answer = opened(TWO_STAGE, tmp_path, "--assume", text)
    assert answer.exit_code == 2 and word in answer.stderr


def test_an_assumption_that_nothing_reads_is_left_out(tmp_path):
    answer = opened(TWO_STAGE, tmp_path, "--assume", "13.helix=3")
    assert answer.exit_code == 3
    assert answer.stdout.splitlines()[0].endswith('cylindrical_gear 13 "pinion 2" (helix)')


def test_a_mark_outlives_the_text_of_the_scene_and_overrides(tmp_path):
    opened(HAND, tmp_path)
    file = InputFile(tmp_path / "out" / "scene.toml", (Override.of("run.duration_s=0.1"),))
    scene = read_model(SceneInput, file)
    assert len(scene.left_out) == 6
    text = toml_text(scene.model_dump(mode="json", exclude_unset=True))
    assert validated(SceneInput, tomllib.loads(text)).left_out == scene.left_out
    acknowledged = read_model(SceneInput, replace(file, overrides=(Override.of("left_out="),)))
    assert acknowledged.left_out == () and "left_out" not in acknowledged.model_dump(mode="json")


@pytest.mark.parametrize(
    ("verb", "code"), [(("simulate", "-o", "nowhere/run.nc"), 2), (("modes", "-o", "modes.nc"), 3)]
)
def test_later_verbs_repeat_the_mark_before_all_else(verb, code, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = (EXAMPLES / "jeffcott_scene.toml").read_text("utf-8")
    Path("scene.toml").write_text(f'left_out = ["shaft 5 (line 7): alone"]\n{scene}', encoding="utf-8")
    answer = loa(verb[0], "scene.toml", *verb[1:], "--strict")
    assert answer.exit_code == code, answer.output
    assert (
        answer.stdout.splitlines()[0] == "warning (left_out): left out of the scene: shaft 5 (line 7): alone"
    )
    if code == 3:
        (warning,) = stamped(Path("modes.nc"))
        assert warning["check"] == "left_out"


def test_a_scene_without_a_mark_has_the_address_it_had():
    scene = read_model(SceneInput, EXAMPLES / "jeffcott_scene.toml")
    assert "left_out" not in scene.model_dump(mode="json")


def test_over_http_and_in_python_the_statement_comes_first(tmp_path):
    file = tmp_path / "unit.rexs"
    file.write_text(HAND, encoding="utf-8")
    unit = unit_of_rexs(
        {"rexs_base64": b64encode(file.read_bytes()).decode(), "assume": []}, tmp_path, lambda _field: None
    )
    assert next(iter(unit)) == "left_out" == next(iter(UnitBody.model_fields))
    assert unit["left_out"] == unit["scene"]["left_out"] and "line 326" in unit["left_out"][0]
    assert validated(SceneInput, unit["scene"]).left_out == tuple(unit["left_out"])
