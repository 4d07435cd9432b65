"""Options that belong together: one dataclass in the verb, one option each on the command line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import pytest
import typer
from typer.testing import CliRunner

from lineofaction.cli.guard import grouped, parameters_of


@dataclass(frozen=True)
class Size:
    """A length, asked for, and a width."""

    length: Annotated[float, typer.Option(help="Length in mm.")]
    width: Annotated[float, typer.Option(min=1.0, help="Width in mm.")] = 2.0


def drawn(*arguments: str) -> str:
    app = typer.Typer()

    @app.command()
    @grouped
    def draw(*, name: str, size: Size, bold: bool = False) -> None:
        typer.echo(f"{name} {size.length} {size.width} {bold}")

    return CliRunner().invoke(app, arguments).output


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("a", "--length", "3", "--width", "4", "--bold"), "a 3.0 4.0 True\n"),
        (("a", "--length", "3"), "a 3.0 2.0 False\n"),
    ],
)
def test_the_verb_is_called_with_the_group(arguments: tuple[str, ...], said: str) -> None:
    assert drawn(*arguments) == said


@pytest.mark.parametrize(
    ("arguments", "named"),
    [(("a",), "--length"), (("a", "--length", "3", "--width", "0"), "--width")],
)
def test_an_option_of_a_group_has_its_own_faults(arguments: tuple[str, ...], named: str) -> None:
    assert named in drawn(*arguments)
    assert "Error" in drawn(*arguments)


def test_options_stand_where_their_group_stood() -> None:
    @grouped
    def verb(*, name: str, size: Size, bold: bool = False) -> None: ...

    assert [part.name for part in parameters_of(verb)] == ["name", "length", "width", "bold"]
