"""Extreme results of every kind pass every reader: none answers 5xx, no verb meets a defect.

Results are made by the work of their processes, of inputs at the ends of what these take: names of all
characters, the shortest run, one position, one torque, no load, no excitation. A new study is among them by
its row. By day one result of a fifth of the kinds is read, and images are left out; at night 500 are read
with all their images.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from condensed_once import find_condensed
from extreme_inputs import extreme_inputs
from fastapi.testclient import TestClient
from pydantic import ValidationError
from result_readers import READERS, Reading

from lineofaction.gearbox.convert.errors import translated
from lineofaction.gearbox.problems import ServiceError
from lineofaction.gearbox.result_files import stamp
from lineofaction.report.drawing.figure import Figure
from service.app import create_app
from service.settings import Settings
from service.store.places import stored_results
from service.store.results import StoredResult
from service.worker.order import WorkOrder
from service.worker.preparations import files_read
from service.worker.process import default_registry

PROCESSES = tuple(default_registry())
FEW, MANY = 1, -(-500 // len(PROCESSES))
DRAWS = 40
"""Inputs that are drawn for a result at most: some are refused, as they should be."""


Json = dict[str, Any]


def make(home: Path, process: str, inputs: Json) -> list[StoredResult]:
    """Do a process, and store what it makes; a study of a run does that too."""
    offered, store = default_registry()[process], stored_results(home)
    if "run" in offered.inputs.model_fields and offered.inputs.model_fields["run"].is_required():
        *_, run = make(home, "simulate", {"scene": inputs["scene"]})
        inputs = inputs | {"run": run.key}
    prepared = offered.prepare(offered.inputs.model_validate_json(json.dumps(inputs)), store)
    module, _, name = offered.entry.partition(":")
    with TemporaryDirectory(dir=home) as folder:
        stored = files_read(prepared, store)
        order = WorkOrder(offered.entry, prepared, offered.key(prepared), Path(folder), home, stored=stored)
        products = getattr(import_module(module), name)(order, lambda *_: None)
        for product in products:
            stamp(product.file, product.warnings or [])
            store.put(product.key, product.kind, product.file)
    return [store.verified(product.key, product.kind) for product in products]


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory, condensed_bodies: Path) -> Path:
    folder = tmp_path_factory.mktemp("read")
    find_condensed(condensed_bodies, folder)
    return folder


@pytest.fixture(scope="module")
def http(home: Path) -> Iterator[TestClient]:
    with TestClient(create_app(Settings(data_directory=home)), raise_server_exceptions=False) as client:
        yield client


def results(home: Path, process: str, seed: int) -> list[StoredResult]:
    """Return what a process makes of the first inputs drawn that it takes."""
    draw = Random(f"{process} {seed}")
    for _ in range(DRAWS):
        try:
            return make(home, process, extreme_inputs(process, draw))
        except (ServiceError, ValidationError):
            pass
        except Exception as error:
            if translated(error) is None:
                raise
    return []


def read(home: Path, http: TestClient, process: str, count: int, folder: Path) -> int:
    """Put results of a process through all readers; return how many there were."""
    made = [result for seed in range(count) for result in results(home, process, seed)]
    for result in made:
        for reader in READERS:
            reader(Reading(result, http, folder))
    return len(made)


@pytest.mark.law
@pytest.mark.drawn
@pytest.mark.parametrize("process", PROCESSES)
def test_a_few_of_every_kind_are_read(
    home: Path, http: TestClient, process: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def undrawn(_figure: Figure) -> bytes:
        return b""

    monkeypatch.setattr("lineofaction.report.document.png", undrawn)
    assert read(home, http, process, FEW, tmp_path) >= FEW


@pytest.mark.nightly
@pytest.mark.parametrize("process", PROCESSES)
def test_many_of_every_kind_are_read(home: Path, http: TestClient, process: str, tmp_path: Path) -> None:
    assert read(home, http, process, MANY, tmp_path) >= MANY
