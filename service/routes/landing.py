"""Landing page and conformance."""

from __future__ import annotations

from fastapi import APIRouter

from service.access import Scope
from service.routes.media_types import OPENAPI
from service.routes.scopes import ScopedRoute, needs
from service.schemas.ogc import CONFORMANCE, Conformance, Landing, Link
from service.version import solver_version

router = APIRouter(tags=["service"], route_class=ScopedRoute)

_OGC = "http://www.opengis.net/def/rel/ogc/1.0/"
_LINKS = (
    Link(href="/v1/", rel="self", title="This page"),
    Link(href="/openapi.json", rel="service-desc", type=OPENAPI, title="OpenAPI description"),
    Link(href="/docs", rel="service-doc", type="text/html", title="The description, to read and to try"),
    Link(href="/v1/conformance", rel=f"{_OGC}conformance", title="Conformance"),
    Link(href="/v1/processes", rel=f"{_OGC}processes", title="Processes"),
    Link(href="/v1/jobs", rel=f"{_OGC}job-list", title="Jobs"),
    Link(href="/v1/databases", rel="data", title="STE databases"),
)


@router.get("", summary="Landing page")
@router.get("/", include_in_schema=False)
@needs(Scope.READ)
def landing_page() -> Landing:
    """Return the links of the service."""
    return Landing(
        title="lineofaction",
        description="STE databases of gear pairs by contact analysis, and dynamics excited by them.",
        version=solver_version(),
        links=list(_LINKS),
    )


@router.get("/conformance", summary="Conformance classes of OGC API - Processes")
@needs(Scope.READ)
def conformance() -> Conformance:
    """Say which parts of the standard are met."""
    return Conformance(conformsTo=list(CONFORMANCE))
