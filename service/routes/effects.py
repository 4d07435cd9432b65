"""The registry of effects."""

from __future__ import annotations

from fastapi import APIRouter

from lineofaction.gearbox.loading import LOADING
from service.access import Scope
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import EffectBody

router = APIRouter(tags=["effects"], route_class=ScopedRoute)


@router.get("/effects", summary="Optional physics")
@needs(Scope.READ)
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
