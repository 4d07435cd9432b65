"""The inputs of a process for cases and for scenes: one of them."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import ConfigDict, Field, model_validator

from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.model import BoundaryModel, refuse
from lineofaction.gearbox.schemas.rules import exactly_one_of, stated
from lineofaction.gearbox.schemas.scene import SceneInput

Name = Annotated[str, Field(min_length=1, max_length=64)]


class CaseOrScene(BoundaryModel):
    """A case or a scene, one of both."""

    model_config = ConfigDict(json_schema_extra=stated(exactly_one_of("case", "scene")))

    case: Case | None = Field(default=None, description="The case, as in a case file; alternative to a scene")
    scene: SceneInput | None = Field(
        default=None,
        description="The scene, with cases written out or databases by hash; alternative to a case",
    )

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        """Refuse none of both, and both."""
        if (self.case is None) == (self.scene is None):
            value = None if self.case is None else "beside a scene"
            refuse("case", value, "given without a scene, left out beside one", "Give one of them.")
        return self
