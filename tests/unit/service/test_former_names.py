"""Former names of verbs, processes and methods are heard for one version, and listed nowhere."""

from __future__ import annotations

import pytest
import typer

from service.cli.commands import app
from service.client.processes import Processes
from service.registry import FORMER, STUDIES
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
