"""The inputs of a sensitivity study."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from lineofaction.gearbox.schemas.model import BoundaryModel, refuse

Misalignment = Annotated[float, Field(ge=-10_000.0, le=10_000.0)]
Percent = Annotated[float, Field(ge=-10.0, le=10.0)]


class Inputs(BoundaryModel):
    """Misalignments and changes of the center distance, varied one at a time; zero is always added."""

    misalignment_um: Annotated[tuple[Misalignment, ...], Strict(False)] = Field(
        default=(0.0, 15.0, 30.0, 45.0, 60.0),
        title="Misalignments, µm",
        min_length=1,
        max_length=64,
        description="Misalignments in um, increasing",
        examples=[[0.0, 30.0]],
    )
    center_distance_change_percent: Annotated[tuple[Percent, ...], Strict(False)] = Field(
        default=(-0.2, -0.1, 0.0, 0.1, 0.2),
        title="Changes of the center distance, %",
        min_length=1,
        max_length=64,
        description="Changes of the center distance in per cent of the nominal one, increasing",
        examples=[[0.0, 0.1]],
    )

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        """Both are axes."""
        for name in ("misalignment_um", "center_distance_change_percent"):
            values = getattr(self, name)
            if any(b <= a for a, b in pairwise(values)):
                refuse(name, list(values), "strictly increasing", "Sort the list and drop repeats.")
        return self
