"""REXS's XML form (``.rexs``): a model from it and back."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat
from xml.sax.saxutils import escape, quoteattr

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Array, Attribute, Extra, LoadSpectrum, Model, Scalar, Value
from lineofaction.gearbox.rexs.tree import MAX_ENTRIES, Element, Written, written
from lineofaction.gearbox.rexs.values import (
    KINDS,
    coded,
    decoded,
    entry_kind,
    integer_of,
    kind_of,
    rows_of,
    scalar_of,
    text_of,
    texts_of,
)

_MAX_DEPTH = 32
"""Largest depth of nested elements that is read."""
_PREVIEW = 60
"""Number of characters quoted of a line that is not well-formed."""

_ENCODINGS = ("utf-8", "utf-16", "utf-16le", "utf-16be", "us-ascii", "iso-8859-1", "windows-1252")
"""Encodings of XML files: those that expat decodes itself, and those of writers on Windows."""

_KIND_FIELD = "valueType"
"""XML field, of ours, with the kind of a value whose text would be read as another kind. REXS allows
additional fields.
"""

_STEP = "  "
"""Indentation of a level."""
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML cannot hold."""
_WRAPPED = {"model": ("relations", "components"), "load_spectrum": ("accumulation",)}
"""Groups of parts that XML wraps in an element, by the outer element."""


@dataclass(slots=True)
class _XmlElement(Element):
    """An element: its fields, its elements, and its text between them."""

    name: str
    line: int
    fields: dict[str, str]
    inside: list[_XmlElement] = field(default_factory=list)
    characters: list[str] = field(default_factory=list)

    @property
    def location(self) -> str:
        return f"line {self.line}, {self.name}"

    def content(self) -> str:
        """Return the text directly inside, empty if it is blank."""
        text = "".join(self.characters)
        return text if text.strip() else ""

    def text(self, name: str) -> str:
        text = self.fields.pop(name, None)
        if text is None:
            raise BadInput.of(f"{self.location}, {name}", None, "given")
        return text

    def optional_text(self, name: str) -> str | None:
        return self.fields.pop(name, None)

    def number(self, name: str) -> int:
        return integer_of(self.text(name), f"{self.location}, {name}")

    def optional_number(self, name: str) -> int | None:
        text = self.fields.pop(name, None)
        return None if text is None else integer_of(text, self.location)

    def parts(self, name: str) -> list[_XmlElement]:
        return self.groups({name: None})[name]

    def extra(self) -> Extra:
        return tuple(self.fields.items())

    def groups(self, known: dict[str, int | None]) -> dict[str, list[_XmlElement]]:
        """Return the elements inside by their names.

        `known` are the names that there may be: None for any number of elements, 1 for at most one.
        """
        groups: dict[str, list[_XmlElement]] = {name: [] for name in known}
        for part in self.inside:
            name = part.name.rpartition(":")[2]  # without a prefix of a namespace
            if name not in groups:
                raise BadInput.of(part.location, part.name, "one of " + ", ".join(known))
            groups[name].append(part)
            if known[name] is not None and len(groups[name]) > 1:
                raise BadInput.of(part.location, part.name, "given once")
        return groups

    def group(self, name: str) -> list[_XmlElement]:
        """Return the elements of a group, which has no fields of its own."""
        for field_name in self.fields:  # the first one is at fault
            raise BadInput.of(self.location, field_name, "left out: a group has no fields")
        return self.parts(name)

    def attribute(self) -> Attribute:
        name = self.text("id")
        shapes = self.groups({"array": 1, "matrix": 1, "array_of_arrays": 1})
        bodies = [part for group in shapes.values() for part in group]
        if len(bodies) > 1 or (bodies and self.content()):
            raise BadInput.of(self.location, name, "one value, array or matrix")
        is_kind = entry_kind(self.fields.get(_KIND_FIELD, "")) in KINDS
        kind_name = self.fields.pop(_KIND_FIELD) if is_kind else None
        kind, value, code = bodies[0]._shaped(name, kind_name) if bodies else self._scalar(name, kind_name)
        unit, origin = self.optional_text("unit"), self.optional_text("origin")
        return Attribute(name, kind, value, unit, code, origin, self.extra())

    def _scalar(self, name: str, kind_name: str | None) -> tuple[str, Value, None]:
        """Return kind, value and code of a scalar: the code is None, and so is the value without a text."""
        text = self.content()
        if not text:
            return kind_name or kind_of(name, []), None, None
        kind = entry_kind(kind_name) if kind_name else kind_of(name, [text])
        return kind, scalar_of(kind, text, f"{self.location}, {name}"), None

    def _shaped(self, name: str, kind_name: str | None) -> tuple[str, Value, str | None]:
        """Return kind, value and code of an array, a matrix or an array of arrays.

        The code is the type of numbers in base64; None: the entries are elements.
        """
        location = f"{self.location}, {name}"
        code = self.fields.get("code")
        if code is not None:
            return self._coded(code, location)
        is_array = self.name == "array"
        bodies = [self] if is_array else self.parts("r" if self.name == "matrix" else "array")
        texts = [["".join(cell.characters) for cell in body.parts("c")] for body in bodies]
        kind = entry_kind(kind_name) if kind_name else kind_of(name, [text for row in texts for text in row])
        rows = tuple(tuple(scalar_of(kind, text, location) for text in row) for row in texts)
        if is_array:
            return f"{kind}_array", rows[0], None
        return f"{kind}_matrix" if self.name == "matrix" else f"array_of_{kind}_arrays", rows, None

    def _coded(self, code: str, location: str) -> tuple[str, Value, str]:
        """Return kind, value and code of an array or matrix in base64."""
        if self.inside or self.name == "array_of_arrays":
            raise BadInput.of(location, self.name, "an array or a matrix in base64, or one of elements")
        values = decoded(code, "".join(self.characters), location)
        kind = "integer" if code == "int32" else "floating_point"
        if self.name == "array":
            return f"{kind}_array", values, code
        rows, columns = self.number("rows"), self.number("columns")
        return f"{kind}_matrix", rows_of(values, rows, columns, location), code

    def spectrum(self) -> LoadSpectrum:
        parts = self.groups({"load_case": None, "accumulation": 1})
        cases = tuple(case.load_case({}) for case in parts["load_case"])
        groups = [group.group("component") for group in parts["accumulation"]]
        accumulation = tuple(part.component({}) for part in groups[0]) if groups else None
        return LoadSpectrum(self.number("id"), cases, accumulation, self.extra())


def read_xml(data: bytes) -> Model:
    """Return the model of an XML text; comments are not kept.

    No codec is looked up by a name of the file.

    Raises `BadInput`: it is not well-formed, declares a document type or an entity, is too deep or too large,
    or is no REXS.
    """
    root = _root(data)
    if root.name.rpartition(":")[2] != "model":
        raise BadInput.of(root.location, root.name, "model, the root of a REXS file")
    parts = root.groups({"relations": 1, "components": 1, "load_spectrum": None})
    return root.model(
        (part.relation() for group in parts["relations"] for part in group.group("relation")),
        (part.component({}) for group in parts["components"] for part in group.group("component")),
        (part.spectrum() for part in parts["load_spectrum"]),
    )


def _root(data: bytes) -> _XmlElement:
    """Return the root element of an XML text."""
    builder = _Builder()
    try:
        builder.parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages.get(error.code, "unknown")
        bound = f"well-formed XML, which line {error.lineno} is not ({reason})"
        lines = data.splitlines()[error.lineno - 1 : error.lineno]
        first_line = lines[0].strip()[:_PREVIEW].decode(errors="replace") if lines else ""
        raise BadInput.of("file", first_line, bound, "REXS is XML, JSON or a ZIP of them.") from None
    return builder.root.inside[0]


class _Builder:
    """Builds the elements from expat's events; document types, entities and depth are refused."""

    def __init__(self) -> None:
        self.root = _XmlElement("", 0, {})  # around the root element of the text
        self._open = [self.root]  # elements that have begun and not ended, the outermost first
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = lambda _name: self._open.pop()
        self.parser.CharacterDataHandler = self._characters
        self.parser.StartDoctypeDeclHandler = self._document_type
        self.parser.XmlDeclHandler = self._declaration
        self._count = 0

    def _start(self, name: str, fields: dict[str, str]) -> None:
        line = self.parser.CurrentLineNumber
        self._count += 1
        if self._count > MAX_ENTRIES:
            too_many = f"more than {MAX_ENTRIES} elements"
            raise BadInput.of(f"line {line}", too_many, "smaller", "Code arrays in base64.")
        if len(self._open) > _MAX_DEPTH:
            depth = f"elements nested {len(self._open)} deep"
            raise BadInput.of(f"line {line}", depth, f"at most {_MAX_DEPTH} deep")
        element = _XmlElement(name, line, fields)
        self._open[-1].inside.append(element)
        self._open.append(element)

    def _characters(self, text: str) -> None:
        self._open[-1].characters.append(text)

    def _declaration(self, version: str, encoding: str | None, standalone: int) -> None:
        del version, standalone
        if encoding is not None and encoding.lower() not in _ENCODINGS:
            known = f"one of {', '.join(_ENCODINGS)}"
            raise BadInput.of("encoding", encoding[:_PREVIEW], known, "Write UTF-8.")

    def _document_type(self, name: str, *rest: object) -> NoReturn:
        del rest
        raise BadInput.of("document type", name, "left out: REXS has none, and entities are not read")


def xml_of(model: Model) -> bytes:
    """Return a model as XML in UTF-8; the same model gives the same bytes."""
    text = "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', *_lines(written(model)), ""])
    unfit = _NO_XML.search(text)
    if unfit:
        raise BadInput.of("model", unfit[0], "of characters that XML can hold")
    return text.encode("utf-8")


def _lines(element: Written | Attribute, indent: str = "") -> Iterator[str]:
    if isinstance(element, Attribute):
        yield f"{indent}{_attribute(element)}"
        return
    start = f"{indent}<{element.name}{_fields(element.fields)}"
    if element.name == "ref":
        yield f"{start}/>"
        return
    yield f"{start}>"
    inner = indent + _STEP
    for name, parts in element.groups.items():
        if name in _WRAPPED.get(element.name, ()):
            yield f"{inner}<{name}>"
            yield from (line for part in parts for line in _lines(part, inner + _STEP))
            yield f"{inner}</{name}>"
        else:
            yield from (line for part in parts for line in _lines(part, inner))
    yield f"{indent}</{element.name}>"


def _fields(fields: Mapping[str, str | int]) -> str:
    """Return fields in quotes; ends of lines in values are preserved."""
    escapes = {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
    return "".join(f" {name}={quoteattr(str(value), escapes)}" for name, value in fields.items())


def _attribute(attribute: Attribute) -> str:
    known = {"id": attribute.id, "unit": attribute.unit, "origin": attribute.origin}
    known[_KIND_FIELD] = _hidden_kind(attribute)
    fields = {name: value for name, value in known.items() if value is not None} | dict(attribute.extra)
    return f"<attribute{_fields(fields)}>{_body(attribute)}</attribute>"


def _hidden_kind(attribute: Attribute) -> str | None:
    """Return the kind of a value whose text shows another, else None."""
    if attribute.code is not None:
        return None
    entry = kind_of(attribute.id, texts_of(attribute.value))
    rows = isinstance(attribute.value, tuple) and any(isinstance(row, tuple) for row in attribute.value)
    forms = (f"{entry}_matrix", f"array_of_{entry}_arrays") if rows else (f"{entry}_array",)
    visible = forms if isinstance(attribute.value, tuple) else (entry,)
    return None if attribute.kind in visible else attribute.kind


def _body(attribute: Attribute) -> str:
    kind, value, code = attribute.kind, attribute.value, attribute.code
    if value is None:
        return ""
    if not isinstance(value, tuple):
        return escape(text_of(value))
    rows: list[Array] = [row for row in value if isinstance(row, tuple)]
    scalars: list[Scalar] = [entry for entry in value if not isinstance(entry, tuple)]
    if code is not None:
        text = coded(code, [*scalars, *(number for row in rows for number in row)])
        size = f'rows="{len(rows)}" columns="{len(rows[0]) if rows else 0}"'
        matrix = f'<matrix code="{code}" {size}>{text}</matrix>'
        return f'<array code="{code}">{text}</array>' if kind.endswith("_array") else matrix
    if kind.startswith("array_of_"):
        inside = "".join(f"<array>{_cells(row)}</array>" for row in rows)
        return f"<array_of_arrays>{inside}</array_of_arrays>"
    if kind.endswith("_matrix"):
        return f"<matrix>{''.join(f'<r>{_cells(row)}</r>' for row in rows)}</matrix>"
    return f"<array>{_cells(scalars)}</array>"


def _cells(values: Sequence[Scalar]) -> str:
    return "".join(f"<c>{escape(text_of(value))}</c>" for value in values)
