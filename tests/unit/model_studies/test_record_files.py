"""A record comes back from its file as it was, and its numbers are variables with units and dimensions."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import Any, Generic, TypeVar

import h5netcdf
import numpy as np
import pytest
import xarray
from typing_extensions import TypeAliasType

from bounds.types import FloatArray, IntArray
from model_studies import NOT_STORED, in_unit
from model_studies.netcdf import UnreadableFile
from model_studies.record import under_key
from model_studies.record_file import read_record, write_record

SCHEMA = "a study of cups"


class Ended(StrEnum):
    """A reason."""

    FULL = "full"


@dataclass(frozen=True)
class Cup:
    """A record in a row."""

    name: str
    height: FloatArray = field(metadata=in_unit("m", "rim"))
    load: float = field(metadata=in_unit("n_m"))
    taste: float | None = None


C = TypeVar("C")


@dataclass(frozen=True)
class Set(Generic[C]):
    """A generic base."""

    first: C
    rest: tuple[C, ...]


@dataclass(frozen=True)
class Study(Set[Cup]):
    count: IntArray
    ended: Ended
    shares: Mapping[int, float]
    spare: Cup | None = None
    table: object = field(default=None, metadata=NOT_STORED)


def cup(name: str, scale: float, taste: float | None = None) -> Cup:
    return Cup(name, scale * np.array([1.0, np.nan, np.inf]), scale / 3.0, taste)


STUDY = Study(
    cup("a", 1.0, 0.1),
    (cup("b", 2.0), cup("c", 3.0, float("nan")), cup("d", 0.7, -0.0)),
    np.array([], dtype=np.int64),
    Ended.FULL,
    {-1: 0.25, 2: 0.75},
    table="not kept",
)


def written(study: Study, folder: Path) -> Path:
    write_record(study, folder / "study.nc", SCHEMA)
    return folder / "study.nc"


def numbers(value: Any) -> bytes:
    return np.asarray(value, dtype=float).tobytes()


def test_it_comes_back_to_the_last_bit(tmp_path):
    back = read_record(written(STUDY, tmp_path), {SCHEMA: Study})
    assert type(back) is Study
    for mine, theirs in zip((STUDY.first, *STUDY.rest), (back.first, *back.rest), strict=True):
        assert (type(theirs), mine.name) == (Cup, theirs.name)
        assert numbers(mine.height) == numbers(theirs.height)
        assert numbers(mine.load) == numbers(theirs.load) and isinstance(theirs.load, float)
        assert (mine.taste is None) == (theirs.taste is None)
        assert numbers(mine.taste or 0.0) == numbers(theirs.taste or 0.0)
    assert (back.count.dtype, back.count.shape) == (np.int64, (0,))
    assert back.ended is Ended.FULL
    assert (back.shares, back.spare, back.table) == ({-1: 0.25, 2: 0.75}, None, None)


def test_rows_of_records_are_one_variable_with_unit_and_dimensions(tmp_path):
    with xarray.open_dataset(written(STUDY, tmp_path), engine="h5netcdf") as read:
        heights = read["rest.height"]
        assert (heights.dims, heights.shape, heights.units) == (("rest", "rim"), (3, 3), "m")
        assert heights.long_name == "rest height"
        assert (read["rest.load"].dims, read["rest.load"].units) == (("rest",), "N m")
        assert (read["first.load"].dims, float(read["first.load"])) == ((), 1.0 / 3.0)


@dataclass(frozen=True)
class Saucer:
    """A record whose attributes have other names than its file."""

    radius: float = field(metadata=in_unit("m") | under_key("size"))
    owner: str = field(metadata=under_key("whose"))


def test_a_file_may_hold_fields_by_other_names(tmp_path):
    saucer = Saucer(0.07, "Ada")
    write_record(saucer, tmp_path / "saucer.nc", SCHEMA)
    with h5netcdf.File(tmp_path / "saucer.nc") as file:
        assert list(file.variables) == ["size"]
        assert json.loads(file.attrs["documents"])["fields"] == {"size": "variable", "whose": "Ada"}
    assert read_record(tmp_path / "saucer.nc", {SCHEMA: Saucer}) == saucer


Scalar = TypeVar("Scalar", bound=np.generic)
Aliased = TypeAliasType("Aliased", np.ndarray[Any, np.dtype[Scalar]], type_params=(Scalar,))
"""An array's type as numpy 2.5 names it from Python 3.12 on; with others it has the type itself."""


@dataclass(frozen=True)
class Spoon:
    """A record whose arrays have an alias of their type."""

    length: Aliased[np.float64] = field(metadata=in_unit("m"))
    marks: Aliased[np.int64] | None = None


def test_an_alias_of_an_array_is_an_array(tmp_path):
    write_record(Spoon(np.array([0.1, 0.2]), np.array([3])), tmp_path / "spoon.nc", SCHEMA)
    with h5netcdf.File(tmp_path / "spoon.nc") as file:
        assert set(file.variables) == {"length", "marks"}
    back = read_record(tmp_path / "spoon.nc", {SCHEMA: Spoon})
    assert numbers(back.length) == numbers([0.1, 0.2]) and back.marks.tolist() == [3]


@dataclass(frozen=True)
class Later(Cup):
    """A later version of a record."""

    handle: float | None = None
    labels: Mapping[str, str] = field(default_factory=dict)


def test_a_file_of_an_earlier_version_has_no_fields_but_the_defaults(tmp_path):
    file = tmp_path / "cup.nc"
    write_record(cup("a", 1.0), file, SCHEMA)
    read = read_record(file, {SCHEMA: Later})
    assert (read.handle, read.labels) == (None, {})


def test_a_record_in_place_of_none_is_kept(tmp_path):
    back = read_record(written(replace(STUDY, spare=cup("e", 5.0)), tmp_path), {SCHEMA: Study})
    assert back.spare.name == "e" and numbers(back.spare.height) == numbers(cup("e", 5.0).height)


@dataclass(frozen=True)
class Other:
    """Not what was written."""

    first: Cup
    lid: float


def test_other_files_and_other_fields_are_refused(tmp_path):
    file = written(STUDY, tmp_path)
    with pytest.raises(UnreadableFile, match="expected a study of hats"):
        read_record(file, {"a study of hats": Study})
    with pytest.raises(UnreadableFile, match="not as this version writes it"):
        read_record(file, {SCHEMA: Other})
    with pytest.raises(UnreadableFile, match="no such file"):
        read_record(tmp_path / "none.nc", {SCHEMA: Study})


def test_a_changed_number_is_found(tmp_path):
    file = written(STUDY, tmp_path)
    with h5netcdf.File(file, "r+") as content:
        content.variables["first.load"][...] = 1.0
    with pytest.raises(UnreadableFile, match="checksum"):
        read_record(file, {SCHEMA: Study})
