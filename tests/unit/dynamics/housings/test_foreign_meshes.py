"""Meshes that lead to other files are refused where they are read and where they are sent."""

from __future__ import annotations

import builtins
import threading
from pathlib import Path
from typing import Any

import pytest
from foreign_meshes import FOREIGN_MESHES
from foreign_netcdf import SECRET, write_canary

from dynamics.errors import InputError
from dynamics.housings import read_mesh
from dynamics.solid_housing import check_mesh_content

LATER = ("pieces in other files", "a mesh of another program", "geometry in place of a mesh")
"""Those that name files where their reader looks for none."""


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The files that are opened from here on."""
    files: list[str] = []
    plain = builtins.open

    def recorded(file: Any, *options: Any, **others: Any) -> Any:
        files.append(str(file))
        return plain(file, *options, **others)

    monkeypatch.setattr(builtins, "open", recorded)
    return files


@pytest.mark.parametrize("name", FOREIGN_MESHES)
def test_it_is_refused_unread(tmp_path: Path, opened: list[str], name: str) -> None:
    """The refusal tells neither the other file, nor a folder, nor the words of a parser."""
    canary = write_canary(tmp_path)
    suffix, content = FOREIGN_MESHES[name]
    file = tmp_path / f"housing{suffix}"
    file.write_bytes(content(canary))
    caught: list[Exception] = []

    def read() -> None:
        with pytest.raises(InputError) as refusal:
            read_mesh(file, "mm")
        caught.append(refusal.value)

    reading = threading.Thread(target=read, daemon=True)
    reading.start()
    reading.join(5.0)
    assert str(canary) not in opened
    (refusal,) = caught
    assert (refusal.field, refusal.value) == ("mesh_file", file.name)
    assert SECRET.decode() not in str(refusal) and str(tmp_path) not in str(refusal)


@pytest.mark.parametrize("name", [name for name in FOREIGN_MESHES if name not in LATER])
def test_its_content_tells_before_it_is_read(tmp_path: Path, name: str) -> None:
    suffix, content = FOREIGN_MESHES[name]
    with pytest.raises(InputError, match=r"other files|document type|ENDDATA"):
        check_mesh_content(f"housing{suffix}", content(tmp_path))


def test_words_that_look_like_it_are_no_matter(tmp_path: Path) -> None:
    """Comments and names; a text in Latin-1."""
    text = "** INCLUDE in a comment, \xfc\n*HEADING\nincluded\n*NODE\n1, 0, 0, 0\n*NSET, NSET=INCLUDE\n1\n"
    check_mesh_content("a.inp", text.encode("latin-1"))
    check_mesh_content("a.bdf", b"BEGIN BULK\n$ INCLUDE 'a'\nGRID,1,,0.,0.,0.\nENDDATA\n")
    (tmp_path / "a.inp").write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError, match="tetrahedra"):  # it is read, and has none
        read_mesh(tmp_path / "a.inp", "mm")
