"""What a key has left of its shares, as HTTP says it in the fields RateLimit-Policy and RateLimit.

The fields are lists of Structured Fields (RFC 9651) as of draft-ietf-httpapi-ratelimit-headers: a policy has
the quota `q`, its window `w` in s and its unit `qu`, a limit what remains, `r`, and the seconds `t` after
which all of the quota is there again.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

POLICY, LIMIT = "RateLimit-Policy", "RateLimit"


@dataclass(frozen=True)
class Quota:
    """A share of one key."""

    name: str
    """Of the policy, letters and hyphens."""
    maximum: int
    """The quota."""
    left: int
    """What remains of it."""
    unit: str = ""
    """Of what it is, as the draft registers it; empty: requests."""
    window_s: int | None = None
    """In which so many may come; None: so many at the same time."""
    full_s: int | None = None
    """After which all of it is there again; None: as soon as others end."""

    @property
    def policy(self) -> str:
        """The share as an item of RateLimit-Policy."""
        unit = f';qu="{self.unit}"' if self.unit else ""
        window = "" if self.window_s is None else f";w={self.window_s}"
        return f'"{self.name}";q={self.maximum}{unit}{window}'

    @property
    def limit(self) -> str:
        """What remains as an item of RateLimit."""
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
