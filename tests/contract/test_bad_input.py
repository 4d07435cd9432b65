"""Bad input gives one clear error at every entry point (Python, command line, HTTP); nothing runs on."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from bad_inputs import BAD_FILES, BAD_INPUTS, BadInput
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from fe_contact.errors import InputError
from lineofaction.cli.commands import app as loa
from lineofaction.gearbox.convert.case import check_case
from lineofaction.gearbox.schemas import Case, validated
from service.app import create_app
from service.settings import Settings


def names(cases: tuple[BadInput, ...]) -> Any:
    return pytest.mark.parametrize("bad", cases, ids=[case.name.replace(" ", "_") for case in cases])


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    with TestClient(create_app(Settings(data_directory=tmp_path_factory.mktemp("data")))) as found:
        yield found
        assert found.get("/v1/jobs").json()["jobs"] == []


def children() -> set[str]:
    return set(Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text().split())


def toml(table: dict[str, Any], prefix: str = "") -> str:
    plain = {key: value for key, value in table.items() if not isinstance(value, dict)}
    text = f"[{prefix}]\n" if prefix else ""
    text += "".join(f"{key} = {_value(value)}\n" for key, value in plain.items())
    for key, value in table.items():
        if isinstance(value, dict):
            text += toml(value, f"{prefix}.{key}" if prefix else key)
    return text


def _value(value: Any) -> str:
    """Write one TOML value (nan and inf are TOML, and no JSON)."""
    return str(value) if isinstance(value, float) else json.dumps(value)


def test_there_are_at_least_thirty() -> None:
    assert len(BAD_INPUTS) >= 30
    assert len({bad.name for bad in (*BAD_INPUTS, *BAD_FILES)}) == len(BAD_INPUTS) + len(BAD_FILES)


@names(BAD_INPUTS)
def test_python(bad: BadInput) -> None:
    before = children()
    with pytest.raises(InputError) as caught:
        bad.python()
    assert caught.value.field.endswith(bad.python_field)
    assert str(caught.value.bound)
    assert children() == before


@names((*BAD_INPUTS, *BAD_FILES))
def test_command_line(bad: BadInput, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    file, output = tmp_path / "case.toml", tmp_path / "ste.nc"
    file.write_text(toml(bad.case()))
    before = children()
    result = CliRunner().invoke(loa, ["analyze", str(file), "-o", str(output), "--json"])
    assert result.exit_code == 2
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"error: {bad.case_field} = ")
    assert ": must be " in line
    assert not output.exists()
    assert not (tmp_path / "cache").exists()
    assert children() == before


@names((*BAD_INPUTS, *BAD_FILES))
def test_http(bad: BadInput, client: TestClient) -> None:
    before = children()
    body = json.dumps({"inputs": {"case": bad.case()}})  # writes NaN and Infinity, as careless callers do
    answer = client.post(
        "/v1/processes/analyze/execution", content=body, headers={"Content-Type": "application/json"}
    )
    assert answer.status_code == 422, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    (fault,) = answer.json()["errors"]
    assert fault["field"] == bad.case_field
    assert fault["bound"] and fault["suggestion"]
    assert children() == before


def without_places(said: str, file: Path) -> str:
    """Return what the command line says without the line of the file, which HTTP has none of."""
    return re.sub(rf" \({re.escape(str(file))}:\d+\)$", "", said, flags=re.MULTILINE)


@names((*BAD_INPUTS, *BAD_FILES))
def test_both_doors_of_a_case_say_the_same(bad: BadInput, client: TestClient, tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    file.write_text(toml(bad.case()))
    said = CliRunner().invoke(loa, ["analyze", str(file), "-o", str(tmp_path / "ste.nc")]).stderr
    body = json.dumps({"inputs": {"case": bad.case()}})
    headers = {"Content-Type": "application/json"}
    answer = client.post("/v1/processes/analyze/execution", content=body, headers=headers).json()
    assert without_places(said, file) == f"error: {answer['detail']}\n"


def test_the_value_shown_is_the_value_given(client: TestClient) -> None:
    for bad in BAD_INPUTS:
        if len(bad.changes) != 1 or bad.case_field not in bad.changes:
            continue
        given = bad.changes[bad.case_field]
        body = json.dumps({"inputs": {"case": bad.case()}})
        headers = {"Content-Type": "application/json"}
        answer = client.post("/v1/processes/analyze/execution", content=body, headers=headers).json()
        shown = answer["errors"][0]["value"]
        assert shown == given or shown == repr(given), bad.name


def test_bounds_are_in_the_units_of_the_field(client: TestClient) -> None:
    (bad,) = [case for case in BAD_INPUTS if case.name == "bore beyond the root"]
    body = {"inputs": {"case": bad.case()}}
    (fault,) = client.post("/v1/processes/analyze/execution", json=body).json()["errors"]
    assert fault["value"] == 95.0
    assert "70 mm" in fault["bound"]


@names(tuple(bad for bad in BAD_INPUTS if bad.name in ("face width no number", "face width infinite")))
def test_what_is_no_number_is_said_to_be_none(bad: BadInput, client: TestClient) -> None:
    body = json.dumps({"inputs": {"case": bad.case()}})
    headers = {"Content-Type": "application/json"}
    answer = client.post("/v1/processes/analyze/execution", content=body, headers=headers).json()
    assert answer["errors"][0]["bound"].startswith("a finite number")


def test_a_case_that_is_right_is_not_refused() -> None:
    good = BadInput("good", lambda: None, "").case()
    assert check_case(validated(Case, good)).pinion.teeth == 20
