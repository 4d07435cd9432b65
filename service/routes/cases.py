"""Cases before anything is computed: examples, drawing, TOML in and out."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field, Strict
from starlette.responses import JSONResponse, Response

from lineofaction.gearbox.convert.toml import toml_text
from lineofaction.gearbox.problems import LiveUnavailable, QueueFull, TooLarge, TooManyHeld
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.file_content import FileContentInput
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.named import Named
from lineofaction.gearbox.schemas.outline import OutlineBody
from lineofaction.gearbox.schemas.reading import validated
from service.access import Scope
from service.live.order import LiveOrder
from service.page.examples import Example, examples
from service.routes.context import Context, Ctx, key_of
from service.routes.media_types import JSON
from service.routes.refusals import documented
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import ExampleBody
from service.worker.catalogue import ANALYZE
from service.worker.process import on_demand

READING_FAILURES = (TooLarge, TooManyHeld, QueueFull, LiveUnavailable)
"""What a reader of foreign bytes answers beside faults of the bytes."""
_MOST_FILES = 16

router = APIRouter(tags=["cases"], route_class=ScopedRoute)
case_json, outline_json = (
    on_demand(f"lineofaction.gearbox.convert.{name}") for name in ("case:case_json", "outline:outline_json")
)


class CaseInputs(BoundaryModel):
    """A case."""

    case: Case = Field(description="The case, as in a case file")


class CaseRequest(BoundaryModel):
    """A case, where an execution of analyze has it."""

    inputs: CaseInputs = Field(description="The case, as in an execution of analyze")


class TomlBody(BoundaryModel):
    """The text of a case file."""

    toml: str = Field(max_length=4_000_000, description="TOML", examples=["[pair]\nnormal_module_mm = 4.0\n"])


class CaseText(TomlBody):
    """The text of a case file, and the files that it names."""

    files: Annotated[tuple[FileContentInput, ...], Strict(False)] = Field(
        default=(),
        max_length=_MOST_FILES,
        description="The files that the text names, found by their names without folders",
        examples=[[]],
    )


class CaseBody(BaseModel):
    """A case with all defaults."""

    case: Annotated[dict[str, Any], Named("Case")]


@router.get("/examples", summary="Example cases")
@needs(Scope.READ)
def example_cases() -> list[ExampleBody]:
    """List the pairs that the page offers."""
    return [_example(example) for example in examples()]


@router.post("/cases/outline", summary="Drawing of the two gears", response_model=OutlineBody)
@needs(Scope.READ)
def case_outline(body: CaseRequest) -> Response:
    """Transverse outlines of both gears in mm, the path of contact, and the figures of the pair."""
    return JSONResponse(outline_json(body.inputs.case))


@router.post(
    "/cases/from-toml",
    summary="Read a case file",
    response_model=CaseBody,
    responses=documented(*READING_FAILURES),
)
@needs(Scope.READ)
async def case_from_toml(body: CaseText, context: Ctx, request: Request) -> Response:
    """Read the case in a file's text and in the files that it names, with all defaults."""
    return await read_by(
        context, LiveOrder("service.reading.texts:case_of_toml", body.model_dump(mode="json")), request
    )


async def read_by(context: Context, order: LiveOrder, request: Request) -> Response:
    """Answer what a reader of foreign bytes finds, for the caller of a request."""
    caller = key_of(request)
    answer = context.reader.ask(order, None if caller is None else caller.name)
    return Response(await asyncio.wrap_future(answer), media_type=JSON)


@router.post("/cases/to-toml", summary="Write a case file")
@needs(Scope.READ)
def case_to_toml(body: CaseRequest) -> TomlBody:
    """Write the case with all defaults as a file's text."""
    return TomlBody(toml=toml_text(case_json(body.inputs.case)))


def _example(example: Example) -> ExampleBody:
    case = case_json(validated(Case, example.content))
    facts = {"name": example.name, "title": example.title, "note": example.note}
    return ExampleBody(**facts, case=case, hash=ANALYZE.key({"case": case}))


def explained(handler: Any, model: type[BaseModel]) -> None:
    """Name the model that explains refused fields."""
    handler.body_model = model


explained(case_outline, CaseRequest)
explained(case_from_toml, CaseText)
explained(case_to_toml, CaseRequest)
