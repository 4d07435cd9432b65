"""Metrics of the database and the store, which are equal for all processes on them."""

from __future__ import annotations

from collections.abc import Iterable

from prometheus_client import Metric
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily

from lineofaction.gearbox.problems import DatabaseUnavailable
from service.queue.workload import Workload, WorkloadReader
from service.store.write_check import WriteCheck

_STATES = ("accepted", "running", "successful", "failed", "dismissed")
_ENDED = ["process", "outcome"]


def database_figures(workload: WorkloadReader) -> Iterable[Metric]:
    """Yield figures of the database; where it does not answer, only that."""
    up = GaugeMetricFamily("loa_database_up", "Whether the database answers this process")
    try:
        load = workload.read()
    except DatabaseUnavailable:
        up.add_metric([], 0)
        yield up
        return
    up.add_metric([], 1)
    yield up
    yield from _queue(load)
    yield from _ended_metrics(load)
    yield from _results(load)


def writing_figures(writes: WriteCheck) -> Iterable[Metric]:
    """Return metrics on whether this process can write, and on the time of a write."""
    outcome = writes.outcome()
    text = "Whether this process can write to the database, and to the place of results"
    writable = GaugeMetricFamily("loa_writable", text, labels=["part"])
    # both parts of the outcome are reasons of a failure, empty where a write succeeds
    writable.add_metric(["database"], float(not outcome.database))
    writable.add_metric(["results"], float(not outcome.results))
    yield writable


def _queue(load: Workload) -> Iterable[Metric]:
    states = GaugeMetricFamily("loa_computations", "Computations by state", labels=["state"])
    for state in _STATES:
        states.add_metric([state], load.states.get(state, 0))
    depth = GaugeMetricFamily(
        "loa_queue_depth", "Computations that wait or run, by process", labels=["state", "process"]
    )
    for (state, process), number in sorted(load.queue.items()):
        depth.add_metric([state, process], number)
    oldest = GaugeMetricFamily("loa_oldest_waiting_seconds", "Age of the oldest waiting computation")
    oldest.add_metric([], load.oldest_waiting_s)
    return states, depth, oldest


def _ended_metrics(load: Workload) -> Iterable[Metric]:
    text = "Computations that ended, from their first start"
    seconds = HistogramMetricFamily("loa_computation_seconds", text, labels=_ENDED)
    attempts = CounterMetricFamily(
        "loa_computation_attempts", "Attempts at computations that ended", labels=_ENDED
    )
    for entry in load.durations:
        names = [entry.process, entry.outcome]
        seconds.add_metric(names, list(entry.buckets), entry.seconds)
        attempts.add_metric(names, entry.attempts)
    return seconds, attempts


def _results(load: Workload) -> Iterable[Metric]:
    number = GaugeMetricFamily("loa_results", "Results in the store", labels=["kind"])
    size = GaugeMetricFamily("loa_result_bytes", "Bytes of results in the store", labels=["kind"])
    for kind, count, total in load.results:
        number.add_metric([kind], count)
        size.add_metric([kind], total)
    return number, size
