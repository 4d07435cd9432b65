"""The end of an attempt: its products are stored, or the table states why there are none."""

from __future__ import annotations

import shutil
import time
import uuid
from dataclasses import dataclass
from pathlib import Path

import structlog

from service.queue.claims import Claim, Claims
from service.store import ResultStore
from service.tracing.tracer import tracer
from service.worker.order import Outcome
from service.worker.usage import no_space

logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class Ended:
    """An attempt that has ended: its claim, how it ended, its workspace and the log of its worker."""

    claim: Claim
    outcome: Outcome
    workspace: Path
    log: Path


@dataclass(frozen=True)
class Settlement:
    """Settles attempts; each step may be repeated until the database and the store take it.

    Attributes
    ----------
    claims : Claims
    store : ResultStore
    most_attempts : int
        At a computation.
    """

    claims: Claims
    store: ResultStore
    most_attempts: int

    def settle(self, ended: Ended) -> None:
        """Store what was made, or note why there is nothing; then remove the workspace.

        The workspace of a worker that died stays for the next attempt, and that of one whose end cannot be
        noted stays for the next call.
        """
        outcome = ended.outcome
        span = tracer().begin("settle", ended.claim.traceparent, time.time(), {})
        try:
            self._note(ended)
        finally:
            span.end(time.time(), {"loa.computation": ended.claim.id})
        if not outcome.died or ended.claim.attempts >= self.most_attempts:
            shutil.rmtree(ended.workspace, ignore_errors=True)

    def _note(self, ended: Ended) -> None:
        """Tell the table."""
        claim, outcome = ended.claim, ended.outcome
        if outcome.died:
            self.again_or_fail(claim, outcome.failure)
        elif outcome.unexpected:
            reference = uuid.uuid4().hex[:12]
            logger.error("worker failed", computation=claim.id, reference=reference, log=str(ended.log))
            text = f"An unexpected failure occurred. The log has the details under {reference}."
            self.claims.fail(claim, text, reference=reference)
        elif outcome.failure:
            self.claims.fail(claim, outcome.failure, outcome.faults)
        else:
            self._keep(claim, outcome)

    def _keep(self, claim: Claim, outcome: Outcome) -> None:
        """Store what was made; a file system that does not take it will not do so at a repetition either."""
        try:
            for product in outcome.products:
                self.store.within(claim.project).put(product.key, product.kind, product.file)
        except OSError as error:
            reference = uuid.uuid4().hex[:12]
            logger.exception("result could not be stored", computation=claim.id, reference=reference)
            text = f"The result could not be stored. The log has the details under {reference}."
            self.claims.fail(claim, no_space(error) or text, reference=reference)
        else:
            self.claims.succeed(claim)

    def again_or_fail(self, claim: Claim, reason: str) -> None:
        """Give work that died another attempt, as long as there are any."""
        most = self.most_attempts
        if claim.attempts < most:
            text = f"{reason} Waits for attempt {claim.attempts + 1} of {most}."
            self.claims.put_back(claim, text, counted=True)
        else:
            self.claims.fail(claim, f"{reason} That was attempt {claim.attempts} of {most}.")
