"""Checks of the content of a mesh file before a reader gets it.

A content that names further files is refused, and so is one on which a reader would not end.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from io import BytesIO, TextIOWrapper
from pathlib import PurePath
from xml.parsers import expat

from dynamics.errors import InputError

FIELD = "mesh_file"
_ALONE = "Write all nodes and elements into one file."
_PART = 4096  # bytes that are parsed at once
Fault = tuple[str, str] | None
"""The bound that a content breaks, and what to do."""


def mesh_text(content: bytes) -> TextIOWrapper:
    """Return the text of a mesh by lines; a lone carriage return ends a line, too."""
    return TextIOWrapper(BytesIO(content), encoding="utf-8", errors="replace")


def check_mesh_content(name: str, content: bytes) -> None:
    """Refuse a mesh that names further files, or on which a reader does not end.

    The suffix of the file's `name` says the format. Raises `InputError` naming ``mesh_file``.
    """
    find = _FAULTS.get(PurePath(name).suffix.lower())  # other formats name no files
    fault = find(content) if find else None
    if fault:
        raise InputError(FIELD, name, *fault)


def _of_abaqus(content: bytes) -> Fault:
    """Find INCLUDE by the rule of meshlane: with stars and without, in large letters and small."""
    keywords = (line.partition(",")[0].strip().replace("*", "").upper() for line in mesh_text(content))
    return ("without *INCLUDE: other files are not read", _ALONE) if "INCLUDE" in keywords else None


def _of_nastran(content: bytes) -> Fault:
    """Find INCLUDE, and bulk data without its last line: meshio waits for it without end."""
    if any(line.lstrip().upper().startswith("INCLUDE") for line in mesh_text(content)):
        return "without INCLUDE: other files are not read", _ALONE
    lines = iter(mesh_text(content))
    has_begin = any(line.strip().startswith("BEGIN BULK") for line in lines)
    if has_begin and any(line.startswith("ENDDATA") for line in lines):
        return None
    return "bulk data from BEGIN BULK to ENDDATA", "Export the whole model."


def _of_vtk_xml(content: bytes) -> Fault:
    """Find a document type: it declares entities, which are other files and texts that grow without end."""
    heads: list[str] = []
    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = lambda *_: heads.append("document type")
    parser.StartElementHandler = lambda *_: heads.append("element")
    with suppress(expat.ExpatError, LookupError, ValueError):
        for start in range(0, len(content), _PART):
            parser.Parse(content[start : start + _PART])
            if heads:
                break
    if heads[:1] == ["element"]:
        return None
    return "VTK XML without a document type", "Export it again, as VTU or gmsh (.msh)."


_FAULTS: dict[str, Callable[[bytes], Fault]] = {
    ".inp": _of_abaqus,
    ".bdf": _of_nastran,
    ".nas": _of_nastran,
    ".fem": _of_nastran,
    ".vtu": _of_vtk_xml,
}
