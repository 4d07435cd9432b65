"""Measured housings of scene files: their fields, their files, and what they leave as it is."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from measured_housings import function, universal_file
from measured_scenes import LINES, MASS, mass_lines, measured_scene
from small_table import small_table

from dynamics.errors import InputError
from lineofaction.gearbox.convert import measured_housings
from lineofaction.gearbox.convert.housings import numbered_as_written
from lineofaction.gearbox.convert.measured_housings import housing_mobility, read_responses
from lineofaction.gearbox.convert.scene import check_scene, dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import SceneInput, validated
from lineofaction.gearbox.schemas.file_content import FileContentInput
from lineofaction.gearbox.schemas.files import READERS, side_files, written_out
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.schemas.named_files import in_folder
from lineofaction.gearbox.subjects import scene_of
from service.reading.texts import scene_of_toml

MATRIX = [[1e8 * (i == k) for k in range(3)] for i in range(3)]
NODES: dict[str, Any] = {
    "seat_nodes": [{"bearing": "left", "node": 1}],
    "point_nodes": [{"name": "lid", "node": 11}],
}


def content(folder: Path, sets: list[dict[str, Any]] | None = None, name: str = "gearcase.uff") -> Any:
    file = universal_file(folder / "some.uff", mass_lines() if sets is None else sets)
    return FileContentInput.packed(name, file.read_bytes()).model_dump(mode="json")


def housing(folder: Path, **fields: Any) -> dict[str, Any]:
    return {"name": "gearcase", "frf_file": content(folder), **NODES} | fields


def test_a_scene_file_names_the_file_and_a_request_holds_it(tmp_path):
    """Both are the same scene; files beside it are written again under their names."""
    file = measured_scene(tmp_path)
    scene, _ = scene_of(file)
    (part,) = scene.housings
    assert part.bushings == ("left",)
    assert part.frf_file.unpacked() == (tmp_path / "gearcase.uff").read_bytes()
    again = validated(SceneInput, scene.model_dump(mode="json"))
    assert again == scene
    table, files = side_files(scene.model_dump(mode="json", exclude_unset=True))
    assert [each.name for each in files] == ["gearcase.uff"]
    folder = tmp_path / "again"
    folder.mkdir()
    (folder / files[0].name).write_bytes(files[0].unpacked())
    assert table["housings"][0]["frf_file"] == "gearcase.uff"
    assert validated(SceneInput, written_out(table, in_folder(folder), READERS)).housings == scene.housings


def test_a_text_with_its_files_is_read_as_beside_it_on_disk(tmp_path):
    file = measured_scene(tmp_path)
    sent = [FileContentInput.of(tmp_path / "gearcase.uff").model_dump(mode="json")]
    empty = tmp_path / "empty"
    empty.mkdir()
    fields: list[str] = []
    scene = scene_of_toml({"toml": file.read_text("utf-8"), "files": sent}, empty, fields.append)["scene"]
    assert validated(SceneInput, scene).housings == scene_of(file)[0].housings


@pytest.mark.law
def test_a_measured_housing_moves_no_shaft(tmp_path):
    """The scene of dynamics is the one without it; matrices of other housings keep their bearings."""
    table = {"mesh": small_table()}
    scene, _ = scene_of(measured_scene(tmp_path))
    bare = scene.model_copy(update={"housings": ()})
    assert dynamic_scene(scene, table).housings == dynamic_scene(bare, table).housings == ()
    both = {"name": "frame", "bushings": ["left"], "stiffness_matrix": MATRIX}
    beside_it = scene.model_copy(update={"housings": (*scene.housings, HousingInput.model_validate(both))})
    (frame,) = dynamic_scene(beside_it, table).housings
    assert frame.name == "frame"


def test_errors_of_dynamics_count_housings_as_the_file_does(tmp_path):
    """The second and third housing of the file are the first and second of dynamics."""
    scene, _ = scene_of(measured_scene(tmp_path))
    same = {"bushings": ["left"], "stiffness_matrix": MATRIX}
    two = tuple(HousingInput.model_validate(same | {"name": name}) for name in "ab")
    facts = {"mesh": small_table().geometry}
    with pytest.raises(BadInput, match=r"housings\[2\]\.bushings\[0\].*in one housing only"):
        check_scene(scene.model_copy(update={"housings": (*scene.housings, *two)}), facts)
    with pytest.raises(InputError, match=r"^meshes\[0\]"), numbered_as_written(scene.housings):
        raise InputError("meshes[0]", 1, "as it is")


def test_the_axes_of_the_file_are_turned_into_the_scene(tmp_path):
    """The file's x is the scene's z, its z the scene's y: so its y is the scene's x."""
    given = housing(tmp_path, x_axis=[0.0, 0.0, 0.5], z_axis=[0.0, 1.0, 0.0])
    found = housing_mobility(HousingInput.model_validate(given))
    np.testing.assert_allclose(found.axes, [[0, 1, 0], [0, 0, 1], [1, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(found.mobility[:, 0, 0] * 2j * np.pi * LINES * MASS, 1.0, rtol=1e-5)


def test_a_file_is_read_once(tmp_path, monkeypatch):
    given = housing(tmp_path, name="once")
    first = housing_mobility(HousingInput.model_validate(given))
    monkeypatch.setattr(measured_housings, "read_frequency_responses", lambda *_: pytest.fail("read again"))
    assert housing_mobility(HousingInput.model_validate(given)) is first


LEFT = {"bearing": "left", "node": 1}
REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "no seats": ({"seat_nodes": []}, r"seat_nodes = nothing: must be given with frf_file"),
    "no points": ({"point_nodes": []}, r"point_nodes = nothing: must be given with frf_file"),
    "a node twice": ({"seat_nodes": [LEFT, LEFT]}, r"seat_nodes\[1\]\.node = 1: must be a node that no"),
    "other bearings": ({"bushings": ["right"]}, r"bushings.*left out with seat_nodes"),
    "damping": ({"damping_ratio": 0.01}, r"damping_ratio = 0\.01.*left out with frf_file"),
    "matrices too": ({"stiffness_matrix": MATRIX}, r"stiffness_matrix.*one of them"),
    "modes too": ({"modes": 12}, r"modes.*given with step_file or mesh_file"),
    "a place": ({"origin_mm": [0.0, 0.0, 1.0]}, r"origin_mm.*given with step_file or mesh_file"),
    "skew axes": ({"x_axis": [1.0, 0.0, 1.0]}, r"x_axis.*perpendicular to z_axis"),
    "no axis": ({"z_axis": [0.0, 0.0, 0.0]}, r"z_axis.*not all zero"),
    "below zero": ({"seat_nodes": [LEFT | {"node": -1}]}, r"seat_nodes\[0\]\.node"),
    "nodes of matrices": ({"frf_file": None, "stiffness_matrix": MATRIX}, r"seat_nodes.*given with frf_file"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_fields_that_do_not_fit_are_refused(name, tmp_path):
    fields, message = REFUSED[name]
    with pytest.raises(BadInput, match=message):
        validated(HousingInput, housing(tmp_path, **fields))


FAULTS: dict[str, tuple[Callable[[Path], dict[str, Any]], str]] = {
    "another ending": (
        lambda folder: {"frf_file": content(folder, name="a.mat")},
        r"frf_file\.name = .a\.mat.: must be a name that ends in \.unv",
    ),
    "damaged": (
        lambda _: {"frf_file": {"name": "a.uff", "content": "AAAA"}},
        r"frf_file\.content.*compressed by zlib",
    ),
    "a seat not in it": (
        lambda _: {"seat_nodes": [LEFT, LEFT | {"node": 7}]},
        r"seat_nodes\[1\]\.node = 7: must be a reference node of gearcase\.uff: 1",
    ),
    "a point not in it": (
        lambda _: {"point_nodes": [{"name": "lid", "node": 99}]},
        r"point_nodes\[0\]\.node = 99: must be a response node of gearcase\.uff: 11, 12",
    ),
    "no functions": (
        lambda folder: {"frf_file": content(folder, mass_lines(func_type=6))},
        r"frf_file = .gearcase\.uff.: must be a file with frequency responses",
    ),
    "no units": (
        lambda folder: {"frf_file": content(folder, mass_lines(orddenom_axis_units_lab="NONE"))},
        r"frf_file.*states its unit of force",
    ),
    "an evil name": (
        lambda folder: {"frf_file": content(folder, mass_lines(func_type=6), name="../../x\n.uff")},
        r"frf_file = .responses\.uff.: must be a file with frequency responses",
    ),
    "a foreign file": (
        lambda _: {"frf_file": FileContentInput.packed("a.uff", b"\x89HDF\r\n\x1a\n" * 40).model_dump()},
        r"frf_file = .a\.uff.",
    ),
    "a hole": (
        lambda folder: {"frf_file": content(folder, [*mass_lines(), function(LINES, LINES, (11, 3, 1, 1))])},
        r"frf_file.*a function of lid z per left y",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_file_that_cannot_be_used_is_named_by_the_field_of_the_scene(name, tmp_path):
    change, message = FAULTS[name]
    scene = tomllib.loads(measured_scene(tmp_path).read_text("utf-8"))
    scene["housings"] = [housing(tmp_path) | change(tmp_path)]
    inputs = validated(SceneInput, scene)
    with pytest.raises(BadInput, match=rf"^housings\[0\]\.{message}"):
        check_scene(inputs, {"mesh": small_table().geometry})
        read_responses(inputs)


def test_a_file_that_is_not_beside_the_scene_is_refused(tmp_path):
    file = measured_scene(tmp_path)
    (tmp_path / "gearcase.uff").unlink()
    with pytest.raises(
        BadInput, match=r"housings\[0\]\.frf_file = .gearcase\.uff.: must be a file that exists"
    ):
        scene_of(file)
    file.write_text(file.read_text("utf-8").replace('"gearcase.uff"', '"scene.toml"'), "utf-8")
    with pytest.raises(BadInput, match=r"housings\[0\]\.frf_file.*ends in \.unv, \.uff, \.uf"):
        scene_of(file)
