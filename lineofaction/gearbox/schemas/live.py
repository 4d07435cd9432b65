"""Other flanks, another load and alignment for the gears of a stored database; and a case to be planned."""

from __future__ import annotations

from typing import Annotated, Any, Optional

from pydantic import Field, Strict, create_model

from fe_contact.flank.modification import FlankModification
from lineofaction.gearbox.schemas.case import Case, Load
from lineofaction.gearbox.schemas.declared import figures
from lineofaction.gearbox.schemas.gear import ToothingInput
from lineofaction.gearbox.schemas.model import BoundaryModel


def _left_out(name: str) -> Any:
    """Return a field of a gear that may be left out: it is then as in the case."""
    field = ToothingInput.model_fields[name]
    kind: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    text = f"{field.description}; left out: as in the case"
    return Optional[kind], Field(default=None, description=text, examples=field.examples)  # noqa: UP045


FlankChange = create_model(
    "FlankChange",
    __base__=BoundaryModel,
    __doc__="Flank modifications of one gear; > 0 is material removed.",
    **{figure.field: _left_out(figure.field) for figure in figures(FlankModification)},
)

Torques = Annotated[tuple[Load, ...], Strict(False), Field(min_length=1, max_length=16)]
Caller = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,64}$")]


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
        description="Gap growth in um over the common face width in the plane of action, zero at mid-face",
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
    condense: bool = Field(
        default=False,
        description="Compute the compliance first if it is not in the cache of this service, as for gears "
        "analyzed on another machine (otherwise refused, not-analysed). After a minute, repeat "
        "the request to continue",
        examples=[False],
    )
    caller: Caller | None = Field(
        default=None,
        description="Name of the caller; a later request of the same caller replaces its waiting one",
        examples=["slider-1"],
    )


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


class PlanRequest(BoundaryModel):
    """The body of an execution of analyze, planned instead of run."""

    inputs: PlanInputs = Field(description="Inputs of the plan")
    caller: Caller | None = Field(
        default=None,
        description="Name of the caller; a later request of the same caller replaces its waiting one",
        examples=["form-1"],
    )
