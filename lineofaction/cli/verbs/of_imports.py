"""Arguments, help and examples of the verbs on files of others: gear units, sheets of inspections."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.options import AsJson, CaseFile, SceneFile, overridable, to_file
from lineofaction.cli.verbs import Later

if TYPE_CHECKING:
    from lineofaction.cli import housing, measured, new
else:
    housing, measured, new = map(Later, ("cli.housing", "cli.measured", "cli.new"))

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
    new.run_open(file, output, assume or (), as_json=json)


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
        Path | None, typer.Argument(help="Traces of the gear (CSV); left out: write those of the case.")
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
    output: Annotated[Path | None, to_file("Case (TOML) or, without a sheet, CSV file to write.")] = None,
    json: AsJson = False,
) -> None:
    """Take pitches, traces and topographies of an inspected gear into a case, every line accounted for."""
    measured.run_measured(case, sheet, (gear, loaded, cutoff_mm), output, as_json=json)


@verbs.command(
    "housing",
    rich_help_panel="gearbox",
    epilog="Example: loa housing gearbox case.step --material cast_aluminum",
)
@computing
@overridable("scene", "scene")
def _housing(
    scene: SceneFile,
    step: Annotated[Path, typer.Argument(help="STEP file of the housing: one solid.")],
    *,
    material: Annotated[str, typer.Option(help="gray_cast_iron, spheroidal_cast_iron or cast_aluminum.")],
    stands_on: Annotated[
        str, typer.Option(help="Side of the scene it stands on, by its outermost flat faces.")
    ] = "-y",
    origin_mm: Annotated[
        str | None,
        typer.Option(help="Origin of the file in the scene, x,y,z in mm; default: found by the bores."),
    ] = None,
    x_axis: Annotated[str | None, typer.Option(help="Its x axis in the scene, x,y,z.")] = None,
    z_axis: Annotated[str | None, typer.Option(help="Its z axis in the scene, x,y,z.")] = None,
    output: Annotated[
        Path | None,
        to_file("Scene with the housing to write, the STEP file beside it; of a folder, default: its scene."),
    ] = None,
    json: AsJson = False,
) -> None:
    """Make the solid of a STEP file the housing of a scene: bearing seats from its bores, and its foot."""
    placed = {"origin_mm": origin_mm, "x_axis": x_axis, "z_axis": z_axis}
    housing.run_housing(scene, step, (material, stands_on), placed, output, as_json=json)
