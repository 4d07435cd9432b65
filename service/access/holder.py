"""Who sends a request: a name, a project, what the holder may do there, and how much of it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from enum import StrEnum

from lineofaction.gearbox.problems import BadInput
from service.project import COMMON

# How long a key is good: durations as they are written on the command line, instants as they are kept.


SOON = timedelta(days=7)
"""A key that ends within this is mentioned in the log."""

_DURATION = re.compile(r"([1-9][0-9]{0,4})([hdw])")
_UNITS = {"h": timedelta(hours=1), "d": timedelta(days=1), "w": timedelta(weeks=1)}


def duration(field: str, text: str) -> timedelta:
    """Return a duration such as 12h, 90d or 26w; raises `BadInput`."""
    parts = _DURATION.fullmatch(text)
    if parts is None:
        raise BadInput.of(field, text, "a number of hours, days or weeks", "For example: 12h, 90d, 26w")
    return int(parts[1]) * _UNITS[parts[2]]


def written(instant: datetime) -> str:
    """Return an instant in UTC as RFC 3339, seconds."""
    return instant.astimezone(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")


def read(text: str) -> datetime:
    """Return an instant as `written`; raises ValueError of what has no time zone."""
    instant = datetime.fromisoformat(text)
    if instant.tzinfo is None:
        raise ValueError(text)
    return instant


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
    """A known caller.

    Attributes
    ----------
    name : str
        Stands in the log and beside jobs.
    project : str
        Whose jobs and results are seen.
    scopes : tuple of Scope
    expires : str or None
        The instant from which the caller is refused, RFC 3339, UTC; None: none.
    requests_per_minute : int or None
        Beyond it requests are answered with 429; None: no limit.
    unfinished_jobs : int or None
        Jobs that may wait or run at the same time; None: no limit but the queue's.
    highest_priority : int or None
        That jobs may have, -9 to 9; None: any.
    max_cost_s : int or None
        CPU seconds that each job may take; None: no limit.
    connections : int or None
        Requests answered at the same time, and bodies under way; None: a share of the server's.
    streams : int or None
        Event streams open at the same time; None: no limit but the server's.
    """

    name: str
    project: str = COMMON
    scopes: tuple[Scope, ...] = EVERY_SCOPE
    expires: str | None = None
    requests_per_minute: int | None = None
    unfinished_jobs: int | None = None
    highest_priority: int | None = None
    max_cost_s: int | None = None
    connections: int | None = None
    streams: int | None = None

    @property
    def limits(self) -> dict[str, int | None]:
        """The limits by their names."""
        return {name: getattr(self, name) for name in LIMITS}

    def ends_within(self, time: timedelta, now: datetime | None = None) -> bool:
        """Whether the caller's time ends in less than this, or is over."""
        return self.expires is not None and read(self.expires) <= (now or datetime.now(UTC)) + time

    @property
    def expired(self) -> bool:
        """Whether the caller's time is over."""
        return self.ends_within(timedelta(0))


LIMITS = (
    "requests_per_minute",
    "unfinished_jobs",
    "highest_priority",
    "max_cost_s",
    "connections",
    "streams",
)
"""Fields of a holder that are limits."""
LEAST = {"highest_priority": -9}
"""Of limits; of others 1."""
