"""Checks of a result: assumptions, whether they held, and which of them end a run or a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from dynamics.types import Json

SeriesBlock = dict[str, Any]
"""Series of `RunResult` by name, over some of its samples."""


@dataclass(frozen=True)
class Check:
    """An assumption, and whether it held.

    Where it does not hold, the result is to be taken with its reason in mind, and an automatic effect may
    mend it. Where it also is not `valid`, the result is wrong and no effect mends it: that ends a run unless
    the scene only wants a report.
    """

    effect: str
    """Effect that mends a violation; empty: none does."""
    assumption: str
    part: str
    holds: bool
    reason: str
    figures: Mapping[str, float | None] = field(default_factory=dict)
    """Figures by which the assumption holds or not, SI."""
    valid: bool | None = None
    """Whether the result is right where the assumption does not hold; None: right either way."""

    def to_json(self) -> Json:
        """Return the entry of the check in the effect ledger."""
        head = {name: getattr(self, name) for name in ("effect", "assumption", "part", "holds")}
        valid = {} if self.valid is None else {"valid": self.valid}
        return {**head, **valid, **self.figures, "reason": self.reason}


def ending(checks: Sequence[Json], on_violation: str) -> str:
    """Return the `checks` that end a run or a study by the scene's `on_violation`, in words; empty: none."""
    wrong = [check for check in checks if check["holds"] is False]
    if on_violation == "report":
        return ""
    if on_violation == "repeat":
        wrong = [check for check in wrong if check.get("valid") is False]
    return "; ".join(
        f"{check['assumption']} ({check['part'] or check['effect']}): {check['reason']}" for check in wrong
    )
