"""Landing page and conformance."""

from __future__ import annotations

from fastapi import APIRouter

from service.schemas.ogc import CONFORMANCE, Conformance, Landing, Link
from service.version import solver_version

router = APIRouter(tags=["service"])


@router.get("/", summary="Landing page")
def landing() -> Landing:
    """Return the links of the service."""
    relations = (
        ("/v1/", "self", "This page"),
        ("/openapi.json", "service-desc", "OpenAPI description"),
        ("/v1/conformance", "http://www.opengis.net/def/rel/ogc/1.0/conformance", "Conformance"),
        ("/v1/processes", "http://www.opengis.net/def/rel/ogc/1.0/processes", "Processes"),
        ("/v1/jobs", "http://www.opengis.net/def/rel/ogc/1.0/job-list", "Jobs"),
        ("/v1/databases", "data", "STE databases"),
    )
    return Landing(
        title="lineofaction",
        description="STE databases of gear pairs by contact analysis, and dynamics excited by them.",
        version=solver_version(),
        links=[Link(href=href, rel=rel, title=title) for href, rel, title in relations],
    )


@router.get("/conformance", summary="Conformance classes of OGC API - Processes")
def conformance() -> Conformance:
    """Say which parts of the standard are met."""
    return Conformance(conformsTo=list(CONFORMANCE))
