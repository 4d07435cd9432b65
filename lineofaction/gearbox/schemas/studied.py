"""The subjects and variables of studies: a case or a scene, speeds, orders."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import ConfigDict, Field, model_validator

from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.model import HASH, BoundaryModel, Row, refuse, refuse_unsorted
from lineofaction.gearbox.schemas.rules import absent, all_of, both, exactly_one_of, required
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.spelling import Spelling

MAX_SPEEDS = 10_000
Speed = Annotated[float, Field(ge=0.0, le=1e7)]
TurningSpeed = Annotated[float, Field(gt=0.0, le=1e7)]
Orders = Annotated[int, Field(ge=1, le=100)]
RunHash = Annotated[str, Field(pattern=HASH)]
_OF_RUN = both(required("run"), {"properties": {"speed_rpm": {"maxItems": 0}}})
_OVER_SPEEDS = both(absent("run"), {"required": ["speed_rpm"], "properties": {"speed_rpm": {"minItems": 1}}})
Factor = Annotated[float, Field(ge=0.05, le=20.0)]
Factors = Row[Factor]
RANGES = ("housing_damping", "housing_frequency", "mount_stiffness", "bearing_stiffness", "mesh_damping")
"""Copy of the names in `dynamics.noise.GUESSES`. Importing that module takes longer than a service takes to
start."""


class OverSpeeds(BoundaryModel):
    """Inputs of a study over speeds.

    `at_rest` says whether the study also has an answer without speeds. `usual_speeds` is the number of speeds
    by default: with fewer, peaks of modes damped by 1 % are missed.
    """

    at_rest: ClassVar[bool] = False
    usual_speeds: ClassVar[int] = 600
    speed_rpm: Row[float]

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        refuse_unsorted("speed_rpm", self.speed_rpm, count=8)
        return self


class OverOrders(OverSpeeds):
    """Inputs of a study of mesh orders over speeds at which the shafts turn."""

    speed_rpm: Row[TurningSpeed] = Field(
        min_length=1,
        max_length=MAX_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing",
        examples=[[300.0, 600.0, 900.0]],
    )
    orders: Orders = Field(default=10, description="Harmonics of the mesh frequency", examples=[10])


class OverSpeedsOrRun(OverOrders):
    """Inputs of a study of mesh orders in the linear response over speeds, or in a run at its own speeds."""

    model_config = ConfigDict(json_schema_extra=all_of({"oneOf": [_OF_RUN, _OVER_SPEEDS]}))

    speed_rpm: Row[TurningSpeed] = Field(
        default=(),
        max_length=MAX_SPEEDS,
        description="Speeds of the first driven shaft in rpm, increasing; a run has its own",
        examples=[[300.0, 600.0, 900.0]],
    )
    run: Annotated[RunHash | None, Spelling("--run", file=True)] = Field(
        default=None,
        description="Run of the scene whose bearing forces are taken in place of the linear response, at its "
        "speeds",
    )

    @model_validator(mode="after")
    def _speeds_or_run(self) -> Self:
        if self.run is not None and self.speed_rpm:
            first = list(self.speed_rpm)[:8]
            refuse("speed_rpm", first, "left out with a run", "The run has its own speeds.")
        if self.run is None and not self.speed_rpm:
            refuse("speed_rpm", [], "at least one speed, if no run is given", "For example 300, 600 and 900.")
        return self


class CaseOrScene(BoundaryModel):
    """A case or a scene, exactly one."""

    model_config = ConfigDict(json_schema_extra=all_of(exactly_one_of("case", "scene")))

    case: Case | None = Field(default=None, description="The case, as in a case file; alternative to a scene")
    scene: SceneInput | None = Field(
        default=None,
        description="The scene, with cases written out or databases by hash; alternative to a case",
    )

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.case is None) == (self.scene is None):
            value = None if self.case is None else "beside a scene"
            refuse("case", value, "given without a scene, left out beside one", "Give one of them.")
        return self
