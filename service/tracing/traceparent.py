"""The header ``traceparent`` (W3C Trace Context): which trace the work at hand belongs to."""

from __future__ import annotations

import re
from contextvars import ContextVar

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
