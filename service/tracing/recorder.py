"""Spans by OpenTelemetry, sent where the standard variables ``OTEL_...`` say. Only this loads its SDK."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping
from importlib.metadata import entry_points
from typing import Any

import structlog
from opentelemetry import trace
from opentelemetry.sdk.resources import OTELResourceDetector, Resource
from opentelemetry.sdk.trace import TracerProvider
from opentelemetry.sdk.trace.export import BatchSpanProcessor, SpanExporter
from opentelemetry.trace import StatusCode, set_span_in_context
from opentelemetry.trace.propagation.tracecontext import TraceContextTextMapPropagator

from service.tracing.tracer import Fact, Silent, Span, Tracer
from service.version import solver_version

_FLUSHING_S = 1.0
_PROBES = ("/health", "/ready", "/metrics")
_NS = 1_000_000_000
_W3C = TraceContextTextMapPropagator()
logger = structlog.get_logger(__name__)


def recorder() -> Tracer:
    """Return a tracer with the exporter of ``OTEL_TRACES_EXPORTER``, by default OTLP over HTTP."""
    exporter = _exporter(os.environ.get("OTEL_TRACES_EXPORTER", "").strip() or "otlp")
    if exporter is None:
        return Silent()
    own = {"service.name": "lineofaction", "service.version": solver_version()}
    resource = Resource.create(own).merge(OTELResourceDetector().detect())
    provider = TracerProvider(resource=resource, shutdown_on_exit=False)
    provider.add_span_processor(BatchSpanProcessor(exporter))
    return _Recorder(provider)


def _exporter(name: str) -> SpanExporter | None:
    chosen = "otlp_proto_http" if name == "otlp" else name
    for entry in entry_points(group="opentelemetry_traces_exporter", name=chosen):
        exporter: SpanExporter = entry.load()()
        return exporter
    logger.warning("no traces", reason=f"no exporter of the name {name} is installed (OTEL_TRACES_EXPORTER)")
    return None


class _Recorder:
    """A tracer of OpenTelemetry."""

    def __init__(self, provider: TracerProvider) -> None:
        self._provider = provider
        self._tracer = provider.get_tracer("lineofaction", solver_version())

    @property
    def options(self) -> dict[str, Any]:
        """Let the framework make a span of each request; not of probes, nor of its own steps."""
        telemetry = {
            "tracer_provider": self._provider,
            "metrics": False,
            "logs": False,
            "operation_spans": False,
            "auto_configure": False,
            "exclude": lambda scope: scope["path"] in _PROBES,
        }
        return {"telemetry": telemetry}

    def current(self, sent: str) -> str:
        """Return the traceparent of the request's own span; without one what was sent."""
        return _traceparent(trace.get_current_span()) or sent

    def begin(self, name: str, parent: str, at_s: float, facts: Mapping[str, Fact]) -> Span:
        context = _W3C.extract({"traceparent": parent})
        started = int(at_s * _NS)
        return _Recorded(self._tracer.start_span(name, context, attributes=dict(facts), start_time=started))

    def flush(self) -> None:
        """Send what is left; a receiver that does not answer is not waited for."""
        thread = threading.Thread(target=self._provider.force_flush, daemon=True)
        thread.start()
        thread.join(_FLUSHING_S)


class _Recorded:
    """A span of OpenTelemetry."""

    def __init__(self, span: trace.Span) -> None:
        self._span = span

    @property
    def traceparent(self) -> str:
        return _traceparent(self._span)

    def end(self, at_s: float, facts: Mapping[str, Fact], *, fault: str = "") -> None:
        self._span.set_attributes(dict(facts))
        if fault:
            self._span.set_status(StatusCode.ERROR, fault)
        self._span.end(int(at_s * _NS))


def _traceparent(span: trace.Span) -> str:
    """Return a span as W3C Trace Context writes it, empty for one of no trace."""
    carrier: dict[str, str] = {}
    _W3C.inject(carrier, set_span_in_context(span))
    return carrier.get("traceparent", "")
