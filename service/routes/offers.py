"""Routes that compute nothing, a row each: all are offered, some for drafts too."""

from __future__ import annotations

from service.routes import cases, documents, inspections

ROUTERS = (
    cases.router,
    inspections.router,
    cases.scenes_router,
    cases.units_router,
    documents.effects_router,
)
