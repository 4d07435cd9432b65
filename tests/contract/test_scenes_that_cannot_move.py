"""A scene that cannot move is one clear error at every entry point, before anything is computed."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from bad_scenes import BAD_SCENES, BadScene, good_scene
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from dynamics.errors import InputError
from fe_contact.ste import PairFacts
from lineofaction.cli.commands import app as loa
from lineofaction.gearbox.convert.case import check_case
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from service.app import create_app
from service.settings import Settings

EVERY = pytest.mark.parametrize("bad", BAD_SCENES, ids=[bad.name.replace(" ", "_") for bad in BAD_SCENES])
HEADERS = {"Content-Type": "application/json"}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    with TestClient(create_app(Settings(data_directory=tmp_path_factory.mktemp("data")))) as found:
        yield found
        assert found.get("/v1/jobs").json()["jobs"] == []


def answered(bad: BadScene, client: TestClient) -> Any:
    body = json.dumps({"inputs": {"scene": bad.table()}})
    return client.post("/v1/processes/simulate/execution", content=body, headers=HEADERS)


def commanded(bad: BadScene, folder: Path) -> Any:
    """What the command line says to the scene as a file, its tables written inline."""
    file = folder / "scene.toml"
    lines = [f"{key} = {inline(value)}" for key, value in bad.table().items()]
    file.write_text("\n".join(lines) + "\n")
    return CliRunner().invoke(loa, ["simulate", str(file), "-o", str(folder / "run.nc"), "--json"])


def inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {inline(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(inline(item) for item in value) + "]"
    return json.dumps(value)


@EVERY
def test_python(bad: BadScene) -> None:
    with pytest.raises(InputError) as caught:
        bad.python()
    assert caught.value.field == bad.python_field
    assert str(caught.value.bound)


@EVERY
def test_command_line(bad: BadScene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    result = commanded(bad, tmp_path)
    assert result.exit_code == 2
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"error: {bad.field} = ")
    assert ": must be " in line
    assert not (tmp_path / "run.nc").exists()
    assert not (tmp_path / "cache").exists()


@EVERY
def test_http(bad: BadScene, client: TestClient) -> None:
    answer = answered(bad, client)
    assert answer.status_code == 422, answer.text
    (fault,) = answer.json()["errors"]
    assert fault["field"] == bad.field
    assert fault["bound"]


@EVERY
def test_both_doors_of_a_scene_say_the_same(bad: BadScene, client: TestClient, tmp_path: Path) -> None:
    assert commanded(bad, tmp_path).stderr == f"error: {answered(bad, client).json()['detail']}\n"


def test_a_scene_that_moves_is_not_refused() -> None:
    scene = validated(SceneInput, good_scene())
    check_scene(scene, {mesh.name: PairFacts.of(check_case(mesh.case)) for mesh in scene.meshes if mesh.case})
