"""Questions about a draft, as it is typed: drawing, plan, curves, text, gears as made; faults are an answer.

A draft is a case or a scene that a user is still typing, so that it has faults most of the time. A browser
logs every refused request as an error of the page. Therefore these routes answer faults of fields with the
status 200, where the routes of finished inputs refuse them as `BadInput` with 422. Other errors are refused.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastapi import APIRouter, Request
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from pydantic import BaseModel, Field
from starlette.responses import JSONResponse, Response

from lineofaction.gearbox.problems import BadInput, ServiceError
from service.routes import queries
from service.routes.offers import ROUTERS
from service.routes.problem_answers import refusal_of
from service.routes.scopes import ScopedRoute
from service.schemas.answers import FaultBody

DRAFTS = {
    "/cases/outline": ("outline", "Drawing of a draft"),
    "/cases/to-toml": ("to-toml", "Case file of a draft"),
    "/cases/as-made": ("as-made", "Gears of a draft as made"),
    "/plans": ("plan", "Plan of a draft"),
    "/databases/{key}/ste": ("{key}/ste", "Transmission error of drafted flanks"),
    "/scenes/to-files": ("scene", "Text of a drafted scene"),
    "/scenes/from-toml": ("scene-text", "Scene of a drafted text"),
    "/scenes/housing-surface": ("housing-surface", "Surface of drafted housings"),
}
"""Path of a question about a finished input, to the path below `/drafts` and the summary of the same question
about a draft."""


class FaultsBody(BaseModel):
    """The faults of a draft."""

    detail: str = Field(description="All faults in words")
    faults: list[FaultBody] = Field(description="Each fault: field, value, bound, suggestion")


class DraftRoute(ScopedRoute):
    """A route of questions about drafts: faults of the draft are an answer."""

    def admitted_handler(self) -> Callable[[Request], Any]:
        """Return the handler that answers with the result or with the faults."""
        answer = super().admitted_handler()

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
    """Return the faults of a draft as an answer; raises `refusal` if it is not about fields of the draft."""
    problem = refusal.as_json()
    # the field "body": the request itself is malformed, for example no JSON
    is_malformed = "body" in (fault["field"] for fault in problem["errors"])
    if is_malformed or problem["type"] != BadInput.type:  # the type: a live worker sends problem details
        raise refusal
    return JSONResponse({"detail": problem["detail"], "faults": problem["errors"]})


router = APIRouter(tags=["drafts"], route_class=DraftRoute)


def _add(route: APIRoute) -> None:
    """Add the route of `/drafts` that answers the question of `route` about a draft."""
    path, summary = DRAFTS[route.path]
    router.add_api_route(
        f"/drafts/{path}",
        route.endpoint,
        methods=["POST"],
        name="draft_" + path.removeprefix("{key}/").replace("-", "_"),
        summary=summary,
        description=f"Answer as `/v1{route.path}`, or with what is wrong.",
        response_model=route.response_model | FaultsBody,
        responses=route.responses,
    )


for question in (route for router in (*ROUTERS, queries.live_router) for route in router.routes):
    if isinstance(question, APIRoute) and question.path in DRAFTS:
        _add(question)
