"""TOML from anybody: read within bounds, whatever it is made of."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from lineofaction.gearbox.problems import BadInput, Fault

_MOST_PARTS = 32
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_FORM = "Write NAME = VALUE (a number, a text in quotes, a list in brackets) or a [table]."
_LONG_KEY = re.compile(rf"(?<![\w-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{_MOST_PARTS}}}")


def toml_table(text: str, field: str) -> dict[str, Any]:
    """Return the table of a TOML text.

    Parameters
    ----------
    text : str
    field : str
        What the text is called in an error.

    Raises
    ------
    BadInput
        It is not well formed, nested deeper than the reader's stack, has a number of thousands of digits, or
        a key of more than 32 parts: reading such a key takes time and memory with the square of its length.
    """
    if _LONG_KEY.search(text) is not None:
        raise BadInput.of(
            field, None, f"TOML with keys of at most {_MOST_PARTS} parts", "See docs/case-file.md."
        )
    try:
        return tomllib.loads(text)
    except ValueError as error:  # of TOML, or of a number with too many digits
        raise BadInput([_fault(field, text, str(error))]) from None
    except RecursionError:
        raise BadInput.of(field, None, "TOML of less depth", "See docs/case-file.md.") from None


def _fault(field: str, text: str, message: str) -> Fault:
    """Return what is wrong with a TOML text, with the line and what is expected there."""
    words, at, where = message.partition(" (at line ")
    number = where.partition(",")[0]
    if not at or not number.isdigit():
        return Fault(field, None, "well-formed TOML", f"{message}.")
    line = text.splitlines()[int(number) - 1].strip() if int(number) <= len(text.splitlines()) else ""
    bound = f"well-formed TOML, which line {number} is not"
    return Fault(field, line or None, bound, f"{words}. {_FORM}")
