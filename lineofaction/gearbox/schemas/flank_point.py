"""The load and the alignment at which the flanks of a case are looked at."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.rules import all_of, at_most_one_of
from lineofaction.gearbox.schemas.spelling import Spelling


class FlankPoint(BoundaryModel):
    """One load and one alignment; the case supplies the fields that are left out."""

    model_config = ConfigDict(json_schema_extra=all_of(at_most_one_of("torque_n_m", "normal_force_n")))

    torque_n_m: Annotated[float | None, Spelling("--torque")] = Field(
        default=None,
        title="Torque on the pinion, N m",
        ge=1e-9,
        le=1e9,
        description="Torque on the driving gear in N m; left out, with no force: the highest of the case",
        examples=[100.0],
    )
    normal_force_n: Annotated[float | None, Spelling("--force")] = Field(
        default=None, ge=1e-9, le=1e9, description="Normal tooth force in N, instead of a torque"
    )
    misalignment_um: float | None = Field(
        default=None,
        title="Misalignment, µm",
        ge=-10_000.0,
        le=10_000.0,
        description="Misalignment in µm; left out: the case's value nearest to 0",
    )
    center_distance_change_mm: float | None = Field(
        default=None,
        ge=-10.0,
        le=10.0,
        description="Change of the center distance in mm; left out: the case's value nearest to 0",
    )

    @model_validator(mode="after")
    def _one_load(self) -> Self:
        if self.torque_n_m is not None and self.normal_force_n is not None:
            remedy = "Give a torque or a normal force."
            refuse("normal_force_n", self.normal_force_n, "left out when torque_n_m is given", remedy)
        return self
