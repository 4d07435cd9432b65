"""The description of the API: the framework's description, completed by facts common to all operations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from pydantic.json_schema import models_json_schema

from lineofaction.gearbox.problems import (
    BadInput,
    Busy,
    DatabaseDamaged,
    DatabaseUnavailable,
    HeadTooLarge,
    IssuerUnavailable,
    KeyExpired,
    Malformed,
    MissingScope,
    NoSpace,
    NotForUs,
    OutOfFiles,
    RateExceeded,
    ServiceError,
    StoreUnavailable,
    TooLarge,
    TooManyHeld,
    TooManyRequests,
    TooSlow,
    Unauthorised,
    Unexpected,
    UnsupportedMediaType,
    last_part,
)
from lineofaction.gearbox.schemas.named_parts import with_named
from lineofaction.gearbox.schemas.plan import InputWarning
from lineofaction.gearbox.schemas.query import QueryInput
from service.access.holder import MEANINGS
from service.routes.access import OPEN_PATHS
from service.routes.media_types import (
    CBOR,
    EVENT_STREAM,
    HEADERS,
    JSON,
    OF_ALL,
    OF_STATUS,
    PROBLEM,
    described_headers,
)
from service.routes.middleware import API_PREFIX
from service.routes.scopes import KEY_SCHEME
from service.schemas.answer_examples import answer_example, problem_example
from service.schemas.answers import ProblemBody, ReportSection
from service.schemas.examples import request_example

Json = dict[str, Any]
Kinds = dict[int, dict[str, str]]
"""Types and titles of problems by status."""

_OF_ALL: tuple[type[ServiceError], ...] = (
    Malformed,
    TooSlow,
    HeadTooLarge,
    NotForUs,
    TooManyRequests,
    Unexpected,
)
"""Problems of all requests; below, those of requests with keys, of routes on stores, and of bodies."""
_WITH_KEYS = (Unauthorised, KeyExpired, MissingScope, RateExceeded, TooManyHeld, IssuerUnavailable)
_OF_STORES = (Busy, DatabaseUnavailable, DatabaseDamaged, NoSpace, OutOfFiles, StoreUnavailable)
_OF_BODIES = (TooLarge, UnsupportedMediaType, BadInput)
_OF_ROUTING: Kinds = {405: {"about:blank": "Method Not Allowed"}}
_KINDS = "x-problems"
TAGS = {
    "service": "What the service is, and which parts of the standard it meets.",
    "processes": "What can be computed, and executions: each enters a job.",
    "jobs": "State, progress, results and dismissal of computations.",
    "results": "Stored results under the hash of their input: figures, files, plots, mesh forces.",
    "live": "Answers while the caller waits: other flanks on a stored compliance, plans of runs.",
    "drafts": "Questions about what is being typed: faults are an answer (200), not a refusal (422).",
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
"""Arguments of the framework's app that go into the description."""
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
"""Links from every status document to further operations, by name."""
_REF = "#/components/schemas/{model}"
_EXAMPLE_TYPES = (JSON, CBOR, EVENT_STREAM)
_FURTHER_MODELS = (ProblemBody, QueryInput, InputWarning, ReportSection)
"""Models in the description that no handler names."""


def documented(*problems: type[ServiceError]) -> dict[int | str, Json]:
    """Return a route's declaration of its problems, as the framework takes it."""
    return {
        status: {"description": HTTPStatus(status).phrase, _KINDS: kinds}
        for status, kinds in _by_status(problems).items()
    }


def _describe_refusals(document: Json) -> None:
    """Give every operation a reference for each status that refuses it, of its route and of the middleware.

    A reference leads to a response that is common to all operations and lists the problems of the status.
    """
    all_kinds: Kinds = {}
    for path, operation in _operations(document):
        responses = operation["responses"]
        refused = {status: responses.pop(status) for status in list(responses) if int(status) >= 400}
        of_route = {int(status): entry[_KINDS] for status, entry in refused.items() if _KINDS in entry}
        for kinds in (of_route, _of_request(path, operation)):
            for status, titles in kinds.items():
                all_kinds.setdefault(status, {}).update(titles)
                responses[str(status)] = {"$ref": f"#/components/responses/{_name(status)}"}
    document["components"]["responses"] = {
        _name(status): _response(status, kinds) for status, kinds in all_kinds.items()
    }


def _by_status(problems: Iterable[type[ServiceError]]) -> Kinds:
    kinds: Kinds = {}
    for problem in problems:
        kinds.setdefault(problem.status, {})[problem.type] = problem.title
    return kinds


def _of_request(path: str, operation: Mapping[str, Any]) -> Kinds:
    """Return the problems of the middleware, and of reading a body and parameters."""
    problems = [*_OF_ALL]
    if path not in OPEN_PATHS:
        problems += _WITH_KEYS
    if path.startswith(API_PREFIX):
        problems += _OF_STORES
    if "requestBody" in operation:
        problems += _OF_BODIES
    if "parameters" in operation:
        problems.append(BadInput)
    return _by_status(problems) | _OF_ROUTING


def _name(status: int) -> str:
    return HTTPStatus(status).phrase.title().replace(" ", "")


def _response(status: int, kinds: Mapping[str, str]) -> Json:
    """Return the response of a status, with an example of each type of problem."""
    examples = {
        last_part(kind): {"summary": title, "value": problem_example(status, kind, title)}
        for kind, title in kinds.items()
    }
    return {
        "description": f"{HTTPStatus(status).phrase}: {', '.join(examples)}",
        "headers": described_headers(*OF_ALL, *OF_STATUS.get(status, ())),
        "content": {PROBLEM: {"schema": {"$ref": "#/components/schemas/ProblemBody"}, "examples": examples}},
    }


def install_description(app: FastAPI) -> None:
    """Complete the description that `app` makes of itself."""
    framework_description = app.openapi

    def described() -> Json:
        is_new = app.openapi_schema is None  # the framework keeps the document of the first call
        document = framework_description()
        if is_new:
            _complete(document)
        return document

    app.openapi = described  # type: ignore[method-assign]  # as the framework says to


def _complete(document: Json) -> None:
    """Add the common parts of all operations, refusals, headers, links and keys, and examples of bodies."""
    components = document["components"]
    schemas = components["schemas"] = with_named(components["schemas"])
    further: Any = [(model, "validation") for model in _FURTHER_MODELS]
    schemas.update(models_json_schema(further, ref_template=_REF)[1]["$defs"])
    for unused in ("HTTPValidationError", "ValidationError"):  # the framework's own
        schemas.pop(unused, None)
    components["headers"] = dict(HEADERS)
    components["securitySchemes"] = {KEY_SCHEME: _KEY}
    _describe_refusals(document)
    for path, operation in _operations(document):
        _show(operation.get("requestBody", {}).get("content", {}), request_example(path))
        answers = (answer for answer in operation["responses"].values() if "$ref" not in answer)
        for response in answers:
            response["headers"] = described_headers(*OF_ALL) | response.get("headers", {})
            _show(response.get("content", {}), answer_example(path))
            _add_links(response)


def _operations(document: Json) -> Iterator[tuple[str, Json]]:
    for path, methods in document["paths"].items():
        for operation in methods.values():
            yield path, operation


def _show(content: Json, example: Any) -> None:
    for kind in _EXAMPLE_TYPES:
        if kind in content and example is not None:
            content[kind] = {**content[kind], "example": example}


def _add_links(response: Json) -> None:
    schema = response.get("content", {}).get(JSON, {}).get("schema", {})
    if schema == {"$ref": _REF.format(model="StatusInfo")}:
        response["links"] = {
            name: {"operationId": operation, "parameters": _JOB, "description": text}
            for name, (operation, text) in _LINKS.items()
        }
