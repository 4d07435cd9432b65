"""Flank results and sensitivity studies as jobs: the real processes over HTTP, and through the client."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from study_service import empty_service, figures_alone, without

from fe_contact import LoadDistribution
from lineofaction.client import JobState, LineOfActionClient
from lineofaction.gearbox.convert.case import CheckedCase, case_at
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.gear import FlankPoint
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.flank.run import RUN, flanks_of
from lineofaction.gearbox.studies.root_stress import Inputs
from lineofaction.gearbox.studies.root_stress.run import RUN as ROOT_STRESS
from service.worker.process import default_registry

FLANK = default_registry()["flank"]

GEAR = {"teeth": 20, "face_width_mm": 10.0, "bore_diameter_mm": 40.0, "thickness_allowance_um": 90.0}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": GEAR, "wheel": GEAR},
    "load": {"torque_n_m": [20.0, 40.0]},
    "accuracy": {"level": "draft", "positions": 8},
}
PLANE = CASE | {"accuracy": CASE["accuracy"] | {"model": "plane_strain"}}


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The service's directory of data."""
    return tmp_path_factory.mktemp("service") / "data"


@pytest.fixture(scope="module")
def served(data: Path) -> Iterator[tuple[LineOfActionClient, TestClient]]:
    """A client of a running service with its real processes, and the bare HTTP one."""
    with empty_service(data) as found:
        yield found


def test_flank_results_are_those_of_python(served: tuple[LineOfActionClient, TestClient], data: Path) -> None:
    client, http = served
    seen: list[JobState] = []
    file = client.flank.submit(PLANE, torque_n_m=30.0).file(seen.append)
    found = LoadDistribution.from_netcdf(file)
    # on the gears as the job condensed them: linear algebra in more threads sums in another order
    case = CheckedCase(case_at(validated(Case, PLANE), FlankPoint(torque_n_m=30.0)))
    here = flanks_of(case, data / "compliance")
    assert np.array_equal(found.force, here.force)
    assert found.metadata.content_hash == here.metadata.content_hash
    assert [state.progress for state in seen] == sorted(state.progress for state in seen)
    result = client.result(seen[-1].id)
    facts = http.get(f"/v1/results/{result.key}").json()
    assert {name: facts[name] for name in RUN.figures(found)} == RUN.figures(found)
    assert facts["size"] == file.stat().st_size


def test_equal_questions_in_other_words_are_one_result() -> None:
    """The case of a point is what is hashed: another list of loads and other positions do not matter."""
    other = copy.deepcopy(PLANE) | {"load": {"torque_n_m": [40.0]}}
    other["accuracy"]["positions"] = 16
    asked: list[dict[str, Any]] = [
        {"case": PLANE}, {"case": other, "torque_n_m": 40.0}, {"case": other, "torque_n_m": 41.0}
    ]  # fmt: skip
    keys = []
    for inputs in asked:
        model = FLANK.inputs.model_validate_json(json.dumps(inputs))
        keys.append(FLANK.key(FLANK.prepare(model, None)))  # type: ignore[arg-type]  # needs no store
    assert keys[0] == keys[1] != keys[2]


def test_a_study_comes_with_all_its_curves(served: tuple[LineOfActionClient, TestClient]) -> None:
    client, http = served
    seen: list[JobState] = []
    job = client.sensitivity.submit(CASE, misalignment_um=[20.0], center_distance_change_percent=[0.1])
    (study,) = job.result(seen.append)
    assert study.name == "20/20"
    for curves in study.curves:
        assert curves.misalignment.deviation == pytest.approx([0.0, 20e-6])
        assert curves.center_distance_change.deviation == pytest.approx([0.0, 0.08e-3])
        assert np.all(curves.misalignment.peak_to_peak > 1e-7)
    progress = [state.progress for state in seen]
    assert progress == sorted(progress) and progress[-1] == 100
    (pair,) = http.get(f"/v1/results/{client.result(seen[-1].id).key}").json()["pairs"]
    assert pair["curves"][1]["corner_contact"] is True
    assert pair["curves"][0]["misalignment"]["misalignment_um"] == pytest.approx([0.0, 20.0])


def test_a_sensitivity_across_the_face_takes_a_case_of_the_plane_there() -> None:
    process = default_registry()["sensitivity"]

    def asked(case: dict[str, Any]) -> dict[str, Any]:
        model = process.inputs.model_validate_json(json.dumps({"case": case}))
        return process.prepare(model, None)  # type: ignore[arg-type]  # needs no store

    assert asked(PLANE)["case"]["accuracy"]["model"] == "3d"
    assert asked(CASE)["case"]["accuracy"]["model"] == "auto"


def test_the_root_stress_is_that_of_python(served: tuple[LineOfActionClient, TestClient], data: Path) -> None:
    client, http = served
    found = client.root_stress.submit(PLANE, torque_n_m=30.0).figures()
    point = FlankPoint(torque_n_m=30.0)
    means = Means(data, lambda *_: None)
    case = CheckedCase(case_at(validated(Case, PLANE), point))
    here = ROOT_STRESS.figures(ROOT_STRESS.compute(case, Inputs(), means))
    costs = ("receipt", "warnings")
    assert without(costs, figures_alone(found)) == without(costs, here)
    assert found["receipt"]["cpu_seconds"] > 0.0
    (job,) = (j for j in http.get("/v1/jobs").json()["jobs"] if j["processID"] == "root-stress")
    key = client.result(job["jobID"]).key
    figures = http.get(f"/v1/results/{key}/figures").json()
    assert [figure["key"] for s in figures["sections"] for figure in s["figures"]] == ["root_stress"]


@pytest.mark.parametrize(
    ("process", "further", "field"),
    [
        ("flank", {"torque_n_m": 5.0, "normal_force_n": 5.0}, "normal_force_n"),
        ("flank", {"torque_n_m": -1.0}, "torque_n_m"),
        ("flank", {"torque": 5.0}, "torque"),
        ("root-stress", {"torque_n_m": -1.0}, "torque_n_m"),
        ("flank", {"center_distance_change_mm": -1.0}, "errors.center_distance_change_mm"),
        ("sensitivity", {"misalignment_um": [30.0, 15.0]}, "misalignment_um"),
        ("sensitivity", {"misalignment_um": []}, "misalignment_um"),
        ("sensitivity", {"center_distance_change_percent": [-1.0]}, "errors.center_distance_change_mm"),
        ("sensitivity", {"center_distance_change_percent": ["x"]}, "center_distance_change_percent"),
    ],
)
def test_bad_inputs_are_refused_by_name_before_there_is_a_job(
    served: tuple[LineOfActionClient, TestClient], process: str, further: dict[str, Any], field: str
) -> None:
    client, http = served
    jobs = len(http.get("/v1/jobs").json()["jobs"])
    with pytest.raises(BadInput) as caught:
        client.submit(process, {"case": CASE, **further})
    assert any(field in fault.field for fault in caught.value.faults), caught.value.faults
    assert len(http.get("/v1/jobs").json()["jobs"]) == jobs


def test_both_processes_are_described(served: tuple[LineOfActionClient, TestClient]) -> None:
    _, http = served
    listed = {process["id"] for process in http.get("/v1/processes").json()["processes"]}
    assert listed == {
        "analyze", "flank", "sensitivity", "root-stress", "ablate", "frontier", "optimize", "scatter",
        "sweep", "simulate", "modes", "response", "vibration", "noise", "listen", "steady", "deflect",
        "study",
    }  # fmt: skip
    inputs = http.get("/v1/processes/flank").json()["inputs"]
    assert set(inputs) == {
        "case", "torque_n_m", "normal_force_n", "misalignment_um", "center_distance_change_mm",
    }  # fmt: skip
