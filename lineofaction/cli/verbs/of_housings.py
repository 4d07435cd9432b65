"""Arguments, help and example of the verb that reads housings from STEP files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lineofaction.cli.guard import computing
from lineofaction.cli.options import AsJson, to_file
from lineofaction.cli.overrides import SceneFile, overridable
from lineofaction.cli.verbs import Later

if TYPE_CHECKING:
    from lineofaction.cli import housing
else:
    housing = Later("cli.housing")

verbs = typer.Typer()


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
    x_axis: Annotated[
        str | None, typer.Option(help="Direction of the file's x axis in the scene, x,y,z.")
    ] = None,
    z_axis: Annotated[
        str | None, typer.Option(help="Direction of the file's z axis in the scene, x,y,z.")
    ] = None,
    output: Annotated[
        Path | None,
        to_file("Scene with the housing to write, the STEP file beside it; of a folder, default: its scene."),
    ] = None,
    json: AsJson = False,
) -> None:
    """Make the solid of a STEP file the housing of a scene: bearing seats from its bores, and its foot."""
    placed = {"origin_mm": origin_mm, "x_axis": x_axis, "z_axis": z_axis}
    housing.run_housing(scene, step, material, stands_on, placed, output, as_json=json)
