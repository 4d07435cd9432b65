"""Shares of a key that are left, as HTTP states them in the fields RateLimit-Policy and RateLimit.

The fields are lists of Structured Fields (RFC 9651) as of draft-ietf-httpapi-ratelimit-headers. A policy has
the quota `q`, its window `w` in s and its unit `qu`. A limit has the remainder `r`, and the seconds `t` after
which the whole quota is available again.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

POLICY, LIMIT = "RateLimit-Policy", "RateLimit"


@dataclass(frozen=True)
class Quota:
    """A share of the service that one key may take."""

    name: str
    """Name of the policy, letters and hyphens."""
    maximum: int
    """Size of the quota."""
    left: int
    """Remainder of the quota."""
    unit: str = ""
    """Unit of the quota, as the draft registers it; empty: requests."""
    window_s: int | None = None
    """Window of the quota in s; None: the quota holds at any instant."""
    full_s: int | None = None
    """Seconds after which the whole quota is available again; None: as soon as others end."""

    @property
    def policy(self) -> str:
        """The share as an item of RateLimit-Policy."""
        unit = f';qu="{self.unit}"' if self.unit else ""
        window = "" if self.window_s is None else f";w={self.window_s}"
        return f'"{self.name}";q={self.maximum}{unit}{window}'

    @property
    def limit(self) -> str:
        """The remainder as an item of RateLimit."""
        full = "" if self.full_s is None else f";t={self.full_s}"
        return f'"{self.name}";r={max(self.left, 0)}{full}'


def quota_fields(quotas: Iterable[Quota]) -> dict[str, str]:
    """Return the fields of an answer; none where there are no shares."""
    shares = list(quotas)
    if not shares:
        return {}
    return {
        POLICY: ", ".join(share.policy for share in shares),
        LIMIT: ", ".join(share.limit for share in shares),
    }
