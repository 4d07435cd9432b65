"""What the caller of ``loa new`` says of a pair, as its options."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer


@dataclass(frozen=True)
class Wanted:
    """What the caller says, each field an option; None is by rule. Lengths in mm, angles in deg."""

    module: Annotated[float | None, typer.Option(min=0.05, max=100.0, help="Normal module in mm.")] = None
    teeth: Annotated[int | None, typer.Option(min=6, max=500, help="Teeth of the pinion, or of the sun.")] = (
        None
    )
    ratio: Annotated[
        float | None, typer.Option(min=1.0, max=50.0, help="Speed ratio, driving to driven gear.")
    ] = None
    helix: Annotated[float | None, typer.Option(min=-45.0, max=45.0, help="Helix angle in deg.")] = None
    width: Annotated[float | None, typer.Option(min=0.05, max=5000.0, help="Face width in mm.")] = None
