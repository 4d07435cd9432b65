"""The accuracy ladder of cases and scenes as jobs: the real process over HTTP, and through the client."""

from __future__ import annotations

import importlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from running_service import REFERENCES
from scene_files import scene_file

from dynamics.ladder.registry import RUNGS as SCENE_RUNGS
from fe_contact.analysis.ladder import RUNGS
from fe_contact.errors import SolveError
from fe_contact.ste import SteDatabase
from service.app import create_app
from service.client import JobState, LineOfActionClient
from service.convert.frontier import frontier_of
from service.convert.run_frontier import run_frontier_of
from service.convert.scene import dynamic_scene
from service.jobs.catalogue import FRONTIER
from service.jobs.frontier_work import climb_ladder
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
CLOSED = ["iso6336", "thin_slices"]

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
    """A scene of 60 ms with its table by hash."""
    given = read_model(SceneInput, scene_file(tmp_path, duration=0.06))
    (mesh,) = given.meshes
    return given.model_copy(
        update={"meshes": (mesh.model_copy(update={"database_file": None, "database_hash": KEY}),)}
    )


def prepared(**inputs: Any) -> dict[str, Any]:
    """What a request with a case makes of its inputs."""
    return FRONTIER.prepare(FRONTIER.inputs.model_validate_json(json.dumps(inputs)), None)  # type: ignore[arg-type]


def untimed(value: Any) -> Any:
    """Leave out what differs from run to run: times, memory, and the knee, which hangs on them."""
    measured = ("cpu_seconds", "stages", "peak_memory_bytes", "knee")
    if isinstance(value, dict):
        return {name: untimed(inner) for name, inner in value.items() if name not in measured}
    return [untimed(item) for item in value] if isinstance(value, list) else value


def worked(inputs: dict[str, Any], workspace: Path, data: Path) -> tuple[dict[str, Any], list[float]]:
    """Do the work in this process; return its JSON and the progress of the whole job."""
    seen: list[float | None] = []
    order = WorkOrder(FRONTIER.entry, inputs, FRONTIER.key(inputs), workspace, data)
    (product,) = climb_ladder(order, lambda *step: seen.append(FRONTIER.overall(*step)))
    assert (product.key, product.kind) == (order.key, "frontier")
    return json.loads(product.file.read_bytes()), [part for part in seen if part is not None]


def test_the_ladder_of_a_case_is_that_of_python(served: Served) -> None:
    client, _, _ = served
    seen: list[JobState] = []
    told = client.frontier(CASE, seen.append, rungs=CLOSED)
    here = frontier_of(validated(Case, CASE), CLOSED)
    assert [rung["name"] for rung in told["rungs"]] == CLOSED
    assert told["rungs"][0]["mean_error"] > 1e-3 and told["reference"] == "thin_slices"
    assert all(rung["cpu_seconds"] > 0.0 for rung in told["rungs"])
    assert untimed(told) == untimed(json.loads(json.dumps(here.to_json())))
    progress = [state.progress for state in seen]
    assert progress == sorted(progress) and progress[-1] == 100


def test_its_file_is_json_whatever_is_accepted(served: Served) -> None:
    client, http, _ = served
    told = client.frontier(CASE, rungs=CLOSED)
    job = client.submit("frontier", {"case": CASE, "rungs": CLOSED[::-1]})  # the same question: stored
    assert job.status == "successful"
    reference = http.get(f"/v1/jobs/{job.id}/results", params=REFERENCES).json()["frontier"]
    assert reference["type"] == "application/json"
    for accept in ("application/json", "application/x-netcdf", "*/*"):
        answer = http.get(reference["href"], headers={"Accept": accept})
        assert (answer.headers["content-type"], answer.json()) == ("application/json", told)
    known = http.get(reference["href"], headers={"If-None-Match": answer.headers["etag"]})
    assert (known.status_code, known.content) == (304, b"")


def test_the_ladder_of_a_scene_is_that_of_python(served: Served, scene: SceneInput, tmp_path: Path) -> None:
    """The work itself, in this process: a case goes through a child above."""
    client, _, data = served
    rungs = ["quasi_static", "100_nm", "10_nm"]
    given = {"scene": scene.model_dump(mode="json"), "rungs": rungs}
    inputs = FRONTIER.prepare(FRONTIER.inputs.model_validate_json(json.dumps(given)), stored_results(data))
    made, progress = worked(inputs, tmp_path, data)
    assert progress == sorted(progress) and len(progress) == len(rungs) + 1
    stored_results(data).put(FRONTIER.key(inputs), "frontier", tmp_path / "frontier.json")
    told = client.frontier(scene, rungs=rungs)
    here = run_frontier_of(
        dynamic_scene(scene, {"mesh": SteDatabase.from_netcdf(tmp_path / "ste.nc")}), rungs
    )
    assert told == made and told["reference"] == "10_nm"
    assert untimed(told) == untimed(json.loads(json.dumps(here.to_json())))


@pytest.mark.parametrize(
    ("failure", "said"), [(SolveError("no equilibrium"), "no equilibrium"), (MemoryError(), "out of memory")]
)
def test_a_rung_that_fails_is_named_and_the_others_survive(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: Exception, said: str
) -> None:
    class Failing:
        """The rung in the middle of the ladder, which fails as it runs."""

        name, title, family, element_size = "corrected", "fails", "auto", 1.0

        def refusal(self, _checked: object) -> None:
            return None

        def run(self, *_: object) -> SteDatabase:
            raise failure

    rungs = [rung for rung in RUNGS if rung.name in CLOSED]
    climbing = importlib.import_module("fe_contact.analysis.frontier")
    monkeypatch.setattr(climbing, "RUNGS", (rungs[0], Failing(), rungs[1]))
    made, progress = worked(prepared(case=CASE, rungs=[*CLOSED, "corrected"]), tmp_path, tmp_path)
    assert made["left_out"] == {"corrected": said}
    assert [rung["name"] for rung in made["rungs"]] == CLOSED
    assert progress[-1] == pytest.approx(1.0)


def test_equal_questions_in_other_words_are_one_result() -> None:
    everything = [rung.name for rung in RUNGS]
    keys = [
        FRONTIER.key(prepared(case=CASE, **further))
        for further in ({}, {"rungs": everything}, {"rungs": [*everything[::-1], *CLOSED]}, {"rungs": CLOSED})
    ]
    assert keys[0] == keys[1] == keys[2] != keys[3]


@pytest.mark.parametrize(
    ("inputs", "field"),
    [
        ({"rungs": CLOSED}, "case"),
        ({"case": CASE, "rungs": []}, "rungs"),
        ({"case": CASE, "rungs": ["iso6336"]}, "rungs"),  # nothing to compare it to
        ({"case": CASE, "rungs": ["iso6336", "4d"]}, "rungs"),
        ({"case": CASE, "rungs": [SCENE_RUNGS[0].name, *CLOSED]}, "rungs"),
        ({"case": CASE, "rung": CLOSED}, "rung"),
        ({"case": CASE | {"load": {"torque_n_m": [-1.0]}}}, "load.torque_n_m"),
    ],
)
def test_bad_inputs_are_refused_by_name_before_there_is_a_job(
    served: Served, inputs: dict[str, Any], field: str
) -> None:
    client, http, _ = served
    jobs = len(http.get("/v1/jobs").json()["jobs"])
    with pytest.raises(BadInput) as caught:
        client.submit("frontier", inputs)
    assert any(field in fault.field for fault in caught.value.faults), caught.value.faults
    assert len(http.get("/v1/jobs").json()["jobs"]) == jobs


def test_a_hash_of_another_kind_is_not_found(served: Served) -> None:
    _, http, _ = served
    assert http.get(f"/v1/frontiers/{KEY}").status_code == 404
    assert http.get("/v1/frontiers/nonsense").status_code == 422
