"""Arguments, help and example of the verb that compares with numbers of others."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import guarded
from lineofaction.cli.options import AsJson, to_file
from lineofaction.cli.verbs import Later

if TYPE_CHECKING:
    from lineofaction.cli import validate
else:
    validate = Later("cli.validate")

verbs = typer.Typer()


@verbs.command("validate", rich_help_panel="trust", epilog="Example: loa validate iso_tr_6336_30")
@guarded
def _validate(
    names: Annotated[
        list[str] | None, typer.Argument(help="Cases by name, or files of cases (TOML); left out: all.")
    ] = None,
    output: Annotated[Path | None, to_file("Page to write (Markdown).")] = None,
    json: AsJson = False,
) -> None:
    """Compare with numbers of others: theirs and ours with their errors, and why they differ if they do."""
    validate.run_validate(names or [], output, as_json=json)
