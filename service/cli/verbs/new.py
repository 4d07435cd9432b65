"""The verb that writes first files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.guard import guarded

verbs = typer.Typer()

Module = Annotated[float | None, typer.Option(min=0.05, max=100.0, help="Normal module in mm.")]
Teeth = Annotated[int | None, typer.Option(min=6, max=500, help="Teeth of the pinion, or of the sun.")]
Ratio = Annotated[float | None, typer.Option(min=1.0, max=50.0, help="Speed ratio, driving to driven gear.")]
Helix = Annotated[float | None, typer.Option(min=-45.0, max=45.0, help="Helix angle in deg.")]
Width = Annotated[float | None, typer.Option(min=0.05, max=5000.0, help="Face width in mm.")]
NewFile = Annotated[
    Path | None, typer.Option("-o", "--output", help="New file to write (TOML); default: print it.")
]


@verbs.command(epilog="Example: loa new --helical --module 1.8 --teeth 23 --ratio 2.9 -o pair.toml")
@guarded
def new(
    spur: Annotated[bool, typer.Option("--spur", help="A spur pair.")] = False,
    helical: Annotated[bool, typer.Option("--helical", help="A helical pair (default).")] = False,
    internal: Annotated[bool, typer.Option("--internal", help="A pinion in a ring gear.")] = False,
    planetary: Annotated[bool, typer.Option("--planetary", help="A planetary stage, as a scene.")] = False,
    scene: Annotated[bool, typer.Option("--scene", help="A helical pair between shafts.")] = False,
    module: Module = None,
    teeth: Teeth = None,
    ratio: Ratio = None,
    helix: Helix = None,
    width: Width = None,
    output: NewFile = None,
) -> None:
    """Write a first case or scene file; rules set all data that are not given."""
    from service.cli.new.run import run_new  # noqa: PLC0415 (start-up time)
    from service.cli.new.sketch import Wanted  # noqa: PLC0415

    kinds = {"spur": spur, "helical": helical, "internal": internal, "planetary": planetary, "scene": scene}
    run_new(kinds, Wanted(module, teeth, ratio, helix, width), output)
