"""The verdict of the checks of a result, and those that end a run or a study.

A check is an entry with `effect`, `assumption`, `part`, `holds` and `reason`. Where it does not hold, the
result is to be taken with its reason in mind, and an automatic effect may mend it. Where it also has `valid`
False, the result is wrong and no effect mends it: that ends a run unless the scene only wants a report.
"""

from __future__ import annotations

from collections.abc import Sequence

from dynamics.types import Json


def ending(checks: Sequence[Json], on_violation: str) -> str:
    """Say which `checks` end a run or a study by the scene's `on_violation`; empty where none does."""
    wrong = [check for check in checks if check["holds"] is False]
    if on_violation == "report":
        return ""
    if on_violation == "repeat":
        wrong = [check for check in wrong if check.get("valid") is False]
    return "; ".join(
        f"{check['assumption']} ({check['part'] or check['effect']}): {check['reason']}" for check in wrong
    )
