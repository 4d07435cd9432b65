"""Scenes on the solid of a housing over HTTP: its file goes along, the worker reduces it, faults return."""

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from housing_solid import SEAT, housed_scene, housing, write_block
from study_service import empty_service

from dynamics.housings import ReducedHousing
from dynamics.linearize import ModalAnalysis
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.client import JobState, LineOfActionClient
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.modes import Inputs
from lineofaction.gearbox.studies.modes.run import RUN
from lineofaction.gearbox.subjects import scene_inputs, scene_of
from service.store.places import stored_results

KEY = "cd" * 32
Served = tuple[LineOfActionClient, TestClient, Path]


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A client of a running service that holds the table, the bare HTTP one, a folder with the STEP file."""
    folder = tmp_path_factory.mktemp("scene")
    write_block(folder / "block.step")
    housed_scene(folder)
    data = folder / "data"
    with empty_service(data) as (client, http):
        stored_results(data).put(KEY, "database", folder / "mesh.nc")
        yield client, http, folder


def scene_file(folder: Path, **fields: Any) -> Path:
    scene = copy.deepcopy(housed_scene(folder, **fields))
    del scene["meshes"][0]["database_file"]
    scene["meshes"][0]["database_hash"] = KEY
    file = folder / "scene.json"
    file.write_text(json.dumps(scene))
    return file


def test_modes_on_a_solid_are_those_of_the_command_line(served, monkeypatch):
    """The effect on; the housing is a stage of the work, and in the service's cache afterwards."""
    client, _, folder = served
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
    seen: list[JobState] = []
    file = client.modes.submit(scene_file(folder)).file(seen.append)
    (folder / "here.json").write_text(json.dumps(housed_scene(folder)))
    here = tabled_scene(*scene_of(folder / "here.json"), None, lambda _stage, _fraction: None)
    expected = RUN.compute(here, Inputs(), Means(folder, lambda _stage, _fraction: None))
    found = ModalAnalysis.from_netcdf(file)
    np.testing.assert_array_equal(found.natural_frequency, expected.natural_frequency)
    np.testing.assert_array_equal(found.surface_motion, expected.surface_motion)
    assert found.surface_motion.any(), "walls move"
    assert "housing" in [state.stage for state in seen if state.stage]
    assert sorted(state.progress for state in seen) == [state.progress for state in seen]
    kept = sorted((folder / "data" / "housings").glob("*.nc"))
    assert [each.name[:4] for each in kept] == ["hous", "mesh"]
    cost = ReducedHousing.from_netcdf(kept[0]).cost
    own = found.metadata["reduction_cost"]["case"]
    assert (own["seconds"], own["predicted_seconds"]) == (cost.seconds, cost.predicted_seconds)


@pytest.mark.law
def test_the_content_of_a_file_is_part_of_the_address_of_a_result(served):
    """Another solid of the same name is another question."""
    client, _, folder = served
    first = client.submit("modes", scene_inputs(scene_file(folder)))
    text = (folder / "block.step").read_text()
    (folder / "block.step").write_text(text + "/* revised */\n")
    second = client.submit("modes", scene_inputs(scene_file(folder)))
    (folder / "block.step").write_text(text)
    third = client.submit("modes", scene_inputs(scene_file(folder)))
    keys = [client.wait(job.id).key for job in (first, second, third)]
    assert keys[0] == keys[2] != keys[1]


def test_a_bore_that_is_not_there_is_a_fault_of_the_job(served):
    client, _, folder = served
    seats = housing()["seats"]
    wrong = [seats[0], seats[1] | SEAT | {"bore_diameter_mm": 55.0}]
    job = client.submit("modes", scene_inputs(scene_file(folder, seats=wrong)))
    with pytest.raises(BadInput) as caught:
        client.wait(job.id)
    (fault,) = caught.value.faults
    assert fault.field == "housings[0].seats[1].bore_diameter_mm"
    assert "diameter of 40 mm" in fault.suggestion


@pytest.mark.parametrize("field", ["step_file", "modes_file"])
def test_the_name_of_a_file_is_refused_at_the_request(served, field):
    """A service reads no files of its callers."""
    client, http, folder = served
    inputs = scene_inputs(scene_file(folder))
    (part,) = inputs["scene"]["housings"]
    if field == "modes_file":
        part = {"name": "case", "bushings": part["bushings"], "stiffness_matrix": np.eye(10).tolist()}
    inputs["scene"]["housings"] = [part | {field: "case.x"}]
    answer = http.post("/v1/processes/modes/execution", json={"inputs": inputs})
    assert answer.status_code == 422
    assert field in json.dumps(answer.json())
    with pytest.raises(BadInput):
        client.submit("modes", inputs)


def test_a_body_beyond_the_limit_is_refused_by_its_size(served):
    _, http, folder = served
    inputs = scene_inputs(scene_file(folder))
    inputs["scene"]["housings"][0]["step_file"]["content"] += 4_000_000 * "A"
    answer = http.post("/v1/processes/modes/execution", json={"inputs": inputs})
    assert answer.status_code == 413
