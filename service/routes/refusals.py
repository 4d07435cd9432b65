"""The refusals of every request as the description has them: by status, each status said once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from http import HTTPStatus
from typing import Any

from lineofaction.gearbox.problems import (
    BadInput,
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
from service.routes.access import OPEN_PATHS
from service.routes.media_types import OF_ALL, OF_STATUS, PROBLEM, described_headers
from service.routes.middleware import API_PREFIX
from service.schemas.answer_examples import problem_example

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
_WITH_KEYS = (Unauthorised, KeyExpired, MissingScope, RateExceeded, TooManyHeld, IssuerUnavailable)
_OF_STORES = (DatabaseUnavailable, DatabaseDamaged, NoSpace, OutOfFiles, StoreUnavailable)
_OF_BODIES = (TooLarge, UnsupportedMediaType, BadInput)
_OF_ROUTING: Kinds = {405: {"about:blank": "Method Not Allowed"}}
_KINDS = "x-problems"


def documented(*problems: type[ServiceError]) -> dict[int | str, Json]:
    """Return what a route declares of the problems that are its own, as the framework takes it."""
    return {
        status: {"description": HTTPStatus(status).phrase, _KINDS: kinds}
        for status, kinds in _by_status(problems).items()
    }


def describe_refusals(document: Json) -> None:
    """Give every operation all its refusals, as references to one response a status."""
    found: Kinds = {}
    for path, methods in document["paths"].items():
        for operation in methods.values():
            responses = operation["responses"]
            for kinds in (_taken_out(responses), _of_request(path, operation)):
                for status, named in kinds.items():
                    found.setdefault(status, {}).update(named)
                    responses[str(status)] = {"$ref": f"#/components/responses/{_name(status)}"}
    document["components"]["responses"] = {
        _name(status): _response(status, found[status]) for status in found
    }


def _by_status(problems: Iterable[type[ServiceError]]) -> Kinds:
    kinds: Kinds = {}
    for problem in problems:
        kinds.setdefault(problem.status, {})[problem.type] = problem.title
    return kinds


def _of_request(path: str, operation: Mapping[str, Any]) -> Kinds:
    """Return the problems of what stands in front of a route, and of reading its body and parameters."""
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


def _taken_out(responses: Json) -> Kinds:
    """Take the refusals out of the responses of an operation; return those that its route declares."""
    refused = {status: responses.pop(status) for status in list(responses) if int(status) >= 400}
    return {int(status): entry[_KINDS] for status, entry in refused.items() if _KINDS in entry}


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
