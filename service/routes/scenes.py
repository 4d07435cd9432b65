"""Scenes of dynamics before anything is computed: TOML in and out."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Request
from pydantic import BaseModel, Field
from starlette.responses import Response

from lineofaction.gearbox.convert.toml import toml_text
from lineofaction.gearbox.schemas.model import BoundaryModel
from lineofaction.gearbox.schemas.named import Named
from lineofaction.gearbox.schemas.scene import SceneInput
from service.access import Scope
from service.live.order import LiveOrder
from service.routes.cases import READING_FAILURES, CaseText, TomlBody, explained, read_by
from service.routes.context import Ctx
from service.routes.refusals import documented
from service.routes.scopes import ScopedRoute, needs

router = APIRouter(tags=["scenes"], route_class=ScopedRoute)


class SceneInputs(BoundaryModel):
    """A scene."""

    scene: SceneInput = Field(description="The scene, as in a scene file")


class SceneRequest(BoundaryModel):
    """A scene, where an execution of simulate has it."""

    inputs: SceneInputs = Field(description="The scene, as in an execution of simulate")


class SceneToml(TomlBody):
    """The text of a scene file."""


class SceneText(CaseText):
    """The text of a scene file, and the files that it names."""


class SceneBody(BaseModel):
    """A scene as it was given, without defaults."""

    scene: Annotated[dict[str, Any], Named("SceneInput")]


@router.post(
    "/scenes/from-toml",
    summary="Read a scene file",
    response_model=SceneBody,
    responses=documented(*READING_FAILURES),
)
@needs(Scope.READ)
async def scene_from_toml(body: SceneText, context: Ctx, request: Request) -> Response:
    """Read the scene in a file's text and in the files that it names; names of cases not given stay."""
    return await read_by(
        context, LiveOrder("service.reading.texts:scene_of_toml", body.model_dump(mode="json")), request
    )


@router.post("/scenes/to-toml", summary="Write a scene file")
@needs(Scope.READ)
def scene_to_toml(body: SceneRequest) -> SceneToml:
    """Write the scene as a file's text, without defaults."""
    return SceneToml(toml=toml_text(body.inputs.scene.model_dump(mode="json", exclude_unset=True)))


explained(scene_from_toml, SceneText)
explained(scene_to_toml, SceneRequest)
