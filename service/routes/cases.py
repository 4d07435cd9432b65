"""Cases, scenes and gear units before anything is computed: examples, drawing, TOML in and out, REXS."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field, Strict
from starlette.concurrency import run_in_threadpool
from starlette.responses import JSONResponse, Response

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import LiveUnavailable, QueueFull, TooLarge, TooManyHeld
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.file_content import FileContentInput
from lineofaction.gearbox.schemas.files import side_files
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.named_parts import Named
from lineofaction.gearbox.schemas.outline import OutlineBody
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_text
from service.access.holder import Scope
from service.live.order import LiveOrder
from service.page.example_cases import examples
from service.routes.context import Context, Ctx, asker_of
from service.routes.media_types import JSON
from service.routes.openapi import documented
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import ExampleBody, HousingSurface, UnitBody, UnitFile
from service.version import program_tag
from service.worker.process import ANALYZE

READING_FAILURES = (TooLarge, TooManyHeld, QueueFull, LiveUnavailable)
"""Refusals of a reader of foreign bytes, in addition to faults of the bytes."""
_MAX_FILES = 16
"""Most files that a case or scene may name."""
_MAX_CHARACTERS = 4_000_000
"""Longest text of a case or scene file."""

router = APIRouter(tags=["cases"], route_class=ScopedRoute)
case_json = on_demand("lineofaction.gearbox.convert.case:case_json")
case_as_filed = on_demand("lineofaction.gearbox.convert.case:case_as_filed")
outline_json = on_demand("lineofaction.gearbox.convert.outline:outline_json")
scenes_router = APIRouter(tags=["scenes"], route_class=ScopedRoute)
units_router = APIRouter(tags=["units"], route_class=ScopedRoute)
ENTRY = "lineofaction.gearbox.from_rexs.unit_answer:unit_of_rexs"
"""Function that reads a gear unit, in a process of its own."""


class CaseInputs(BoundaryModel):
    """The inputs that name one case."""

    case: Case = Field(description="The case, as in a case file")


class CaseRequest(BoundaryModel):
    """A case under the name that an execution of analyze has for it."""

    inputs: CaseInputs = Field(description="The case, as in an execution of analyze")


class TomlBody(BoundaryModel):
    """The text of a case file."""

    toml: str = Field(
        max_length=_MAX_CHARACTERS, description="TOML", examples=["[pair]\nnormal_module_mm = 4.0\n"]
    )


class CaseText(TomlBody):
    """The text of a case file, and the files that it names."""

    files: Annotated[tuple[FileContentInput, ...], Strict(False)] = Field(
        default=(),
        max_length=_MAX_FILES,
        description="The files that the text names, found by their names without folders",
        examples=[[]],
    )


class CaseBody(BaseModel):
    """A case with all defaults."""

    case: Annotated[dict[str, Any], Named("Case")]


@router.get("/examples", summary="Example cases")
@needs(Scope.READ)
def example_cases(context: Ctx) -> list[ExampleBody]:
    """List the pairs that the page offers."""
    bodies = []
    for example in examples():
        case = case_json(validated(Case, example.content))
        key = ANALYZE.key({"case": case})
        stored = context.store.holds(key, ANALYZE.kind)
        fields = example._asdict() | {"case": case, "hash": key, "stored": stored}
        bodies.append(ExampleBody.model_validate(fields))
    return bodies


@router.post("/cases/outline", summary="Drawing of the two gears", response_model=OutlineBody)
@needs(Scope.READ, body=CaseRequest)
def case_outline(body: CaseRequest) -> Response:
    """Transverse outlines of both gears in mm, the path of contact, and the figures of the pair."""
    return JSONResponse(outline_json(body.inputs.case))


@router.post(
    "/cases/from-toml",
    summary="Read a case file",
    response_model=CaseBody,
    responses=documented(*READING_FAILURES),
)
@needs(Scope.READ, body=CaseText)
async def case_from_toml(body: CaseText, context: Ctx, request: Request) -> Response:
    """Read the case in a file's text and in the files that it names, with all defaults."""
    return await read_by(context, "service.reading.texts:case_of_toml", body, request)


async def read_by(context: Context, entry: str, body: BaseModel, request: Request) -> Response:
    """Return the answer of a reader of foreign bytes for a body; `entry` names its function."""
    answer = context.reader.ask(LiveOrder(entry, body.model_dump(mode="json")), asker_of(request))
    return Response(await asyncio.wrap_future(answer), media_type=JSON)


@router.post("/cases/to-toml", summary="Write a case file")
@needs(Scope.READ, body=CaseRequest)
def case_to_toml(body: CaseRequest) -> TomlBody:
    """Write the case with all defaults as a file's text."""
    return TomlBody(toml=toml_text(case_as_filed(body.inputs.case)))


class SceneInputs(BoundaryModel):
    """The inputs that name one scene."""

    scene: SceneInput = Field(description="The scene, as in a scene file")


class SceneRequest(BoundaryModel):
    """A scene under the name that an execution of simulate has for it."""

    inputs: SceneInputs = Field(description="The scene, as in an execution of simulate")


class SceneToml(TomlBody):
    """The text of a scene file."""


class SceneText(CaseText):
    """The text of a scene file, and the files that it names."""


class SceneBody(BaseModel):
    """A scene as it was given, without defaults."""

    scene: Annotated[dict[str, Any], Named("SceneInput")]


@scenes_router.post(
    "/scenes/from-toml",
    summary="Read a scene file",
    response_model=SceneBody,
    responses=documented(*READING_FAILURES),
)
@needs(Scope.READ, body=SceneText)
async def scene_from_toml(body: SceneText, context: Ctx, request: Request) -> Response:
    """Read the scene in a file's text and in the files that it names; names of cases not given stay."""
    return await read_by(context, "service.reading.texts:scene_of_toml", body, request)


@scenes_router.post("/scenes/to-toml", summary="Write a scene file")
@needs(Scope.READ, body=SceneRequest)
def scene_to_toml(body: SceneRequest) -> SceneToml:
    """Write the scene as a file's text, without defaults."""
    return SceneToml(toml=toml_text(body.inputs.scene.model_dump(mode="json", exclude_unset=True)))


@scenes_router.post("/scenes/to-files", summary="Write a scene file and files beside it")
@needs(Scope.READ, body=SceneRequest)
def scene_to_files(body: SceneRequest) -> SceneText:
    """Write the scene as a file's text, without defaults; solids and matrices are files beside it."""
    table, files = side_files(body.inputs.scene.model_dump(mode="json", exclude_unset=True))
    return SceneText(toml=toml_text(table), files=tuple(files))


class HousingsRequest(BoundaryModel):
    """Housings of a scene."""

    housings: Annotated[tuple[HousingInput, ...], Strict(False)] = Field(
        min_length=1, max_length=100, description="The housings, as in an execution of simulate"
    )

    @property
    def shape(self) -> str:
        """The fields that determine the surfaces, as text."""
        fields = {"step_file", "mesh_file", "mesh_unit", "origin_mm", "x_axis", "z_axis"}
        return self.model_dump_json(include={"housings": {"__all__": fields}})


class HousingSurfaceBody(BaseModel):
    """The surface of housings where they stand in their scene."""

    surface: HousingSurface | None = Field(description="Surface; null: no housing has the file of a solid")


@scenes_router.post(
    "/scenes/housing-surface",
    summary="Surface of housings, to draw",
    response_model=HousingSurfaceBody,
    responses=documented(*READING_FAILURES),
)
@needs(Scope.READ, body=HousingsRequest)
async def housing_surface(body: HousingsRequest, context: Ctx, request: Request) -> Response:
    """Return at most 20 000 coarse triangles of the solids of housings, where they stand; nothing is reduced.

    A process of its own reads the files. Equal files that stand alike are read once.
    """
    tag = f"surface-{program_tag()}-{body.shape}"
    known = await run_in_threadpool(context.cached_answers.find, tag)
    if known is not None:
        return Response(known, media_type=JSON)
    answer = await read_by(
        context, "lineofaction.gearbox.convert.drawn_housing:drawn_housings", body, request
    )
    await run_in_threadpool(context.cached_answers.keep, tag, bytes(answer.body))
    return answer


@units_router.post(
    "/units/open",
    summary="Open a gear unit (REXS)",
    response_model=UnitBody,
    responses=documented(*READING_FAILURES),
)
@needs(Scope.READ, body=UnitFile)
async def open_unit(body: UnitFile, context: Ctx, request: Request) -> Response:
    """Open a gear unit of another tool: a case for each cylindrical stage, the scene, and the account.

    A process of its own reads the file; nothing outside of it is opened.
    """
    return await read_by(context, ENTRY, body, request)
