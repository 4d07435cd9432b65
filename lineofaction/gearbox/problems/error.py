"""The base of all errors of the service, and the two that anything may raise."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, ClassVar

from lineofaction.gearbox.problems.fault import Fault

EXIT_FAILED = 1
EXIT_BAD_INPUT = 2
EXIT_WARNINGS = 3
EXIT_UNREACHABLE = 4
EXIT_UNEXPECTED = 5
EXIT_INTERRUPTED = 130
OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"


def last_part(problem_type: str) -> str:
    """Return the last part of the URI of a problem type."""
    return re.split("[:/]", problem_type)[-1]


class ServiceError(Exception):
    """Anything the service, its client or its command line raises on purpose."""

    status: ClassVar[int] = 500
    type: ClassVar[str] = "urn:lineofaction:problem:unexpected"
    title: ClassVar[str] = "Unexpected failure"
    exit_code: ClassVar[int] = EXIT_UNEXPECTED
    challenge: str | None = None
    accept_post: str | None = None
    faults: tuple[Fault, ...] = ()
    retry_after_s: int | None = None

    @property
    def kind(self) -> str:
        """Last part of the problem type, by which it is counted and logged."""
        return last_part(self.type)

    def as_json(self) -> dict[str, Any]:
        """Return the problem details object of RFC 9457."""
        return {
            "type": self.type,
            "title": self.title,
            "status": self.status,
            "detail": str(self).encode("utf-8", "replace").decode(),
            "errors": [fault.as_json() for fault in self.faults],
        }


class BadInput(ServiceError):
    """The caller's input cannot be used."""

    status = 422
    type = "urn:lineofaction:problem:bad-input"
    title = "The input cannot be used"
    exit_code = EXIT_BAD_INPUT

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("; ".join(str(fault) for fault in self.faults))

    @classmethod
    def of(cls, field: str, value: object, bound: str, suggestion: str = "") -> BadInput:
        """Return the error of a single fault."""
        return cls([Fault(field, value, bound, suggestion)])

    def within(self, prefix: str) -> BadInput:
        """Return the same error with its fields named inside `prefix`."""
        return BadInput(replace(fault, field=f"{prefix}.{fault.field}") for fault in self.faults)


class Unexpected(ServiceError):
    """A defect: the log holds the details under the reference."""

    def __init__(self, reference: str) -> None:
        self.reference = reference
        super().__init__(f"An unexpected failure occurred. The log has the details under {reference}.")

    def as_json(self) -> dict[str, Any]:
        """Return the problem with its reference number."""
        return {**super().as_json(), "reference": self.reference}
