"""Traces: where a request came from (W3C Trace Context), and spans by the API of OpenTelemetry.

The API records nothing without its SDK, which the extra `telemetry` installs, or without a receiver in the
standard variables ``OTEL_...``.
"""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Mapping
from contextvars import ContextVar
from functools import cache
from typing import TYPE_CHECKING

import structlog
from opentelemetry import trace
from opentelemetry.trace import Span, StatusCode, set_span_in_context
from opentelemetry.trace.propagation.tracecontext import TraceContextTextMapPropagator

from service.version import solver_version

if TYPE_CHECKING:
    from fastapi.telemetry import TelemetryConfig
    from opentelemetry.sdk.trace import TracerProvider

TRACEPARENT: ContextVar[str] = ContextVar("traceparent", default="")
"""Traceparent of the request that is being answered; empty: the request belongs to no trace."""
Fact = str | int | float

_VALID = re.compile(r"(?!ff)[0-9a-f]{2}-(?!0{32})([0-9a-f]{32})-(?!0{16})[0-9a-f]{16}-[0-9a-f]{2}", re.ASCII)
_W3C = TraceContextTextMapPropagator()
_PROBES = ("/health", "/ready", "/metrics")
_ENDPOINTS = ("OTEL_EXPORTER_OTLP_ENDPOINT", "OTEL_EXPORTER_OTLP_TRACES_ENDPOINT")
_FLUSHING_S = 1.0
_NS = 1_000_000_000
logger = structlog.get_logger(__name__)


def valid_traceparent(text: str) -> str:
    """Return a text that is a traceparent, empty if it is none."""
    return text if _VALID.fullmatch(text) else ""


def trace_fields(traceparent: str) -> dict[str, str]:
    """Return the fields of a trace for a line of the log; none without a trace."""
    match = _VALID.fullmatch(traceparent)
    return {} if match is None else {"trace_id": match[1]}


def traceparent_of(span: Span) -> str:
    """Return the traceparent of a span, W3C Trace Context; empty for a span without trace."""
    carrier: dict[str, str] = {}
    _W3C.inject(carrier, set_span_in_context(span))
    return carrier.get("traceparent", "")


def current_traceparent(sent: str) -> str:
    """Return the traceparent of the request's span, or else the one that its caller `sent`."""
    return traceparent_of(trace.get_current_span()) or sent


def begun_span(name: str, parent: str, at_s: float, attributes: Mapping[str, Fact] | None = None) -> Span:
    """Return a span that began at an instant, s since 1970; without a parent it begins a trace."""
    tracer = (span_provider() or trace.get_tracer_provider()).get_tracer("lineofaction", solver_version())
    context = _W3C.extract({"traceparent": parent})
    return tracer.start_span(name, context, attributes=dict(attributes or {}), start_time=int(at_s * _NS))


def end_span(
    span: Span, at_s: float, attributes: Mapping[str, Fact] | None = None, *, fault: str = ""
) -> None:
    """End a span at an instant, s since 1970, with facts and, if it failed, the reason."""
    span.set_attributes(dict(attributes or {}))
    if fault:
        span.set_status(StatusCode.ERROR, fault)
    span.end(int(at_s * _NS))


def telemetry_options() -> TelemetryConfig:
    """Return the options by which the framework makes a span of each request except probes."""
    return {
        "tracer_provider": span_provider(),
        "metrics": False,
        "logs": False,
        "operation_spans": False,
        "auto_configure": False,
        "exclude": lambda scope: scope["path"] in _PROBES,
    }


def flush_spans() -> None:
    """Send the remaining spans, without waiting for a receiver that does not answer."""
    provider = span_provider()
    if provider is not None:
        thread = threading.Thread(target=provider.force_flush, daemon=True)
        thread.start()
        thread.join(_FLUSHING_S)


@cache
def span_provider() -> TracerProvider | None:
    """Return the provider that sends this process's spans to the receiver that the environment names.

    None: it names none. Then spans go where the provider of the API sends them, by default nowhere.
    """
    if not _is_requested():
        return None
    try:
        from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter  # noqa: PLC0415
        from opentelemetry.sdk.resources import OTELResourceDetector, Resource  # noqa: PLC0415
        from opentelemetry.sdk.trace import TracerProvider  # noqa: PLC0415
        from opentelemetry.sdk.trace.export import BatchSpanProcessor  # noqa: PLC0415
    except ImportError:
        reason = "left out without the extra: pip install 'lineofaction[telemetry]'"
        logger.warning("no traces", reason=reason)
        return None
    ours = {"service.name": "lineofaction", "service.version": solver_version()}
    resource = Resource.create(ours).merge(OTELResourceDetector().detect())
    provider = TracerProvider(resource=resource, shutdown_on_exit=False)
    provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter()))
    return provider


def _is_requested() -> bool:
    """Whether the environment names a receiver, or the protocol otlp, which has a usual receiver."""
    exporter = os.environ.get("OTEL_TRACES_EXPORTER", "").strip().lower()
    disabled = os.environ.get("OTEL_SDK_DISABLED", "").strip().lower() == "true"
    if disabled or exporter == "none":
        return False
    if exporter not in ("", "otlp"):
        reason = f"OTEL_TRACES_EXPORTER={exporter}: spans leave by otlp, or by opentelemetry-instrument"
        logger.warning("no traces", reason=reason)
        return False
    return exporter == "otlp" or any(map(os.environ.get, _ENDPOINTS))
