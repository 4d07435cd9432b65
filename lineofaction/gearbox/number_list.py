"""Numbers in a text: a list, or a range with its step."""

from __future__ import annotations

import math

from lineofaction.gearbox.problems import BadInput

MAX = 10_000

_BOUND = "FIRST:LAST:STEP, or increasing numbers separated by commas"

_REMEDY = "For example 100:3000:50 or 300,600,900."

_ROUNDING = 1e-9  # rounding of the last value over the step


def number_list(option: str, text: str) -> list[float]:
    """Return the numbers of an option; a range holds its last value where a step ends there.

    Raises `BadInput`: it is neither a range nor a list, or holds too many numbers.
    """
    try:
        if ":" in text:
            first, last, step = (float(part) for part in text.split(":"))
            return _range(option, text, first, last, step)
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise BadInput.of(option, text, _BOUND, _REMEDY) from None


def _range(option: str, text: str, first: float, last: float, step: float) -> list[float]:
    usable = all(math.isfinite(value) for value in (first, last, step)) and step > 0.0 and last >= first
    if not usable:
        raise BadInput.of(option, text, "a range FIRST:LAST:STEP that rises by a step above 0", _REMEDY)
    count = math.floor((last - first) / step * (1.0 + _ROUNDING) + _ROUNDING) + 1
    if count > MAX:
        raise BadInput.of(option, text, f"at most {MAX} values", "Take a wider step.")
    return [first + step * index for index in range(count)]
