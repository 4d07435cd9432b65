"""Studies of scenes as jobs: the real processes over HTTP, and through the client."""

from __future__ import annotations

import importlib
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from scene_files import scene_file

from dynamics.linearize import ForcedResponse, ModalAnalysis
from dynamics.loads import TimeLaw
from dynamics.periodic import SteadyStates
from dynamics.results import RunResult
from dynamics.simulation import simulate
from dynamics.study import Response, Study, responses_of
from fe_contact.ste import SteDatabase
from lineofaction.client import JobState, LineOfActionClient
from lineofaction.gearbox.convert.scene import TabledScene, dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import read_model
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.stages import PacedFraction
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.modes import Inputs
from lineofaction.gearbox.studies.modes.run import RUN
from lineofaction.gearbox.subjects import scene_inputs
from service.app import create_app
from service.settings import Settings
from service.store import stored_results
from service.worker.order import WorkOrder
from service.worker.process import default_registry

KEY = "ab" * 32
STUDY = {
    "factors": [
        {"path": "loads.brake.torque_n_m", "levels": [50.0, 100.0]},
        {"path": "meshes.mesh.damping_ratio", "uniform": {"low": 0.05, "high": 0.1}},
    ],
    "responses": [{"quantity": "dte_rms"}, {"quantity": "bearing_force", "order": 1}],
    "samples": 3,
}


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[LineOfActionClient, TestClient]]:
    """A client of a running service that holds the table, and the bare HTTP one."""
    directory = tmp_path_factory.mktemp("service")
    folder = tmp_path_factory.mktemp("scene")
    scene_file(folder)
    app, results = create_app(Settings(data_directory=directory / "data")), directory / "results"
    with (
        TestClient(app) as service,
        LineOfActionClient("http://testserver", cache_dir=results, transport=service._transport) as found,
    ):
        stored_results(directory / "data").put(KEY, "database", folder / "ste.nc")
        yield found, service


@pytest.fixture
def scene(tmp_path: Path) -> SceneInput:
    """The scene with its table by hash."""
    given = read_model(SceneInput, scene_file(tmp_path))
    (mesh,) = given.meshes
    return given.model_copy(
        update={"meshes": (mesh.model_copy(update={"database_file": None, "database_hash": KEY}),)}
    )


def here(scene: SceneInput, tmp_path: Path) -> TabledScene:
    """The scene with its table."""
    tables = {"mesh": SteDatabase.from_netcdf(tmp_path / "ste.nc")}
    return TabledScene(scene, tables, dynamic_scene(scene, tables))


def none(_stage: str, _fraction: float) -> None:
    """Report nothing."""


def test_modes_are_those_of_python(
    served: tuple[LineOfActionClient, TestClient], scene: SceneInput, tmp_path: Path
) -> None:
    client, http = served
    seen: list[JobState] = []
    file = client.modes.submit(scene, speed_rpm=[0.0, 3000.0], orders=4).file(seen.append)
    found = ModalAnalysis.from_netcdf(file)
    python = RUN.compute(
        here(scene, tmp_path), Inputs(speed_rpm=(0.0, 3000.0), orders=4), Means(tmp_path, none)
    )
    for name in ("natural_frequency", "frequency", "critical_speed", "strain_energy"):
        np.testing.assert_array_equal(getattr(found, name), getattr(python, name))
    assert [state.progress for state in seen] == sorted(state.progress for state in seen)
    answer = http.get(f"/v1/results/{client.result(seen[-1].id).key}").json()
    assert {name: answer[name] for name in RUN.figures(found)} == RUN.figures(found)


@pytest.mark.parametrize(
    ("name", "further", "result"),
    [
        ("response", {"speed_rpm": [300.0, 600.0], "orders": 3}, ForcedResponse),
        (
            "steady",
            {"speed_rpm": [3000.0, 3200.0], "settling_periods": 2},
            SteadyStates,
        ),
        ("study", STUDY, Study),
    ],
)
def test_the_work_of_a_study_is_served_as_figures_and_as_its_file(
    served: tuple[LineOfActionClient, TestClient],
    scene: SceneInput,
    tmp_path: Path,
    name: str,
    further: dict[str, Any],
    result: Any,
) -> None:
    """The work itself, in this process: a child is a matter of the jobs, which the modes go through."""
    client, http = served
    process, figures = default_registry()[name], STUDIES[name].run.figures
    data = http.app.state.context.settings.data_directory  # type: ignore[attr-defined]
    inputs = {"scene": scene.model_dump(mode="json"), **further}
    given = process.inputs.model_validate_json(json.dumps(inputs))
    inputs = process.prepare(given, stored_results(data))
    seen: list[tuple[str, float]] = []
    module, _, function = process.entry.partition(":")
    order = WorkOrder(process.entry, inputs, process.key(inputs), tmp_path, data)
    work = getattr(importlib.import_module(module), function)
    (product,) = work(order, lambda *step: seen.append(step))
    paced = PacedFraction(process.stages)
    overall = [paced.at(*step, float(instant)) for instant, step in enumerate(seen)]
    assert None not in overall and overall == sorted(overall)  # type: ignore[type-var]
    stored_results(data).put(product.key, product.kind, product.file)
    job = client.submit(process.id, scene_inputs(scene) | further)
    assert job.status == "successful"
    found = result.from_netcdf(client.fetch_file(client.result(job.id).key, process.kind))
    answer = http.get(f"/v1/results/{product.key}").json()
    assert {name: answer[name] for name in figures(found)} == figures(found)


def test_a_study_over_http_has_the_bits_of_python_and_keeps_its_worst_run(
    served: tuple[LineOfActionClient, TestClient], scene: SceneInput, tmp_path: Path
) -> None:
    client, _ = served
    made = client.study(scene, STUDY | {"keep_worst": 1})
    alone = here(scene, tmp_path).scene
    values = dict(zip(made.factor, made.value[made.worst[0]].tolist(), strict=True))
    mesh = replace(alone.meshes[0], damping_ratio=values["meshes.mesh.damping_ratio"])
    load = replace(alone.loads[0], torque=TimeLaw.constant(values["loads.brake.torque_n_m"]))
    run = simulate(replace(alone, meshes=(mesh,), loads=(load,)))
    responses = (Response("dte_rms"), Response("bearing_force", order=1))
    assert made.figure[made.worst[0]].tolist() == responses_of(run, responses)[0]
    (key,) = made.facts["runs"].values()
    kept = RunResult.from_netcdf(client.fetch_file(key, "run"))
    np.testing.assert_array_equal(kept.mesh_force, run.mesh_force)


@pytest.mark.parametrize(
    ("process", "further", "field"),
    [
        ("modes", {"speed_rpm": [3.0, 2.0]}, "speed_rpm"),
        ("modes", {"speed_rpm": [-1.0]}, "speed_rpm"),
        ("modes", {"orders": 0}, "orders"),
        ("modes", {"speed": [1.0]}, "speed"),
        ("response", {}, "speed_rpm"),
        ("steady", {"speed_rpm": [5.0, 5.0]}, "speed_rpm"),
        ("steady", {"speed_rpm": [5.0], "repeat": 99}, "repeat"),
        ("response", {"speed_rpm": [0.0, 1.0]}, "speed_rpm"),
        ("study", {**STUDY, "samples": 1}, "samples"),
        ("study", {**STUDY, "factors": [{"path": "loads.x.y", "levels": [1.0]}], "samples": 1}, "path"),
    ],
)
def test_bad_inputs_are_refused_by_name_before_there_is_a_job(
    served: tuple[LineOfActionClient, TestClient],
    scene: SceneInput,
    process: str,
    further: dict[str, Any],
    field: str,
) -> None:
    client, http = served
    jobs = len(http.get("/v1/jobs").json()["jobs"])
    with pytest.raises(BadInput) as caught:
        client.submit(process, scene_inputs(scene) | further)
    assert any(field in fault.field for fault in caught.value.faults), caught.value.faults
    assert len(http.get("/v1/jobs").json()["jobs"]) == jobs
