"""Matrices of foreign files: none is unpickled, none unpacks to more than it says, none is told of."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest
from foreign_matrices import FOREIGN_MATRICES
from foreign_netcdf import SECRET, write_canary

from dynamics.errors import InputError
from dynamics.housings import read_reduced_matrices
from dynamics.joints import read_housing
from dynamics.joints.housing import LARGEST


@pytest.mark.parametrize("name", FOREIGN_MATRICES)
def test_it_is_refused_by_the_name_of_the_file(tmp_path: Path, name: str) -> None:
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


def test_a_table_is_no_larger_than_matrices_are(tmp_path: Path) -> None:
    with (tmp_path / "case.csv").open("wb") as stream:
        stream.truncate(LARGEST + 1)
    with pytest.raises(InputError, match=f"at most {LARGEST} bytes"):
        read_housing(tmp_path / "case.csv", "case", ("a",))
