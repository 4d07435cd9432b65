"""The netCDF file, bit-exact and atomic, and tables over several base pitches."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import h5netcdf
import numpy as np
import pytest
import xarray

from fe_contact.errors import DatabaseError
from fe_contact.ste import SCHEMA_VERSION, SteDatabase
from fe_contact.ste.curve_errors import SOURCES
from fe_contact.ste.curve_quantities import OFF_MESH, QUANTITIES
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


def test_round_trips_are_bit_exact(stored, tmp_path):
    database, path = stored
    back = SteDatabase.from_netcdf(path)
    assert isinstance(back, SteDatabase)
    assert back.identical(database)
    assert back.static_transmission_error[3, 1, 2, 0].tobytes() == PAYLOAD.tobytes()
    SteDatabase.from_netcdf(path).to_netcdf(tmp_path / "again.nc")
    assert SteDatabase.from_netcdf(tmp_path / "again.nc").identical(database)


def test_a_ring_gear_is_remembered_and_an_external_pair_says_nothing_of_it(stored, tmp_path):
    database, path = stored
    ring = replace(database, geometry=replace(database.geometry, internal=True))
    ring.to_netcdf(tmp_path / "ring.nc")
    back = SteDatabase.from_netcdf(tmp_path / "ring.nc")
    assert back.geometry.internal
    assert back.identical(ring)
    assert not back.identical(database)
    with xarray.open_dataset(path, engine="h5netcdf") as dataset:
        assert "internal" not in json.loads(dataset.attrs["facts"])
    assert not SteDatabase.from_netcdf(path).geometry.internal


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
        axes = ("position", "force", "misalignment", "center_distance_change")
        assert set(dataset.sizes) == {*axes, "pair", "support_force", "residual"}
        assert dataset.static_transmission_error.dims == axes
        assert dataset.static_transmission_error.attrs["units"] == "m"
        assert dataset.max_pressure.attrs["units"] == "Pa"
        assert all(variable.attrs["long_name"] for variable in dataset.variables.values())
        assert dataset.status.attrs["flag_meanings"].split()[2] == "singular"
        assert dataset.attrs["schema_version"] == SCHEMA_VERSION
        assert json.loads(dataset.attrs["case"]) == database.metadata.case
        assert json.loads(dataset.attrs["facts"])["base_pitch"] == database.geometry.base_pitch
        assert "1 of 1440 points FAILED" in dataset.attrs["summary"]
        point = dataset.static_transmission_error.sel(
            force=2660.0, misalignment=0.0, center_distance_change=0.0
        )
        assert np.array_equal(point, database.static_transmission_error[:, 2, 1, 1])
        # Other filters would need plug-ins elsewhere.
        encoding = dataset.static_transmission_error.encoding
        assert encoding["zlib"] and encoding["shuffle"]
        assert encoding.get("compression") in (None, "gzip", "zlib")
        assert "_FillValue" not in encoding
        assert database.to_xarray().equals(dataset)


def refusal(path):
    with pytest.raises(DatabaseError) as caught:
        SteDatabase.from_netcdf(path)
    assert str(caught.value).startswith(f"{path.name}: ")
    return str(caught.value)


def test_a_missing_foreign_or_broken_file_is_refused(stored, tmp_path):
    assert "no such file" in refusal(tmp_path / "none.nc")
    path = tmp_path / "foreign.nc"
    xarray.Dataset({"t": ("x", [1.0, 2.0])}).to_netcdf(path, engine="h5netcdf")
    assert "no STE database" in refusal(path)
    whole = stored[1].read_bytes()
    cut_short = [whole[: int(part * len(whole))] for part in (0.1, 0.5, 0.9)]
    for content in (b"", b"PK not a table", b"\x89HDF\r\n\x1a\n" + bytes(100), *cut_short):
        path.write_bytes(content)
        assert "not a readable netCDF-4 file" in refusal(path)


def rewritten(path, change):
    """The same file with something changed by another program."""
    with xarray.open_dataset(path, engine="h5netcdf", decode_cf=False) as dataset:
        changed = change(dataset.load())
    changed.to_netcdf(path.with_name("changed.nc"), engine="h5netcdf")
    return refusal(path.with_name("changed.nc"))


def test_what_another_program_changed_is_refused(stored):
    message = rewritten(stored[1], lambda dataset: dataset.assign_attrs(schema_version=SCHEMA_VERSION + 1))
    assert f"schema version {SCHEMA_VERSION + 1}" in message
    assert f"reads 1 to {SCHEMA_VERSION}" in message
    assert "checksum" in rewritten(stored[1], lambda d: d.assign(torque=d.torque * (1 + 1e-15)))
    assert "without load_share" in rewritten(stored[1], lambda d: d.drop_vars("load_share"))
    assert "no JSON object" in rewritten(stored[1], lambda d: d.assign_attrs(facts="[1]"))
    for name in ("case", "facts", "receipt"):
        message = rewritten(stored[1], lambda d, name=name: d.assign_attrs({name: "{broken"}))
        assert f"its {name} is not readable JSON" in message


def test_older_files_do_not_know_the_errors_of_orders_beside_the_mesh(make, tmp_path):
    database = make(position=[0.0, 0.3, 0.6], force=[1000.0, 2000.0])
    errors = np.ones((len(SOURCES), QUANTITIES - 1, *database.status.shape[1:]))
    older = replace(database.metadata, schema_version=3)
    replace(database, curve_error=errors, metadata=older).to_netcdf(tmp_path / "older.nc")
    read = SteDatabase.from_netcdf(tmp_path / "older.nc").curve_error
    assert read.shape[1] == QUANTITIES
    assert np.isnan(read[:, OFF_MESH]).all()
    assert np.all(np.delete(read, OFF_MESH, axis=1) == 1.0)


def test_every_flipped_bit_is_noticed_or_harmless(make, tmp_path):
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


def test_a_failed_write_leaves_the_old_file_and_nothing_else(stored, monkeypatch):
    database, path = stored
    before = path.read_bytes()

    def full(*_args, **_kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        database.to_netcdf(path)
    assert path.read_bytes() == before
    assert list(path.parent.iterdir()) == [path]


def test_the_final_name_appears_only_when_complete(four_axes, tmp_path, monkeypatch):
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


def test_permissions_are_the_usual_ones(stored, tmp_path):
    (tmp_path / "plain").write_text("x")
    assert stored[1].stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_the_room_is_light_until_a_file_is_touched():
    """Evaluating tables must not cost the import of xarray, HDF5, or anything of the solver."""
    heavy = ("xarray", "h5py", "h5netcdf", "pandas", "gmsh", "skfem", "numba")
    code = f"import sys, fe_contact.ste; print([name for name in {heavy} if name in sys.modules])"
    output = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert output.strip() == "[]"


FORCE = 3000.0


@pytest.fixture(scope="module")
def uneven(make):
    """Knots of no pattern, the first not at 0."""
    knots = np.sort(np.random.default_rng(4).uniform(0.0, 1.0, 40))
    return make(position=knots, relief=3e-6)


@pytest.mark.parametrize("period", [2, 7])
def test_equal_pitches_written_out_answer_as_one(uneven, repeat, period):
    many = repeat(uneven, period)
    x = np.random.default_rng(5).uniform(0.0, 1.0, 300)
    for turns in (0, 1, period - 1, 3 * period + 1, -2):
        np.testing.assert_allclose(many.ste(x + turns, FORCE), uneven.ste(x, FORCE), rtol=1e-12)
        one, same = uneven.force_at(x, 9e-6), many.force_at(x + turns, 9e-6)
        np.testing.assert_allclose(same.force, one.force, rtol=1e-11)
        np.testing.assert_allclose(same.position_slope, one.position_slope, rtol=1e-9, atol=1e-3)


def test_equal_pitches_have_figures_and_shares_of_one(uneven, repeat):
    one, many = uneven.curve(force=FORCE), repeat(uneven, 7).curve(force=FORCE)
    assert float(many.mean) == pytest.approx(float(one.mean), rel=1e-12, abs=0.0)
    assert float(many.peak_to_peak) == pytest.approx(float(one.peak_to_peak), rel=1e-12, abs=0.0)
    np.testing.assert_allclose(
        [float(a) for a in many.harmonics], [float(a) for a in one.harmonics], atol=1e-18
    )
    between = many.spectrum.order % 1.0 != 0.0
    assert many.spectrum.order[-1] == 20.0
    assert many.spectrum.amplitude[between].max() < 1e-12 * float(one.mean)
    # Also beside the knots, and at the seams between pitches.
    x = np.concatenate([np.random.default_rng(6).uniform(0.0, 1.0, 200), [0.0, 1.0 - 1e-12]])
    one = uneven.curve(force=FORCE, at=x)
    many = repeat(uneven, 5)
    for turns in (0, 4, 11, -3):
        curve = many.curve(force=FORCE, at=x + turns)
        assert np.array_equal(curve.pair, one.pair)
        np.testing.assert_allclose(curve.load_share, one.load_share, atol=1e-9)


def test_the_share_of_a_pair_of_teeth_is_continuous_over_its_mesh(uneven, repeat):
    """Every pair of teeth has a share of its own; what is pair j becomes pair j + 1 at a whole pitch."""
    many = repeat(uneven, 5)
    share = many.load_share.copy()
    teeth = (many.pair - np.floor(many.position).astype(int)[:, None]) % 5
    share *= (1.0 + 0.3 * np.cos(teeth * 2.0))[:, None, None, None, :]
    share /= share.sum(axis=-1, keepdims=True)
    table = replace(many, load_share=share)
    for seam in (1.0, 3.0, 5.0):
        before, after = (table.curve(force=FORCE, at=[seam + s]).load_share[0] for s in (-1e-9, 1e-9))
        np.testing.assert_allclose(before[:-1], after[1:], atol=1e-6)
    stored = table.curve(force=float(table.force[2])).load_share
    np.testing.assert_allclose(stored, table.load_share[:, 2, 0, 0], atol=1e-12)


def test_a_long_wave_is_an_order_between_the_mesh_harmonics(make, repeat):
    """One cycle in four pitches: order 1/4 of the mesh, 5 of a gear of 20 teeth, besides what was there."""
    one = make(position=np.arange(96) / 96)
    many = repeat(one, 4)
    wave = 2e-7 * np.cos(2 * np.pi * many.position / 4 + 1.1)[:, None, None, None]
    waving = replace(
        many,
        static_transmission_error=many.static_transmission_error + wave,
        no_load_transmission_error=many.no_load_transmission_error + wave[:, 0],
    )
    spectrum = waving.spectrum(force=float(one.force[1]))
    assert spectrum.order[0] == 0.25
    assert spectrum.pinion_order[0] == spectrum.wheel_order[0] == 5.0
    assert spectrum.amplitude[0] == pytest.approx(2e-7, rel=1e-3, abs=0.0)
    assert spectrum.phase[0] == pytest.approx(1.1, abs=2e-3)
    assert spectrum.amplitude[3] == pytest.approx(
        float(one.harmonics(force=float(one.force[1]))[0]), rel=3e-3
    )


def test_a_hunting_cycle_is_answered_within_memory(make, repeat):
    """39 on 40 teeth: 1560 pitches, whose load shares keep the columns of one pitch."""
    cycle = repeat(make(position=[0.1, 0.4, 0.8], force=(1000.0, 3000.0)), 1560)
    curve = cycle.curve(force=2000.0)
    assert curve.load_share.shape == (3 * 1560, 4)
    assert curve.spectrum.order.size == 20 * 1560


def test_the_file_keeps_the_period_and_without_one_holds_a_pitch(uneven, repeat, tmp_path):
    many = repeat(uneven, 7)
    many.to_netcdf(tmp_path / "many.nc")
    back = SteDatabase.from_netcdf(tmp_path / "many.nc")
    assert back.identical(many)
    assert not replace(many, period=8).identical(many)
    assert back.force_table().period == 7
    assert "7 base pitches" in back.summary()
    path = tmp_path / "old.nc"
    uneven.to_netcdf(path)
    with h5netcdf.File(path, "a") as file:
        del file.attrs["period"]
    assert SteDatabase.from_netcdf(path).identical(uneven)


def test_a_changed_period_is_noticed_and_must_fit_the_positions(uneven, repeat, tmp_path):
    path = tmp_path / "changed.nc"
    for value in (2, 1.5, "many"):
        uneven.to_netcdf(path)
        with h5netcdf.File(path, "a") as file:
            del file.attrs["period"]
            file.attrs["period"] = value
        assert "damaged" in refusal(path)
    whole, within = "period must be a whole number", r"position must lie in \[0, 1\)"
    for period, message in ((0, whole), (2.0, whole), (1, within)):
        with pytest.raises(DatabaseError, match=message):
            replace(repeat(uneven, 2), period=period)
