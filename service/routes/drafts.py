"""Questions about a draft, as it is typed: drawing, plan, curves, text, gears as made; faults are an answer.

A draft is wrong most of the time. A browser logs every refused request as an error of the page, so here what
elsewhere is refused as `BadInput` (422) of fields is answered (200). All else is refused as everywhere.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastapi import APIRouter, Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, Field
from starlette.responses import JSONResponse, Response

from lineofaction.gearbox.problems import (
    BadInput,
    DamagedFile,
    LiveUnavailable,
    NotAnalyzed,
    NotFound,
    QueueFull,
    ServiceError,
    Superseded,
)
from lineofaction.gearbox.schemas.live import LiveInput, LiveOutput, PlanRequest
from lineofaction.gearbox.schemas.plan import OutlineBody, PlanBody
from service.access.keyring import Scope
from service.routes import cases, queries
from service.routes.context import Ctx
from service.routes.middleware import refusal_of
from service.routes.openapi import documented
from service.routes.results import Key
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import FaultBody


class FaultsBody(BaseModel):
    """What is wrong with a draft."""

    detail: str = Field(description="All faults in words")
    faults: list[FaultBody] = Field(description="Each thing wrong: field, value, bound, what to try")


class DraftRoute(ScopedRoute):
    """A route of questions about drafts: it answers what is wrong with one."""

    def answering(self) -> Callable[[Request], Any]:
        """Return what answers, with the result or with the faults."""
        answer = super().answering()

        async def answered(request: Request) -> Response:
            try:
                response: Response = await answer(request)
            except RequestValidationError as error:
                return _faults_of(refusal_of(request, error))
            except ServiceError as error:
                return _faults_of(error)
            return response

        return answered


def _faults_of(refusal: ServiceError) -> Response:
    """Return the answer of faults; raises the refusal of what is no draft, or of a busy service."""
    problem = refusal.as_json()
    of_fields = "body" not in (fault["field"] for fault in problem["errors"])
    if problem["type"] != BadInput.type or not of_fields:  # the type: a live worker sends problem details
        raise refusal
    return JSONResponse({"detail": problem["detail"], "faults": problem["errors"]})


router = APIRouter(tags=["drafts"], route_class=DraftRoute)


@router.post("/drafts/outline", summary="Drawing of a draft", response_model=OutlineBody | FaultsBody)
@needs(Scope.READ, body=cases.CaseRequest)
def draft_outline(body: cases.CaseRequest) -> Response:
    """Answer as `/v1/cases/outline`, or with what is wrong."""
    return cases.case_outline(body)


@router.post("/drafts/to-toml", summary="Case file of a draft", response_model=cases.TomlBody | FaultsBody)
@needs(Scope.READ, body=cases.CaseRequest)
def draft_to_toml(body: cases.CaseRequest) -> cases.TomlBody:
    """Answer as `/v1/cases/to-toml`, or with what is wrong."""
    return cases.case_to_toml(body)


@router.post(
    "/drafts/as-made",
    summary="Gears of a draft as made",
    response_model=cases.AsMadeBody | FaultsBody,
    responses=documented(*cases.READING_FAILURES),
)
@needs(Scope.READ, body=cases.AsMadeRequest)
async def draft_as_made(body: cases.AsMadeRequest, context: Ctx, request: Request) -> Response:
    """Answer as `/v1/cases/as-made`, or with what is wrong."""
    return await cases.case_as_made(body, context, request)


@router.post(
    "/drafts/plan",
    summary="Plan of a draft",
    response_model=PlanBody | FaultsBody,
    responses=documented(QueueFull, Superseded, LiveUnavailable),
)
@needs(Scope.READ, body=PlanRequest)
async def draft_plan(body: PlanRequest, context: Ctx) -> Response:
    """Answer as `/v1/plans`, or with what is wrong."""
    return await queries.plan(body, context)


@router.post(
    "/drafts/{key}/ste",
    summary="Transmission error of drafted flanks",
    response_model=LiveOutput | FaultsBody,
    responses=documented(QueueFull, Superseded, NotAnalyzed, LiveUnavailable, NotFound, DamagedFile),
)
@needs(Scope.READ, body=LiveInput)
async def draft_ste(key: Key, body: LiveInput, context: Ctx) -> Response:
    """Answer as `/v1/databases/{hash}/ste`, or with what is wrong."""
    return await queries.live_ste(key, body, context)


@router.post("/drafts/scene", summary="Text of a drafted scene", response_model=cases.SceneText | FaultsBody)
@needs(Scope.READ, body=cases.SceneRequest)
def draft_scene(body: cases.SceneRequest) -> cases.SceneText:
    """Answer as `/v1/scenes/to-files`, or with what is wrong."""
    return cases.scene_to_files(body)


@router.post(
    "/drafts/scene-text",
    summary="Scene of a drafted text",
    response_model=cases.SceneBody | FaultsBody,
    responses=documented(*cases.READING_FAILURES),
)
@needs(Scope.READ, body=cases.SceneText)
async def draft_scene_text(body: cases.SceneText, context: Ctx, request: Request) -> Response:
    """Answer as `/v1/scenes/from-toml`, or with what is wrong."""
    return await cases.scene_from_toml(body, context, request)
