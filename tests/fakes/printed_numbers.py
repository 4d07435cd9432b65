"""Faults of printed numbers: digits beyond an error, rounding printed as a result, no change with digits.

A printed number is a token of a text; it ends with a decimal place, that of its last digit. The place of an
error is that of its second digit. What a program answers as JSON beside the text says which error a number
has: the value under a key and the error under the same key with "error" in it.
"""

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from html.parser import HTMLParser
from typing import Any

from bounds.error_digits import DIGITS_OF_ERROR, MAX_DIGITS

NUMBER = r"[-+−]?(?<![\w.])\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)"
_TOKEN = re.compile(NUMBER)
_WITH_ERROR = re.compile(rf"({NUMBER})(?: [^\d\s±]+)?\s*± ?({NUMBER})")
_NO_CHANGE = re.compile(r"(?<![\w.])[-+−]0(?:\.0+)?(?![\w.])")
_FREE = re.compile(
    r"content hash \w+|hash of the report\s+\w+|[0-9a-f]{16,}|below [\d.e-]+|\d{4}-\d\d-\d\d"
    r"|\d+\.\d+\.\d+[.\w]*|(?:/|\w+/)\S+"
)
"""Texts whose digits are no results: hashes, limits, dates, versions, paths."""
SMALLEST = 1e-12
"""Size below which a printed number that is not 0 is rounding, in any unit of the program."""
_ORDINALS = ("order", "harmonic", "orders", "load", "shafts")
"""Words behind which a number is the name of one of several."""
_MATCHED = 4
"""Significant digits from which on a token is the number of the answer that it agrees with."""


def place_of(token: str) -> int:
    """Return the decimal place with which a printed number ends; of "1200" the last digit that is not 0."""
    mantissa, _, exponent = token.lower().partition("e")
    decimals = mantissa.partition(".")[2]
    return len(decimals) - int(exponent or 0)


def digits_of(token: str) -> int:
    """Return the number of significant digits of a printed number."""
    return len(token.lower().partition("e")[0].lstrip("+-−0.").replace(".", "").lstrip("0"))


def place_of_error(error: float) -> int:
    """Return the decimal place with which a number of this error ends."""
    return DIGITS_OF_ERROR - 1 - int(f"{error:.{DIGITS_OF_ERROR - 1}e}".partition("e")[2])


def faults(text: str, answer: Any = None) -> list[str]:
    """Return the faults of a text, each with its line; `answer` is the JSON beside it."""
    errors: dict[float, float] = {}
    for value, error in _errors(answer):  # numbers that are equal have the least of their errors
        errors[value] = min(error, errors.get(value, math.inf))
    return [f"{fault}: {line.strip()}" for line in text.splitlines() for fault in _line_faults(line, errors)]


def _line_faults(line: str, errors: Mapping[float, float]) -> Iterator[str]:
    plain = _FREE.sub(" ", line)
    for value, error in _WITH_ERROR.findall(plain):
        if _value(error) == 0.0 or (abs(place_of(value) - place_of(error)) > 0 and "." in value + error):
            yield f"{value} ± {error} end with different digits"
        elif digits_of(error) > DIGITS_OF_ERROR and place_of(error) > 0:
            yield f"± {error} has more digits than decide"
    for token in _TOKEN.findall(plain):
        if digits_of(token) > MAX_DIGITS:
            yield f"{token} has digits of rounding"
        if 0.0 < abs(_value(token)) < SMALLEST:
            yield f"{token} is rounding"
        error = _error_of(token, errors)
        if error is not None and place_of(token) > place_of_error(error):
            yield f"{token} has digits beyond its error {error:.2g}"
    yield from (f"{zero} is no change" for zero in _NO_CHANGE.findall(plain))


def _value(token: str) -> float:
    return float(token.replace("−", "-"))


def _error_of(token: str, errors: Mapping[float, float]) -> float | None:
    """Return the least error of the numbers of the answer that round to a token; None: it is none of them."""
    if digits_of(token) < _MATCHED:
        return None
    value, place = _value(token), place_of(token)
    near = [error for known, error in errors.items() if round(abs(known), place) == abs(value)]
    return min(near, default=None)


def _errors(answer: Any) -> Iterator[tuple[float, float]]:
    if isinstance(answer, list):
        for part in answer:
            yield from _errors(part)
    elif isinstance(answer, dict):
        for name, value in answer.items():
            for twin in _error_names(name):
                if twin in answer and twin != name:
                    yield from _pairs(value, answer[twin])
            yield from _errors(value)


def _error_names(name: str) -> Iterator[str]:
    """Yield the keys under which the error of a number may stand: before its unit, or behind it."""
    parts = name.split("_")
    for k in range(len(parts) + 1):
        yield "_".join([*parts[:k], "error", *parts[k:]])


def _pairs(value: Any, error: Any) -> Iterator[tuple[float, float]]:
    if isinstance(value, list) and isinstance(error, list):
        for one, other in zip(value, error, strict=False):
            yield from _pairs(one, other)
    elif all(isinstance(x, (int, float)) and math.isfinite(x) for x in (value, error)) and error > 0.0:
        yield float(value), float(error)


class _Tables(HTMLParser):
    """Text of a page: a line for each row of a table and for each paragraph, without scripts."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = [""]
        self._hidden = 0

    def handle_starttag(self, tag: str, attrs: Sequence[tuple[str, str | None]]) -> None:
        self._hidden += tag in ("script", "style", "svg")
        if tag in ("tr", "p", "h1", "h2", "h3", "li", "figcaption", "dt", "div", "caption"):
            self.lines.append("")
        elif tag in ("td", "th", "dd"):
            self.lines[-1] += "  "

    def handle_endtag(self, tag: str) -> None:
        self._hidden -= tag in ("script", "style", "svg")

    def handle_data(self, data: str) -> None:
        if not self._hidden:
            self.lines[-1] += data.replace("\n", " ")


def text_of_page(html: str) -> str:
    """Return what a reader of a page reads, without its plots."""
    parser = _Tables()
    parser.feed(html)
    return "\n".join(line for line in parser.lines if line.strip())


def contradictions(text: str) -> list[str]:
    """Return names that a text gives two values: "name: 235 N/mm" and "name 236 N/mm"."""
    known: dict[str, str] = {}
    found = []
    for line in text.splitlines():
        match = re.match(rf"\s*([a-zA-Z][-\w ]+[a-zA-Z])(?::| ) *({NUMBER}) ([^\s,;]+)", line)
        if match and "  " not in line.strip() and match[1].split()[-1] not in _ORDINALS:
            name, value, unit = match.groups()
            before = known.setdefault(f"{name}, {unit}", value)
            if not _agree(before, value):
                found.append(f"{name}: {before} and {value} {unit}")
    return found


def _agree(one: str, other: str) -> bool:
    place = min(place_of(one), place_of(other))
    return abs(_value(one) - _value(other)) <= 0.5000001 * 10.0**-place


def answer_of(text: str) -> Any:
    """Return the JSON of a verb; None where it printed none."""
    return json.loads(text) if text.startswith("{") else None
