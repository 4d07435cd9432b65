"""Spoiled files of every format: a refusal that names the file or an answer, and nothing left behind."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from mutated_files import Asked, corpus, mutated
from service_fakes import REGISTRY

from host import child_environment, processes_in
from service.app import create_app
from service.settings import Settings

FATAL = (11, 23)
"""Seeds of STEP files over which the native reader crashes."""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("service")


@pytest.fixture(scope="module")
def http(place: Path) -> Iterator[TestClient]:
    app = create_app(Settings(data_directory=place), REGISTRY)
    yield TestClient(app, raise_server_exceptions=False, headers={"Host": "localhost"})
    app.state.context.reader.stop()
    app.state.context.live.stop()


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, bytes, Asked]]:
    return list(corpus(tmp_path_factory.mktemp("corpus")))


def answered(http: TestClient, content: bytes, ask: Asked) -> Any:
    request = ask(content)
    return http.post(request.path, json=request.body)


def left(place: Path) -> list[Any]:
    """Return what readers left: folders, and processes in them."""
    return [*(place / "reading").iterdir(), *processes_in(place / "reading")]


ALONE = """
import importlib, json, sys, tempfile
from pathlib import Path
for line in sys.stdin:
    order = json.loads(line)
    module, _, name = order["entry"].partition(":")
    folder = Path(tempfile.mkdtemp(dir="."))
    print(json.dumps(getattr(importlib.import_module(module), name)(order["inputs"], folder, str)))
"""
"""Does the works of orders in one process that is not confined."""


@pytest.mark.law
def test_good_files_read_the_same_as_without_confinement(
    http: TestClient,
    files: list[tuple[str, bytes, Asked]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pool, orders, answers = http.app.state.context.reader, [], []  # type: ignore[attr-defined]
    ask = pool.ask
    monkeypatch.setattr(pool, "ask", lambda order, *rest: orders.append(order) or ask(order, *rest))
    for name, content, request in files:
        answer = answered(http, content, request)
        assert answer.status_code == (422 if name == "netCDF" else 200), (name, answer.text)
        answers.append(answer.json())
    read = [pair for pair in zip(orders, answers, strict=True) if "errors" not in pair[1]]
    lines = b"".join(order.line() for order, _ in read)
    alone = subprocess.run(
        [sys.executable, "-c", ALONE],
        input=lines,
        cwd=tmp_path,
        env=child_environment(),
        capture_output=True,
        check=False,
    )
    assert list(map(json.loads, alone.stdout.splitlines())) == [answer for _, answer in read], alone.stderr


@pytest.mark.law
@pytest.mark.parametrize("seed", FATAL)
def test_a_step_file_that_ends_its_reader_is_named(
    http: TestClient, place: Path, files: list[tuple[str, bytes, Asked]], seed: int
) -> None:
    _, content, ask = files[0]
    answer = answered(http, mutated(content, seed), ask)
    assert answer.status_code == 422, answer.text
    (fault,) = answer.json()["errors"]
    assert (fault["field"], fault["value"]) == ("housings[0].step_file", "block.step")
    assert "ended its reader (SIG" in fault["bound"]
    assert left(place) == []


@pytest.mark.law
@pytest.mark.parametrize("count", [12, pytest.param(480, marks=pytest.mark.nightly)])
def test_spoiled_files_are_refused_or_read(
    http: TestClient, place: Path, files: list[tuple[str, bytes, Asked]], count: int
) -> None:
    """As many of every format, of a mesh and a gear unit in turn of one of their files.

    All by one warm process, which is replaced after 500 forks.
    """
    formats = sorted({name.split()[0] for name, _, _ in files})
    fates: Counter[tuple[str, int]] = Counter()
    for number in range(count):
        form, turn = formats[number % len(formats)], number // len(formats)
        members = [file for file in files if file[0].split()[0] == form]
        _, content, ask = members[turn % len(members)]
        answer = answered(http, mutated(content, number), ask)
        fates[form, answer.status_code] += 1
        assert answer.status_code < 500, (form, number, answer.text)
    assert {status for _, status in fates} <= {200, 413, 422}, fates
    assert left(place) == []
