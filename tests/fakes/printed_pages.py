"""A printed report as its PDF says it is: pages, titles, pictures and tables, by the tags of its elements.

Places of what is drawn are in mm from the left and from the lower edge of its page.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pypdf import PdfReader
from pypdf.generic import ContentStream

Place = tuple[int, int]
"""Number of a page from 0, and of a piece of text on it."""
_MM = 25.4 / 72.0


@dataclass
class Element:
    """An element of the document, what it holds, and the pieces of text that are its own."""

    kind: str
    alternative: str = ""
    children: list[Element] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)

    def all(self, *kinds: str) -> Iterator[Element]:
        if self.kind in kinds:
            yield self
        for child in self.children:
            yield from child.all(*kinds)

    @property
    def everywhere(self) -> list[Place]:
        return [*self.places, *(place for child in self.children for place in child.everywhere)]

    @property
    def pages(self) -> set[int]:
        return {page for page, _ in self.everywhere}


class Printed:
    def __init__(self, content: bytes) -> None:
        self.size = len(content)
        reader = PdfReader(BytesIO(content))
        self._numbers = {page.indirect_reference.idnum: n for n, page in enumerate(reader.pages)}
        self._texts: dict[Place, str] = {}
        self.corners: defaultdict[int, list[NDArray[np.float64]]] = defaultdict(list)
        """By page: two opposite corners of each picture, and where each piece of text begins."""
        self.attachments = {name: files[0] for name, files in reader.attachments.items()}
        self.pages = [self._read(number, page) for number, page in enumerate(reader.pages)]
        self.pictures = [len(page.images) for page in reader.pages]
        root = reader.trailer["/Root"]["/StructTreeRoot"]
        self.document = self._element(root, None)

    def words(self, element: Element) -> str:
        """Return the text of an element, its spaces and ligatures made plain."""
        return plain("".join(self._texts.get(place, "") for place in element.everywhere))

    def titles(self) -> list[str]:
        """Return headings, titles of pictures and captions of tables, as they follow each other."""
        found = [self.words(each) for each in self.document.all("H1", "H2", "H3")]
        found += [self.words(each) for table in self.document.all("Table") for each in table.all("Caption")]
        pictures = (each.alternative.partition(". ")[0] for each in self.document.all("Figure"))
        return found + [plain(title) for title in pictures if title]

    def _read(self, number: int, page: Any) -> str:
        fonts = {name: _letters(font.get_object()) for name, font in page["/Resources"]["/Font"].items()}
        pieces_open: list[int | None] = [None]  # a ligature is a span within one
        letters: dict[bytes, str] = {}
        pieces: defaultdict[Place, str] = defaultdict(str)
        whole = ""
        drawn, text_at = [np.eye(3)], np.eye(3)
        for operands, name in ContentStream(page.get_contents(), page.pdf).operations:
            if name in (b"q", b"Q", b"cm"):
                _place(drawn, name, operands)
            elif name == b"Tm":
                text_at = _matrix(operands)
            elif name == b"Do":
                self.corners[number] += [_MM * (end @ drawn[-1])[:2] for end in ([0, 0, 1], [1, 1, 1])]
            elif name == b"BDC":
                pieces_open.append(operands[1].get("/MCID", pieces_open[-1]))
            elif name == b"EMC":
                pieces_open.pop()
            elif name == b"Tf":
                letters = fonts[operands[0]]
            elif name == b"Tj":
                text = _decoded(operands[0].original_bytes, letters)
                self.corners[number].append(_MM * (text_at @ drawn[-1])[2, :2])
                whole += text
                if (piece := pieces_open[-1]) is not None:
                    pieces[number, piece] += text
            elif name == b"ET":
                whole += " "
                if (piece := pieces_open[-1]) is not None:
                    pieces[number, piece] += " " * pieces_open.count(piece)
        self._texts |= {place: text + " " for place, text in pieces.items()}
        return plain(whole)

    def _element(self, tagged: Any, page: int | None) -> Element:
        tagged = tagged.get_object()
        page = self._numbers[tagged.raw_get("/Pg").idnum] if "/Pg" in tagged else page
        element = Element(str(tagged.get("/S", "")).lstrip("/"), str(tagged.get("/Alt", "")))
        held = tagged.get("/K", [])
        for each in held if isinstance(held, list) else [held]:
            inner = each.get_object()
            if isinstance(inner, int):
                assert page is not None
                element.places.append((page, inner))
            elif inner.get("/Type") == "/MCR":
                on = self._numbers[inner.raw_get("/Pg").idnum] if "/Pg" in inner else page
                assert on is not None
                element.places.append((on, int(inner["/MCID"])))
            else:
                element.children.append(self._element(inner, page))
        return element


def _place(drawn: list[NDArray[np.float64]], name: bytes, operands: Any) -> None:
    """Keep, restore or change the matrix by which a page is drawn, the last of those kept."""
    if name == b"q":
        drawn.append(drawn[-1])
    elif name == b"Q":
        drawn.pop()
    else:
        drawn[-1] = _matrix(operands) @ drawn[-1]


def _matrix(operands: Any) -> NDArray[np.float64]:
    """Return the matrix that moves points, as rows, from within to without."""
    return np.column_stack([np.array(operands, dtype=float).reshape(3, 2), [0.0, 0.0, 1.0]])


def _letters(font: Any) -> dict[bytes, str]:
    """Return what the codes of a font mean, by its own table."""
    table = font["/ToUnicode"].get_data().decode("ascii")
    found: dict[bytes, str] = {}
    for block in re.findall(r"beginbfchar(.*?)endbfchar", table, re.S):
        for code, text in re.findall(r"<(\w+)>\s*<(\w+)>", block):
            found[bytes.fromhex(code)] = bytes.fromhex(text).decode("utf-16-be")
    for block in re.findall(r"beginbfrange(.*?)endbfrange", table, re.S):
        for first, last, text in re.findall(r"<(\w+)>\s*<(\w+)>\s*<(\w+)>", block):
            for step in range(int(last, 16) - int(first, 16) + 1):
                code = (int(first, 16) + step).to_bytes(len(first) // 2)
                found[code] = chr(int(text, 16) + step)
    return found


def _decoded(codes: bytes, letters: dict[bytes, str]) -> str:
    size = len(next(iter(letters)))
    return "".join(letters[codes[at : at + size]] for at in range(0, len(codes), size))


def plain(text: str) -> str:
    """Return a text with plain spaces and without ligatures."""
    for one, letters in {"ﬁ": "fi", "ﬂ": "fl", "ﬀ": "ff", "ﬃ": "ffi", "ﬄ": "ffl"}.items():
        text = text.replace(one, letters)
    return " ".join(text.split())
