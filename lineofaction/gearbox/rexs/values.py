"""Kinds and values of attributes: from text and from base64, and back.

What is no such value is refused (`BadInput`) by its place in the file.
"""

from __future__ import annotations

import array
import base64
import binascii
import math
import re
import sys
from collections.abc import Callable, Sequence

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Array, Scalar, Value
from lineofaction.gearbox.rexs.vocabulary import owners

KINDS = (
    "floating_point",
    "integer",
    "boolean",
    "enum",
    "string",
    "reference_component",
    "file_reference",
    "date_time",
)
_EVIDENT_KINDS = ("floating_point", "boolean")

CODES = {"float32": "f", "float64": "d", "int32": "i"}
"""The codes of REXS, little-endian, with the letters of `array`."""

_INTEGER = re.compile(r"[+-]?\d{1,19}")
_MAX_INTEGER = 2**63


def integer_of(text: str, location: str) -> int:
    """Return an integer of at most 64 bits."""
    plain = text.strip()
    if not _INTEGER.fullmatch(plain) or abs(int(plain)) >= _MAX_INTEGER:
        raise BadInput.of(location, text, "an integer of at most 64 bits")
    return int(plain)


def _float_of(text: str, location: str) -> float:
    try:
        number = float(text) if "_" not in text else math.nan  # Python alone reads 1_000
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise BadInput.of(location, text, "a finite number")
    return number


def _boolean_of(text: str, location: str) -> bool:
    plain = text.strip().lower()
    if plain not in ("true", "false"):
        raise BadInput.of(location, text, "true or false")
    return plain == "true"


OF_TEXT: dict[str, Callable[[str, str], Scalar]] = {
    "floating_point": _float_of,
    "integer": integer_of,
    "reference_component": integer_of,
    "boolean": _boolean_of,
}


def scalar_of(kind: str, text: str, location: str) -> Scalar:
    """Return the value of a text of a scalar kind."""
    read = OF_TEXT.get(kind)
    return text if read is None else read(text, location)


def entry_kind(kind: str) -> str:
    """Return the kind of the entries of an array or a matrix, a scalar kind as it is."""
    for end in ("_arrays", "_array", "_matrix"):
        kind = kind.removesuffix(end)
    return kind.removeprefix("array_of_")


def kind_of(attribute: str, texts: Sequence[str]) -> str:
    """Return the kind of the entries of an attribute's value that XML writes as text only.

    `kinds.toml` lists the attributes of REXS 1.0 to 2.0.0 whose kind their text does not show. Of
    others, and where the text is no value of the listed kind, a number is a floating point, true and false
    are boolean, and any other text is a string. Without a text the kind is that of a number, not given.
    """
    listed = owners("kinds").get(attribute)
    if listed and _all_of(listed, texts):
        return listed
    return next((kind for kind in _EVIDENT_KINDS if _all_of(kind, texts)), "string")


def _all_of(kind: str, texts: Sequence[str]) -> bool:
    try:
        for text in texts:
            scalar_of(kind, text, "")
    except BadInput:
        return False
    return True


def texts_of(value: Value) -> list[str]:
    """Return the texts of all entries of a value, none of one that is not given."""
    if value is None:
        return []
    rows = value if isinstance(value, tuple) else (value,)
    return [text_of(entry) for row in rows for entry in (row if isinstance(row, tuple) else (row,))]


def text_of(value: Scalar) -> str:
    """Return a value as XML writes it; a float reads back the same to the last bit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)


def decoded(code: str, text: str, location: str) -> Array:
    """Return the numbers of a base64 text."""
    if code not in CODES:
        raise BadInput.of(location, code, "one of " + ", ".join(CODES))
    numbers = array.array(CODES[code])
    try:
        numbers.frombytes(base64.b64decode("".join(text.split()), validate=True))
    except (ValueError, binascii.Error):
        raise BadInput.of(location, text[:40], f"base64 of whole {code} numbers") from None
    if sys.byteorder == "big":
        numbers.byteswap()
    if code != "int32" and not all(map(math.isfinite, numbers)):
        raise BadInput.of(location, "a number that is not finite", "finite numbers")
    return tuple(numbers)


def coded(code: str, values: Sequence[Scalar]) -> str:
    """Return numbers as base64 of a code."""
    numbers = array.array(CODES[code], values)  # type: ignore[type-var]  # numbers, by the kind
    if sys.byteorder == "big":
        numbers.byteswap()
    return base64.b64encode(numbers.tobytes()).decode("ascii")


def rows_of(values: Array, rows: int, columns: int, location: str) -> tuple[Array, ...]:
    """Return the rows of a matrix of which base64 holds all values, row by row."""
    if rows < 0 or columns < 0 or rows * columns != len(values):
        raise BadInput.of(location, f"{rows} x {columns}", f"the size of a matrix of {len(values)} values")
    return tuple(values[start : start + columns] for start in range(0, len(values), columns or 1))
