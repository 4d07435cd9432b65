"""REXS's JSON form (``.rexsj``), read into a model and written from one; anything ambiguous is refused.

The kind of a value is REXS's name of its type: an entry ("integer", "floating_point", ...), or an array or
matrix of entries. Large arrays are coded in base64, in a field of the kind's name and ``_coded``.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NoReturn

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Extra, LoadSpectrum, Model, Scalar, Value
from lineofaction.gearbox.rexs.tree import MAX_ENTRIES, Element, Written, written
from lineofaction.gearbox.rexs.values import KINDS, coded, decoded, entry_kind, integer_of, rows_of
from lineofaction.gearbox.shallow_json import shallow_json

_TYPES: dict[str, tuple[type, ...]] = {
    "floating_point": (float, int),
    "integer": (int,),
    "reference_component": (int,),
    "boolean": (bool,),
}
_TEXT = (str,)
"""Type of values of all other kinds."""
_CODED = "_coded"
"""End of the name of a field with a coded value."""
_TYPE_NAMES = {dict: "a table", list: "a list", str: "a text", int: "an integer"}


@dataclass(slots=True)
class _Table(Element):
    """A table of the JSON form with its location in the file.

    Fields are removed as they are read, so that the rest is what REXS does not define (`extra`).
    """

    location: str
    fields: dict[str, Any]
    line: None = None
    """Line in the file, which JSON's reader does not state."""

    @classmethod
    def of(cls, value: Any, location: str) -> _Table:
        """Return a table; refuse any other value."""
        return cls(location, _typed(value, dict, location))

    def text(self, name: str) -> str:
        text: str = _typed(self.fields.pop(name, None), str, f"{self.location}.{name}")
        return text

    def optional_text(self, name: str) -> str | None:
        if self.fields.get(name) is None:
            self.fields.pop(name, None)
            return None
        return self.text(name)

    def number(self, name: str) -> int:
        number: int = _typed(self.fields.pop(name, None), int, f"{self.location}.{name}")
        return number

    def optional_number(self, name: str) -> int | None:
        if self.fields.get(name) is None:
            self.fields.pop(name, None)
            return None
        return self.number(name)

    def parts(self, name: str) -> list[_Table]:
        location = f"{self.location}.{name}s"
        entries = _typed(self.fields.pop(f"{name}s", None), list, location)
        return [_Table.of(entry, f"{location}[{index}]") for index, entry in enumerate(entries)]

    def extra(self) -> Extra:
        return tuple((name, self.text(name)) for name in list(self.fields))

    def type_of(self, inherited: str | None) -> str:
        """Return the type of a component; one without it has the inherited type."""
        kind = self.fields.get("type")
        if kind in (None, "") and inherited is not None:
            self.fields.pop("type", None)
            return inherited
        return self.text("type")

    def attribute(self) -> Attribute:
        name = self.text("id")
        kinds = [field for field in self.fields if entry_kind(field.removesuffix(_CODED)) in KINDS]
        if len(kinds) != 1:
            raise BadInput.of(self.location, ", ".join(kinds) or None, "one value of a type of REXS")
        location, kind = f"{self.location}, {name}", kinds[0].removesuffix(_CODED)
        plain = self.fields.pop(kinds[0])
        code = None
        if kinds[0].endswith(_CODED):
            body = _Table.of(plain, location)
            code = body.text("code")
            value = body._decoded_value(kind, code)
        else:
            value = _value(kind, plain, location)
        unit, origin = self.optional_text("unit"), self.optional_text("origin")
        return Attribute(
            id=name, kind=kind, value=value, unit=unit, code=code, origin=origin, extra=self.extra()
        )

    def _decoded_value(self, kind: str, code: str) -> Value:
        """Return the value of an array or a matrix in base64."""
        entry = entry_kind(kind)
        # a single entry is never coded; int32 is the one code of integers
        if entry != ("integer" if code == "int32" else "floating_point") or kind == entry:
            raise BadInput.of(self.location, code, f"a code of {kind}")
        values = decoded(code, self.text("value"), self.location)
        if kind.endswith("_matrix"):
            return rows_of(values, self.number("rows"), self.number("columns"), self.location)
        return values


def read_json(data: bytes) -> Model:
    """Return the model of a JSON text in UTF-8, with or without byte-order mark.

    Raises `BadInput`: it is no JSON, nested too deep, too large, has a field twice or a number that is not
    finite, or is no REXS.
    """
    root = _Table.of(_Table.of(_json(data), "file").fields.get("model"), "model")
    further: dict[str, Any] = {
        name: root.fields.pop(name) for name in ("load_spectrum", "accumulation") if name in root.fields
    }
    components = tuple(part.component({}) for part in root.parts("component"))
    types = {component.id: component.type for component in components}
    relations = (part.relation() for part in root.parts("relation"))
    return root.model(relations, components, _spectra(further, types))


def _spectra(further: dict[str, Any], types: dict[int, str]) -> Iterator[LoadSpectrum]:
    """Yield the load spectrum, if any, with its accumulation, which is its sibling in the file.

    A component of a load case may leave its type to the component of its id.
    """
    if further.get("load_spectrum") is None:
        if "accumulation" in further:
            raise BadInput.of("model.accumulation", "an accumulation", "beside a load spectrum")
        return
    table = _Table.of(further["load_spectrum"], "model.load_spectrum")
    cases = table.parts("load_case") if "load_cases" in table.fields else []
    loads = tuple(case.load_case(types) for case in cases)
    number, extra, accumulation = table.number("id"), table.extra(), None
    if further.get("accumulation") is not None:
        parts = _Table.of(further["accumulation"], "model.accumulation").parts("component")
        accumulation = tuple(part.component(types) for part in parts)
    yield LoadSpectrum(id=number, cases=loads, accumulation=accumulation, extra=extra)


def _json(data: bytes) -> Any:
    # count values before they are read: they take far more memory than their text
    if sum(data.count(mark) for mark in (b",", b"[", b"{")) > MAX_ENTRIES:
        raise BadInput.of("file", f"more than {MAX_ENTRIES} values", "smaller", "Code arrays in base64.")
    try:
        return shallow_json(
            data.decode("utf-8-sig"),
            parse_constant=_no_number,
            parse_int=lambda text: integer_of(text, "file"),
            object_pairs_hook=_unique,
        )
    except json.JSONDecodeError as error:
        raise BadInput.of(f"line {error.lineno}", error.msg, "JSON") from None
    except UnicodeDecodeError as error:
        raise BadInput.of(f"byte {error.start}", error.reason, "UTF-8") from None
    except RecursionError:
        raise BadInput.of("file", "too many lists and tables in each other", "nested as a model is") from None


def _typed(value: Any, kind: type, location: str) -> Any:
    """Return a value of a type; true and false are no integers."""
    if not isinstance(value, kind) or isinstance(value, bool):
        raise BadInput.of(location, None if value is None else _preview(value), _TYPE_NAMES[kind])
    return value


def _preview(plain: Any) -> Any:
    return plain if isinstance(plain, (str, int, float)) else type(plain).__name__


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return the fields of a table, each given once."""
    table = dict(pairs)
    if len(table) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise BadInput.of("file", twice, "given once in its table")
    return table


def _no_number(text: str) -> NoReturn:
    """Refuse NaN and Infinity, which JSON does not have."""
    raise BadInput.of("file", text, "a finite number")


def _value(kind: str, plain: Any, location: str) -> Value:
    """Return a value of a kind from plain JSON; None for null and for blank text."""
    entry = entry_kind(kind)
    if plain is None or (isinstance(plain, str) and not plain.strip()):
        return None
    if kind == entry:
        return _scalar(entry, plain, location)
    if kind.endswith("_array"):
        return tuple(_scalar(entry, part, location) for part in _list(plain, location))
    return tuple(
        tuple(_scalar(entry, part, location) for part in _list(row, location))
        for row in _list(plain, location)
    )


def _scalar(kind: str, plain: Any, location: str) -> Scalar:
    """Return a value of a scalar kind; a floating point may be written as an integer."""
    types: Any = _TYPES.get(kind, _TEXT)
    if not isinstance(plain, types) or (isinstance(plain, bool) and bool not in types):
        raise BadInput.of(location, _preview(plain), f"of type {kind}")
    value: Scalar = float(plain) if kind == "floating_point" else plain
    if isinstance(value, float) and not math.isfinite(value):
        raise BadInput.of(location, str(value), "a finite number")
    return value


def _list(plain: Any, location: str) -> list[Any]:
    if not isinstance(plain, list):
        raise BadInput.of(location, type(plain).__name__, "a list")
    return plain


def json_of(model: Model) -> bytes:
    """Return a model as JSON in UTF-8, the same bytes at every time."""
    if len(model.spectra) > 1:
        raise BadInput.of("load_spectrum", f"{len(model.spectra)} spectra", "one in JSON", "Write XML.")
    table = _written(written(model))
    for spectrum in table.pop("load_spectra"):
        accumulation = spectrum.pop("accumulation", None)
        table["load_spectrum"] = spectrum
        if accumulation is not None:
            table["accumulation"] = {"components": accumulation}
    text = json.dumps({"model": table}, ensure_ascii=False, indent=1, allow_nan=False)
    return f"{text}\n".encode()


def _written(element: Written | Attribute) -> dict[str, Any]:
    if isinstance(element, Attribute):
        return _attribute(element)
    groups = {name: [_written(part) for part in parts] for name, parts in element.groups.items()}
    return element.fields | groups


def _attribute(attribute: Attribute) -> dict[str, Any]:
    """Return an attribute; one without a value says null."""
    known = {"id": attribute.id, "unit": attribute.unit, "origin": attribute.origin, **dict(attribute.extra)}
    fields = {name: value for name, value in known.items() if value is not None}
    value: Any = attribute.value
    if attribute.code is None or value is None:
        return {**fields, attribute.kind: value}
    body: dict[str, Any] = {"code": attribute.code}
    if attribute.kind.endswith("_matrix"):
        numbers = [number for row in value for number in row]
        size = {"rows": len(value), "columns": len(value[0]) if value else 0}
        body |= {"value": coded(attribute.code, numbers), **size}
    else:
        body["value"] = coded(attribute.code, value)
    return {**fields, f"{attribute.kind}{_CODED}": body}
