"""Tolerance Monte Carlo as a job: the real process over HTTP, and through the client."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from declared_figures import document
from fastapi.testclient import TestClient
from study_service import empty_service, figures_alone

from lineofaction.client import JobState, LineOfActionClient
from lineofaction.gearbox.convert.case import CheckedCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.scatter import Inputs
from lineofaction.gearbox.studies.scatter.run import RUN
from service.worker.process import default_registry

SCATTER = default_registry()["scatter"]
GEAR = {"teeth": 20, "face_width_mm": 10.0, "bore_diameter_mm": 40.0}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": GEAR, "wheel": GEAR},
    "load": {"torque_n_m": [40.0, 80.0]},
    "accuracy": {"level": "draft", "model": "plane_strain"},
}
SAMPLING: dict[str, Any] = {"tolerance_class": 8, "samples": 40, "seed": 3}


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The service's directory of data."""
    return tmp_path_factory.mktemp("service") / "data"


@pytest.fixture(scope="module")
def served(data: Path) -> Iterator[tuple[LineOfActionClient, TestClient]]:
    """A client of a running service with its real processes, and the bare HTTP one."""
    with empty_service(data) as found:
        yield found


def test_the_pairs_are_those_of_python(served: tuple[LineOfActionClient, TestClient], data: Path) -> None:
    client, http = served
    seen: list[JobState] = []
    answer = client.scatter.submit(CASE, **SAMPLING).figures(seen.append)
    told = figures_alone(answer)
    # on the gears as the job condensed them: linear algebra in more threads sums in another order
    here = RUN.compute(CheckedCase(validated(Case, CASE)), Inputs(**SAMPLING), Means(data, lambda *_: None))
    expected = json.loads(json.dumps(RUN.figures(here))) | {"warnings": []}
    assert {**told, "cost": None} == {**expected, "cost": None}
    assert len(told["peak_to_peak_um"]) == 40 and told["names"] == [
        "pinion.profile_slope_um", "wheel.profile_slope_um",
    ]  # fmt: skip
    progress = [state.progress for state in seen]
    assert progress == sorted(progress) and progress[-1] == 100
    again = client.submit("scatter", {"case": CASE, **SAMPLING, "distribution": "normal"})
    assert again.status == "successful"  # the same question with a default written out: stored already
    key = client.result(again.id).key
    assert http.get(f"/v1/results/{key}").json() == document(answer)


def test_every_input_is_another_question() -> None:
    def key(**sampling: Any) -> str:
        given = SCATTER.inputs.model_validate_json(json.dumps({"case": CASE, **sampling}))
        return SCATTER.key(SCATTER.prepare(given, None))  # type: ignore[arg-type]  # needs no store

    plain = key()
    for other in ({"tolerance_class": 7}, {"distribution": "uniform"}, {"samples": 999}, {"seed": 1}):
        assert key(**other) != plain
    assert key(tolerance_class=6, samples=1000) == plain


@pytest.mark.parametrize(
    ("further", "field"),
    [
        ({"tolerance_class": 12}, "tolerance_class"),
        ({"samples": 1}, "samples"),
        ({"samples": 1_000_000}, "samples"),
        ({"distribution": "triangular"}, "distribution"),
        ({"misalignment_um": 20.0}, "misalignment_um"),  # in the plane
        ({"case": CASE | {"pair": CASE["pair"] | {"wheel": GEAR | {"face_width_mm": 3.0}}}}, "face_width"),
    ],
)
def test_bad_inputs_are_refused_by_name_before_there_is_a_job(
    served: tuple[LineOfActionClient, TestClient], further: dict[str, Any], field: str
) -> None:
    client, http = served
    jobs = len(http.get("/v1/jobs").json()["jobs"])
    with pytest.raises(BadInput) as caught:
        client.submit("scatter", {"case": CASE, **SAMPLING, **further})
    assert any(field in fault.field for fault in caught.value.faults), caught.value.faults
    assert len(http.get("/v1/jobs").json()["jobs"]) == jobs
