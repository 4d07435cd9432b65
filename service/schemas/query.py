"""Batches of position and deflection asked of a stored database."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from service.schemas.model import BoundaryModel, refuse

_MOST_POINTS = 100_000
Position = Annotated[float, Field(ge=-1e9, le=1e9)]
Deflection = Annotated[float, Field(ge=-1e6, le=1e6)]


class QueryInput(BoundaryModel):
    """Points at which the mesh force is asked for; a list of one value serves for all points."""

    position: Annotated[tuple[Position, ...], Strict(False)] = Field(
        min_length=1,
        max_length=_MOST_POINTS,
        description="Positions by the driving gear in base pitches, 0 = pitch point",
        examples=[[0.0, 0.25]],
    )
    deflection_um: Annotated[tuple[Deflection, ...], Strict(False)] = Field(
        min_length=1,
        max_length=_MOST_POINTS,
        description="Deflections along the line of action in um",
        examples=[[5.0, 7.5]],
    )
    misalignment_um: float = Field(
        default=0.0, ge=-10_000.0, le=10_000.0, description="Misalignment in um", examples=[0.0]
    )
    center_distance_change_mm: float = Field(
        default=0.0, ge=-100.0, le=100.0, description="Change of the centre distance in mm", examples=[0.0]
    )

    @model_validator(mode="after")
    def _same_length(self) -> Self:
        """Both lists of one length, or one of them a single value."""
        lengths = {len(self.position), len(self.deflection_um)} - {1}
        if len(lengths) > 1:
            refuse(
                "deflection_um",
                f"{len(self.deflection_um)} values",
                f"a list of {len(self.position)} values, like position, or of one",
                "Give as many deflections as positions.",
            )
        return self


class QueryOutput(BoundaryModel):
    """The mesh force at the points asked for."""

    force_n: list[float] = Field(description="Transverse mesh force F_bt in N", examples=[[1834.2, 2651.8]])
    stiffness_n_per_um: list[float] = Field(
        description="Tangent dF/d(deflection) in N/um", examples=[[371.5, 402.3]]
    )
    validity: list[str] = Field(
        description="inside, or lifted_off, above_table, outside_misalignment ... joined by +",
        examples=[["inside", "inside"]],
    )
