"""What an ablation toggles."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Strict

from service.schemas.case_or_scene import CaseOrScene, Name


class AblationInput(CaseOrScene):
    """A case or a scene, and the effects to toggle."""

    only: Annotated[tuple[Name, ...], Strict(False)] | None = Field(
        default=None,
        min_length=1,
        max_length=64,
        description="Effects to toggle, by name; left out: all",
        examples=[["tooth_coupling", "profile_modification"]],
    )
