"""Problems that a service answers with, turned back into the errors they were."""

from __future__ import annotations

import json

import httpx2

from lineofaction.gearbox import problems
from lineofaction.gearbox.problems import (
    BadInput,
    Fault,
    JobFailed,
    NotFound,
    ServiceError,
    Unexpected,
    Unreachable,
)

_WITH_MORE = (BadInput, JobFailed, Unexpected)
"""Errors that need more than their text to be made again."""

_BY_TYPE = {
    kind.type: kind
    for kind in vars(problems).values()
    if isinstance(kind, type) and issubclass(kind, ServiceError) and "type" in vars(kind)
    if kind is not ServiceError and kind not in _WITH_MORE
}


def problem_of(response: httpx2.Response) -> ServiceError:
    """Return the error that an answer tells of; `Unreachable` if it is not this service's."""
    try:
        problem = response.json()
        detail, kind = str(problem["detail"]), str(problem["type"])
        faults = [Fault(**fault) for fault in problem.get("errors", [])]
    except (json.JSONDecodeError, UnicodeDecodeError, KeyError, TypeError):
        return stranger(response)
    if kind == BadInput.type:
        return BadInput(faults)
    if kind == JobFailed.type:
        return BadInput(faults) if faults else JobFailed(detail)
    known = _BY_TYPE.get(kind)
    if known is not None:
        return known(detail)
    return NotFound(detail) if response.status_code == NotFound.status else ServiceError(detail)


def stranger(response: httpx2.Response) -> Unreachable:
    """Return the error of an answer that this service does not give."""
    status, url = response.status_code, response.request.url
    to = f" and sends to {response.headers['location']}" if response.has_redirect_location else ""
    return Unreachable(
        f"{url} answered with status {status}{to}, which is not an answer of this service. Check the address."
    )
