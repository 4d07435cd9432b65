"""Drafts and canaries: no temporary folder keeps a byte of a request, and no answer a byte of the service."""

from __future__ import annotations

import copy
import os
import signal
import sys
import tempfile
from collections.abc import Callable, Iterator
from itertools import cycle, islice
from pathlib import Path
from typing import Any

import pytest
from canary_questions import Question, packed, questions
from fastapi.testclient import TestClient
from foreign_netcdf import SECRET, write_canary
from housing_solid import housed_scene, housing, write_block
from running_service import until
from study_service import empty_service

from host import kill, processes_in
from service.store.places import stored_results

TABLE = "cd" * 32
SLOW = "1," * 2_000_000


class Place:
    """A service, the folders in which it drafts, and requests that end badly.

    Parameters
    ----------
    http : TestClient
    folder : Path
        Holds the data directory, the common temporary folder and the solid.
    """

    def __init__(self, http: TestClient, folder: Path) -> None:
        self.http, self.folder = http, folder
        self.drafts = [
            folder / "temporary",
            *(folder / "data" / name for name in ("reading", "live", "work")),
        ]
        self._scene = copy.deepcopy(housed_scene(folder))
        del self._scene["meshes"][0]["database_file"]
        self._scene["meshes"][0]["database_hash"] = TABLE

    def refused(self, number: int) -> None:
        """Have files refused."""
        answer = self.http.post("/v1/cases/from-toml", json=_text(number, packed("a.csv", b"1")))
        assert answer.status_code == 422

    def reader_killed(self, number: int) -> None:
        future = self.http.app.state.context.reader.ask(_order(number))  # type: ignore[attr-defined]
        readers: list[int] = []
        until(lambda: bool(readers.extend(processes_in(self.drafts[1])) or readers) or future.done())
        for pid in readers:
            os.kill(pid, signal.SIGKILL)
        assert future.exception(timeout=60.0) is not None

    def dismissed(self, number: int) -> None:
        self.http.delete(self._meshing(number))

    def worker_killed(self, number: int) -> None:
        """Kill a worker while its solid is meshed, and dismiss what is begun again."""
        job = self._meshing(number)
        for pid in processes_in(self.drafts[3]):
            kill(pid)
        self.http.delete(job)

    def is_empty(self) -> bool:
        """Whether no draft is left, once jobs have ended."""
        until(lambda: self.http.get("/v1/jobs?status=running&status=accepted").json()["jobs"] == [])
        until(lambda: not list(self.drafts[3].iterdir()))
        return not [file for place in self.drafts if place.is_dir() for file in place.iterdir()]

    def _meshing(self, number: int) -> str:
        """Submit a job, each its own, and return its address once it drafts."""
        solid = (self.folder / "block.step").read_bytes() + f"/* {number} */".encode()
        part = housing(step_file=packed("block.step", solid), element_size_mm=3.0)
        inputs = {"scene": self._scene | {"housings": [part]}}
        headers = {"Prefer": "respond-async"}
        answer = self.http.post("/v1/processes/modes/execution", json={"inputs": inputs}, headers=headers)
        until(lambda: bool(list(self.drafts[3].glob("*/drafts/*"))))
        return f"/v1/jobs/{answer.json()['jobID']}"


def _text(number: int, *files: Any) -> dict[str, Any]:
    """Return a text that names no file of those sent."""
    return {"toml": f'[pair.pinion]\nflank_grid_csv = "{number}.csv"', "files": list(files)}


def _order(number: int) -> Any:
    """Return an order that takes a second to read."""
    from service.live.order import LiveOrder  # noqa: PLC0415 (what the route makes)

    text = _text(number, packed(f"{number}.csv", SLOW.encode()))
    return LiveOrder("service.reading.texts:case_of_toml", text)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Place]:
    folder = tmp_path_factory.mktemp("drafts")
    (folder / "temporary").mkdir()
    write_block(folder / "block.step")
    with pytest.MonkeyPatch.context() as patched, empty_service(folder / "data") as (_, http):
        patched.setattr(tempfile, "tempdir", str(folder / "temporary"))
        made = Place(http, folder)
        stored_results(folder / "data").put(TABLE, "database", folder / "mesh.nc")
        yield made


ENDS: list[Callable[[Place, int], None]] = [
    Place.refused,
    Place.reader_killed,
    Place.dismissed,
    Place.worker_killed,
]


@pytest.mark.law
@pytest.mark.parametrize("count", [8, pytest.param(200, marks=pytest.mark.nightly)])
def test_nothing_is_left_of_requests_that_end_badly(place: Place, count: int) -> None:
    for number, end in enumerate(islice(cycle(ENDS), count)):
        end(place, 1000 * count + number)
    assert place.is_empty()


# A canary beside the service: no question brings it, or a path of the service, into an answer or a log.


LEAST = 40


@pytest.mark.law
def test_no_question_brings_the_canary(place: Place) -> None:
    http, folder = place.http, place.folder
    data = folder / "data"
    canary = write_canary(data)
    answers = {question[0]: _answered(http, question) for question in questions(folder, canary, TABLE)}
    assert len(answers) >= LEAST
    assert {name for name, text in answers.items() if SECRET in text} == set()
    places = [data / "reading", data / "work", folder / "temporary"]
    hidden = [str(place).encode() for place in (*places, sys.prefix, Path(__file__).parents[2])]
    assert {name for name, text in answers.items() if any(place in text for place in hidden)} == set()
    written = [file for file in data.rglob("*") if file.is_file() and file.parent != data]
    assert [file for file in written if SECRET in file.read_bytes()] == []
    for left in places:
        assert list(left.iterdir()) == [], left


def _answered(http: TestClient, question: Question) -> bytes:
    """Return all that a question brings: the answer, and of a job its outcome."""
    _, path, body = question
    answer = http.post(path, json=body, headers={"Prefer": "respond-async"})
    assert answer.status_code < 500, (question[0], answer.text)
    if answer.status_code != 201:
        return answer.content
    job = f"/v1/jobs/{answer.json()['jobID']}"
    until(lambda: http.get(job).json()["status"] in ("failed", "successful", "dismissed"))
    return answer.content + http.get(job).content + http.get(f"{job}/results").content
