"""The trace that a caller is in goes with every request."""

from __future__ import annotations

import sys
from typing import Any


def traced(options: dict[str, Any]) -> dict[str, Any]:
    """Return the options of a request with the headers of the active span of OpenTelemetry, if there is one.

    Who has an active span has imported OpenTelemetry; nobody else pays for that.
    """
    if "opentelemetry.trace" not in sys.modules:
        return options
    from opentelemetry.propagate import inject  # noqa: PLC0415 (not installed with the client)

    headers: dict[str, str] = {}
    inject(headers)
    return {**options, "headers": headers | options.get("headers", {})} if headers else options
