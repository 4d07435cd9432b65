"""What the page is made of: examples that can be computed, files, drawing, TOML."""

import json
import math
import re
import tomllib
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from repository import ROOT

from lineofaction.gearbox.convert.case import case_json, gear_pair
from lineofaction.gearbox.convert.checked_case import check_case
from lineofaction.gearbox.convert.outline import outline_json
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.file_content import FileContentInput
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_text
from service.app import create_app
from service.page.example_cases import examples
from service.page.files import page_file
from service.settings import Settings

STATIC = ROOT / "service" / "page" / "static"
CASES = {example.name: validated(Case, example.content) for example in examples()}


@pytest.fixture
def client(tmp_path):
    with TestClient(create_app(Settings(data_directory=tmp_path))) as found:
        yield found


@pytest.mark.parametrize("name", CASES)
def test_every_example_can_be_computed(name):
    assert check_case(CASES[name]).transverse_contact_ratio > 1.0


def test_the_result_of_the_first_example_is_of_the_case_as_it_is_now():
    known = json.loads((STATIC / "first.json").read_text(encoding="utf-8"))
    assert known["case"] == case_json(next(iter(CASES.values())))


def test_examples_that_fake_the_folder_too_are_the_same():
    for file in (ROOT / "service" / "page" / "examples").glob("*.toml"):
        twin = ROOT / "examples" / file.name
        assert file.name == "helical_automotive.toml" or file.read_bytes() == twin.read_bytes()


@pytest.mark.parametrize("name", CASES)
def test_a_case_written_as_toml_reads_back_the_same(name):
    written = toml_text(case_json(CASES[name]))
    assert validated(Case, tomllib.loads(written)) == CASES[name]


def test_toml_holds_every_kind_of_value():
    content = {
        "a": {
            "text": 'quote " \\ \n',
            "on": True,
            "list": [1.0, -2e-9],
            "grid": [[1, 2], [3, 4]],
            "none": None,
        }
    }
    content["a"]["inner"] = {"x": 1e300}
    read = tomllib.loads(toml_text(content))
    del content["a"]["none"]
    assert read == content


def placed(gear: dict[str, Any], z: float | None = None) -> np.ndarray:
    """Return one turn of outline points (teeth, n, 2), placed as drawn; z in mm: the section there."""
    tooth = np.array(gear["tooth_mm"])
    along = 0.0 if z is None else z - sum(gear["face_mm"]) / 2
    turned = math.radians(gear["angle_deg"] + gear["twist_deg_per_mm"] * along)
    angle = turned + 2.0 * np.pi * np.arange(gear["teeth"]) / gear["teeth"]
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.asarray(np.einsum("ijt,nj->tni", turn, tooth) + np.array(gear["centre_mm"]))


@pytest.mark.parametrize("name", CASES)
def test_the_drawn_flanks_touch_at_the_pitch_point_and_nowhere_overlap(name):
    drawn = outline_json(CASES[name])
    pinion, wheel = placed(drawn["pinion"]), placed(drawn["wheel"])
    pitch_point = np.array(drawn["path_of_contact"]["points_mm"]["C"])
    for gear in (pinion, wheel):
        nearest = np.min(np.linalg.norm(gear - pitch_point, axis=2))
        assert nearest < 0.06 * CASES[name].pair.normal_module_mm  # a chord of the polygon
    # no point of the pinion's outline lies inside a tooth of the wheel (by more than the chords)
    modulus, radius = CASES[name].pair.normal_module_mm, drawn["wheel"]["radius_mm"]
    tip, sign = radius["tip"], -1.0 if drawn["internal"] else 1.0
    arm = pinion.reshape(-1, 2) - np.array(drawn["wheel"]["centre_mm"])
    inside = sign * (tip - np.linalg.norm(arm, axis=1)) > 0.0
    depth = [_depth(point, drawn["wheel"]) for point in arm[inside]]
    assert inside.any() and max(depth) < 0.01 * modulus


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("z", [-9.0, 4.0])
def test_sections_along_the_face_touch_and_nowhere_overlap(name, z):
    drawn, modulus = outline_json(CASES[name]), CASES[name].pair.normal_module_mm
    wheel = drawn["wheel"]
    along = z - sum(wheel["face_mm"]) / 2
    section = wheel | {"angle_deg": wheel["angle_deg"] + wheel["twist_deg_per_mm"] * along}
    arm = placed(drawn["pinion"], z).reshape(-1, 2) - np.array(wheel["centre_mm"])
    sign = -1.0 if drawn["internal"] else 1.0
    inside = sign * (wheel["radius_mm"]["tip"] - np.linalg.norm(arm, axis=1)) > 0.0
    depth = [_depth(point, section) for point in arm[inside]]
    assert -0.08 * modulus < max(depth) < 0.01 * modulus


def _depth(point: np.ndarray, gear: dict[str, Any]) -> float:
    """Depth in mm of a point (from the gear's center) inside a tooth, along the circle; < 0: outside."""
    pitch = 2.0 * np.pi / gear["teeth"]
    angle = math.atan2(point[1], point[0]) - math.pi / 2 - math.radians(gear["angle_deg"])
    angle -= pitch * round(angle / pitch)
    tooth = np.array(gear["tooth_mm"])
    half = tooth[tooth[:, 0] > 0.0]
    radius, flank = np.hypot(half[:, 0], half[:, 1]), np.arctan2(half[:, 0], half[:, 1])
    order = np.argsort(radius)
    r = math.hypot(*point)
    if not radius[order[0]] <= r <= radius[order[-1]]:
        return -math.inf
    return r * (float(np.interp(r, radius[order], flank[order])) - abs(angle))


def test_the_figures_of_the_pair_are_those_of_the_geometry():
    case = CASES["helical_automotive"]
    drawn, pair = outline_json(case), gear_pair(case)
    path = drawn["path_of_contact"]["points_mm"]
    length = math.dist(path["A"], path["E"]) / drawn["path_of_contact"]["base_pitch_mm"]
    assert length == pytest.approx(pair.transverse_contact_ratio, rel=1e-4)
    assert drawn["figures"]["total_contact_ratio"] == pytest.approx(pair.total_contact_ratio, rel=1e-12)


def test_the_page_names_only_files_it_has_and_nothing_foreign(client):
    for file in STATIC.iterdir():
        text = file.read_text(encoding="utf-8")
        for name in re.findall(r'(?:from "\./|/page/)([\w.-]+)', text):
            assert client.get(f"/page/{name}").status_code == 200, (file.name, name)
        assert set(re.findall(r"https?://[\w./]+", text)) <= {"http://www.w3.org/2000/svg"}, file.name


def test_the_pages_are_held_to_their_own_scripts(client):
    for path in ("/", "/docs"):
        answer = client.get(path)
        policy = answer.headers["content-security-policy"]
        rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
        assert rules["default-src"] == "'none'" and rules["script-src"] == rules["connect-src"] == "'self'"
        again = client.get(path, headers={"If-None-Match": answer.headers["etag"]})
        assert again.status_code == 304 and not again.content


@pytest.mark.parametrize("name", ["app.py", "..%2Fapp.py", "%2e%2e/settings.py", "examples", "none.js"])
def test_no_other_file_is_served(client, name):
    assert client.get(f"/page/{name}").status_code == 404


@pytest.mark.parametrize(
    ("kind", "text", "field"),
    [
        ("cases", "[pair", "toml"),
        ("cases", "[pair]\nnormal_module_mm = 4.0\n", "pair.center_distance_mm"),
        ("scenes", "[run", "toml"),
        ("scenes", "[run]\nduration_s = 1.0\nend_s = 2.0\n", "run.end_s"),
    ],
)
def test_text_that_is_no_case_or_scene_is_refused_by_field(client, kind, text, field):
    answer = client.post(f"/v1/{kind}/from-toml", json={"toml": text})
    fields = [fault["field"] for fault in answer.json()["errors"]]
    assert answer.status_code == 422 and field in fields
    assert field != "toml" or fields == ["toml"]


SCENES = ("palermo_scene", "planetary_scene", "flexible_shafts_scene", "wind_turbine_scene")


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_file_read_and_written_is_the_same_scene(client, name):
    text = (ROOT / "examples" / f"{name}.toml").read_text(encoding="utf-8")
    read = client.post("/v1/scenes/from-toml", json={"toml": text}).json()["scene"]
    written = client.post("/v1/scenes/to-toml", json={"inputs": {"scene": read}}).json()["toml"]
    assert validated(SceneInput, tomllib.loads(written)) == validated(SceneInput, tomllib.loads(text))
    assert "sample_rate_hz" not in written or "sample_rate_hz" in text, "no defaults are added"


def test_the_files_that_a_scene_names_are_read_with_it(client):
    scene, case = (ROOT / "examples" / f"{name}.toml" for name in ("palermo_scene", "palermo_spur_20_20"))
    files = [FileContentInput.of(case).model_dump(mode="json")]
    read = client.post("/v1/scenes/from-toml", json={"toml": scene.read_text("utf-8"), "files": files})
    assert read.json()["scene"]["meshes"][0]["case"]["pair"]["pinion"]["teeth"] == 20


def test_a_second_visit_reads_no_file_of_the_page():
    names = [path.name for path in STATIC.iterdir()]
    first = [page_file(name) for name in names]
    assert len(names) > 64
    assert all(page_file(name) is file for name, file in zip(names, first, strict=True))
