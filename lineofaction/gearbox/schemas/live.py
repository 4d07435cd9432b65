"""Live questions: other flanks and loads for the gears of a stored database; plans."""

from __future__ import annotations

from typing import Annotated, Any, Optional

from pydantic import Field, create_model

from fe_contact.flank.modification import FlankModification
from lineofaction.gearbox.schemas.case import Case, Load
from lineofaction.gearbox.schemas.declared import figures
from lineofaction.gearbox.schemas.gear import ToothingInput
from lineofaction.gearbox.schemas.model import BoundaryModel, Listed, Name

Torques = Annotated[Listed[Load], Field(min_length=1, max_length=16)]
Caller = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$")]
_CALLER = (
    "Name of a series of requests within the access key; a later one replaces the one that waits, and stops "
    "the one that is answered"
)


def _optional_field(name: str) -> Any:
    """Return a field of a gear that may be left out: it is then as in the case."""
    field = ToothingInput.model_fields[name]
    kind: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    text = f"{field.description}; left out: as in the case"
    return Optional[kind], Field(default=None, description=text, examples=field.examples)  # noqa: UP045


FlankChange = create_model(
    "FlankChange",
    __base__=BoundaryModel,
    __doc__="Flank modifications of one gear; > 0 is material removed.",
    **{figure.field: _optional_field(figure.field) for figure in figures(FlankModification)},
)


class LiveInput(BoundaryModel):
    """The differences from the case of the database."""

    torque_n_m: Torques = Field(
        description="Torques on the driving gear in N m, increasing, at most twice the highest of the case",
        examples=[[100.0]],
    )
    misalignment_um: float = Field(
        default=0.0,
        ge=-10_000.0,
        le=10_000.0,
        description="Tilt of the axes in the plane of action: gap growth in µm over the common face width",
        examples=[0.0],
    )
    center_distance_change_mm: float = Field(
        default=0.0,
        ge=-10.0,
        le=10.0,
        description="Change of the center distance in mm; each new one is assembled first (0.2 to 1 s)",
        examples=[0.0],
    )
    pinion: FlankChange = Field(  # type: ignore[valid-type]
        default=FlankChange(),
        description="Modifications of the driving gear",
        examples=[{"tip_relief_um": 10.0}],
    )
    wheel: FlankChange = Field(  # type: ignore[valid-type]
        default=FlankChange(),
        description="Modifications of the driven gear",
        examples=[{"tip_relief_um": 10.0}],
    )
    derivatives: bool = Field(
        default=False,
        description="Also return the derivatives of every curve by modifications, misalignment and torque, "
        "and by the flanks point by point",
        examples=[True],
    )
    flanks: bool = Field(
        default=False,
        description="Also return pressure over the driving gear's flank, load over the face and K_Hbeta",
        examples=[True],
    )
    passage: bool = Field(
        default=False,
        description="Also return what a pair of teeth meets on its way through the mesh: pressure and "
        "deflection along its contact line",
        examples=[True],
    )
    tolerance_class: int | None = Field(
        default=None,
        ge=1,
        le=11,
        description="Also draw pairs within this class of ISO 1328-1:2013 (`band`), at one torque and where "
        "teeth are alike. Every answer solves some; repeat the request until `solved` is `of`",
        examples=[6],
    )
    preview: bool = Field(
        default=False,
        description="Answer at every other position and without errors, at a half to a third of the cost: "
        "for a slider that moves",
        examples=[True],
    )
    condense: bool = Field(
        default=False,
        description="Compute the compliance first if it is not in the cache of this service, as for gears "
        "analyzed on another machine (otherwise refused, not-analysed). After a minute, repeat "
        "the request to continue",
        examples=[False],
    )
    caller: Caller | None = Field(default=None, description=_CALLER, examples=["slider-1"])


class PlanRequest(BoundaryModel):
    """The body of an execution of analyze, planned instead of run."""

    class PlanInputs(BoundaryModel):
        """The case to plan."""

        case: Case = Field(description="The case, as in a case file")
        time_budget_s: float | None = Field(
            default=None,
            gt=0.0,
            le=1e6,
            description="Budget in CPU seconds, in addition to a tolerance or a level of the case",
            examples=[30.0],
        )
        study: Name | None = Field(
            default=None,
            description="Name of a study of the case whose cost is predicted too, with its usual inputs",
            examples=["optimize"],
        )

    inputs: PlanInputs = Field(description="Inputs of the plan")
    caller: Caller | None = Field(default=None, description=_CALLER, examples=["form-1"])
