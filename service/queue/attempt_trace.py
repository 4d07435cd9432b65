"""The spans of one attempt: its wait in the queue, the attempt, and the stages of its worker.

They are made here, from what the worker reports of its stages: so those of a worker that dies are known too,
and no worker loads what sends them.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from datetime import datetime

from model_studies.progress import stage_name
from service.queue.claims import Claim
from service.tracing.tracer import Fact, Span, tracer
from service.worker.usage import Usage
from service.worker.worker import Step

_START = "start"
"""Stage before the first report: the process starts and loads its program."""
_MOST_STAGES = 200
"""Spans of one attempt; what is reported after them belongs to the last."""


class AttemptTrace:
    """Spans that end as the attempt goes on.

    Parameters
    ----------
    claim : Claim
    pid : int
        Of the worker.
    launched : float
        When it was launched, s since the epoch: no stage of it begins before.
    """

    def __init__(self, claim: Claim, pid: int, launched: float) -> None:
        facts: dict[str, Fact] = {
            "loa.computation": claim.id,
            "loa.process": claim.process,
            "loa.attempt": claim.attempts,
        }
        begun = datetime.fromisoformat(claim.waited_from).timestamp() if claim.waited_from else launched
        tracer().begin("queue", claim.traceparent, min(begun, launched), facts).end(launched, {})
        facts |= {"process.pid": pid}
        self._attempt = tracer().begin(f"attempt {claim.process}", claim.traceparent, launched, facts)
        self._name, self._cpu_s, self._left = "", 0.0, _MOST_STAGES
        self._stage = self._begun(_START, launched, 0.0)

    def _begun(self, name: str, at_s: float, cpu_s: float) -> Span:
        """Begin a stage."""
        self._name, self._cpu_s, self._left = name, cpu_s, self._left - 1
        return tracer().begin(name, self._attempt.traceparent, at_s, {})

    def see(self, steps: Iterable[Step]) -> None:
        """Take what the worker reported: another name ends a stage and begins the next."""
        for step in steps:
            name = stage_name(step.stage)
            if name != self._name and self._left > 0:
                self._stage.end(step.at, {"loa.cpu_s": step.cpu_s - self._cpu_s})
                self._stage = self._begun(name, step.at, step.cpu_s)

    def end(self, how: str, usage: Usage | None) -> None:
        """End the attempt; what it took is known if its worker was reaped."""
        now, fault = time.time(), "" if how == "done" else how
        facts = {"loa.outcome": how}
        if usage is None:
            self._stage.end(now, {}, fault=fault)
            self._attempt.end(now, facts, fault=fault)
            return
        self._stage.end(now, {"loa.cpu_s": max(usage.cpu_s - self._cpu_s, 0.0)}, fault=fault)
        self._attempt.end(now, facts | {"loa.cpu_s": usage.cpu_s, "loa.peak_mb": usage.peak_mb}, fault=fault)
