"""Figures for Prometheus."""

from __future__ import annotations

from collections.abc import Iterable

from prometheus_client import CollectorRegistry, Counter, Histogram, generate_latest
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.registry import Collector

from service.jobs.submissions import Submissions

_STATES = ("accepted", "running", "successful", "failed", "dismissed")


class Metrics:
    """Counters of one app."""

    def __init__(self, submissions: Submissions) -> None:
        self._registry = CollectorRegistry()
        self._requests = Counter(
            "loa_requests", "Requests answered", ["method", "route", "status"], registry=self._registry
        )
        self._seconds = Histogram("loa_request_seconds", "Time to answer", ["route"], registry=self._registry)
        self._registry.register(_Computations(submissions))

    def observe(self, method: str, route: str, status: int, seconds: float) -> None:
        """Note one answered request."""
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(route).observe(seconds)

    def text(self) -> bytes:
        """Return all figures in the text exposition format."""
        return generate_latest(self._registry)


class _Computations(Collector):
    """Computations by state, counted when asked."""

    def __init__(self, submissions: Submissions) -> None:
        self._submissions = submissions

    def collect(self) -> Iterable[GaugeMetricFamily]:
        """Return the gauge."""
        gauge = GaugeMetricFamily("loa_computations", "Computations by state", labels=["state"])
        counts = self._submissions.counts()
        for state in _STATES:
            gauge.add_metric([state], counts.get(state, 0))
        yield gauge
