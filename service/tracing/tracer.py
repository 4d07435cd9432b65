"""The tracer of this process: silent, unless the environment asks for OpenTelemetry and it is installed."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from contextvars import ContextVar
from functools import cache
from importlib.util import find_spec
from typing import Any, Protocol

import structlog

logger = structlog.get_logger(__name__)

TRACEPARENT: ContextVar[str] = ContextVar("traceparent", default="")
"""Of the request that is being answered; empty: it belongs to no trace."""

_VALID = re.compile(r"(?!ff)[0-9a-f]{2}-(?!0{32})([0-9a-f]{32})-(?!0{16})[0-9a-f]{16}-[0-9a-f]{2}", re.ASCII)


def valid_traceparent(text: str) -> str:
    """Return a text that is a traceparent, empty if it is none."""
    return text if _VALID.fullmatch(text) else ""


def trace_facts(traceparent: str) -> dict[str, str]:
    """Return the trace for a line of the log; nothing without one."""
    found = _VALID.fullmatch(traceparent)
    return {} if found is None else {"trace_id": found[1]}


Fact = str | int | float

_DESTINATIONS = (
    "OTEL_TRACES_EXPORTER",
    "OTEL_EXPORTER_OTLP_ENDPOINT",
    "OTEL_EXPORTER_OTLP_TRACES_ENDPOINT",
)


class Span(Protocol):
    """A part of the work, from its begin to its end."""

    @property
    def traceparent(self) -> str:
        """By which parts of it name it as their parent."""

    def end(self, at_s: float, facts: Mapping[str, Fact], *, fault: str = "") -> None:
        """End it at an instant, s since 1970, with facts and, if it failed, the reason."""


class Tracer(Protocol):
    """What makes spans."""

    @property
    def options(self) -> dict[str, Any]:
        """Options of the web framework, which makes the spans of requests."""

    def current(self, sent: str) -> str:
        """Return the traceparent of the request that is being answered, whose caller `sent` one or none."""

    def begin(self, name: str, parent: str, at_s: float, facts: Mapping[str, Fact]) -> Span:
        """Begin a span at an instant, s since 1970, within a parent; without one it begins a trace."""

    def flush(self) -> None:
        """Send what was not sent yet, within a second."""


class _NoSpan:
    """A span that nobody looks at."""

    def __init__(self, traceparent: str) -> None:
        self.traceparent = traceparent

    def end(self, at_s: float, facts: Mapping[str, Fact], *, fault: str = "") -> None:
        """Do nothing."""


class Silent:
    """A tracer that passes on what callers sent."""

    @property
    def options(self) -> dict[str, Any]:
        """Leave the framework as it is."""
        return {}

    def current(self, sent: str) -> str:
        """Return what was sent."""
        return sent

    def begin(self, _name: str, parent: str, _at_s: float, _facts: Mapping[str, Fact]) -> Span:
        """Return a span that nobody looks at."""
        return _NoSpan(parent)

    def flush(self) -> None:
        """Do nothing."""


@cache
def tracer() -> Tracer:
    """Return the tracer of this process, as the standard variables ``OTEL_...`` choose it."""
    off = os.environ.get("OTEL_SDK_DISABLED", "").strip().lower() == "true"
    none = os.environ.get("OTEL_TRACES_EXPORTER", "").strip().lower() == "none"
    if off or none or not any(os.environ.get(name) for name in _DESTINATIONS):
        return Silent()
    if find_spec("opentelemetry") is None or find_spec("opentelemetry.sdk") is None:  # the API comes anyway
        logger.warning(
            "no traces", reason="left out without the extra: pip install 'lineofaction[telemetry]'"
        )
        return Silent()
    from service.tracing.recorder import recorder  # noqa: PLC0415 (an extra)

    return recorder()
