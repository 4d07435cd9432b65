"""The file of a content is what xarray writes of the same content, for xarray and for readers of HDF5."""

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray

from model_studies.netcdf_content import NetcdfContent, Variable

SPEED = {"units": "m s-1"}


@pytest.fixture
def content():
    """Coordinates along dimensions and beside them, a dimension without, an empty one, a scalar."""
    grid = np.arange(12.0).reshape(2, 3, 2)
    return NetcdfContent(
        {
            "flow": Variable(("height", "time", "side"), grid, SPEED | {"long_name": "flow"}),
            "count": Variable(("time",), np.array([3, 1, 2], np.int16), {"flag_values": np.arange(2)}),
            "height": Variable(("height",), np.array([0.5, 1.5]), {"units": "m"}),
            "pressure": Variable(("height",), np.array([9.0, 8.0]), {"units": "Pa"}),
            "none": Variable(("height", "visit"), np.empty((2, 0)), {}),
            "visit": Variable(("visit",), np.empty(0), {}),
            "gain": Variable((), np.float64(2.5), {}),
        },
        {"title": "a channel", "version": np.int64(3), "share": 0.25},
        coordinates=("pressure",),
    )


@pytest.fixture
def file(content, tmp_path):
    content.write(tmp_path / "channel.nc")
    return tmp_path / "channel.nc"


def test_a_file_is_what_xarray_writes(content, file, tmp_path):
    other = tmp_path / "other.nc"
    content.to_xarray().to_netcdf(other, engine="h5netcdf")
    with (
        xarray.open_dataset(file, engine="h5netcdf") as own,
        xarray.open_dataset(other, engine="h5netcdf", mask_and_scale=False) as theirs,
    ):
        for each in theirs.variables.values():
            each.attrs.pop("_FillValue", None)  # of xarray's own
        assert own.identical(theirs)
        assert set(own.coords) == {"height", "pressure", "visit"}
        assert [own[name].dtype for name in own.variables] == [theirs[name].dtype for name in own.variables]
        assert own.encoding.get("unlimited_dims") == theirs.encoding.get("unlimited_dims") == {"visit"}


def test_variables_along_a_coordinate_name_it(file):
    with h5netcdf.File(file) as content:
        named = {name: each.attrs.get("coordinates") for name, each in content.variables.items()}
    assert {name for name, each in named.items() if each} == {"flow", "none"}
    assert named["flow"] == "pressure"


def test_a_variable_called_as_a_dimension_of_others_is_none_along_it(tmp_path):
    values = {"side": Variable(("side", "end"), np.eye(2), {}), "end": Variable(("side",), np.arange(2), {})}
    NetcdfContent(values, {}).write(tmp_path / "sides.nc")
    with h5netcdf.File(tmp_path / "sides.nc") as content:
        assert set(content.dimensions) == {"side", "end"}
        assert np.array_equal(content["side"][...], np.eye(2))
        assert content["end"].dimensions == ("side",)


def test_hdf5_finds_the_scales_of_every_axis(file):
    with h5py.File(file) as content:
        scales = [axis[0].name for axis in content["flow"].dims]
    assert scales == ["/height", "/time", "/side"]


def test_a_content_that_cannot_be_written_leaves_the_file_as_it_was(content, file):
    before = file.read_bytes()
    spoiled = NetcdfContent(content.variables | {"odd": Variable((), object(), {})}, {})
    with pytest.raises(TypeError):
        spoiled.write(file)
    assert file.read_bytes() == before
    assert [each.name for each in file.parent.iterdir()] == [file.name]
