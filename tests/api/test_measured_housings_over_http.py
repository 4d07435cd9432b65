"""Measured housings over HTTP: the responses go along with the scene, a confined process reads them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import printed
from measured_housings import universal_file
from measured_scenes import mass_lines, measured_scene
from study_service import KEY, study_service

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.file_content import FileContentInput
from lineofaction.gearbox.subjects import scene_inputs, scene_of

SPEEDS = {"speed_rpm": [900.0, 1500.0], "orders": 4}


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    folder = tmp_path_factory.mktemp("measured")
    with study_service(folder) as service:
        yield service, measured_scene(folder)


def inputs_of(scene: Path, **housing: Any) -> dict[str, Any]:
    """Return the inputs of the study, the table by its hash, with other fields of the housing."""
    written, _ = scene_of(scene)
    (mesh,) = written.meshes
    by_hash = mesh.model_copy(update={"database_file": None, "database_hash": KEY})
    inputs = scene_inputs(written.model_copy(update={"meshes": (by_hash,)}))
    inputs["scene"]["housings"][0] |= housing
    return inputs | SPEEDS


def test_velocities_are_those_of_the_command_line(served):
    service, scene = served
    job = service.client.submit("vibration", inputs_of(scene))
    done = service.client.wait(job.id)
    answer = service.http.get(f"/v1/results/{done.key}", headers={"Accept": "application/json"}).json()
    here = printed("vibration", scene, "--speed-rpm", "900,1500", "--orders", 4)
    for name in ("points", "measured", "left_out", "contributions"):
        assert answer[name] == here[name], name
    assert np.isnan(np.array(answer["points"]["lid"]["velocity_mm_per_s"], dtype=float)).sum() == 2
    assert [warning["check"] for warning in answer["warnings"]] == ["measured_housing"]
    page = service.http.get(f"/v1/results/{done.key}/figures").text  # what the page of the service shows
    for sentence in answer["left_out"]:
        assert sentence in page


def sent(folder: Path, sets: list[dict[str, Any]]) -> dict[str, Any]:
    file = universal_file(folder / "attack.uff", sets)
    return FileContentInput.of(file).model_dump(mode="json")


ATTACKS = {
    "no functions": ({"func_type": 6}, "a file with frequency responses"),
    "no units": ({"orddenom_axis_units_lab": "NONE"}, "states its unit of force"),
    "over time": ({"abscissa_spec_data_type": 17}, "over frequency"),
    "per motion": ({"orddenom_spec_data_type": 12}, "a response per force"),
}


@pytest.mark.parametrize("name", ATTACKS)
def test_a_file_that_cannot_be_used_is_a_fault_of_the_job(name, served, tmp_path):
    service, scene = served
    changed, bound = ATTACKS[name]
    job = service.client.submit("vibration", inputs_of(scene, frf_file=sent(tmp_path, mass_lines(**changed))))
    with pytest.raises(BadInput) as caught:
        service.client.wait(job.id)
    (fault,) = caught.value.faults
    assert fault.field == "housings[0].frf_file"
    assert bound in fault.bound


def test_a_node_that_is_not_there_is_a_fault_of_the_job(served):
    service, scene = served
    job = service.client.submit("vibration", inputs_of(scene, point_nodes=[{"name": "lid", "node": 5}]))
    with pytest.raises(BadInput) as caught:
        service.client.wait(job.id)
    assert caught.value.faults[0].field == "housings[0].point_nodes[0].node"


@pytest.mark.parametrize(
    ("file", "field"),
    [
        ("gearcase.uff", "frf_file"),
        ({"name": "/etc/passwd", "content": "eJwDAAAAAAE="}, "frf_file.name"),
        ({"name": "a.uff", "content": "AAAA"}, "frf_file.content"),
    ],
)
def test_what_is_no_file_is_refused_at_the_request(file, field, served):
    """A service reads no files of its callers, and none of another kind or damaged."""
    service, scene = served
    inputs = inputs_of(scene)
    inputs["scene"]["housings"][0]["frf_file"] = file
    answer = service.http.post("/v1/processes/vibration/execution", json={"inputs": inputs})
    assert answer.status_code == 422
    assert f"housings[0].{field}" in json.dumps(answer.json())
