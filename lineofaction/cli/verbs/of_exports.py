"""Arguments, help and example of the verb that exports: bent gears, FMUs, REXS, parts of runs."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.options import AsJson, Force, to_file
from lineofaction.cli.overrides import file_argument, overridable
from lineofaction.cli.verb_parameters import grouped
from lineofaction.cli.verbs import Later
from lineofaction.gearbox.input_file import InputFile

if TYPE_CHECKING:
    from lineofaction.cli import export
else:
    export = Later("cli.export")  # imported at the first use of a name: help needs only the arguments

verbs = typer.Typer()


@dataclass(frozen=True)
class _LoadPoint:
    """One load and alignment."""

    torque_n_m: Annotated[
        float | None,
        typer.Option("--torque", help="Torque on the driving gear in N m; default: the highest load."),
    ] = None
    normal_force_n: Force = None
    misalignment_um: Annotated[
        float | None, typer.Option(help="Misalignment in µm; default: the value of the case nearest to 0.")
    ] = None
    center_distance_change_mm: Annotated[
        float | None,
        typer.Option(help="Change of the center distance in mm; default: the value nearest to 0."),
    ] = None


@dataclass(frozen=True)
class _FmuOptions:
    """Start values of an exported FMU."""

    damping_n_s_per_m: Annotated[
        float, typer.Option(help="Start value of an FMU's mesh damping along the line of action in N s/m.")
    ] = 0.0
    backlash_um: Annotated[
        float | None,
        typer.Option(help="Backlash of an FMU with coast flanks, along the transverse line of action in µm."),
    ] = None


@dataclass(frozen=True)
class _RunPart:
    """Options that choose the exported part of a run."""

    function: Annotated[
        str,
        typer.Option(
            help="Exported from a run: time, spectrum (over frequency) or orders (over mesh orders)."
        ),
    ] = "time"
    start: Annotated[
        float | None, typer.Option("--from", help="Start time of the exported part of a run in s.")
    ] = None
    end: Annotated[
        float | None, typer.Option("--to", help="End time of the exported part of a run in s.")
    ] = None


@verbs.command(
    "export",
    rich_help_panel="results",
    epilog="Example: loa export examples/palermo_spur_20_20.toml --torque 100 -o deformed",
)
@computing
@overridable("case")
@grouped
def _export(
    *,
    case: Annotated[
        InputFile,
        file_argument("Case file; STE database for an FMU; a run; with --rexs a table or deflection", "CASE"),
    ],
    output: Annotated[
        Path,
        to_file(
            "Folder for pinion.vtu and wheel.vtu, or MESH.fmu; for a run .unv or .csv; "
            "with --rexs .rexs, .rexsj or .rexsz."
        ),
    ],
    point: _LoadPoint,
    at: Annotated[str, typer.Option(help="Positions of the driving gear in base pitches.")] = "0",
    beside: Annotated[
        int, typer.Option(min=0, max=100, help="Unloaded teeth to show on either side, in three dimensions.")
    ] = 1,
    rexs: Annotated[
        Path | None,
        typer.Option(help="REXS file of the unit to which the results are added."),
    ] = None,
    library: Annotated[
        str, typer.Option("--for", help="Mesh stiffness of a table for: ross, opentorsion or json.")
    ] = "",
    fmu: _FmuOptions,
    part: _RunPart,
    json: AsJson = False,
) -> None:
    """Write bent gears, the mesh force as FMU, mesh stiffness, results into REXS, a run as UFF or CSV."""
    further = asdict(fmu) | asdict(part) | {"library": library}
    export.run_export(case, output, asdict(point), rexs, at=at, beside=beside, as_json=json, **further)
