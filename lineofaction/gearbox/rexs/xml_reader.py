"""A model from REXS's XML form (``.rexs``)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat

from lineofaction.gearbox.rexs.kinds import KIND_FIELD, KINDS, entry_kind, kind_of
from lineofaction.gearbox.rexs.model import (
    Attribute,
    Component,
    Extra,
    LoadCase,
    LoadSpectrum,
    Model,
    Reference,
    Relation,
    Value,
)
from lineofaction.gearbox.rexs.refusal import MOST_DEPTH, MOST_ENTRIES, refused
from lineofaction.gearbox.rexs.values import decoded, integer_of, rows_of, scalar_of

# The elements of an XML text; document types, entities and depth are refused while it is read.


_SHOWN = 60
"""Characters of a line that is not well-formed."""

_ENCODINGS = ("utf-8", "utf-16", "utf-16le", "utf-16be", "us-ascii", "iso-8859-1", "windows-1252")
"""What expat decodes itself, and what writers on Windows use."""


@dataclass(slots=True)
class Element:
    """An element: its fields, its elements, and its text between them."""

    name: str
    line: int
    fields: dict[str, str]
    parts: list[Element] = field(default_factory=list)
    words: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """All text directly inside."""
        return "".join(self.words)


def _element_of(data: bytes) -> Element:
    """Return the root of an XML text in an encoding of its own: no codec is looked up by a name of the file.

    Raises
    ------
    BadInput
        It is not well-formed, declares a document type or an entity, or is too deep or too large.
    """
    builder = _Builder()
    try:
        builder.parser.Parse(data, True)
    except expat.ExpatError as error:
        words = expat.errors.messages.get(error.code, "unknown")
        bound = f"well-formed XML, which line {error.lineno} is not ({words})"
        raise refused(
            "file", _line(data, error.lineno), bound, "REXS is XML, JSON or a ZIP of them."
        ) from None
    return builder.root.parts[0]


def _line(data: bytes, number: int) -> str:
    """Return the beginning of a line, from 1."""
    lines = data.splitlines()[number - 1 : number]
    return lines[0].strip()[:_SHOWN].decode(errors="replace") if lines else ""


class _Builder:
    """Builds the elements from expat's events."""

    def __init__(self) -> None:
        self.root = Element("", 0, {})
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._characters
        self.parser.StartDoctypeDeclHandler = self._document_type
        self.parser.XmlDeclHandler = self._declaration
        self._open = [self.root]
        self._count = 0

    def _start(self, name: str, fields: dict[str, str]) -> None:
        line = self.parser.CurrentLineNumber
        self._count += 1
        if self._count > MOST_ENTRIES:
            raise refused(
                f"line {line}", f"more than {MOST_ENTRIES} elements", "smaller", "Code arrays in base64."
            )
        if len(self._open) > MOST_DEPTH:
            raise refused(
                f"line {line}", f"elements nested {len(self._open)} deep", f"at most {MOST_DEPTH} deep"
            )
        element = Element(name, line, fields)
        self._open[-1].parts.append(element)
        self._open.append(element)

    def _end(self, name: str) -> None:
        del name
        self._open.pop()

    def _characters(self, text: str) -> None:
        self._open[-1].words.append(text)

    def _declaration(self, version: str, encoding: str | None, standalone: int) -> None:
        del version, standalone
        if encoding is not None and encoding.lower() not in _ENCODINGS:
            raise refused("encoding", encoding[:_SHOWN], f"one of {', '.join(_ENCODINGS)}", "Write UTF-8.")

    def _document_type(self, name: str, *rest: object) -> NoReturn:
        del rest
        raise refused("document type", name, "left out: REXS has none, and entities are not read")


_OWN = ("id", "unit", "origin")


def read_xml(data: bytes) -> Model:
    """Return the model of an XML text; comments are not kept.

    Raises
    ------
    BadInput
        It is no XML that may be read, or no REXS.
    """
    root = _element_of(data)
    if root.name.rpartition(":")[2] != "model":
        raise refused(_place(root), root.name, "model, the root of a REXS file")
    parts = _parts(root, {"relations": 1, "components": 1, "load_spectrum": None})
    return Model(
        version=_text(root, "version"),
        application=_text(root, "applicationId"),
        application_version=_text(root, "applicationVersion"),
        date=_text(root, "date"),
        relations=tuple(
            _relation(part) for group in parts["relations"] for part in _inside(group, "relation")
        ),
        components=tuple(
            _component(part) for group in parts["components"] for part in _inside(group, "component")
        ),
        spectra=tuple(map(_spectrum, parts["load_spectrum"])),
        language=root.fields.get("applicationLanguage"),
        extra=_extra(root, "version", "applicationId", "applicationVersion", "date", "applicationLanguage"),
    )


def _relation(element: Element) -> Relation:
    order = element.fields.get("order")
    return Relation(
        id=_number(element, "id"),
        type=_text(element, "type"),
        refs=tuple(map(_reference, _only(element, "ref"))),
        order=None if order is None else integer_of(order, _place(element)),
        extra=_extra(element, "id", "type", "order"),
    )


def _reference(element: Element) -> Reference:
    """Return a component in a relation."""
    extra = _extra(element, "id", "role", "hint")
    return Reference(_number(element, "id"), _text(element, "role"), element.fields.get("hint"), extra)


def _component(element: Element) -> Component:
    return Component(
        id=_number(element, "id"),
        type=_text(element, "type"),
        attributes=tuple(map(_attribute, _only(element, "attribute"))),
        name=element.fields.get("name"),
        extra=_extra(element, "id", "type", "name"),
        line=element.line,
    )


def _spectrum(element: Element) -> LoadSpectrum:
    parts = _parts(element, {"load_case": None, "accumulation": 1})
    cases = tuple(
        LoadCase(_number(case, "id"), tuple(map(_component, _only(case, "component"))), _extra(case, "id"))
        for case in parts["load_case"]
    )
    whole = [tuple(map(_component, _inside(part, "component"))) for part in parts["accumulation"]]
    return LoadSpectrum(_number(element, "id"), cases, whole[0] if whole else None, _extra(element, "id"))


def _attribute(element: Element) -> Attribute:
    name = _text(element, "id")
    shapes = _parts(element, {"array": 1, "matrix": 1, "array_of_arrays": 1})
    bodies = [part for group in shapes.values() for part in group]
    if len(bodies) > 1 or (bodies and element.text.strip()):
        raise refused(_place(element), name, "one value, array or matrix")
    known = (*_OWN, KIND_FIELD) if entry_kind(element.fields.get(KIND_FIELD, "")) in KINDS else _OWN
    kind = element.fields.get(KIND_FIELD) if KIND_FIELD in known else None
    form, value, code = _shaped(name, bodies[0], kind) if bodies else _scalar(name, element, kind)
    fields = element.fields
    extra = _extra(element, *known)
    return Attribute(name, form, value, fields.get("unit"), code, fields.get("origin"), extra)


def _scalar(name: str, element: Element, said: str | None) -> tuple[str, Value, None]:
    """Return kind, value and no code of a scalar; an empty one has no value."""
    text = element.text if element.text.strip() else ""
    if not text:
        return said or kind_of(name, []), None, None
    kind = entry_kind(said) if said else kind_of(name, [text])
    return kind, scalar_of(kind, text, f"{_place(element)}, {name}"), None


def _shaped(name: str, body: Element, said: str | None) -> tuple[str, Value, str | None]:
    """Return kind, value and code of an array, a matrix or an array of arrays."""
    place = f"{_place(body)}, {name}"
    code = body.fields.get("code")
    if code is not None:
        return _coded(body, code, place)
    if body.name == "array":
        texts = _cells(body)
        kind = entry_kind(said) if said else kind_of(name, texts)
        return f"{kind}_array", tuple(scalar_of(kind, text, place) for text in texts), None
    rows = [_cells(row) for row in _only(body, "r" if body.name == "matrix" else "array")]
    kind = entry_kind(said) if said else kind_of(name, [text for row in rows for text in row])
    form = f"{kind}_matrix" if body.name == "matrix" else f"array_of_{kind}_arrays"
    return form, tuple(tuple(scalar_of(kind, text, place) for text in row) for row in rows), None


def _coded(body: Element, code: str, place: str) -> tuple[str, Value, str]:
    """Return kind, value and code of an array or matrix in base64."""
    if body.parts or body.name == "array_of_arrays":
        raise refused(place, body.name, "an array or a matrix in base64, or one of elements")
    values = decoded(code, body.text, place)
    kind = "integer" if code == "int32" else "floating_point"
    if body.name == "array":
        return f"{kind}_array", values, code
    rows, columns = (_number(body, name) for name in ("rows", "columns"))
    return f"{kind}_matrix", rows_of(values, rows, columns, place), code


def _cells(element: Element) -> list[str]:
    return [cell.text for cell in _only(element, "c")]


def _inside(group: Element, name: str) -> list[Element]:
    """Return the elements of a group, which has no fields of its own."""
    for name_of_field in group.fields:
        raise refused(_place(group), name_of_field, "left out: a group has no fields")
    return _only(group, name)


def _only(element: Element, name: str) -> list[Element]:
    """Return the elements of one name, where no other may be."""
    return _parts(element, {name: None})[name]


def _parts(element: Element, known: dict[str, int | None]) -> dict[str, list[Element]]:
    """Return the elements inside by their names, where `known` says how many there may be."""
    groups: dict[str, list[Element]] = {name: [] for name in known}
    for part in element.parts:
        name = part.name.rpartition(":")[2]
        if name not in groups:
            raise refused(_place(part), part.name, "one of " + ", ".join(known))
        groups[name].append(part)
        if known[name] is not None and len(groups[name]) > 1:
            raise refused(_place(part), part.name, "given once")
    return groups


def _text(element: Element, name: str) -> str:
    """Return a field that must be given."""
    text = element.fields.get(name)
    if text is None:
        raise refused(f"{_place(element)}, {name}", None, "given")
    return text


def _number(element: Element, name: str) -> int:
    """Return an integer that must be given."""
    return integer_of(_text(element, name), f"{_place(element)}, {name}")


def _extra(element: Element, *known: str) -> Extra:
    """Return the fields that REXS does not define."""
    return tuple((name, text) for name, text in element.fields.items() if name not in known)


def _place(element: Element) -> str:
    """Return where an element stands."""
    return f"line {element.line}, {element.name}"
