"""Every way to read a stored result: over HTTP, by a verb, in a notebook. None may meet a defect."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from declared_figures import check_declared
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from lineofaction.cli.commands import app
from lineofaction.cli.output import print_json
from lineofaction.cli.run_study import _show, _writers
from lineofaction.client.report import Report
from lineofaction.gearbox.registry import study_of
from lineofaction.report.document import read_stored
from lineofaction.report.presentation import presentation_of
from service.store.results import StoredResult

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
    assert answer is not None
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
    for ending, write in _writers(study, None).items():
        if ending not in further:
            write(result, reading.folder / f"result{ending}")
    _show(study, result, [], 0.0)
    print_json(study.run.figures(result))


READERS: tuple[Callable[[Reading], None], ...] = (
    figures_as_json,
    drawings,
    sound,
    table_queries,
    report,
    comparison,
    recording,
    exports,
    curves,
    verb_of_study,
)
