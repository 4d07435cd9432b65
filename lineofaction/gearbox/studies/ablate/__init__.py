"""The change by every effect of a case or a scene: each toggled by itself."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Strict

from lineofaction.gearbox.schemas.case_or_scene import Name
from lineofaction.gearbox.schemas.model import BoundaryModel


class Inputs(BoundaryModel):
    """The effects to toggle."""

    only: Annotated[tuple[Name, ...], Strict(False)] | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Effects to toggle, by name; default: all",
        examples=[["tooth_coupling", "profile_modification"]],
    )
