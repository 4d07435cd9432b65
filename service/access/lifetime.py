"""How long a key is good: durations as they are written on the command line, instants as they are kept."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta

from lineofaction.gearbox.problems import BadInput

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
