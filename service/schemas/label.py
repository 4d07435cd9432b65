"""Titles and tags of jobs, as callers write them."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from lineofaction.gearbox.schemas.model import BoundaryModel

Title = Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x1f\x7f]*$")]
Tag = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._:/+-]{0,39}$")]
Tags = Annotated[list[Tag], Field(max_length=16)]


class LabelChange(BoundaryModel):
    """A change of a job's label; what is left out stays."""

    title: Title | None = Field(None, description="Name of the job", examples=["Tip relief 20 um"])
    tags: Tags | None = Field(None, description="Replace the tags of the job", examples=[["ev-3", "draft"]])
