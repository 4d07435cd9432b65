"""The accuracy study of cases and scenes as jobs: the real process over HTTP, and through the client."""

from __future__ import annotations

import importlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from study_service import CASE, Served, figures_alone, prepared, scene_by_hash, study_service, without

from dynamics.accuracy import FIDELITIES as SCENE_FIDELITIES
from fe_contact.analysis.studies.frontier import FIDELITIES
from fe_contact.errors import SolveError
from fe_contact.ste import SteDatabase
from lineofaction.client import JobState
from lineofaction.gearbox.convert.case import CheckedCase
from lineofaction.gearbox.convert.result_files import figures_of
from lineofaction.gearbox.convert.scene import TabledScene, dynamic_scene
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.stages import PacedFraction
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.frontier import Inputs
from lineofaction.gearbox.studies.frontier.run import RUN
from service.store import stored_results
from service.worker import study_work
from service.worker.order import WorkOrder
from service.worker.process import default_registry

FRONTIER = default_registry()["frontier"]
CLOSED = ["iso6336", "thin_slices"]
MEASURED = ("cpu_seconds", "stages", "peak_memory_bytes", "knee")  # the knee hangs on the times


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with study_service(tmp_path_factory.mktemp("service")) as found:
        yield found


@pytest.fixture
def scene(tmp_path: Path) -> SceneInput:
    return scene_by_hash(tmp_path, 0.06)


def worked(inputs: dict[str, Any], workspace: Path, data: Path) -> tuple[dict[str, Any], list[float]]:
    """Do the work in this process; return its JSON and the progress of the whole job."""
    seen: list[float | None] = []
    paced = PacedFraction(FRONTIER.stages)
    order = WorkOrder(FRONTIER.entry, inputs, FRONTIER.key(inputs), workspace, data)
    (product,) = study_work.frontier(order, lambda *step: seen.append(paced.at(*step, float(len(seen)))))
    assert (product.key, product.kind) == (order.key, "frontier")
    return figures_of("frontier", product.file), [part for part in seen if part is not None]


def test_the_ladder_of_a_case_is_that_of_python(served: Served, tmp_path: Path) -> None:
    seen: list[JobState] = []
    told = figures_alone(served.client.frontier.submit(CASE, rungs=CLOSED).figures(seen.append))
    here = RUN.compute(
        CheckedCase(validated(Case, CASE)), Inputs(rungs=tuple(CLOSED)), Means(tmp_path, lambda *_: None)
    )
    assert [rung["name"] for rung in told["rungs"]] == CLOSED
    assert told["rungs"][0]["mean_error"] > 1e-3 and told["reference"] == "thin_slices"
    assert all(rung["cpu_seconds"] > 0.0 for rung in told["rungs"])
    expected = json.loads(json.dumps(RUN.figures(here))) | {"warnings": []}
    assert without(MEASURED, told) == without(MEASURED, expected)
    progress = [state.progress for state in seen]
    assert progress == sorted(progress) and progress[-1] == 100


def test_it_is_served_as_figures_and_as_its_file(served: Served) -> None:
    told = served.client.frontier.submit(CASE, rungs=CLOSED).figures()
    job = served.client.submit("frontier", {"case": CASE, "rungs": CLOSED[::-1]})  # the same question: stored
    assert job.status == "successful"
    served.has_figures_and_file("frontier", told, job.id)


def test_the_ladder_of_a_scene_is_that_of_python(served: Served, scene: SceneInput, tmp_path: Path) -> None:
    """The work itself, in this process: a case goes through a child above."""
    client, data = served.client, served.data
    rungs = ["quasi_static", "100_nm", "10_nm"]
    given = {"scene": scene.model_dump(mode="json"), "rungs": rungs}
    inputs = FRONTIER.prepare(FRONTIER.inputs.model_validate_json(json.dumps(given)), stored_results(data))
    made, progress = worked(inputs, tmp_path, data)
    assert progress == sorted(progress) and len(progress) == len(rungs) + 1
    stored_results(data).put(FRONTIER.key(inputs), "frontier", tmp_path / "frontier.nc")
    told = figures_alone(client.frontier.submit(scene, rungs=rungs).figures())
    tables = {"mesh": SteDatabase.from_netcdf(tmp_path / "ste.nc")}
    means = Means(tmp_path, lambda *_: None)
    here = RUN.compute(
        TabledScene(scene, tables, dynamic_scene(scene, tables), {}), Inputs(rungs=tuple(rungs)), means
    )
    assert told == made and told["reference"] == "10_nm"
    expected = json.loads(json.dumps(RUN.figures(here))) | {"warnings": []}
    assert without(MEASURED, told) == without(MEASURED, expected)


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

    rungs = [rung for rung in FIDELITIES if rung.name in CLOSED]
    module = importlib.import_module("fe_contact.analysis.studies.frontier")
    monkeypatch.setattr(module, "FIDELITIES", (rungs[0], Failing(), rungs[1]))
    made, progress = worked(prepared(FRONTIER, case=CASE, rungs=[*CLOSED, "corrected"]), tmp_path, tmp_path)
    assert made["left_out"] == {"corrected": said}
    assert [rung["name"] for rung in made["rungs"]] == CLOSED
    assert progress[-1] == pytest.approx(1.0)


def test_full_contact_runs_beside_the_ladder_of_a_case(tmp_path: Path) -> None:
    made, _ = worked(prepared(FRONTIER, case=CASE, rungs=CLOSED, full_contact=1), tmp_path, tmp_path)
    beside = made["full_contact"]
    assert (beside["positions_run"], beside["positions_solved"]) == (1, 1)
    assert beside["torques_n_m"] == pytest.approx([20.0, 40.0])
    assert beside["own_error_estimate"] < 5e-3
    assert FRONTIER.key(prepared(FRONTIER, case=CASE, full_contact=1)) != FRONTIER.key(
        prepared(FRONTIER, case=CASE)
    )


def test_equal_questions_in_other_words_are_one_result() -> None:
    everything = [rung.name for rung in FIDELITIES]
    keys = [
        FRONTIER.key(prepared(FRONTIER, case=CASE, **further))
        for further in ({}, {"rungs": everything}, {"rungs": [*everything[::-1], *CLOSED]}, {"rungs": CLOSED})
    ]
    assert keys[0] == keys[1] == keys[2] != keys[3]


def test_up_to_a_fidelity_is_all_before_it_in_the_order_of_cost() -> None:
    names = [fidelity.name for fidelity in FIDELITIES]
    for last in ("corrected_fine", "3d_draft", "3d_fine"):
        asked = prepared(FRONTIER, case=CASE, up_to=last)
        assert asked["rungs"] == names[: names.index(last) + 1]
    assert prepared(FRONTIER, case=CASE, up_to="3d_draft", rungs=["3d_fine", *CLOSED])["rungs"] == CLOSED


@pytest.mark.parametrize(
    ("inputs", "field"),
    [
        ({"rungs": CLOSED}, "case"),
        ({"case": CASE, "rungs": []}, "rungs"),
        ({"case": CASE, "rungs": ["iso6336"]}, "rungs"),  # nothing to compare it to
        ({"case": CASE, "rungs": ["iso6336", "4d"]}, "rungs"),
        ({"case": CASE, "rungs": [SCENE_FIDELITIES[0].name, *CLOSED]}, "rungs"),
        ({"case": CASE, "rung": CLOSED}, "rung"),
        ({"case": CASE, "full_contact": 0}, "full_contact"),
        ({"case": CASE, "full_contact": 65}, "full_contact"),
        ({"case": CASE | {"load": {"torque_n_m": [-1.0]}}}, "load.torque_n_m"),
    ],
)
def test_bad_inputs_are_refused_by_name_before_there_is_a_job(
    served: Served, inputs: dict[str, Any], field: str
) -> None:
    served.refuses("frontier", inputs, field)
