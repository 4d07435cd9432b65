"""Files that reach out of themselves are refused by every reader, and none says what it read."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray
from foreign_netcdf import SECRET, STRIKES, struck, write_canary
from reduced_housings import random_housing
from small_table import small_table

from dynamics.housings import ReducedHousing
from dynamics.results import RunResult
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.result_figures import run_json
from lineofaction.gearbox.result_files import case_of_file, stamped
from lineofaction.report.document import file_attributes
from model_studies import netcdf as netcdf_input
from model_studies.array_file import Stored, arrays_content, read_arrays
from model_studies.netcdf import UnreadableFile, opened, read_dataset


def write_own(file: Path) -> None:
    stored = {"mass": Stored(("row",), "kg", "mass")}
    arrays_content("own", stored, {"mass": np.arange(8.0)}, {}).write(file)


WRITERS: dict[str, tuple[Callable[[Path], Any], str]] = {
    "arrays": (write_own, "mass"),
    "table": (lambda file: small_table().to_netcdf(file), "static_transmission_error"),
    "housing": (lambda file: random_housing().to_netcdf(file), "stiffness"),
}
"""What writes a good file, and the variable that is struck."""
READERS: dict[str, Callable[[Path], Any]] = {
    "arrays": lambda file: read_arrays(file, ("own",)),
    "table": SteDatabase.from_netcdf,
    "housing": ReducedHousing.from_netcdf,
    "run": RunResult.from_netcdf,
    "dataset": read_dataset,
    "attributes": file_attributes,
    "warnings": stamped,
    "outline": run_json,
}


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    folder = tmp_path_factory.mktemp("good")
    for name, (write, _) in WRITERS.items():
        write(folder / f"{name}.nc")
    return folder


@pytest.fixture
def strike(good, tmp_path):
    canary = write_canary(tmp_path)

    def make(kind, name):
        file = tmp_path / "file.nc"
        file.write_bytes((good / f"{kind}.nc").read_bytes())
        struck(file, WRITERS[kind][1], STRIKES[name], canary)
        return file

    return make


@pytest.mark.parametrize("name", STRIKES)
@pytest.mark.parametrize("kind", WRITERS)
def test_a_file_that_reaches_out_is_refused(kind, name, strike):
    """By the reader of its kind; the refusal tells neither the canary, nor a folder, nor HDF5's words."""
    file = strike(kind, name)
    with pytest.raises(Exception) as caught:
        READERS[kind](file)
    message = str(caught.value)
    assert SECRET[:8].decode() not in message and str(file.parent) not in message
    assert message.startswith("file.nc: ") and "damaged" not in message and "readable" not in message, message


@pytest.mark.parametrize("name", ["external storage", "virtual of external storage", "external link", "huge"])
@pytest.mark.parametrize("reader", READERS)
def test_every_reader_walks_a_file_first(reader, name, strike):
    file = strike("table", name)
    with pytest.raises(Exception, match=r"lie in other|links to|unpacks"):
        READERS[reader](file)
    assert case_of_file(file) is None


def test_files_of_the_program_open(good):
    for kind in WRITERS:
        assert READERS[kind](good / f"{kind}.nc") is not None


def test_a_dataset_is_that_of_xarray(tmp_path):
    """Texts in any script, too."""
    written = xarray.Dataset({"t": ("x", [1.0, 2.0])}, {"name": ("x", ["Ölkühler", "軸受"])}, {"unit": "µm"})
    written.to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    read, expected = (
        read_dataset(tmp_path / "a.nc"),
        xarray.load_dataset(tmp_path / "a.nc", engine="h5netcdf"),
    )
    assert read.identical(expected) and read["name"].dtype == expected["name"].dtype


def test_a_file_may_begin_behind_other_bytes(tmp_path):
    """HDF5 allows for a block of the user; the parts of a divided file are none."""
    with h5py.File(tmp_path / "late.nc", "w", userblock_size=1024) as file:
        file["x"] = [1.0]
    with opened(tmp_path / "late.nc") as file:
        assert list(file["x"]) == [1.0]
    for driver, part in (("split", "divided.nc-m.h5"), ("family", "divided%d.nc")):
        name = "divided.nc" if driver == "split" else part
        with h5py.File(tmp_path / name, "w", driver=driver) as file:
            file["x"] = [1.0]
        first = tmp_path / part.replace("%d", "0")
        with pytest.raises(UnreadableFile, match="not a readable"), opened(first):
            pass


def test_no_plug_ins_are_loaded(good):
    with opened(good / "arrays.nc"):
        assert h5py.h5pl.size() == 0


def test_the_larger_a_file_the_more_it_may_unpack(tmp_path, monkeypatch):
    """A hundredfold: of noise any amount, of zeros none above the first."""
    monkeypatch.setattr(netcdf_input, "FREE_BYTES", 1 << 16)
    for name, values in (("noise", np.random.default_rng(1).random(1 << 16)), ("zeros", np.zeros(1 << 16))):
        with h5py.File(tmp_path / f"{name}.nc", "w") as file:
            file.create_dataset("x", data=values, compression="gzip")
    with opened(tmp_path / "noise.nc") as file:
        assert file["x"].size == 1 << 16
    with pytest.raises(UnreadableFile, match="unpacks to more than"), opened(tmp_path / "zeros.nc"):
        pass


@pytest.mark.parametrize(
    "shapes", ['{"mass": ["<f8", [100000000000]]}', '{"mass": ["O", [8]]}', "[]", "[" * 9999]
)
def test_arrays_are_as_large_as_their_values(tmp_path, shapes):
    """What a file states of types and shapes is no more than what is in it."""
    write_own(tmp_path / "own.nc")
    with h5py.File(tmp_path / "own.nc", "r+") as file:
        file.attrs["documents"] = f'{{"shapes": {shapes}, "fields": {{}}}}'
    with pytest.raises(UnreadableFile, match=r"^own.nc: damaged"):
        read_arrays(tmp_path / "own.nc", ("own",))
