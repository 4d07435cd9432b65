"""The netCDF file: bit-exact, atomic, and clear about files it cannot read."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray

from fe_contact.errors import DatabaseError
from fe_contact.ste import SCHEMA_VERSION, SteDatabase
from fe_contact.ste.fields import DIMENSIONS
from fe_contact.types import Status

PAYLOAD = np.array([0x7FF8000000ABCDEF], dtype=np.uint64).view(np.float64)[0]  # a NaN that carries a number


@pytest.fixture
def stored(four_axes, tmp_path):
    """A database on disk, with a failed point whose NaN has a payload."""
    ste, status = four_axes.static_transmission_error.copy(), four_axes.status.copy()
    ste[3, 1, 2, 0], status[3, 1, 2, 0] = PAYLOAD, Status.SINGULAR
    database = replace(four_axes, static_transmission_error=ste, status=status)
    path = tmp_path / "table.nc"
    database.to_netcdf(path)
    return database, path


def test_round_trip_is_bit_exact(stored):
    database, path = stored
    back = SteDatabase.from_netcdf(path)
    assert isinstance(back, SteDatabase)
    assert back.identical(database)
    assert back.static_transmission_error[3, 1, 2, 0].tobytes() == PAYLOAD.tobytes()


def test_a_second_round_trip_gives_the_same_table(stored, tmp_path):
    database, path = stored
    SteDatabase.from_netcdf(path).to_netcdf(tmp_path / "again.nc")
    assert SteDatabase.from_netcdf(tmp_path / "again.nc").identical(database)


def test_a_ring_gear_is_remembered_and_an_external_pair_says_nothing_of_it(stored, tmp_path):
    database, path = stored
    ring = replace(database, facts=replace(database.facts, internal=True))
    ring.to_netcdf(tmp_path / "ring.nc")
    back = SteDatabase.from_netcdf(tmp_path / "ring.nc")
    assert back.facts.internal
    assert back.identical(ring)
    assert not back.identical(database)
    with xarray.open_dataset(path, engine="h5netcdf") as dataset:
        assert "internal" not in json.loads(dataset.attrs["facts"])
    assert not SteDatabase.from_netcdf(path).facts.internal


def test_large_receipts_survive(make, tmp_path):
    """HDF5 limits plain attributes to 64 kB."""
    database = make()
    large = replace(
        database, metadata=replace(database.metadata, receipt={"log": ["0123456789" * 10] * 3000})
    )
    large.to_netcdf(tmp_path / "large.nc")
    assert SteDatabase.from_netcdf(tmp_path / "large.nc").identical(large)


def test_other_programs_read_names_units_and_documents(stored):
    database, path = stored
    with xarray.open_dataset(path, engine="h5netcdf") as dataset:
        assert set(dataset.variables) == set(DIMENSIONS)
        assert set(dataset.sizes) == {
            "position",
            "force",
            "misalignment",
            "center_distance_change",
            "pair",
            "support_force",
            "residual",
        }
        assert dataset.static_transmission_error.dims == (
            "position",
            "force",
            "misalignment",
            "center_distance_change",
        )
        assert dataset.static_transmission_error.attrs["units"] == "m"
        assert dataset.max_pressure.attrs["units"] == "Pa"
        assert all(variable.attrs["long_name"] for variable in dataset.variables.values())
        assert dataset.status.attrs["flag_meanings"].split()[2] == "singular"
        assert dataset.attrs["schema_version"] == SCHEMA_VERSION
        assert json.loads(dataset.attrs["case"]) == database.metadata.case
        assert json.loads(dataset.attrs["facts"])["base_pitch"] == database.facts.base_pitch
        assert "1 of 1440 points FAILED" in dataset.attrs["summary"]
        point = dataset.static_transmission_error.sel(
            force=2660.0, misalignment=0.0, center_distance_change=0.0
        )
        assert np.array_equal(point, database.static_transmission_error[:, 2, 1, 1])


def test_only_zlib_is_used(stored):
    """Other filters would need plug-ins elsewhere."""
    _, path = stored
    with xarray.open_dataset(path, engine="h5netcdf") as dataset:
        encoding = dataset.static_transmission_error.encoding
        assert encoding["zlib"]
        assert encoding["shuffle"]
        assert encoding.get("compression") in (None, "gzip", "zlib")
        assert "_FillValue" not in encoding


def test_to_xarray_is_what_the_file_holds(stored):
    database, path = stored
    with xarray.open_dataset(path, engine="h5netcdf") as dataset:
        assert database.to_xarray().equals(dataset)


class TestUnreadable:
    def refusal(self, path):
        with pytest.raises(DatabaseError) as caught:
            SteDatabase.from_netcdf(path)
        assert str(caught.value).startswith(f"{path.name}: ")
        return str(caught.value)

    def test_missing(self, tmp_path):
        assert "no such file" in self.refusal(tmp_path / "none.nc")

    @pytest.mark.parametrize("content", [b"", b"PK not a table", b"\x89HDF\r\n\x1a\n" + bytes(100)])
    def test_no_netcdf(self, tmp_path, content):
        path = tmp_path / "odd.nc"
        path.write_bytes(content)
        assert "not a readable netCDF-4 file" in self.refusal(path)

    def test_foreign(self, tmp_path):
        path = tmp_path / "foreign.nc"
        xarray.Dataset({"t": ("x", [1.0, 2.0])}).to_netcdf(path, engine="h5netcdf")
        assert "no STE database" in self.refusal(path)

    @pytest.mark.parametrize("part", [0.1, 0.5, 0.9])
    def test_cut_short(self, stored, part):
        _, path = stored
        content = path.read_bytes()
        path.write_bytes(content[: int(part * len(content))])
        assert "not a readable netCDF-4 file" in self.refusal(path)

    def rewritten(self, path, change):
        """The same file with something changed by another program."""
        with xarray.open_dataset(path, engine="h5netcdf", decode_cf=False) as dataset:
            changed = change(dataset.load())
        changed.to_netcdf(path, engine="h5netcdf")
        return self.refusal(path)

    def test_newer_schema(self, stored):
        message = self.rewritten(
            stored[1], lambda dataset: dataset.assign_attrs(schema_version=SCHEMA_VERSION + 1)
        )
        assert f"schema version {SCHEMA_VERSION + 1}" in message
        assert f"reads 1 to {SCHEMA_VERSION}" in message

    def test_changed_number(self, stored):
        assert "checksum" in self.rewritten(stored[1], lambda d: d.assign(torque=d.torque * (1 + 1e-15)))

    def test_missing_variable(self, stored):
        assert "without load_share" in self.rewritten(stored[1], lambda d: d.drop_vars("load_share"))

    @pytest.mark.parametrize("name", ["case", "facts", "receipt"])
    def test_broken_document(self, stored, name):
        message = self.rewritten(stored[1], lambda d: d.assign_attrs({name: "{broken"}))
        assert f"its {name} is not readable JSON" in message

    def test_facts_of_another_shape(self, stored):
        assert "no JSON object" in self.rewritten(stored[1], lambda d: d.assign_attrs(facts="[1]"))

    def test_every_flipped_bit_is_noticed_or_harmless(self, make, tmp_path):
        """No single damaged byte gives a wrong table in silence."""
        database, path = make(position=[0.0, 0.3, 0.6], force=[1000.0, 2000.0]), tmp_path / "small.nc"
        database.to_netcdf(path)
        content = bytearray(path.read_bytes())
        noticed = 0
        for place in np.random.default_rng(1).choice(len(content), 60, replace=False):
            damaged = bytearray(content)
            damaged[place] ^= 0x10
            path.write_bytes(damaged)
            try:
                back = SteDatabase.from_netcdf(path)
            except DatabaseError:
                noticed += 1
                continue
            for name in DIMENSIONS:
                assert np.array_equal(getattr(back, name), getattr(database, name)), (place, name)
        assert noticed > 0


class TestAtomicWrite:
    def test_a_failed_write_leaves_the_old_file_and_nothing_else(self, stored, monkeypatch):
        database, path = stored
        before = path.read_bytes()

        def full(*_args, **_kwargs):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(os, "fsync", full)
        with pytest.raises(OSError, match="No space"):
            database.to_netcdf(path)
        assert path.read_bytes() == before
        assert list(path.parent.iterdir()) == [path]

    def test_the_final_name_appears_only_when_complete(self, four_axes, tmp_path, monkeypatch):
        path = tmp_path / "table.nc"
        seen = []
        replace_file = Path.replace

        def watch(temporary, target):
            seen.append((path.exists(), SteDatabase.from_netcdf(temporary).identical(four_axes), target))
            return replace_file(temporary, target)

        monkeypatch.setattr(Path, "replace", watch)
        four_axes.to_netcdf(path)
        assert seen == [(False, True, path)]
        assert list(tmp_path.iterdir()) == [path]

    def test_permissions_are_the_usual_ones(self, stored, tmp_path):
        (tmp_path / "plain").write_text("x")
        assert stored[1].stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_the_room_is_light_until_a_file_is_touched():
    """Evaluating tables must not cost the import of xarray, HDF5, or anything of the solver."""
    heavy = ("xarray", "h5py", "h5netcdf", "pandas", "gmsh", "skfem", "numba")
    code = f"import sys, fe_contact.ste; print([name for name in {heavy} if name in sys.modules])"
    output = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert output.strip() == "[]"
