"""Arguments, help and example of the verb that runs hard scenes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import guarded
from lineofaction.cli.options import AsJson, to_file
from lineofaction.cli.verbs import Later

if TYPE_CHECKING:
    from lineofaction.cli import hardcases
else:
    hardcases = Later("cli.hardcases")

verbs = typer.Typer()


@verbs.command(
    "hardcases", rich_help_panel="trust", epilog="Example: loa hardcases --only table -o hardcases.html"
)
@guarded
def _hardcases(
    only: Annotated[
        list[str] | None, typer.Option("--only", help="Names or families of scenes, separated by commas.")
    ] = None,
    output: Annotated[Path | None, to_file("Report page to write (HTML).")] = None,
    json: AsJson = False,
) -> None:
    """Run the hard scenes: cases known to break solvers, each checked against laws of physics."""
    hardcases.run_hardcases(only or [], output, as_json=json)
