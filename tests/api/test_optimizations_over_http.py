"""Micro-geometry optimizations as jobs: the real process over HTTP, and through the client."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from declared_figures import document
from fastapi.testclient import TestClient
from running_service import REFERENCES
from study_service import empty_service, figures_alone

from lineofaction.client import JobState, LineOfActionClient
from lineofaction.gearbox.convert.case import CheckedCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.optimize import Inputs
from lineofaction.gearbox.studies.optimize.run import RUN
from service.worker.process import default_registry

OPTIMISE = default_registry()["optimize"]
GEAR = {"teeth": 20, "face_width_mm": 10.0, "bore_diameter_mm": 40.0}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": GEAR, "wheel": GEAR},
    "load": {"torque_n_m": [40.0, 80.0]},
    "accuracy": {"level": "draft", "model": "plane_strain"},
}
FREE = {"tip_relief_um": [0.0, 40.0], "tip_relief_length_mm": [0.5, 3.0]}
STUDY: dict[str, Any] = {
    "variables": {"pinion": FREE, "wheel": FREE},
    "scatter": {"pinion": {"profile_slope_um": 2.0}, "points": 2},
    "limits": {"max_pressure_mpa": 4000.0},
    "search": {"evaluations": 24, "positions": 16},
}
TIMES = ("cpu_seconds", "wall_seconds", "peak_memory_bytes")

Served = tuple[LineOfActionClient, TestClient]


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The service's directory of data."""
    return tmp_path_factory.mktemp("service") / "data"


@pytest.fixture(scope="module")
def served(data: Path) -> Iterator[Served]:
    """A client of a running service with its real processes, and the bare HTTP one."""
    with empty_service(data) as found:
        yield found


def untimed(value: Any) -> Any:
    """Leave out what differs from run to run."""
    if isinstance(value, dict):
        return {name: untimed(inner) for name, inner in value.items() if name not in TIMES}
    return [untimed(item) for item in value] if isinstance(value, list) else value


def test_the_optimization_is_that_of_python(served: Served, data: Path) -> None:
    client, http = served
    seen: list[JobState] = []
    answer = client.optimize.submit(CASE, STUDY).figures(seen.append)
    told = figures_alone(answer)
    # on the gears as the job condensed them: linear algebra in more threads sums in another order
    here = RUN.compute(
        CheckedCase(validated(Case, CASE)), validated(Inputs, STUDY), Means(data, lambda *_: None)
    )
    expected = json.loads(json.dumps(RUN.figures(here) | {"warnings": RUN.warnings(here)}))
    assert untimed(told) == untimed(expected)
    assert told["outcome"] == "improved" and told["gain_um"] > told["gain_error_um"]
    assert set(told["optimum"]["values"]) == {"pinion", "wheel"}
    for gear, values in told["optimum"]["values"].items():
        for field, value in values.items():
            low, high = STUDY["variables"][gear][field]
            assert low <= value <= high, field
    assert told["optimum"]["values"]["pinion"]["tip_relief_length_mm"] == pytest.approx(
        1e3 * here.optimum.values["pinion.tip_relief_length"], rel=1e-9
    )
    assert told["nodes"]["deviation"] == [[-2.0], [2.0]]
    progress = [state.progress for state in seen]
    assert progress == sorted(progress) and progress[-1] == 100
    job = client.submit("optimize", {"case": CASE, **STUDY})  # the same question: stored already
    assert job.status == "successful"
    reference = http.get(f"/v1/jobs/{job.id}/results", params=REFERENCES).json()["optimization"]
    assert http.get(reference["href"]).json() == document(answer)
    assert client.optimize.submit(CASE, STUDY).file().suffix == ".nc"


@pytest.mark.parametrize(("model", "crowned"), [("plane_strain", False), ("3d", True)])
def test_without_variables_the_tip_relief_of_both_gears_is_free(model: str, crowned: bool) -> None:
    case = CASE | {"accuracy": CASE["accuracy"] | {"model": model}}
    asked = {"case": case, "variables": {"most_tip_relief_um": 25.0}}
    given = OPTIMISE.inputs.model_validate_json(json.dumps(asked))
    variables = OPTIMISE.prepare(given, None)["variables"]  # type: ignore[arg-type]  # needs no store
    free = {gear: {k: v for k, v in variables[gear].items() if v is not None} for gear in ("pinion", "wheel")}
    relief = {"tip_relief_um": [0.0, 25.0], "tip_relief_length_mm": pytest.approx([0.6, 3.2])}
    assert free["wheel"] == relief
    assert free["pinion"] == relief | ({"helix_crowning_um": [0.0, 30.0]} if crowned else {})


def test_defaults_written_out_are_the_same_question() -> None:
    def key(study: dict[str, Any]) -> str:
        given = OPTIMISE.inputs.model_validate_json(json.dumps({"case": CASE, **study}))
        return OPTIMISE.key(OPTIMISE.prepare(given, None))  # type: ignore[arg-type]

    assert key(STUDY) == key({**STUDY, "misalignment_um": 0.0, "objective": {"kind": "weighted_mean"}})
    assert key(STUDY) != key({**STUDY, "objective": {"kind": "worst"}})


@pytest.mark.parametrize(
    ("further", "field"),
    [
        ({"variables": {"most_tip_relief_um": 0.0}}, "variables.most_tip_relief_um"),
        ({"variables": {"pinion": {"tip_relief_um": [40.0, 0.0]}}}, "variables.pinion.tip_relief_um"),
        ({"variables": {"pinion": {"tip_relief_um": [-1.0, 5.0]}}}, "variables.pinion.tip_relief_um"),
        ({"variables": {"pinion": {"tip_relief_um": [0.0, 40.0]}}}, "variables.pinion.tip_relief"),
        ({"variables": {"pinion": {"helix_crowning_um": [0.0, 9.0]}}}, "helix_crowning_um"),
        ({"scatter": {"misalignment_um": 8.0}}, "misalignment_um"),
        ({"objective": {"weights": [1.0]}}, "objective.weights"),
        ({"search": {"evaluations": 0}}, "search.evaluations"),
        ({"torque_n_m": [80.0, 40.0]}, "torque_n_m"),
        ({"torque_n_m": [40.0, 40.0], "misalignment_um": [5.0, 5.0]}, "torque_n_m"),
        ({"torque_n_m": [40.0, 80.0], "misalignment_um": [0.0, 1.0, 2.0]}, "misalignment_um"),
        ({"misalignment_um": [0.0, 1.0, 2.0]}, "misalignment_um"),  # of the torques of the case
        ({"misalignment_um": [0.0, 2e4]}, "misalignment_um[1]"),
        ({"misalignment_um": [0.0, 5.0]}, "misalignment_um"),  # in the plane
    ],
)
def test_bad_inputs_are_refused_by_name_before_there_is_a_job(
    served: Served, further: dict[str, Any], field: str
) -> None:
    client, http = served
    jobs = len(http.get("/v1/jobs").json()["jobs"])
    with pytest.raises(BadInput) as caught:
        client.submit("optimize", {"case": CASE, **STUDY, **further})
    assert any(field in fault.field for fault in caught.value.faults), caught.value.faults
    assert len(http.get("/v1/jobs").json()["jobs"]) == jobs
