"""REXS files: read by their content, checked, written by their name.

REXS is an exchange format of gear units: components with attributes, and relations between components.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from lineofaction.gearbox.problems import BadInput, Fault
from lineofaction.gearbox.rexs.archive import MAX_BYTES, archive_of, read_archive
from lineofaction.gearbox.rexs.json_form import json_of, read_json
from lineofaction.gearbox.rexs.model import Document, Model
from lineofaction.gearbox.rexs.xml_form import read_xml, xml_of

_ASSEMBLIES = ("assembly", "ordered_assembly")
"""Types of the relations that make a component a part of another."""
_MAX_FAULTS = 20
"""Faults of a model that one message lists."""
_ZIP_START = b"PK"
_UTF8_MARK = b"\xef\xbb\xbf"
"""Byte order mark, which some programs write before the text."""

ENDINGS = (".rexs", ".rexsj", ".rexsz", ".rexs.zip")
"""Endings of the names: XML, JSON, and twice a ZIP archive of XML and other files."""


def read_rexs(path: Path) -> Document:
    """Return the content of a REXS file: XML, JSON or ZIP by its bytes. No other file is opened.

    Raises `BadInput` if the file is missing, too large or damaged, or if its model is unsound: an id is given
    twice, a reference has no component, or a component is part of itself. The message names the place.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise BadInput.of("file", str(path), f"a file that can be read ({error.strerror})") from None
    return parsed(data)


def parsed(data: bytes) -> Document:
    """Return the document of a file's bytes."""
    if len(data) > MAX_BYTES:
        raise BadInput.of("file", f"more than {MAX_BYTES} bytes", "smaller")
    text, files = read_archive(data) if data.startswith(_ZIP_START) else (data, {})
    start = text.removeprefix(_UTF8_MARK).lstrip()[:1]
    model = read_json(text) if start == b"{" else read_xml(text)
    _check(model)
    return Document(model, files)


def serialized(document: Document, name: str) -> bytes:
    """Return a document in the form that the ending of a file's name says.

    Raises `BadInput` if the ending is none of `ENDINGS`, if the model is unsound, or if the document has
    other files and the ending is not that of an archive.
    """
    ending = next((end for end in reversed(ENDINGS) if name.lower().endswith(end)), None)
    if ending is None:
        raise BadInput.of("file", name, "a name that ends in one of " + ", ".join(ENDINGS))
    _check(document.model)
    if ending in (".rexsz", ".rexs.zip"):
        return archive_of(xml_of(document.model), document.files)
    if document.files:
        raise BadInput.of("file", name, "an archive (.rexsz): other files belong to the model")
    return json_of(document.model) if ending == ".rexsj" else xml_of(document.model)


def _check(model: Model) -> None:
    faults = [*_repeated_faults(model), *_dangling(model), *_cycles(model)]
    if faults:
        raise BadInput(faults[:_MAX_FAULTS])


def _repeated_faults(model: Model) -> Iterator[Fault]:
    lists = {
        "component": [component.id for component in model.components],
        "relation": [relation.id for relation in model.relations],
        "load spectrum": [spectrum.id for spectrum in model.spectra],
    }
    for spectrum in model.spectra:
        lists[f"load spectrum {spectrum.id}, load case"] = [case.id for case in spectrum.cases]
    for location, ids in lists.items():
        yield from (
            Fault(location, number, "an id given once") for number, count in Counter(ids).items() if count > 1
        )


def _dangling(model: Model) -> Iterator[Fault]:
    known = {component.id for component in model.components}
    bound = "the id of a component"
    for relation in model.relations:
        yield from (
            Fault(f"relation {relation.id}, {ref.role}", ref.id, bound)
            for ref in relation.refs
            if ref.id not in known
        )
    for location, part in model.all_components():
        if part.id not in known:
            yield Fault(location, part.id, bound)
        for attribute in part.attributes:
            if attribute.kind == "reference_component" and attribute.value not in {None, *known}:
                yield Fault(f"{location}, {attribute.id}", attribute.value, bound)


def _cycles(model: Model) -> Iterator[Fault]:
    """Yield the components that are parts of themselves, directly or by others, and the holders of these.

    A component is settled when all its parts are: those without parts at once, their holders after them. A
    component that never settles is on a cycle, or holds a component that is. They come in order of their ids.
    """
    parts: dict[int, set[int]] = {}
    for relation in model.relations:
        assembly, part = relation.of_role("assembly"), relation.of_role("part")
        if relation.type in _ASSEMBLIES and assembly is not None and part is not None:
            parts.setdefault(assembly, set()).add(part)
    holders: dict[int, set[int]] = {}
    for assembly, inner in parts.items():
        for part in inner:
            holders.setdefault(part, set()).add(assembly)
    open_parts = {assembly: len(inner) for assembly, inner in parts.items()}
    settled = [part for part in holders if part not in parts]
    while settled:
        for assembly in holders.get(settled.pop(), ()):
            open_parts[assembly] -= 1
            if not open_parts[assembly]:
                settled.append(assembly)
    for number in sorted(assembly for assembly, count in open_parts.items() if count):
        yield Fault(f"component {number}", number, "no part of itself, nor whole of one that is")
