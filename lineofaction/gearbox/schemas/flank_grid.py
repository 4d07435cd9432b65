"""A free-form flank of the case file: material removed at the nodes of a grid."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from lineofaction.gearbox.schemas.model import BoundaryModel, Listed

Deviation = Annotated[float, Field(ge=-1000.0, le=1000.0)]
_NODES = Field(min_length=2, max_length=500)
_GridAxis = Annotated[Listed[Annotated[float, Field(ge=-10_000.0, le=10_000.0)]], _NODES]
_GridRow = Annotated[Listed[Deviation], _NODES]
EXAMPLE = {
    "roll_length_mm": [4.0, 20.0],
    "face_position_mm": [-12.5, 12.5],
    "removed_um": [[0.0, 0.0], [5.0, 7.0]],
}


class FlankGridInput(BoundaryModel):
    """A free-form flank as a grid: one row of removed material per roll length."""

    roll_length_mm: _GridAxis = Field(
        description="Roll lengths of the rows in mm, increasing", examples=[[4.0, 10.0, 16.0]]
    )
    face_position_mm: _GridAxis = Field(
        description="Distances of the columns from mid-face in mm, increasing", examples=[[-12.5, 12.5]]
    )
    removed_um: Listed[_GridRow] = Field(
        min_length=2,
        max_length=500,
        description="Material removed in µm, a row per roll length",
        examples=[[[0.0, 2.0], [0.0, 0.0], [5.0, 7.0]]],
    )
