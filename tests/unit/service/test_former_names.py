"""Former names of verbs, processes and methods are heard for one version, and listed nowhere."""

from __future__ import annotations

from pathlib import Path

import pytest
import typer
from fastapi.testclient import TestClient

from lineofaction.cli.commands import app
from lineofaction.client.processes import Processes
from lineofaction.gearbox.registry import FORMER, STUDIES
from service.app import create_app
from service.schemas.request_examples import request_example
from service.settings import Settings
from service.worker.catalogue import default_registry


@pytest.mark.parametrize(("former", "name"), FORMER.items())
def test_a_former_name_is_the_present_one(former: str, name: str) -> None:
    processes = default_registry()
    assert former in processes
    assert processes[former] is processes[name]
    assert getattr(Processes, former) is getattr(Processes, name)
    verbs = typer.main.get_command(app)
    context = typer.Context(verbs)
    assert verbs.get_command(context, former).name == verbs.get_command(context, name).name == name


@pytest.mark.parametrize("former", FORMER)
def test_it_is_listed_nowhere(former: str) -> None:
    verbs = typer.main.get_command(app)
    assert former not in STUDIES
    assert former not in list(default_registry())
    assert former not in verbs.list_commands(typer.Context(verbs))


@pytest.mark.parametrize(("former", "name"), FORMER.items())
def test_an_execution_under_a_former_name_is_one(former: str, name: str, tmp_path: Path) -> None:
    """It was 201 with the body null, and no job."""
    execution = f"/v1/processes/{name}/execution"
    former_execution = f"/v1/processes/{former}/execution"
    with TestClient(create_app(Settings(data_directory=tmp_path), works=False)) as client:
        answer = client.post(former_execution, json={}, follow_redirects=False)
        assert (answer.status_code, answer.headers["location"]) == (308, execution)
        followed = client.post(former_execution, json=request_example(execution))
        assert followed.status_code == 201
        assert client.get(followed.headers["location"]).json()["processID"] == name
        assert client.post("/v1/processes/nothing/execution", json={}).status_code == 404
