"""Ablations of cases and scenes as jobs: the real process over HTTP, and through the client."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from study_service import CASE, Served, figures_alone, prepared, scene_by_hash, study_service, without

from fe_contact.effects import EFFECTS
from fe_contact.ste import SteDatabase
from lineofaction.client import JobState
from lineofaction.gearbox.convert.case import CheckedCase
from lineofaction.gearbox.convert.scene import TabledScene, dynamic_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.stages import PacedFraction
from lineofaction.gearbox.studies.ablate import Inputs
from lineofaction.gearbox.studies.ablate.run import RUN
from lineofaction.gearbox.studies.computation import Means
from service.store import stored_results
from service.store.results import IndexLine
from service.worker import study_work
from service.worker.order import WorkOrder
from service.worker.process import default_registry

ABLATE = default_registry()["ablate"]
OLD = "0d" * 32
ONLY = ["tooth_coupling", "misalignment"]
TIMES = ("cpu_seconds", "predicted_cpu_seconds", "cost_ratio")  # measured, or predicted for this cache


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with study_service(tmp_path_factory.mktemp("service")) as found:
        yield found


@pytest.fixture
def scene(tmp_path: Path) -> SceneInput:
    return scene_by_hash(tmp_path, 0.03)


def test_the_ablation_of_a_case_is_that_of_python(served: Served, tmp_path: Path) -> None:
    seen: list[JobState] = []
    told = figures_alone(served.client.ablate.submit(CASE, only=ONLY).figures(seen.append))
    here = RUN.compute(
        CheckedCase(validated(Case, CASE)), Inputs(only=tuple(ONLY)), Means(tmp_path, lambda *_: None)
    )
    assert [effect["name"] for effect in told["effects"]] == ["tooth_coupling"]
    assert told["left_out"] == {"misalignment": "the gears are aligned"}
    assert abs(told["effects"][0]["mean_change_um"][1]) > 1e-3
    expected = json.loads(json.dumps(RUN.figures(here))) | {"warnings": []}
    assert without(TIMES, told) == without(TIMES, expected)
    progress = [state.progress for state in seen]
    assert progress == sorted(progress) and progress[-1] == 100


def test_it_is_served_as_figures_and_as_its_file(served: Served) -> None:
    told = served.client.ablate.submit(CASE, only=ONLY).figures()
    job = served.client.submit("ablate", {"case": CASE, "only": ONLY[::-1]})  # the same question: stored
    assert job.status == "successful"
    served.has_figures_and_file("ablation", told, job.id)


def test_one_that_version_0_1_stored_as_json_is_to_be_computed_again(served: Served, tmp_path: Path) -> None:
    old, store = tmp_path / "ablation.json", stored_results(served.data)
    old.write_text("{}", encoding="utf-8")
    digest = hashlib.sha256(b"{}").hexdigest()
    name = f"ablation/{OLD[:2]}/{OLD}.{digest[:16]}.01234567.json"
    store.files.put(name, old, digest)
    store.enter(IndexLine(OLD, "ablation", digest, 2, name, "2026-01-01T00:00:00Z"))
    for path in (f"/v1/results/{OLD}", f"/v1/results/{OLD}/figures"):
        answer = served.http.get(path)
        assert answer.status_code == 404
        assert "Version 0.1 stored it as JSON" in answer.json()["detail"]


def test_the_ablation_of_a_scene_is_that_of_python(served: Served, scene: SceneInput, tmp_path: Path) -> None:
    """The work itself, in this process: a case goes through a child above."""
    client, data = served.client, served.data
    given = {"scene": scene.model_dump(mode="json"), "only": ["lateral"]}
    inputs = ABLATE.prepare(ABLATE.inputs.model_validate_json(json.dumps(given)), stored_results(data))
    seen: list[tuple[str, float]] = []
    order = WorkOrder(ABLATE.entry, inputs, ABLATE.key(inputs), tmp_path, data)
    (product,) = study_work.ablate(order, lambda *step: seen.append(step))
    paced = PacedFraction(ABLATE.stages)
    overall = [paced.at(*step, float(instant)) for instant, step in enumerate(seen)]
    assert overall and None not in overall and overall == sorted(overall)  # type: ignore[type-var]
    stored_results(data).put(product.key, product.kind, product.file)
    told = figures_alone(client.ablate.submit(scene, only=["lateral"]).figures())
    tables = {"mesh": SteDatabase.from_netcdf(tmp_path / "ste.nc")}
    means = Means(tmp_path, lambda *_: None)
    here = RUN.compute(
        TabledScene(scene, tables, dynamic_scene(scene, tables), {}), Inputs(only=("lateral",)), means
    )
    assert [effect["name"] for effect in told["effects"]] == ["lateral"]
    expected = json.loads(json.dumps(RUN.figures(here))) | {"warnings": []}
    assert without(TIMES, told) == without(TIMES, expected)


def test_equal_questions_in_other_words_are_one_result() -> None:
    everything = [effect.name for effect in EFFECTS]
    keys = [
        ABLATE.key(prepared(ABLATE, case=CASE, **further))
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
    served.refuses("ablate", inputs, field)


def test_a_case_beside_a_scene_is_refused(served: Served, scene: SceneInput) -> None:
    with pytest.raises(BadInput, match=r"case.*left out beside one"):
        served.client.submit("ablate", {"case": CASE, "scene": scene.model_dump(mode="json")})
