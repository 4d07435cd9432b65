"""Matrices of foreign files: none is unpickled, none unpacks to more than it says, none is told of."""

import io
import struct
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foreign_netcdf import SECRET, write_canary

from dynamics.errors import InputError
from dynamics.housings import read_reduced_matrices
from dynamics.joints import read_housing
from dynamics.joints.housing import LARGEST

Content = Callable[[Path], bytes]
"""From the canary to the content of a file."""


class _Opened:
    """Reads the canary where it is unpickled."""

    def __init__(self, canary: Path) -> None:
        self._canary = canary

    def __reduce__(self) -> tuple[Any, ...]:
        return Path.read_text, (self._canary,)


def _objects(canary: Path) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, stiffness=np.array([_Opened(canary)], dtype=object))
    return stream.getvalue()


def _npy(header: str, data: bytes = b"") -> bytes:
    return np.lib.format.magic(1, 0) + struct.pack("<H", len(header)) + header.encode() + data


def _archive(content: bytes, megabytes: int = 0) -> Content:
    """Pack a content with so many of zeros behind it."""

    def packed(_canary):
        stream = io.BytesIO()
        with (
            zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
            archive.open("stiffness.npy", "w") as member,
        ):
            member.write(content)
            for _ in range(megabytes):
                member.write(bytes(1 << 20))
        return stream.getvalue()

    return packed


def _shape(shape: str, kind: str = "<f8") -> bytes:
    return _npy(f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}}}\n", bytes(64))


def _smaller_than_said(_canary: Path) -> bytes:
    """State a small size of a member that unpacks to 64 MB, in both places of the archive."""
    content = bytearray(_archive(_shape("(8388600,)"), 64)(_canary))
    for mark, at in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        place = content.index(mark) + at
        content[place : place + 4] = struct.pack("<I", 1000)
    return bytes(content)


FOREIGN_MATRICES: dict[str, tuple[str, Content]] = {
    "objects": (".npz", _objects),
    "an object in place of an archive": (".npz", lambda canary: __import__("pickle").dumps(_Opened(canary))),
    "a bomb": (".npz", _archive(_shape("(20971520,)"), 160)),
    "a bomb of a small size": (".npz", _smaller_than_said),
    "a bomb of raw bytes": (".npz", _archive(b"", 160)),
    "more than there is": (".npz", _archive(_shape("(1099511627776,)"))),
    "a size beyond all numbers": (".npz", _archive(_shape("(8589934592, 8589934592)"))),
    "texts": (".npz", _archive(_shape("(8,)", "<S8"))),
    "entries without a size": (".npz", _archive(_shape("(1099511627776,)", "<S0"))),
    "objects in a header": (".npz", _archive(_shape("(8,)", "|O"))),
    "a deep header": (".npz", _archive(_npy("(" * 9000))),
    "a long header": (".npz", _archive(_npy("{'descr': '<f8'," + " " * 60000 + "}"))),
    "a call in a header": (".npz", _archive(_npy("__import__('os').getcwd()\n"))),
    "another member": (".npz", _archive(b"../../etc/passwd")),
    "no numbers": (".csv", lambda canary: f"{canary},1\n2,3\n".encode()),
    "no text": (".csv", lambda _canary: b"\xff\xfe\x00,1\n"),
}


@pytest.mark.parametrize("name", FOREIGN_MATRICES)
def test_it_is_refused_by_the_name_of_the_file(tmp_path, name):
    """In the program's words; the memory that it takes stays small."""
    canary = write_canary(tmp_path)
    suffix, content = FOREIGN_MATRICES[name]
    file = tmp_path / f"case{suffix}"
    file.write_bytes(content(canary))
    readers = {"stiffness_file": lambda: read_housing(file, "case", ("a",))}
    if suffix == ".npz":
        readers["matrix_file"] = lambda: read_reduced_matrices(file)
    for field, read in readers.items():
        tracemalloc.start()
        with pytest.raises(InputError) as caught:
            read()
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert peak < 1e7
        assert (caught.value.field, caught.value.value) == (field, file.name)
        assert SECRET.decode() not in str(caught.value) and str(tmp_path) not in str(caught.value)


def test_a_table_is_no_larger_than_matrices_are(tmp_path):
    with (tmp_path / "case.csv").open("wb") as stream:
        stream.truncate(LARGEST + 1)
    with pytest.raises(InputError, match=f"at most {LARGEST} bytes"):
        read_housing(tmp_path / "case.csv", "case", ("a",))
