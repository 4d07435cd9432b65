"""What an ablation switches over."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from service.schemas.case import Case
from service.schemas.model import BoundaryModel, refuse
from service.schemas.scene import SceneInput

Name = Annotated[str, Field(min_length=1, max_length=64)]


class AblationInput(BoundaryModel):
    """A case or a scene, and the effects to switch over."""

    case: Case | None = Field(default=None, description="The case, as in a case file; or else a scene")
    scene: SceneInput | None = Field(
        default=None, description="The scene, with cases written out or databases by hash; or else a case"
    )
    only: Annotated[tuple[Name, ...], Strict(False)] | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Effects to switch over, by name; left out: all",
        examples=[["tooth_coupling", "profile_modification"]],
    )

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        """Refuse none of both, and both."""
        if (self.case is None) == (self.scene is None):
            given = None if self.case is None else "beside a scene"
            refuse("case", given, "given without a scene, left out beside one", "Give one of them.")
        return self
