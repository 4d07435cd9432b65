"""A scene as it is edited: its text and its faults are answers, and what its schema says of names."""

import pytest
from fastapi.testclient import TestClient
from whole_service import whole_service

from lineofaction.gearbox.schemas.scene import SceneInput
from service.schemas.examples import SCENE


@pytest.fixture
def client(tmp_path):
    found = whole_service(tmp_path)
    yield TestClient(found.app, headers=found.headers)
    found.app.state.context.live.stop()


def test_a_drafted_scene_and_its_text_are_each_other(client):
    text = client.post("/v1/drafts/scene", json={"inputs": {"scene": SCENE}}).json()
    assert client.post("/v1/drafts/scene-text", json=text).json() == {"scene": SCENE}


def test_faults_of_a_drafted_scene_are_an_answer(client):
    gears = [SCENE["gears"][0] | {"shaft": "none such"}, *SCENE["gears"][1:]]
    wrong = {"inputs": {"scene": SCENE | {"gears": gears}}}
    draft, refused = (
        client.post("/v1/drafts/scene", json=wrong),
        client.post("/v1/scenes/to-files", json=wrong),
    )
    assert (draft.status_code, refused.status_code) == (200, 422)
    assert draft.json()["faults"] == refused.json()["errors"]
    assert draft.json()["faults"][0]["field"] == "gears[0].shaft"
    typed = client.post("/v1/drafts/scene-text", json={"toml": "[run]\nduration_s = -1.0\n"})
    assert typed.status_code == 200
    assert {fault["field"] for fault in typed.json()["faults"]} >= {"run.duration_s", "shafts"}


def test_the_schema_says_every_field_that_names_a_part():
    """A name that there is not is refused in just these fields."""
    schema = SceneInput.model_json_schema()
    for kind, fields in schema["x-references"].items():
        part = schema["$defs"][schema["properties"][kind]["items"]["$ref"].rpartition("/")[2]]
        assert set(fields) <= set(part["properties"])
        assert set(fields.values()) <= set(schema["properties"])
