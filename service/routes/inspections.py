"""Gears as made: measured by an inspection, or drawn within a class of ISO 1328-1."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter, Request
from pydantic import Field
from starlette.responses import Response

from lineofaction.gearbox.schemas.model import BoundaryModel
from service.access.holder import Scope
from service.routes.cases import READING_FAILURES, CaseBody, CaseRequest, read_by
from service.routes.context import Ctx
from service.routes.openapi import documented
from service.routes.scopes import ScopedRoute, needs

router = APIRouter(tags=["cases"], route_class=ScopedRoute)


class InspectionInput(BoundaryModel):
    """The sheet of an inspection, and how its gear is mounted."""

    csv: str = Field(
        min_length=1,
        max_length=16_000_000,
        description="The sheet, CSV or the curve file of a machine (docs/how-to/measured-gear.md)",
        examples=["tooth,flank,trace,deviation_um\n1,right,pitch,0.0\n"],
    )
    gear: Literal["pinion", "wheel"] = Field(description="The gear that was inspected", examples=["pinion"])
    loaded: Literal["left", "right"] = Field(
        default="right", description="Flanks of the inspected gear that carry the load", examples=["right"]
    )
    cutoff_mm: float | None = Field(
        default=None,
        gt=0.0,
        le=1000.0,
        description="Cut-off of the filter in mm; left out: a thirtieth of the trace",
        examples=[0.8],
    )


class AsMadeRequest(CaseRequest):
    """A case, and its gears as made: measured, or drawn within a class."""

    measured: InspectionInput | None = Field(
        default=None, description="The inspection of one gear; left out: both are drawn", examples=[None]
    )
    tolerance_class: int = Field(
        default=6, ge=1, le=11, description="Class of ISO 1328-1:2013 of gears that are drawn", examples=[6]
    )
    seed: int = Field(
        default=0, ge=0, le=2**53 - 1, description="Seed of the draw; equal seeds, equal gears", examples=[1]
    )


class AsMadeBody(CaseBody):
    """A case of gears as made."""

    left_out: list[str] = Field(
        description="Values that the machine printed otherwise than recomputed; points of the loaded "
        "flanks that are left out, and why"
    )


@router.post(
    "/cases/as-made",
    summary="State what gears are as made",
    response_model=AsMadeBody,
    responses=documented(*READING_FAILURES),
)
@needs(Scope.READ, body=AsMadeRequest)
async def case_as_made(body: AsMadeRequest, context: Ctx, request: Request) -> Response:
    """Return the case with one gear as its inspection measured it, or both drawn within a class."""
    return await read_by(context, "service.reading.sheets:case_as_made", body, request)
