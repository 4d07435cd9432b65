"""Wrong cases and scenes that cannot move: one clear error at every entry point, and nothing runs on."""

import json
import os
import re
from pathlib import Path
from typing import Any

import pytest
from bad_inputs import BAD_FILES, BAD_INPUTS, BadInput
from bad_scenes import BAD_SCENES, BadScene, good_scene
from command_line import loa
from fastapi.testclient import TestClient
from toml_text import toml_text

from dynamics.errors import InputError as DynamicsInputError
from fe_contact.errors import InputError
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.checked_case import check_case
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.scene import SceneInput

Bad = BadInput | BadScene


def names(bad: tuple[Bad, ...]) -> Any:
    return pytest.mark.parametrize("bad", bad, ids=[each.name.replace(" ", "_") for each in bad])


def children() -> set[str]:
    return set(Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text().split())


def answered(bad: Bad, client: TestClient) -> Any:
    """Post it with NaN and Infinity, as careless callers do."""
    body = json.dumps({"inputs": {bad.subject: bad.table()}})
    headers = {"Content-Type": "application/json"}
    return client.post(f"/v1/processes/{bad.process}/execution", content=body, headers=headers)


def test_there_are_at_least_thirty():
    assert len(BAD_INPUTS) >= 30
    assert len({bad.name for bad in (*BAD_INPUTS, *BAD_FILES)}) == len(BAD_INPUTS) + len(BAD_FILES)


@names((*BAD_INPUTS, *BAD_SCENES))
def test_python(bad):
    before = children()
    with pytest.raises((InputError, DynamicsInputError)) as caught:
        bad.python()
    if isinstance(bad, BadScene):
        assert caught.value.field == bad.python_field
    assert caught.value.field.endswith(bad.python_field)
    assert str(caught.value.bound)
    assert children() == before


@names((*BAD_INPUTS, *BAD_FILES, *BAD_SCENES))
def test_command_line_and_http_say_the_same(bad, client, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    before, file, output = children(), tmp_path / "input.toml", tmp_path / "output.nc"
    file.write_text(toml_text(bad.table()))
    result = loa(bad.process, file, "-o", output, "--json")
    assert (result.exit_code, result.stdout) == (2, "")
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"error: {bad.field} = ") and ": must be " in line
    assert not output.exists() and not (tmp_path / "cache").exists()
    answer = answered(bad, client)
    assert answer.status_code == 422, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    (fault,) = answer.json()["errors"]
    assert fault["field"] == bad.field and fault["bound"]
    if isinstance(bad, BadInput):  # HTTP has no line of the file
        assert fault["suggestion"]
        line = re.sub(rf" \({re.escape(str(file))}:\d+\)$", "", line)
    assert line == f"error: {answer.json()['detail']}"
    assert children() == before


def test_the_value_shown_is_the_value_given(client):
    for bad in BAD_INPUTS:
        if len(bad.changes) == 1 and bad.field in bad.changes:
            value = bad.changes[bad.field]
            shown = answered(bad, client).json()["errors"][0]["value"]
            assert shown == value or shown == repr(value), bad.name


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("bore beyond the root", "70 mm"),
        ("face width no number", "a finite number"),
        ("face width infinite", "a finite number"),
    ],
)
def test_bounds_are_words_in_the_units_of_the_field(name, words, client):
    (bad,) = [case for case in BAD_INPUTS if case.name == name]
    (fault,) = answered(bad, client).json()["errors"]
    assert words in fault["bound"]
    assert fault["bound"].startswith(words) or fault["value"] == 95.0


def test_what_is_right_is_not_refused():
    case = BadInput("good", lambda: None, "").table()
    assert check_case(validated(Case, case)).pinion.teeth == 20
    scene = validated(SceneInput, good_scene())
    with_case = [mesh for mesh in scene.meshes if mesh.case]
    check_scene(scene, {mesh.name: PairGeometry.of(check_case(mesh.case)) for mesh in with_case})
