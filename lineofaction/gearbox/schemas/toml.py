"""TOML of cases and scenes: untrusted text read within bounds, written without fields that are not set."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

from lineofaction.gearbox.problems import BadInput, Fault

_MAX_PARTS = 32
"""Largest number of parts of a dotted key."""
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
"""Pattern of a part of a key, bare or in quotes; ++ and *+ never go back, so the search takes linear time."""
_FORM = "Write NAME = VALUE (a number, a text in quotes, a list in brackets) or a [table]."
"""Remedy of a text that is not TOML."""
_TABLE, _TABLE_OF_LIST = "[{}]", "[[{}]]"
"""Heads of a table and of a table in a list, for its dotted name."""
_LONG_KEY = re.compile(rf"(?<![\w-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{_MAX_PARTS}}}")


def toml_table(text: str, field: str) -> dict[str, Any]:
    """Return the table of a TOML text.

    Raises `BadInput`: it is not well formed, nested deeper than the reader's stack, has a number of thousands
    of digits, or a key of more than 32 parts: reading such a key takes time and memory with the square of its
    length.

    Parameters
    ----------
    field : str
        Name of the text in an error.
    """
    if _LONG_KEY.search(text) is not None:
        raise BadInput.of(
            field, None, f"TOML with keys of at most {_MAX_PARTS} parts", "See docs/case-file.md."
        )
    try:
        return tomllib.loads(text)
    except ValueError as error:  # of TOML, or of a number with too many digits
        raise BadInput([_fault(field, text, str(error))]) from None
    except RecursionError:
        raise BadInput.of(field, None, "TOML of less depth", "See docs/case-file.md.") from None


def _fault(field: str, text: str, message: str) -> Fault:
    """Return the fault of a TOML text, with the line that the reader's `message` names, if it names one."""
    reason, at, where = message.partition(" (at line ")
    number = where.partition(",")[0]
    if not at or not number.isdigit():
        return Fault(field, None, "well-formed TOML", f"{message}.")
    line = text.splitlines()[int(number) - 1].strip() if int(number) <= len(text.splitlines()) else ""
    bound = f"well-formed TOML, which line {number} is not"
    return Fault(field, line or None, bound, f"{reason}. {_FORM}")


def toml_text(content: Mapping[str, Any]) -> str:
    """Return a table as TOML: tables, lists of tables, numbers, texts, booleans, nested lists.

    Fields that are None are left out.
    """
    return "\n".join(_table(content, ())).strip() + "\n"


def _table(content: Mapping[str, Any], path: tuple[str, ...], head: str = _TABLE) -> Iterator[str]:
    """Yield the lines of a table: its head, its values, then the tables in it."""
    present = {name: value for name, value in content.items() if value is not None}
    values = {name: value for name, value in present.items() if not _holds_tables(value)}
    # a table that holds tables alone needs no head: theirs name it
    if path and (values or not present or head != _TABLE):
        yield f"\n{head.format('.'.join(path))}"
    for name, value in values.items():
        yield f"{name} = {_value(value)}"
    for name, value in present.items():
        if isinstance(value, Mapping):
            yield from _table(value, (*path, name))
        elif _holds_tables(value):
            for item in value:
                yield from _table(item, (*path, name), _TABLE_OF_LIST)


def _holds_tables(value: Any) -> bool:
    return isinstance(value, Mapping) or (
        isinstance(value, list | tuple) and bool(value) and all(isinstance(item, Mapping) for item in value)
    )


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return f"[{', '.join(_value(item) for item in value)}]"
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("these files hold finite numbers only")
    # texts are written as in JSON; integers and finite floats as Python does
    return json.dumps(value) if isinstance(value, str) else repr(value)
