"""JSON with every doubt refused: fields given twice, numbers that are not finite, depth, size."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, NoReturn

from lineofaction.gearbox.rexs.model import Extra
from lineofaction.gearbox.rexs.refusal import MOST_ENTRIES, refused
from lineofaction.gearbox.rexs.values import integer_of


def value_of(data: bytes) -> Any:
    """Return the value of a JSON text in UTF-8, with or without byte-order mark.

    Raises
    ------
    BadInput
        It is no JSON, nested too deep, too large, or has a field twice or a number that is not finite.
    """
    if sum(data.count(mark) for mark in (b",", b"[", b"{")) > MOST_ENTRIES:
        raise refused("file", f"more than {MOST_ENTRIES} values", "smaller", "Code arrays in base64.")
    try:
        return json.loads(
            data.decode("utf-8-sig"),
            parse_constant=_no_number,
            parse_int=lambda text: integer_of(text, "file"),
            object_pairs_hook=_once,
        )
    except json.JSONDecodeError as error:
        raise refused(f"line {error.lineno}", error.msg, "JSON") from None
    except UnicodeDecodeError as error:
        raise refused(f"byte {error.start}", error.reason, "UTF-8") from None
    except RecursionError:
        raise refused("file", "too many lists and tables in each other", "nested as a model is") from None


@dataclass(frozen=True)
class Table:
    """A table of the JSON form with its place, of which fields are taken by name and type."""

    place: str
    fields: dict[str, Any]

    @classmethod
    def of(cls, value: Any, place: str) -> Table:
        """Return a table, refuse what is none."""
        return cls(place, _typed(value, dict, place))

    def text(self, name: str) -> str:
        """Return a text that must be given."""
        text: str = _typed(self.fields.get(name), str, self._at(name))
        return text

    def optional_text(self, name: str) -> str | None:
        """Return a text, None where it is not given."""
        return None if self.fields.get(name) is None else self.text(name)

    def number(self, name: str) -> int:
        """Return an integer that must be given."""
        number: int = _typed(self.fields.get(name), int, self._at(name))
        return number

    def tables(self, name: str, *, needed: bool = True) -> list[Table]:
        """Return the tables of a list, none of one that is not needed and not given."""
        if not needed and name not in self.fields:
            return []
        entries = _typed(self.fields.get(name), list, self._at(name))
        return [Table.of(entry, f"{self._at(name)}[{index}]") for index, entry in enumerate(entries)]

    def extra(self, *known: str) -> Extra:
        """Return the texts of fields that are not known; other values are refused."""
        names = [name for name in self.fields if name not in known]
        return tuple((name, self.text(name)) for name in names)

    def _at(self, name: str) -> str:
        return f"{self.place}.{name}"


_WORDS = {dict: "a table", list: "a list", str: "a text", int: "an integer"}


def _typed(value: Any, kind: type, place: str) -> Any:
    """Return a value of a type; true and false are no integers."""
    if not isinstance(value, kind) or isinstance(value, bool):
        shown = value if isinstance(value, (str, int, float, bool)) else type(value).__name__
        raise refused(place, shown if value is not None else None, _WORDS[kind])
    return value


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return the fields of a table, each given once."""
    table = dict(pairs)
    if len(table) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise refused("file", twice, "given once in its table")
    return table


def _no_number(text: str) -> NoReturn:
    """Refuse NaN and Infinity, which JSON does not have."""
    raise refused("file", text, "a finite number")
