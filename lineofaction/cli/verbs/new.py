"""The verbs that write first files: from rules, or from a file of another tool."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lineofaction.cli.guard import computing, guarded
from lineofaction.cli.new.wanted import Wanted
from lineofaction.cli.signature import grouped
from lineofaction.cli.verbs.options import AsJson

verbs = typer.Typer()

_ASSUME = (
    "Set a value over the file's before it is opened, in its unit: 14.helix_angle_reference_diameter=-12; "
    "repeatable."
)

NewFile = Annotated[
    Path | None, typer.Option("-o", "--output", help="New file to write (TOML); default: print it.")
]


@verbs.command(epilog="Example: loa new --helical --module 1.8 --teeth 23 --ratio 2.9 -o pair.toml")
@guarded
@grouped
def new(
    *,
    spur: Annotated[bool, typer.Option("--spur", help="A spur pair.")] = False,
    helical: Annotated[bool, typer.Option("--helical", help="A helical pair (default).")] = False,
    internal: Annotated[bool, typer.Option("--internal", help="A pinion in a ring gear.")] = False,
    planetary: Annotated[bool, typer.Option("--planetary", help="A planetary stage, as a scene.")] = False,
    scene: Annotated[bool, typer.Option("--scene", help="A helical pair between shafts.")] = False,
    wanted: Wanted,
    output: NewFile = None,
) -> None:
    """Write a first case or scene file; rules set all data that are not given."""
    from lineofaction.cli.new.run import run_new  # noqa: PLC0415 (start-up time)

    kinds = {"spur": spur, "helical": helical, "internal": internal, "planetary": planetary, "scene": scene}
    run_new(kinds, wanted, output)


@verbs.command("open", epilog="Example: loa open gearbox.rexs --out gearbox")
@computing
def open_unit(
    file: Annotated[Path, typer.Argument(help="Gear unit as REXS: .rexs, .rexsj, .rexsz or .rexs.zip.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", help="Folder for the files; default: that of the file's name, here."),
    ] = None,
    assume: Annotated[
        list[str] | None,
        typer.Option("--assume", metavar="COMPONENT.ATTRIBUTE=VALUE", help=_ASSUME),
    ] = None,
    json: AsJson = False,
) -> None:
    """Open a gear unit of another tool (REXS): write its cases, its scene and the report of the import."""
    from lineofaction.cli.open import run_open  # noqa: PLC0415 (start-up time)

    run_open(file, out, assume or (), as_json=json)
