"""Ablations of cases and scenes as jobs: the real process over HTTP, and through the client."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from running_service import REFERENCES
from scene_files import scene_file

from fe_contact.effects import EFFECTS
from fe_contact.ste import SteDatabase
from service.app import create_app
from service.client import JobState, LineOfActionClient
from service.convert.ablation import ablation_json, ablation_of_case, ablation_of_scene
from service.convert.scene import dynamic_scene
from service.jobs.ablation_work import switch_effects
from service.jobs.catalogue import ABLATE
from service.jobs.order import WorkOrder
from service.problems import BadInput
from service.schemas import Case, read_model, validated
from service.schemas.scene import SceneInput
from service.settings import Settings
from service.store import stored_results

KEY = "ab" * 32
GEAR = {"teeth": 20, "face_width_mm": 10.0, "bore_diameter_mm": 40.0, "thickness_allowance_um": 90.0}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": GEAR, "wheel": GEAR},
    "load": {"torque_n_m": [20.0, 40.0]},
    "accuracy": {"level": "draft", "positions": 16, "model": "plane_strain"},
}
ONLY = ["tooth_coupling", "misalignment"]

Served = tuple[LineOfActionClient, TestClient, Path]


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A client of a running service that holds a table, the bare HTTP one, and the data directory."""
    directory = tmp_path_factory.mktemp("service")
    scene_file(directory)
    data = directory / "data"
    with (
        TestClient(create_app(Settings(data_directory=data))) as service,
        LineOfActionClient(
            "http://testserver", cache_dir=directory / "results", transport=service._transport
        ) as found,
    ):
        stored_results(data).put(KEY, "database", directory / "ste.nc")
        yield found, service, data


@pytest.fixture
def scene(tmp_path: Path) -> SceneInput:
    """A scene of 30 ms with its table by hash."""
    given = read_model(SceneInput, scene_file(tmp_path, duration=0.03))
    (mesh,) = given.meshes
    return given.model_copy(
        update={"meshes": (mesh.model_copy(update={"database_file": None, "database_hash": KEY}),)}
    )


def prepared(**inputs: Any) -> dict[str, Any]:
    """What a request with a case makes of its inputs."""
    return ABLATE.prepare(ABLATE.inputs.model_validate_json(json.dumps(inputs)), None)  # type: ignore[arg-type]


def untimed(value: Any) -> Any:
    """Leave out what differs from run to run: measured times, and predictions for this cache."""
    times = ("cpu_seconds", "predicted_cpu_seconds", "cost_ratio")
    if isinstance(value, dict):
        return {name: untimed(inner) for name, inner in value.items() if name not in times}
    return [untimed(item) for item in value] if isinstance(value, list) else value


def test_the_ablation_of_a_case_is_that_of_python(served: Served, tmp_path: Path) -> None:
    client, _, _ = served
    seen: list[JobState] = []
    told = client.ablate(CASE, seen.append, only=ONLY)
    here = ablation_of_case(validated(Case, CASE), ONLY, tmp_path / "compliance", lambda *_: None)
    assert [effect["name"] for effect in told["effects"]] == ["tooth_coupling"]
    assert told["left_out"] == {"misalignment": "the gears are aligned"}
    assert abs(told["effects"][0]["mean_change_um"][1]) > 1e-3
    assert untimed(told) == untimed(json.loads(json.dumps(ablation_json(here))))
    progress = [state.progress for state in seen]
    assert progress == sorted(progress) and progress[-1] == 100


def test_its_file_is_json_whatever_is_accepted(served: Served) -> None:
    client, http, _ = served
    told = client.ablate(CASE, only=ONLY)
    job = client.submit("ablate", {"case": CASE, "only": ONLY[::-1]})  # the same question: stored already
    assert job.status == "successful"
    reference = http.get(f"/v1/jobs/{job.id}/results", params=REFERENCES).json()["ablation"]
    assert reference["type"] == "application/json"
    for accept in ("application/json", "application/x-netcdf", "*/*"):
        answer = http.get(reference["href"], headers={"Accept": accept})
        assert (answer.headers["content-type"], answer.json()) == ("application/json", told)
        digest = base64.b64encode(hashlib.sha256(answer.content).digest()).decode()
        assert answer.headers["content-digest"] == f"sha-256=:{digest}:"
    known = http.get(reference["href"], headers={"If-None-Match": answer.headers["etag"]})
    assert (known.status_code, known.content) == (304, b"")


def test_the_ablation_of_a_scene_is_that_of_python(served: Served, scene: SceneInput, tmp_path: Path) -> None:
    """The work itself, in this process: a case goes through a child above."""
    client, _, data = served
    given = {"scene": scene.model_dump(mode="json"), "only": ["lateral"]}
    inputs = ABLATE.prepare(ABLATE.inputs.model_validate_json(json.dumps(given)), stored_results(data))
    seen: list[tuple[str, float]] = []
    order = WorkOrder(ABLATE.entry, inputs, ABLATE.key(inputs), tmp_path, data)
    (product,) = switch_effects(order, lambda *step: seen.append(step))
    overall = [ABLATE.overall(*step) for step in seen]
    assert overall and None not in overall and overall == sorted(overall)  # type: ignore[type-var]
    stored_results(data).put(product.key, product.kind, product.file)
    told = client.ablate(scene, only=["lateral"])
    tables = {"mesh": SteDatabase.from_netcdf(tmp_path / "ste.nc")}
    here = ablation_of_scene(dynamic_scene(scene, tables), ["lateral"], lambda *_: None)
    assert [effect["name"] for effect in told["effects"]] == ["lateral"]
    assert untimed(told) == untimed(json.loads(json.dumps(ablation_json(here))))


def test_equal_questions_in_other_words_are_one_result() -> None:
    everything = [effect.name for effect in EFFECTS]
    keys = [
        ABLATE.key(prepared(case=CASE, **further))
        for further in ({}, {"only": everything}, {"only": [*everything[::-1], *ONLY]}, {"only": ONLY})
    ]
    assert keys[0] == keys[1] == keys[2] != keys[3]


@pytest.mark.parametrize(
    ("inputs", "field"),
    [
        ({"only": ONLY}, "case"),
        ({"case": CASE, "only": []}, "only"),
        ({"case": CASE, "only": ["windage"]}, "only"),
        ({"case": CASE, "only": ["gyroscopic"]}, "only"),  # an effect of scenes
        ({"case": CASE, "effect": ["misalignment"]}, "effect"),
        ({"case": CASE | {"load": {"torque_n_m": [-1.0]}}}, "load.torque_n_m"),
    ],
)
def test_bad_inputs_are_refused_by_name_before_there_is_a_job(
    served: Served, inputs: dict[str, Any], field: str
) -> None:
    client, http, _ = served
    jobs = len(http.get("/v1/jobs").json()["jobs"])
    with pytest.raises(BadInput) as caught:
        client.submit("ablate", inputs)
    assert any(field in fault.field for fault in caught.value.faults), caught.value.faults
    assert len(http.get("/v1/jobs").json()["jobs"]) == jobs


def test_a_case_beside_a_scene_is_refused(served: Served, scene: SceneInput) -> None:
    client, _, _ = served
    with pytest.raises(BadInput, match=r"case.*left out beside one"):
        client.submit("ablate", {"case": CASE, "scene": scene.model_dump(mode="json")})


def test_a_hash_of_another_kind_is_not_found(served: Served) -> None:
    _, http, _ = served
    assert http.get(f"/v1/ablations/{KEY}").status_code == 404
    assert http.get("/v1/ablations/nonsense").status_code == 422
