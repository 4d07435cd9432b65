"""The list of STE databases."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, Field

from lineofaction.gearbox.schemas.named import Named
from service.schemas.ogc import Link


class DatabaseEntry(BaseModel):
    """One database."""

    hash: str = Field(description="Content hash of the input, the name of the resource")
    href: str = Field(description="Its path on the service")
    created: str = Field(description="Time of storage, RFC 3339, UTC")
    size: int = Field(ge=0, description="Size of the file in bytes")
    case: Annotated[dict[str, Any], Named("Case")] | None = Field(
        description="The case with all defaults; null if the file is damaged"
    )


class DatabaseList(BaseModel):
    """A page of databases, the newest first."""

    databases: list[DatabaseEntry]
    links: list[Link]
