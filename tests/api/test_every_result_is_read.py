"""Extreme results of every kind pass every reader: none answers 5xx, no verb meets a defect.

Results are made by the work of their processes, of inputs at the ends of what these take: names of all
characters, the shortest run, one position, one torque, no load, no excitation. A new study is among them by
its row. By day one result of a fifth of the kinds is read, and images are left out; at night 250 are read
with all their images.
"""

import copy
import json
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from io import BytesIO
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from condensed_once import find_condensed
from declared_figures import check_declared
from extreme_inputs import extreme_inputs
from fastapi.testclient import TestClient
from PIL import Image
from pydantic import ValidationError
from typer.testing import CliRunner

import lineofaction as loa
from bounds.brief import MAX_LINES, WIDTH
from lineofaction.cli.commands import app
from lineofaction.cli.output import print_json
from lineofaction.cli.run_study import _show, _writers
from lineofaction.client.report import Report
from lineofaction.gearbox.convert.errors import translated
from lineofaction.gearbox.problems import ServiceError
from lineofaction.gearbox.registry import study_of
from lineofaction.gearbox.result_files import stamp
from lineofaction.report.document import read_stored
from lineofaction.report.presentation import presentation_of
from service.app import create_app
from service.settings import Settings
from service.store.places import stored_results
from service.store.results import StoredResult
from service.worker.order import WorkOrder
from service.worker.preparations import files_read
from service.worker.process import default_registry

DEFECT = 500


@dataclass(frozen=True)
class Reading:
    """A result, the service that has it, and a folder to write to."""

    result: StoredResult
    http: TestClient
    folder: Path


def _got(reading: Reading, path: str, **query: str) -> Any:
    """Return the document at a path of the result, None where it is refused in words."""
    answer = reading.http.get(f"/v1/results/{reading.result.key}{path}", params=query)
    assert answer.status_code < DEFECT, (path, answer.text)
    if answer.status_code != 200:
        assert answer.json()["detail"]
        return None
    return answer


def _verb(*arguments: object) -> None:
    """Call a verb; what it cannot do it says."""
    ended = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert ended.exit_code in (0, 1, 2), (arguments, ended.stderr, ended.exception)
    assert ended.exit_code == 0 or ended.stderr.startswith("error: "), ended.stderr


def figures_as_json(reading: Reading) -> None:
    answer = _got(reading, "")
    check_declared(reading.result.kind, answer.json())


def drawings(reading: Reading) -> None:
    """Read the report as the page and a notebook show it, and beside itself."""
    for query in ({}, {"against": reading.result.key}):
        answer = _got(reading, "/figures", **query)
        if answer is not None:
            assert Report.model_validate(answer.json())._repr_html_()


def sound(reading: Reading) -> None:
    for query in (
        {},
        {"quantity": "mesh_force"},
        {"quantity": "transmission_error"},
        {"against": reading.result.key},
    ):
        _got(reading, "/sound", **query)


def motions(reading: Reading) -> None:
    answer = _got(reading, "/motion")
    if answer is not None:
        count = sum(len(group["motions"]) for group in answer.json()["groups"])
        for number in {0, count - 1}:
            assert _got(reading, "/motion", number=str(number)) is not None
        assert _got(reading, "/motion", number=str(count)) is None


def table_queries(reading: Reading) -> None:
    path = f"/v1/databases/{reading.result.key}"
    columns = np.array([0.0, 0.25, -1.0, 5.0]).tobytes()
    raw = {"Content-Type": "application/octet-stream", "Accept": "application/octet-stream"}
    for answer in (
        reading.http.post(f"{path}/query", content=columns, headers=raw),
        reading.http.post(f"{path}/query", json={"position": [0.0, 0.5], "deflection_um": [-5.0, 1e3]}),
        reading.http.post(f"{path}/ste", json={"torque_n_m": [100.0]}),
        reading.http.get("/v1/databases"),
    ):
        assert answer.status_code < DEFECT, answer.text


def report(reading: Reading) -> None:
    _verb(
        "report",
        reading.result.path,
        "-o",
        reading.folder / "page.html",
        "--images",
        reading.folder / "images",
    )


def comparison(reading: Reading) -> None:
    _verb("compare", reading.result.path, reading.result.path, "-o", reading.folder / "comparison.html")


def recording(reading: Reading) -> None:
    _verb("listen", reading.result.path, "-o", reading.folder / "run.wav")


def exports(reading: Reading) -> None:
    for name, *options in (
        ("run.csv",),
        ("run.unv",),
        ("run.unv", "--function", "spectrum"),
        ("run.unv", "--function", "orders"),
        ("mesh.fmu",),
    ):
        _verb("export", reading.result.path, "-o", reading.folder / name, *options)


def curves(reading: Reading) -> None:
    for form in ("--csv", "--json", "--at=0,0.5"):
        _verb("ste", reading.result.path, "--torque", "1", form)


def verb_of_study(reading: Reading) -> None:
    """Print and write what the verb of a study does of its result, but for files made of its subject too."""
    study = study_of(reading.result.kind)
    if study is None:
        return
    result = read_stored(study, reading.result.path)
    further = {*study.run.writers, *([] if presentation_of(study).series else [".csv"])}
    for ending, write in _writers(study, None, None).items():
        if ending not in further:
            write(result, reading.folder / f"result{ending}")
    _show(study, result, [], 0.0)
    print_json(study.run.figures(result))


def python_prompt(reading: Reading) -> None:
    """Show, copy and compare a result as a user of Python does."""
    result = loa.read(reading.result.path)
    lines = repr(result).split("\n")
    assert 1 < len(lines) <= MAX_LINES and max(map(len, lines)) <= WIDTH, lines
    assert "<table>" in result._repr_html_()
    for other in (
        pickle.loads(pickle.dumps(result)),
        copy.deepcopy(result),
        loa.read(reading.result.path),
    ):
        assert other is not result and other == result
    assert result != 0
    assert result.to_xarray().attrs


READERS: tuple[Callable[[Reading], None], ...] = (
    figures_as_json,
    drawings,
    sound,
    motions,
    table_queries,
    report,
    comparison,
    recording,
    exports,
    curves,
    verb_of_study,
    python_prompt,
)


PROCESSES = tuple(default_registry())
FEW, MANY = 1, -(-250 // len(PROCESSES))
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
def home(tmp_path_factory, condensed_bodies):
    folder = tmp_path_factory.mktemp("read")
    find_condensed(condensed_bodies, folder)
    return folder


@pytest.fixture(scope="module")
def http(home):
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
def test_a_few_of_every_kind_are_read(home, http, process, tmp_path, monkeypatch):
    def undrawn(_figure, across=1, *, half=False):
        content = BytesIO()
        Image.new("RGB", (across, 1)).save(content, "PNG")
        return content.getvalue()

    monkeypatch.setattr("lineofaction.report.document.png", undrawn)
    assert read(home, http, process, FEW, tmp_path) >= FEW


@pytest.mark.nightly
@pytest.mark.parametrize("process", PROCESSES)
def test_many_of_every_kind_are_read(home, http, process, tmp_path):
    assert read(home, http, process, MANY, tmp_path) >= MANY
