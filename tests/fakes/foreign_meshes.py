"""Meshes that lead to other files, or on which a reader does not end, by name: a suffix and a content."""

from collections.abc import Callable
from pathlib import Path

Content = Callable[[Path], bytes]
"""From the canary to the content of a file."""

_NODE = "*NODE\n1, 0.0, 0.0, 0.0\n"
_GRID = "GRID,1,,0.0,0.0,0.0\n"
_VTU = '<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid>{}</UnstructuredGrid></VTKFile>'


def _text(text: str) -> Content:
    return lambda canary: text.format(canary=canary).encode()


def _laughs(_canary: Path) -> bytes:
    entities = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">' for i in range(1, 10))
    return f'<!DOCTYPE VTKFile [<!ENTITY l0 "ha">{entities}]>{_VTU.format("&l9;")}'.encode()


def _entity(encoding: str) -> Content:
    def content(canary: Path) -> bytes:
        head = f'<?xml version="1.0" encoding="{encoding}"?>'
        declared = f'<!DOCTYPE VTKFile [<!ENTITY canary SYSTEM "{canary.as_uri()}">]>'
        return (head + declared + _VTU.format("&canary;")).encode(
            "utf-16" if encoding == "utf-16" else "ascii"
        )

    return content


FOREIGN_MESHES: dict[str, tuple[str, Content]] = {
    "include": (".inp", _text(_NODE + "*INCLUDE, INPUT={canary}\n")),
    "include in small letters": (".inp", _text(_NODE + "*include,input={canary}\n")),
    "include without a star": (".inp", _text(_NODE + "*NSET, NSET=a\n1\n*END\nINCLUDE, INPUT={canary}\n")),
    "include behind a carriage return": (".inp", _text("*HEADING\rx\r  *INCLUDE, INPUT={canary}\r")),
    "include behind blanks": (".inp", _text("*HEADING\n \t\x0b*INCLUDE,INPUT={canary}\n")),
    "include with two stars in it": (".inp", _text("*HEADING\n*IN*CLUDE*, INPUT={canary}\n")),
    "include without a dot": (".inp", _text("*HEADING\n*\u0131nclude, INPUT={canary}\n")),
    "include with an equals sign alone": (".inp", _text("*HEADING\nInclude ,={canary}\n")),
    "include in Nastran": (".bdf", _text("BEGIN BULK\n" + _GRID + "INCLUDE '{canary}'\nENDDATA\n")),
    "include before the bulk data": (
        ".nas",
        _text("  include '{canary}'\nBEGIN BULK\n" + _GRID + "ENDDATA\n"),
    ),
    "bulk data without end": (".fem", _text("ENDDATA\nBEGIN BULK\n\n")),
    "an entity that is a file": (".vtu", _entity("ascii")),
    "an entity in sixteen bits": (".vtu", _entity("utf-16")),
    "an entity in no encoding": (".vtu", _entity("none-such")),
    "billion laughs": (".vtu", _laughs),
    "pieces in other files": (
        ".vtu",
        _text(
            '<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid><Piece Source="{canary}"/>'
            "</PUnstructuredGrid></VTKFile>"
        ),
    ),
    "a mesh of another program": (".msh", _text('(0 "{canary}")\n(2 3)\n')),
    "geometry in place of a mesh": (".msh", _text('Merge "{canary}";\n')),
}
