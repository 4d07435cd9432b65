"""A running service that holds a table, and what the tests of its studies of cases and scenes share."""

import base64
import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from condensed_once import find_condensed
from declared_figures import check_declared, document
from fastapi.testclient import TestClient
from running_service import REFERENCES
from scene_files import scene_file

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import JSON, NETCDF
from lineofaction.gearbox.schemas import read_model
from lineofaction.gearbox.schemas.figures import Figures
from lineofaction.gearbox.schemas.scene import SceneInput
from service.app import create_app
from service.settings import Settings
from service.store.places import stored_results
from service.worker.process import Process

KEY = "ab" * 32
"""Hash under which the service holds the table of `scene_file`."""

_GEAR = {"teeth": 20, "face_width_mm": 10.0, "bore_diameter_mm": 40.0, "thickness_allowance_um": 90.0}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 4.0, "center_distance_mm": 80.0, "pinion": _GEAR, "wheel": _GEAR},
    "load": {"torque_n_m": [20.0, 40.0]},
    "accuracy": {"level": "draft", "positions": 16, "model": "plane_strain"},
}


@dataclass(frozen=True)
class Served:
    """A running service: its client, the bare HTTP one, and the data directory."""

    client: LineOfActionClient
    http: TestClient
    data: Path

    def has_figures_and_file(self, output: str, told: Figures, job: str) -> None:
        reference = self.http.get(f"/v1/jobs/{job}/results", params=REFERENCES).json()[output]
        assert reference["type"] == NETCDF
        for accept, kind in ((JSON, JSON), ("*/*", JSON), (NETCDF, NETCDF)):
            answer = self.http.get(reference["href"], headers={"Accept": accept})
            assert answer.headers["content-type"] == kind
            if kind == JSON:
                assert answer.json() == document(told)
                check_declared(output, answer.json())
            digest = base64.b64encode(hashlib.sha256(answer.content).digest()).decode()
            assert answer.headers["content-digest"] == f"sha-256=:{digest}:"
            again = {"If-None-Match": answer.headers["etag"], "Accept": accept}
            known = self.http.get(reference["href"], headers=again)
            assert (known.status_code, known.content) == (304, b"")

    def assert_refused(self, process: str, inputs: dict[str, Any], field: str) -> None:
        jobs = len(self.http.get("/v1/jobs").json()["jobs"])
        with pytest.raises(BadInput) as caught:
            self.client.submit(process, inputs)
        assert any(field in fault.field for fault in caught.value.faults), caught.value.faults
        assert len(self.http.get("/v1/jobs").json()["jobs"]) == jobs


@contextmanager
def empty_service(data: Path) -> Iterator[tuple[LineOfActionClient, TestClient]]:
    """Run a service with its real processes on its data; yield its client and the bare HTTP one."""
    with (
        TestClient(create_app(Settings(data_directory=data))) as service,
        LineOfActionClient(
            "http://testserver", cache_dir=data.parent / "results", transport=service._transport
        ) as found,
    ):
        yield found, service


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory, condensed_bodies: Path) -> Iterator[Served]:
    """A running service with its real processes, without a table, on bodies that all tests share."""
    data = tmp_path_factory.mktemp("service") / "data"
    find_condensed(condensed_bodies, data)
    with empty_service(data) as (client, http):
        yield Served(client, http, data)


@contextmanager
def study_service(directory: Path) -> Iterator[Served]:
    scene_file(directory)
    data = directory / "data"
    with empty_service(data) as (client, http):
        stored_results(data).put(KEY, "database", directory / "ste.nc")
        yield Served(client, http, data)


def scene_by_hash(directory: Path, duration: float) -> SceneInput:
    given = read_model(SceneInput, scene_file(directory, duration=duration))
    (mesh,) = given.meshes
    by_hash = mesh.model_copy(update={"database_file": None, "database_hash": KEY})
    return given.model_copy(update={"meshes": (by_hash,)})


def prepared(process: Process, **inputs: Any) -> dict[str, Any]:
    return process.prepare(process.inputs.model_validate_json(json.dumps(inputs)), None)


def without(names: tuple[str, ...], value: Any) -> Any:
    if isinstance(value, dict):
        return {name: without(names, inner) for name, inner in value.items() if name not in names}
    return [without(names, item) for item in value] if isinstance(value, list) else value
