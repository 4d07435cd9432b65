"""Limits on the CPU time of computations: of a job, of a key, and how they are kept."""

from __future__ import annotations

from sqlalchemy import Update, update

from bounds import engineering
from host import family_cpu_seconds
from lineofaction.gearbox.problems import BadInput
from service.queue.attempt import Attempt
from service.queue.claims import Claims
from service.queue.tables import computations
from service.queue.terms import Caller

_LOWER = (
    "Select a coarser level, fewer positions, loads or samples, of a run a shorter one; or raise the limit."
)


def cost_limit(requested: float | None, caller: Caller) -> float | None:
    """Return the CPU seconds that a job may take: as requested, and no more than its caller's key allows."""
    return min((limit for limit in (requested, caller.max_cost_s) if limit is not None), default=None)


def refuse_beyond(limit: float, stages: dict[str, float]) -> None:
    """Raise `BadInput` if the predicted CPU seconds, by stage, are beyond a limit."""
    predicted = sum(stages.values())
    if predicted <= limit:
        return
    largest = sorted(stages.items(), key=lambda stage: -stage[1])[:2]
    parts = ", ".join(f"{name} {engineering(seconds, 2)} s" for name, seconds in largest)
    bound = f"at least the predicted cost, {engineering(predicted, 3)} CPU s ({parts})"
    raise BadInput.of("max_cost_s", limit, bound, _LOWER)


def extended(computation: str, limit: float | None) -> Update:
    """Return the statement that lets a computation cost what one more job of it may; None: there is no limit.

    A computation costs as much as the most generous of its jobs allows.
    """
    lower = computations.c.max_cost_s < limit if limit is not None else computations.c.max_cost_s.is_not(None)
    return update(computations).where(computations.c.id == computation, lower).values(max_cost_s=limit)


def reached(attempt: Attempt, claims: Claims) -> str | None:
    """Return why an attempt has to end, None as long as it is within the limit of its computation.

    The limit is read again before it ends the work: a job that shares it may have extended it.
    """
    if attempt.claim.max_cost_s is None:
        return None
    spent = family_cpu_seconds(attempt.worker.pid)
    if spent is None or spent <= attempt.claim.max_cost_s:
        return None
    limit = claims.max_cost_s(attempt.claim)
    if limit is None or spent <= limit:
        return None
    return f"The limit of {engineering(limit, 4)} CPU s (max_cost_s) was reached. {_LOWER}"
