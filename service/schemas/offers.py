"""What the service offers to begin with: optional physics and examples."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, Field

from lineofaction.gearbox.schemas.named import Named


class EffectBody(BaseModel):
    """The declaration of an effect."""

    name: str
    needs: list[str]
    adds: list[str]
    cost: str
    sources: list[str]
    valid_for: str


class ExampleBody(BaseModel):
    """A case to begin with."""

    name: str
    title: str
    note: str
    case: Annotated[dict[str, Any], Named("Case")]
    hash: str = Field(description="Hash of its database, whether it is stored or not")
