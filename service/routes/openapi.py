"""The description of the API: what the framework writes, and what holds for all operations alike."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fastapi import FastAPI
from pydantic.json_schema import models_json_schema

from lineofaction.gearbox.schemas.named import with_named
from lineofaction.gearbox.schemas.query import QueryInput
from lineofaction.gearbox.schemas.warning import InputWarning
from service.access import MEANINGS
from service.routes.events import EVENT_STREAM
from service.routes.media_types import CBOR, HEADERS, JSON, OF_ALL, described_headers
from service.routes.refusals import describe_refusals
from service.routes.scopes import KEY_SCHEME
from service.schemas.answer_examples import answer_example
from service.schemas.answers import ProblemBody, ReportSection
from service.schemas.request_examples import request_example

Json = dict[str, Any]

TAGS = {
    "service": "What the service is, and which parts of the standard it meets.",
    "processes": "What can be computed, and executions: each enters a job.",
    "jobs": "State, progress, results and dismissal of computations.",
    "results": "Stored results under the hash of their input: figures, files, plots, mesh forces.",
    "live": "Answers while the caller waits: other flanks on a stored compliance, plans of runs.",
    "cases": "Gear pairs with their loads: examples, drawing, conversion from and to TOML.",
    "scenes": "Geared systems: conversion from and to TOML.",
    "units": "Gear units of other tools (REXS).",
    "effects": "The physics that a case can toggle.",
    "operations": "Health, readiness and metrics, for those who run the service.",
}
ABOUT: Json = {
    "title": "lineofaction",
    "summary": "Contact analysis of gear pairs for noise, and the dynamics it excites.",
    "description": "Jobs follow OGC API - Processes 1.0; errors are problem details (RFC 9457). Units are in "
    "the names of the fields.",
    "license_info": {"name": "GNU General Public License v3.0 or later", "identifier": "GPL-3.0-or-later"},
    "servers": [{"url": "/", "description": "The service that answers with this description"}],
    "openapi_tags": [{"name": name, "description": text} for name, text in TAGS.items()],
}
"""What the framework takes of it."""

_KEY = {
    "type": "http",
    "scheme": "bearer",
    "description": "An access key. A service that listens on loopback alone asks for none until it has one. "
    "An operation names the scope that the key needs: "
    + "; ".join(f"`{scope}`: {meaning}" for scope, meaning in MEANINGS.items())
    + ".",
}
_JOB = {"job_id": "$response.body#/jobID"}
_LINKS = {
    "status": ("job_status", "State and progress"),
    "events": ("job_events", "Changes of the state as they come"),
    "results": ("job_results", "The results, once the state is successful"),
    "dismiss": ("dismiss_job", "Dismissal"),
}
"""From every status document, by name."""

_REF = "#/components/schemas/{model}"
_SHOWN = (JSON, CBOR, EVENT_STREAM)
_BESIDE = (ProblemBody, QueryInput, InputWarning, ReportSection)
"""Models that no handler names."""


def install_description(app: FastAPI) -> None:
    """Let `app` describe itself."""
    written = app.openapi

    def described() -> Json:
        """Return the description, made once."""
        fresh = app.openapi_schema is None
        document = written()
        if fresh:
            _complete(document)
        return document

    app.openapi = described  # type: ignore[method-assign]  # as the framework says to


def _complete(document: Json) -> None:
    """Add what holds for all operations: refusals, headers, links, keys; and an example of every body."""
    components = document["components"]
    components["schemas"] = with_named(components["schemas"])
    _add_models(components["schemas"])
    components["headers"] = dict(HEADERS)
    components["securitySchemes"] = {KEY_SCHEME: _KEY}
    describe_refusals(document)
    for path, operation in _operations(document):
        _show(operation.get("requestBody", {}).get("content", {}), request_example(path))
        for response in _answers(operation):
            response["headers"] = described_headers(*OF_ALL) | response.get("headers", {})
            _show(response.get("content", {}), answer_example(path))
            _add_links(response)


def _operations(document: Json) -> Iterator[tuple[str, Json]]:
    for path, methods in document["paths"].items():
        for operation in methods.values():
            yield path, operation


def _answers(operation: Json) -> Iterator[Json]:
    """Yield the responses of an operation that are no refusals."""
    return (response for response in operation["responses"].values() if "$ref" not in response)


def _add_models(schemas: Json) -> None:
    """Add the schemas of models that no handler names, in place of the framework's own error body."""
    asked: Any = [(model, "validation") for model in _BESIDE]
    schemas.update(models_json_schema(asked, ref_template=_REF)[1]["$defs"])
    for unused in ("HTTPValidationError", "ValidationError"):
        schemas.pop(unused, None)


def _show(content: Json, example: Any) -> None:
    for kind in _SHOWN:
        if kind in content and example is not None:
            content[kind] = {**content[kind], "example": example}


def _add_links(response: Json) -> None:
    """Say what can be done with a job, wherever its status is answered."""
    schema = response.get("content", {}).get(JSON, {}).get("schema", {})
    if schema == {"$ref": _REF.format(model="StatusInfo")}:
        response["links"] = {
            name: {"operationId": operation, "parameters": _JOB, "description": text}
            for name, (operation, text) in _LINKS.items()
        }
