"""The elements of an XML text; document types, entities and depth are refused while it is read."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat

from lineofaction.gearbox.rexs.refusal import MOST_DEPTH, MOST_ENTRIES, refused

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


def element_of(data: bytes) -> Element:
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
