"""The outcome of a random case."""

from __future__ import annotations

import re

from lineofaction.hardcases.scene import Outcome

LONGEST_REFUSAL = 500
"""Characters of a refusal that is still one clear error."""
_REFUSAL = re.compile(r"(InputError|InfeasibleGeometry): .* = .*: must be .+")


def kind_of_end(outcome: Outcome) -> str:
    """Return "table" (sound), "refusal" (one clear error) or what it should not be.

    That is "unsound" (a figure out of its bounds), "unclear" (a refusal that is long, or names no field and
    bound), "mesh" and "solve" (errors of the library that are no refusals), "hang", "crash" or "exception".
    """
    if outcome.passed:
        return "table"
    text = outcome.ended_by
    if not text:
        return "unsound"
    if text.startswith(("InputError: ", "InfeasibleGeometry: ")):
        clear = len(text) < LONGEST_REFUSAL and "\n" not in text and _REFUSAL.fullmatch(text)
        return "refusal" if clear else "unclear"
    ends = {
        "MeshError: ": "mesh",
        "SolveError: ": "solve",
        "not done after": "hang",
        "its process ended": "crash",
    }
    return next((end for start, end in ends.items() if text.startswith(start)), "exception")
