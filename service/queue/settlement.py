"""The end of an attempt: its products are stored, or the job table states why there are none."""

from __future__ import annotations

import shutil
import time
import uuid
from dataclasses import dataclass
from typing import Any

import structlog

from service.queue.attempt import Attempt
from service.queue.claims import MAX_LOST_RUNS, SUSPECT_FROM, Claim, Claims
from service.store.results import ResultStore
from service.tracing import begun_span, end_span
from service.worker.order import Outcome
from service.worker.usage import Usage, no_space

logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class Ended:
    """An attempt that has ended, and how."""

    attempt: Attempt
    outcome: Outcome


@dataclass(frozen=True)
class Settlement:
    """Settles attempts; each step may be repeated until the database and the store accept it."""

    claims: Claims
    store: ResultStore
    max_attempts: int
    """Attempts of a computation after which it has failed, if its worker died each time."""
    alone: bool = True
    """Whether a suspect runs without other jobs; not where a cluster places jobs.

    A suspect is work during whose last runs the server or Dask worker ended.
    """

    def settle(self, ended: Ended) -> None:
        """Store the products, or note why none exist; remove the workspace unless an attempt follows."""
        claim = ended.attempt.claim
        span = begun_span("settle", claim.traceparent, time.time())
        try:
            waits = self._note(claim, ended.outcome, ended.attempt)
        finally:
            end_span(span, time.time(), {"loa.computation": claim.id})
        if not waits:
            shutil.rmtree(ended.attempt.workspace, ignore_errors=True)

    def _note(self, claim: Claim, outcome: Outcome, attempt: Attempt) -> bool:
        """Note how an attempt ended; return whether another follows."""
        if outcome.lost:
            return self.free_or_fail(claim, outcome.failure, claim.lost_runs + 1)
        if outcome.died:
            return self.retry_or_fail(claim, outcome.failure)
        if outcome.unexpected:
            self.fail_by_log(claim, "An unexpected failure occurred.", log=str(attempt.log))
        elif outcome.failure:
            self.claims.fail(claim, outcome.failure, outcome.faults)
        else:
            self._keep(claim, outcome, attempt.worker.usage)
        return False

    def _keep(self, claim: Claim, outcome: Outcome, usage: Usage | None) -> None:
        """Store the products; an error of the file system ends the work: a repetition would fail too."""
        store = self.store.within(claim.project)
        spent = {} if usage is None else {"cpu_seconds": round(usage.cpu_s, 3)}
        try:
            for product in outcome.products:
                cost = {} if product.key != claim.key else spent
                store.put(product.key, product.kind, product.file, product.headline | cost)
        except OSError as error:
            self.fail_by_log(claim, no_space(error) or "The result could not be stored.", exc_info=True)
        else:
            self.claims.succeed(claim)

    def fail_by_log(self, claim: Claim, text: str, **fields: Any) -> None:
        """End work without a result; the details are in the log, under a reference that the caller gets."""
        reference = uuid.uuid4().hex[:12]
        logger.error("worker failed", computation=claim.id, reference=reference, reason=text, **fields)
        message = f"{text} The log has the details under {reference}."
        self.claims.fail(claim, message, reference=reference)

    def retry_or_fail(self, claim: Claim, reason: str) -> bool:
        """Give work that died another attempt, as long as there are any; return whether there is one."""
        maximum = self.max_attempts
        if claim.attempts < maximum:
            text = f"{reason} Waits for attempt {claim.attempts + 1} of {maximum}."
            self.claims.put_back(claim, text, counted=True)
            return True
        self.claims.fail(claim, f"{reason} That was attempt {claim.attempts} of {maximum}.")
        return False

    def free_or_fail(self, claim: Claim, reason: str, lost_runs: int) -> bool:
        """Put back work whose server or Dask worker ended, unless the work itself seems to be the cause.

        It seems so after `MAX_LOST_RUNS` such runs in a row, the last of them without other work.
        """
        if lost_runs < MAX_LOST_RUNS:
            text = f"{reason} Waits to be begun again, which is no attempt."
            self.claims.put_back(claim, text, counted=False, lost_runs=lost_runs)
            return True
        alone = f", the last {lost_runs - SUSPECT_FROM} with no other job beside it" if self.alone else ""
        text = f"{reason} So ended {lost_runs} of its runs in a row{alone}: it may need too much memory. "
        text += "Select a coarser level or fewer positions, or start the service with LOA_MEMORY_LIMIT_MB."
        self.claims.fail(claim, text)
        return False
