"""Load cases under which a gearbox is deflected."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from dynamics.settings.load_case import LoadCase
from service.schemas.declared import declared_in, with_fields
from service.schemas.model import BoundaryModel, refuse
from service.schemas.scene_types import Name

MOST_CASES = 64


@with_fields(declared_in(LoadCase))
class LoadCaseInput(BoundaryModel):
    """A load of the scene and the share of its duration."""

    name: Name = Field(description="Name of the load case", examples=["cruise"])


LoadCases = Annotated[tuple[LoadCaseInput, ...], Strict(False), Field(min_length=1, max_length=MOST_CASES)]


class Inputs(BoundaryModel):
    """Load cases, and the positions of the mesh cycle at which the bodies are balanced."""

    load_cases: LoadCases = Field(
        default=(LoadCaseInput(name="load"),),
        description="Load cases; default: the loads of the scene at t = 0",
        examples=[[{"name": "cruise", "share": 0.8, "torque_n_m": 60.0, "speed_rpm": 3000.0}]],
    )
    positions: int = Field(
        default=16,
        ge=1,
        le=512,
        description="Least number of positions of the mesh cycle; every mesh takes each of them once",
        examples=[16],
    )

    @model_validator(mode="after")
    def _differ(self) -> Self:
        """Refuse two cases of one name."""
        names = [case.name for case in self.load_cases]
        if len(set(names)) < len(names):
            refuse("load_cases", names, "names that differ", "Rename one of them.")
        return self
