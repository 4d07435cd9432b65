"""A canary beside the service: no question brings it, or a path of the service, into an answer or a log."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from canary_questions import Question, questions
from fastapi.testclient import TestClient
from foreign_netcdf import SECRET, write_canary
from housing_solid import housed_scene
from running_service import until
from study_service import empty_service

from service.store.places import stored_results

TABLE = "cd" * 32
LEAST = 40


@pytest.fixture(scope="module")
def beside(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[TestClient, Path, Path]]:
    """A service that holds a table, its data directory with the canary in it, and a folder for files."""
    folder = tmp_path_factory.mktemp("canary")
    data, drafts = folder / "data", folder / "temporary"
    drafts.mkdir()
    housed_scene(folder)
    with pytest.MonkeyPatch.context() as patched, empty_service(data) as (_, http):
        patched.setattr(tempfile, "tempdir", str(drafts))
        stored_results(data).put(TABLE, "database", folder / "mesh.nc")
        yield http, data, folder


@pytest.mark.law
def test_no_question_brings_the_canary(beside: tuple[TestClient, Path, Path]) -> None:
    http, data, folder = beside
    canary = write_canary(data)
    answers = {question[0]: _answered(http, question) for question in questions(folder, canary, TABLE)}
    assert len(answers) >= LEAST
    assert {name for name, text in answers.items() if SECRET in text} == set()
    places = [data / "reading", data / "work", folder / "temporary"]
    hidden = [str(place).encode() for place in (*places, sys.prefix, Path(__file__).parents[2])]
    assert {name for name, text in answers.items() if any(place in text for place in hidden)} == set()
    written = [file for file in data.rglob("*") if file.is_file() and file.parent != data]
    assert [file for file in written if SECRET in file.read_bytes()] == []
    for place in places:
        assert list(place.iterdir()) == [], place


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
