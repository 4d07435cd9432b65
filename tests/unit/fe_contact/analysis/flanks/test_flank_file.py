"""Flank results on disk: every bit comes back, what follows is there for others, damage is refused."""

from dataclasses import fields

import h5netcdf
import numpy as np
import pytest
from analysis_requests import point_request
from spur_gears import GEAR, PAIR

from fe_contact import GearPair, LoadDistribution, contact_pattern, flank_results
from fe_contact.errors import DatabaseError
from fe_contact.ste import Metadata


@pytest.fixture(scope="module")
def found():
    asked = {"torque": 100.0, "center_distance_change": 5e-5, "level": "draft", "model": "plane_strain"}
    return flank_results(PAIR, *point_request(**asked), at=np.arange(8) / 8, case={"name": "spur"})


@pytest.fixture
def file(found, tmp_path):
    found.to_netcdf(tmp_path / "flanks.nc")
    return tmp_path / "flanks.nc"


def test_every_bit_comes_back_and_what_follows_is_there_for_others(found, file):
    back = LoadDistribution.from_netcdf(file)
    assert np.any(np.isinf(found.gap))
    for entry in fields(found):
        one, other = getattr(found, entry.name), getattr(back, entry.name)
        if isinstance(one, np.ndarray):
            assert one.dtype == other.dtype, entry.name
            assert np.array_equal(one, other), entry.name
        else:
            assert one == other, entry.name
    import xarray  # noqa: PLC0415

    with xarray.open_dataset(file, engine="h5netcdf") as table:
        for gear in ("pinion", "wheel"):
            pattern = contact_pattern(found, gear)
            assert np.array_equal(table[f"contact_pattern_{gear}"], pattern.pressure)
            assert np.array_equal(table[f"pattern_roll_length_{gear}"], pattern.roll_length)
        assert np.array_equal(table["line_load"], found.line_load)
        assert table["line_load"].attrs["units"] == "N m-1"
        assert table.attrs["mean_face_load_factor"] == found.mean_face_load_factor


def test_scene_and_making_are_recorded(found):
    scene, here = found.scene, GearPair(GEAR, GEAR, 80.05e-3)
    assert scene.torque == pytest.approx(100.0, rel=1e-12)
    assert scene.center_distance_change == 5e-5
    assert scene.path_of_contact == here.path_of_contact.points
    # equal gears: what one flank is, the other is, and the tip of one meets the other's active start
    for both in (scene.start_of_active_profile, scene.pitch_point, scene.tip):
        assert both[0] == pytest.approx(both[1], rel=1e-12)
    assert scene.start_of_active_profile[1] + scene.tip[0] == pytest.approx(here.common_tangent, rel=1e-12)
    assert 2.0 * scene.pitch_point[0] == pytest.approx(here.common_tangent, rel=1e-12)
    metadata = found.metadata
    assert metadata.case == {"name": "spur"}
    assert set(metadata.receipt["stages"]) == {"compliance", "contact", "assumptions", "error estimate"}
    assert {one["assumption"] for one in metadata.receipt["assumptions"]} >= {"coast flanks stay apart"}
    assert metadata.receipt["repeated"] == []
    assert len(metadata.content_hash) == 64
    assert {entry["name"] for entry in metadata.effect_ledger} >= {"corner_contact", "misalignment"}


def test_damage_and_strangers_are_refused(file, tmp_path):
    with pytest.raises(DatabaseError, match="no such file"):
        LoadDistribution.from_netcdf(tmp_path / "none.nc")
    with h5netcdf.File(file, "a") as content:
        content.variables["force"][0, 1, 0] = 1.0
    with pytest.raises(DatabaseError, match="do not match their checksum"):
        LoadDistribution.from_netcdf(file)
    with h5netcdf.File(file, "a") as content:
        content.attrs["schema_version"] = 9
    with pytest.raises(DatabaseError, match="schema version 9"):
        LoadDistribution.from_netcdf(file)
    with h5netcdf.File(file, "a") as content:
        content.attrs["format"] = "lineofaction STE database"
    with pytest.raises(DatabaseError, match="no flank results"):
        LoadDistribution.from_netcdf(file)


def test_a_missing_part_is_named_and_missing_metadata_is_not(found, tmp_path):
    found.to_xarray().drop_vars("gap").to_netcdf(tmp_path / "part.nc", engine="h5netcdf")
    with pytest.raises(DatabaseError, match="without gap"):
        LoadDistribution.from_netcdf(tmp_path / "part.nc")
    from dataclasses import replace  # noqa: PLC0415

    replace(found, metadata=Metadata()).to_netcdf(tmp_path / "bare.nc")
    assert LoadDistribution.from_netcdf(tmp_path / "bare.nc").metadata == Metadata()
