"""The sender of a request: the name, scopes and limits of a caller."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from enum import StrEnum

from service.project import COMMON

LIMITS = (
    "requests_per_minute",
    "unfinished_jobs",
    "highest_priority",
    "max_cost_s",
    "connections",
    "streams",
)
"""Fields of a holder that are limits."""


class Scope(StrEnum):
    """Something that a caller may do; none contains another."""

    READ = "read"
    SUBMIT = "submit"
    DISMISS = "dismiss"
    OPERATE = "operate"


MEANINGS = {
    Scope.READ: "see processes, jobs and results of the project, ask for plans and live answers",
    Scope.SUBMIT: "execute processes, name jobs of one's own",
    Scope.DISMISS: "dismiss jobs of one's own",
    Scope.OPERATE: "dismiss and name jobs of others in the project, read the metrics of the service",
}
EVERY_SCOPE = tuple(Scope)


@dataclass(frozen=True, kw_only=True)
class Holder:
    """A known caller."""

    name: str
    """Name in the log and in jobs."""
    project: str = COMMON
    """Project whose jobs and results the caller sees."""
    scopes: tuple[Scope, ...] = EVERY_SCOPE
    expires: str | None = None
    """Instant from which the caller is refused, RFC 3339, UTC; None: never."""
    requests_per_minute: int | None = None
    """Requests per minute, beyond which a request is answered with 429; None: no limit."""
    unfinished_jobs: int | None = None
    """Most jobs that wait or run at the same time; None: no limit but the queue's."""
    highest_priority: int | None = None
    """Highest priority of the caller's jobs, -9 to 9; None: any."""
    max_cost_s: int | None = None
    """CPU seconds that each job may take; None: no limit."""
    connections: int | None = None
    """Most requests answered at the same time, including bodies under way; None: a share of the server's."""
    streams: int | None = None
    """Most event streams open at the same time; None: no limit but the server's."""

    @property
    def limits(self) -> dict[str, int | None]:
        """The limits by their names."""
        return {name: getattr(self, name) for name in LIMITS}

    def ends_within(self, time: timedelta, now: datetime | None = None) -> bool:
        """Whether the caller expires within `time` from `now`, or has expired."""
        return self.expires is not None and instant_of(self.expires) <= (now or datetime.now(UTC)) + time

    @property
    def expired(self) -> bool:
        """Whether the caller has expired."""
        return self.ends_within(timedelta(0))


def instant_of(text: str) -> datetime:
    """Return an instant from the file of keys; raises ValueError: it has no time zone."""
    instant = datetime.fromisoformat(text)
    if instant.tzinfo is None:
        raise ValueError(text)
    return instant
