"""Arguments, help and example of the verb on sheets of inspected gears."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.options import AsJson, to_file
from lineofaction.cli.overrides import CaseFile, overridable
from lineofaction.cli.verbs import Later

if TYPE_CHECKING:
    from lineofaction.cli import measured
else:
    measured = Later("cli.measured")

verbs = typer.Typer()


@verbs.command(
    "measured",
    rich_help_panel="pair",
    epilog="Example: loa measured case.toml pinion.csv --gear pinion --loaded right -o measured.toml",
)
@computing
@overridable("case")
def _measured(
    case: CaseFile,
    sheet: Annotated[
        Path | None,
        typer.Argument(help="Traces of the gear, or a folder of gears; left out: write those of the case."),
    ] = None,
    *,
    gear: Annotated[Literal["pinion", "wheel"], typer.Option(help="The gear that was inspected.")],
    loaded: Annotated[
        Literal["left", "right"],
        typer.Option(help="Flanks that carry the load, seen from the datum face."),
    ],
    cutoff_mm: Annotated[
        float | None,
        typer.Option(min=1e-3, max=1e3, help="Cut-off of the filter in mm; default: 1/30 of each trace."),
    ] = None,
    others: Annotated[
        Literal["designed", "mean"],
        typer.Option(help="Teeth that were not measured: as designed, or the mean of those that were."),
    ] = "designed",
    output: Annotated[
        Path | None, to_file("Case (TOML) to write; without a sheet CSV, of a folder JSON.")
    ] = None,
    json: AsJson = False,
) -> None:
    """Take pitches, traces and topographies of an inspected gear into a case, every line accounted for."""
    measured.run_measured(case, sheet, (gear, loaded, cutoff_mm, others == "mean"), output, as_json=json)
