"""Queries of a stored database: batches of position and deflection."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Discriminator, Field, Strict, Tag, model_validator

from lineofaction.gearbox.schemas.model import BoundaryModel, refuse

ONE, MANY = Tag("[one]"), Tag("[many]")
"""Tags of the two types; the names in brackets do not appear in the field of a fault."""
ONE_OR_MANY = Discriminator(lambda value: (MANY if isinstance(value, list | tuple) else ONE).tag)
"""Choice of the type by the value, so that a fault is about the intended type."""
MAX_POINTS = 100_000
LIMITS: dict[str, float] = {
    "position": 1e9,
    "deflection_um": 1e6,
    "misalignment_um": 1e4,
    "center_distance_change_mm": 100.0,
}
"""Largest magnitude of each column of a query; the columns in their order."""

VALIDITY = ("lifted_off", "above_table", "outside_misalignment", "outside_center_distance")
"""Names of the bits of a validity, the lowest first."""

_List = (Strict(False), Field(min_length=1, max_length=MAX_POINTS, fail_fast=True))


def validity_text(flags: int) -> str:
    """Return flags in words, such as inside or above_table+outside_misalignment."""
    return "+".join(word for bit, word in enumerate(VALIDITY) if flags >> bit & 1) or "inside"


def _limit(name: str) -> Any:
    return Field(ge=-LIMITS[name], le=LIMITS[name])


_Positions = Annotated[tuple[Annotated[float, _limit("position")], ...], *_List]
_Deflections = Annotated[tuple[Annotated[float, _limit("deflection_um")], ...], *_List]
_Misalignment = Annotated[float, _limit("misalignment_um")]
_Change = Annotated[float, _limit("center_distance_change_mm")]
_Misalignments = Annotated[
    Annotated[_Misalignment, ONE] | Annotated[tuple[_Misalignment, ...], *_List, MANY], ONE_OR_MANY
]
_Changes = Annotated[Annotated[_Change, ONE] | Annotated[tuple[_Change, ...], *_List, MANY], ONE_OR_MANY]


class QueryInput(BoundaryModel):
    """Points at which the mesh force is requested; a list of one value serves for all points."""

    position: _Positions = Field(
        description="Positions by the driving gear in base pitches, 0 = pitch point",
        examples=[[0.0, 0.25]],
    )
    deflection_um: _Deflections = Field(
        description="Deflections along the line of action in µm", examples=[[5.0, 7.5]]
    )
    misalignment_um: _Misalignments = Field(
        default=0.0, description="Misalignment in µm, one value or one per point", examples=[0.0]
    )
    center_distance_change_mm: _Changes = Field(
        default=0.0,
        description="Change of the center distance in mm, one value or one per point",
        examples=[0.0],
    )

    @model_validator(mode="after")
    def _same_length(self) -> Self:
        """Refuse lists of different lengths, except lists of a single value."""
        points = len(self.position)
        for name in tuple(LIMITS)[1:]:  # all but the position
            values = getattr(self, name)
            count = len(values) if isinstance(values, tuple) else 1
            if points == 1:
                points = count
            elif count not in (1, points):
                bound = f"a list of {points} values, like position, or of one"
                remedy = "Give as many values in every list, or one for all points."
                refuse(name, f"{count} values", bound, remedy)
        return self


class QueryOutput(BoundaryModel):
    """The mesh force at the points requested."""

    force_n: list[float] = Field(description="Transverse mesh force F_bt in N", examples=[[1834.2, 2651.8]])
    stiffness_n_per_um: list[float] = Field(
        description="Tangent dF/d(deflection) in N/µm", examples=[[371.5, 402.3]]
    )
    validity: list[str] = Field(
        description="inside, or lifted_off, above_table, outside_misalignment, outside_center_distance "
        "joined by +",
        examples=[["inside", "inside"]],
    )
    force_error_n: list[float | None] | None = Field(
        default=None,
        description="Error of the force in N: that of the transmission error at the point, interpolation "
        "between the nodes of the table included, times the stiffness; null: not estimated there",
        examples=[[4.1, 5.0]],
    )
