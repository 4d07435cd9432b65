"""The registry of effects."""

from __future__ import annotations

from fastapi import APIRouter
from pydantic import BaseModel

from service.loading import LOADING

router = APIRouter(tags=["effects"])


class EffectBody(BaseModel):
    """The declaration of an effect."""

    name: str
    needs: list[str]
    adds: list[str]
    cost: str
    sources: list[str]
    valid_for: str


@router.get("/effects", summary="Optional physics")
def list_effects() -> list[EffectBody]:
    """All effects; a case switches them in its table [effects]."""
    with LOADING:
        from fe_contact.effects import EFFECTS  # noqa: PLC0415 (start-up time)

    return [
        EffectBody(
            name=effect.name,
            needs=list(effect.needs),
            adds=list(effect.adds),
            cost=effect.cost,
            sources=list(effect.sources),
            valid_for=effect.valid_for,
        )
        for effect in EFFECTS
    ]
