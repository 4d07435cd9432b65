"""Metrics of the requests that a process answers."""

from __future__ import annotations

import os
from typing import Any

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest
from prometheus_client.multiprocess import MultiProcessCollector

from lineofaction.gearbox.problems import ServiceError, last_part

_METHODS = frozenset(("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE", "CONNECT"))
"""Methods of RFC 9110 and RFC 5789, the labels of metrics; a caller may send any word."""


class Metrics:
    """Metrics of requests, printed with those of the `process`.

    Where several processes serve on one socket, the metrics of requests are sums over all of them.
    """

    def __init__(self, process: CollectorRegistry) -> None:
        self._process, self._registry = process, CollectorRegistry()
        self._answered = self._registry
        if "PROMETHEUS_MULTIPROC_DIR" in os.environ:  # see `lineofaction.cli.serve`
            self._answered = CollectorRegistry()
            MultiProcessCollector(self._answered)  # type: ignore[no-untyped-call]
        labels = ["method", "route", "status"]
        self._requests = Counter("loa_requests", "Requests answered", labels, registry=self._registry)
        text = "Time to answer, event streams left out"
        self._seconds = Histogram("loa_request_seconds", text, labels, registry=self._registry)
        self._problems = Counter(
            "loa_problems", "Requests answered with a problem", ["problem"], registry=self._registry
        )
        for kind in sorted(_kinds(ServiceError)):
            self._problems.labels(kind)  # rates count from 0, not from the first time
        sums: dict[str, Any] = {"registry": self._registry, "multiprocess_mode": "livesum"}
        self._open = Gauge("loa_event_streams", "Open event streams", ["route"], **sums)
        self._events = Counter("loa_events", "Events sent", ["route"], registry=self._registry)
        self._connections = Gauge("loa_connections", "Open HTTP connections", **sums)
        self._dropped = Counter(
            "loa_dropped_connections", "Idle connections closed to admit others", registry=self._registry
        )

    def observe(self, method: str, route: str, status: int, seconds: float | None) -> None:
        """Note one answered request; `seconds` is None for a stream, which lasts as long as its reader."""
        labels = (method if method in _METHODS else "other", route, str(status))
        self._requests.labels(*labels).inc()
        if seconds is not None:
            self._seconds.labels(*labels).observe(seconds)

    def refused(self, problem: str) -> None:
        """Note the kind of problem of an answer."""
        self._problems.labels(problem).inc()

    def streams(self, route: str, change: int) -> None:
        """Note an event stream that opened (1) or ended (-1)."""
        self._open.labels(route).inc(change)

    def sent(self, route: str, events: int) -> None:
        """Note events of a stream."""
        self._events.labels(route).inc(events)

    def connected(self, change: int) -> None:
        """Note a connection that was made (1) or lost (-1)."""
        self._connections.inc(change)

    def dropped(self) -> None:
        """Note an idle connection that made room for another."""
        self._dropped.inc()

    def text(self) -> bytes:
        """Return all figures in the text exposition format."""
        return generate_latest(self._answered) + generate_latest(self._process)


def _kinds(problem: type[ServiceError]) -> set[str]:
    return {last_part(problem.type)}.union(*(_kinds(below) for below in problem.__subclasses__()))
