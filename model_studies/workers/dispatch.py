"""The choice which work goes to workers: what costs more than the start of a process."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from host import cpu_seconds
from model_studies.workers.in_process import InProcess, Workers

R = TypeVar("R")
S = TypeVar("S")
T = TypeVar("T")
START_SECONDS = 10.0
"""Least predicted CPU seconds of tasks for which two new processes are started, which load program and
compiled code. Less work stays in this process.
"""
AWAKE = 0.1
"""Share of `START_SECONDS` that work must cost to go to workers that already run; they may have to load its
inputs.
"""


def divided(
    workers: Workers,
    function: Callable[[S, T], R],
    shared: S,
    items: Sequence[T],
    seconds: float | None = None,
) -> Iterator[R]:
    """Yield ``function(shared, item)`` of every item, in their order, by the workers if that pays.

    `seconds`: CPU seconds that all items are predicted to take. Above `START_SECONDS`, or its share for
    workers that already run, the workers do all items. Below it items are done in this process until those
    left would take more, if each took as long as the last. The first item is no measure, since it loads code.
    Raises `WorkersLost` as `Workers.run`, and what the function raises.
    """
    done, expected = 0, seconds or 0.0
    while len(items) - done > 1 and expected <= _minimum(workers):
        began = cpu_seconds()
        result = function(shared, items[done])
        last, done = cpu_seconds() - began, done + 1
        expected = last * (len(items) - done) if done > 1 else 0.0
        yield result
    left: Workers = workers if len(items) - done > 1 else InProcess()
    yield from left.run(function, shared, items[done:])


def pays(workers: Workers, seconds: float) -> bool:
    """Return whether work of so many predicted CPU seconds goes to workers, if it is not `divided`."""
    return not isinstance(workers, InProcess) and seconds > _minimum(workers)


def spent(workers: Workers) -> float:
    """Return the CPU seconds of this process, of its children that have ended, and of tasks by workers."""
    return cpu_seconds() + workers.cost.cpu_seconds


def _minimum(workers: Workers) -> float:
    return START_SECONDS * AWAKE if workers.cost.tasks else START_SECONDS
