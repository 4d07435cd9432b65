"""Load cases under which a gearbox is deflected."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, Strict, model_validator

from dynamics.settings.case_force import CaseForce
from dynamics.settings.load_case import LoadCase
from lineofaction.gearbox.schemas.declared import declared_in, with_fields
from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.rules import own_or_factor, stated
from lineofaction.gearbox.schemas.scene_loads import ACTING, Vector
from lineofaction.gearbox.schemas.scene_types import Name

MOST_CASES = 64
MOST_FORCES = 256


@with_fields(declared_in(CaseForce))
class CaseForceInput(BoundaryModel):
    """A force of the scene under a load case: its own force and moment, or a factor on the scene's."""

    model_config = ConfigDict(json_schema_extra=stated(own_or_factor(*ACTING)))

    name: Name = Field(description="Name of the force in the scene", examples=["belt"])
    force_n: Vector | None = Field(
        default=None,
        description="Force in x, y, z in N; left out: the scene's",
        examples=[[0.0, 800.0, 0.0]],
    )
    moment_n_m: Vector | None = Field(
        default=None,
        description="Moment about x, y and +z in N m; left out: the scene's",
        examples=[[0.0, 0.0, 20.0]],
    )


CaseForces = Annotated[tuple[CaseForceInput, ...], Strict(False), Field(max_length=MOST_FORCES)]


@with_fields(declared_in(LoadCase))
class LoadCaseInput(BoundaryModel):
    """A load of the scene and the share of its duration."""

    name: Name = Field(description="Name of the load case", examples=["cruise"])
    forces: CaseForces = Field(
        default=(),
        description="Forces of the scene that differ under this load case; the others act as in the scene",
        examples=[[{"name": "belt", "force_n": [0.0, 800.0, 0.0]}]],
        exclude_if=lambda forces: not forces,
    )


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
