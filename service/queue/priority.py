"""Priorities of jobs: the oldest of the highest is next; nothing ages."""

from __future__ import annotations

from sqlalchemy import Update, update

from lineofaction.gearbox.problems import BadInput
from service.queue.caller import Caller
from service.queue.tables import computations


def check_priority(priority: int, caller: Caller) -> None:
    """Raise `BadInput` if a caller may not have this priority."""
    highest = caller.highest_priority
    if highest is not None and priority > highest:
        bound = f"at most {highest}, the limit of key {caller.name!r}"
        raise BadInput.of("priority", priority, bound, "Leave it out, or ask the operator of the service.")


def raised(computation: str, priority: int) -> Update:
    """Return the statement that gives a computation at least this priority, as long as it waits."""
    lower = computations.c.priority < priority
    waits = (computations.c.id == computation) & (computations.c.state == "accepted")
    return update(computations).where(waits & lower).values(priority=priority)
