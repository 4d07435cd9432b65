"""Texts with the files that they name: read as beside one another on disk, and nothing else is read."""

import base64
import tomllib
import zlib
from pathlib import Path

import h5py
import pytest
from reduced_housings import random_housing
from repository import ROOT

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, SceneInput, read_model
from lineofaction.gearbox.schemas.file_content import LARGEST, FileContentInput
from lineofaction.gearbox.schemas.files import side_files
from lineofaction.gearbox.schemas.toml import toml_text
from service.reading.texts import case_of_toml, scene_of_toml

SCENE = ROOT / "examples" / "palermo_scene.toml"
CASE = SCENE.with_name("palermo_spur_20_20.toml")
BOX = """
[[housings]]
name = "box"
material = "gray_cast_iron"
step_file = "cad/box.step"
seats = [{bearing = "input left", bore_diameter_mm = 62.0, bore_length_mm = 18.0}]
feet = [{name = "base", point_mm = [0.0, -80.0, 0.0], normal = [0.0, -1.0, 0.0]}]
"""
GRID = "roll_length_mm,face_position_mm,removed_um\n10,0,0\n10,20,1\n20,0,2\n20,20,3\n"


def announce(_field: str) -> None:
    """Where a reader says what it reads next."""


def packed(name: str, content: bytes) -> dict[str, str]:
    return {"name": name, "content": base64.b64encode(zlib.compress(content)).decode()}


def test_the_case_of_a_mesh_is_written_out(tmp_path):
    files = [packed(CASE.name, CASE.read_bytes())]
    scene = scene_of_toml({"toml": SCENE.read_text("utf-8"), "files": files}, tmp_path, announce)["scene"]
    assert SceneInput.model_validate(scene).meshes[0].case == read_model(Case, CASE)
    assert "case_file" not in scene["meshes"][0]


def test_a_case_that_is_not_sent_stays_a_name(tmp_path):
    scene = scene_of_toml({"toml": SCENE.read_text("utf-8"), "files": []}, tmp_path, announce)["scene"]
    assert scene["meshes"][0]["case_file"] == CASE.name


def test_the_solid_of_a_housing_is_written_out_by_its_own_name(tmp_path):
    content = b"ISO-10303-21;\n" * 50
    given = {"toml": SCENE.read_text("utf-8") + BOX, "files": [packed(r"C:\parts\box.step", content)]}
    (housing,) = scene_of_toml(given, tmp_path, announce)["scene"]["housings"]
    assert housing["step_file"]["name"] == "box.step"
    assert FileContentInput.model_validate(housing["step_file"]).unpacked() == content


HOUSED = """
[[housings]]
name = "../../of {0}"
bushings = ["{0} left", "{0} right"]
stiffness_matrix = [{1}]
"""


def housed(scale: float, *names: str) -> str:
    """Return housings with stiffness matrices whose numbers have all their digits."""
    rows = ", ".join(str([scale * (i == k) / 3.0 for k in range(6)]) for i in range(6))
    return "".join(HOUSED.format(name, rows) for name in names)


@pytest.mark.law
def test_a_scene_with_files_beside_it_is_the_same_scene(tmp_path):
    """To the last bit, by names without folders; equal names of other content are told apart by a number."""
    step = FileContentInput.packed("case.step", b"ISO-10303-21;").model_dump(mode="json")
    scene = tomllib.loads(SCENE.read_text("utf-8") + housed(1e8, "input") + housed(3e8, "output"))
    scene["housings"] += [
        {"name": "a", "step_file": step},
        {"name": "b", "step_file": step | {"name": "x/case.step"}},
    ]
    scene["housings"] += [
        {"name": "c", "mesh_file": FileContentInput.packed("case.step", b"other").model_dump()}
    ]
    scene["housings"][1]["name"] = "of/input"
    table, files = side_files(scene)
    assert [file.name for file in files] == [
        *("of_input_stiffness.csv", "of_input_2_stiffness.csv", "case.step", "case_2.step"),
    ]
    assert max(map(len, toml_text(table).splitlines())) < 200
    given = {"toml": toml_text(table | {"housings": table["housings"][:2]})}
    back = scene_of_toml(given | {"files": [file.model_dump() for file in files]}, tmp_path, announce)[
        "scene"
    ]
    for one, other in zip(back["housings"], scene["housings"], strict=False):
        assert one["stiffness_matrix"] == other["stiffness_matrix"]


def test_a_housing_with_mass_keeps_its_matrices(tmp_path):
    own = {"name": "h", "stiffness_matrix": [[1.0]], "mass_matrix": [[1.0]]}
    assert side_files({"housings": [own]}) == ({"housings": [own]}, [])
    assert side_files({"shafts": []}) == ({"shafts": []}, [])


def test_a_flank_of_a_case_is_read_from_its_file(tmp_path):
    text = CASE.read_text("utf-8").replace("[pair.pinion]", '[pair.pinion]\nflank_grid_csv = "flank.csv"')
    case = case_of_toml({"toml": text, "files": [packed("flank.csv", GRID.encode())]}, tmp_path, announce)[
        "case"
    ]
    assert case["pair"]["pinion"]["flank_grid"]["removed_um"] == [[0.0, 1.0], [2.0, 3.0]]


@pytest.mark.parametrize("name", ["/etc/hostname.step", "../box.step", "box.stp", "..", ""])
def test_nothing_is_read_but_what_is_given(tmp_path, monkeypatch, name):
    (tmp_path / "inner").mkdir()
    (tmp_path / "box.step").write_text("solid")
    monkeypatch.chdir(tmp_path / "inner")
    text = SCENE.read_text("utf-8") + BOX.replace("cad/box.step", name)
    for files in ([], [packed("other.step", b"solid")]):
        with pytest.raises(BadInput) as refused:
            scene_of_toml({"toml": text, "files": files}, tmp_path, announce)
        assert [fault.field for fault in refused.value.faults] == ["housings[0].step_file"]


@pytest.mark.parametrize("files", [[], ["case.nc"]])
def test_a_file_of_modes_is_not_opened(tmp_path, monkeypatch, files):
    """HDF5 opens more than it is given: one error says who reads the file, given or not."""
    random_housing().to_netcdf(tmp_path / "case.nc")
    monkeypatch.setattr(h5py, "File", lambda *_, **__: pytest.fail("opened"))
    given = [packed(name, (tmp_path / name).read_bytes()) for name in files]
    (tmp_path / "own").mkdir()
    text = f'{SCENE.read_text("utf-8")}\n[[housings]]\nname = "box"\nmodes_file = "case.nc"\n'
    with pytest.raises(BadInput, match=r"no netCDF files of its callers\. Run the scene by loa") as refused:
        scene_of_toml({"toml": text, "files": given}, tmp_path / "own", announce)
    assert [fault.field for fault in refused.value.faults] == ["housings[0].modes_file"]


@pytest.mark.parametrize(
    ("files", "field"),
    [
        ([packed("a.step", b"1"), packed("folder/a.step", b"2")], "files[1].name"),
        ([packed("..", b"1")], "files[0].name"),
        ([packed("a\0.step", b"1")], "files[0].name"),
        ([{"name": "a.step", "content": "no zlib"}], "files[0].content"),
    ],
)
def test_files_that_are_none_are_refused_by_field(files, field, tmp_path):
    with pytest.raises(BadInput) as refused:
        scene_of_toml({"toml": "", "files": files}, tmp_path, announce)
    assert [fault.field for fault in refused.value.faults] == [field]


def test_a_file_is_read_once_however_often_it_is_named(tmp_path, monkeypatch):
    reads: list[Path] = []
    read = FileContentInput.of
    monkeypatch.setattr(FileContentInput, "of", lambda file: (reads.append(file), read(file))[1])
    text = SCENE.read_text("utf-8") + "".join(BOX.replace('"box"', f'"box {k}"') for k in range(20))
    sent = {"toml": text, "files": [packed("box.step", b"ISO-10303-21;")]}
    assert len(scene_of_toml(sent, tmp_path, announce)["scene"]["housings"]) == 20
    assert len(reads) == 1


def test_files_are_bounded_together(tmp_path):
    """Each of them may be as large as all."""
    half = b"0" * (LARGEST // 2 + 1)
    sent = {"toml": "", "files": [packed("a.csv", half), packed("b.csv", half)]}
    with pytest.raises(BadInput, match="with all other files at most 64000000 bytes") as refused:
        scene_of_toml(sent, tmp_path, announce)
    assert [fault.field for fault in refused.value.faults] == ["files[1].content"]


def test_a_file_that_is_no_text_is_refused_by_its_own_name(tmp_path):
    """Not by the place that it has in the service."""
    with pytest.raises(BadInput) as refused:
        scene_of_toml(
            {"toml": SCENE.read_text("utf-8"), "files": [packed(CASE.name, b"\xff\xfe")]}, tmp_path, announce
        )
    (fault,) = refused.value.faults
    assert (fault.value, "/tmp" in str(refused.value)) == (CASE.name, False)
