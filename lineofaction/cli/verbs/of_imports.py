"""Arguments, help and example of the verb that opens gear units of other tools."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.options import AsJson
from lineofaction.cli.verbs import Later

if TYPE_CHECKING:
    from lineofaction.cli import open_unit
else:
    open_unit = Later("cli.open_unit")

verbs = typer.Typer()

_ASSUME = (
    "Set a value over the file's before it is opened, in its unit: 14.helix_angle_reference_diameter=-12; "
    "repeatable."
)


@verbs.command("open", rich_help_panel="start", epilog="Example: loa open gearbox.rexs -o gearbox")
@computing
def _open_unit(
    file: Annotated[Path, typer.Argument(help="Gear unit as REXS: .rexs, .rexsj, .rexsz or .rexs.zip.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", "--out", help="Folder for the files; default: that of the file's name, here."
        ),
    ] = None,
    assume: Annotated[
        list[str] | None,
        typer.Option("--assume", metavar="COMPONENT.ATTRIBUTE=VALUE", help=_ASSUME),
    ] = None,
    json: AsJson = False,
) -> None:
    """Open a gear unit of another tool (REXS): write its cases, its scene and the report of the import."""
    open_unit.run_open(file, output, assume or (), as_json=json)
