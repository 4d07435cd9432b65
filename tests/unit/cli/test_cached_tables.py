"""The table of a case is computed once: by this program, as long as its file is whole."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from command_line import loa, printed
from small_table import small_table
from spur_case import spur_case

from fe_contact.ste import SteDatabase
from host.directories import cache_home
from lineofaction.cli import cached_tables, scene_tables
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import EXIT_WARNINGS, JobFailed
from lineofaction.gearbox.schemas import Case, read_model
from lineofaction.gearbox.subjects import scene_of

EXAMPLE = Path(__file__).parents[3] / "examples" / "palermo_scene.toml"
RECEIPT = {"cpu_seconds": 1.0, "stages": {}, "peak_memory_bytes": 0}
LOST = ("static_transmission_error", "tangent_compliance", "error_estimate", "max_pressure", "face_centroid")


@pytest.fixture
def computed(monkeypatch):
    made: list[SteDatabase] = []

    def computed_table(*_):
        table = small_table()
        made.append(replace(table, metadata=replace(table.metadata, receipt=RECEIPT)))
        return made[-1]

    monkeypatch.setattr("lineofaction.cli.computed_tables.computed_table", computed_table)
    return made


def tabled(**mesh: object) -> TabledScene:
    scene, folder = scene_of(EXAMPLE)
    meshes = tuple(each.model_copy(update=mesh) for each in scene.meshes)
    scene = scene.model_copy(update={"meshes": meshes})
    return scene_tables.tabled_scene(scene, folder, None, lambda *_: None)


def files() -> list[Path]:
    return list((cache_home() / "tables").glob("*"))


def test_a_table_is_computed_once_and_read_to_the_last_bit(computed):
    first, again = tabled(), tabled(damping_ratio=0.1)
    assert len(computed) == len(files()) == 1
    before, after = (scene.databases["mesh"] for scene in (first, again))
    for name in before.stored:
        np.testing.assert_array_equal(getattr(before, name), getattr(after, name), err_msg=name)
    assert (before.geometry, before.metadata) == (after.geometry, after.metadata)


def test_an_unchanged_case_is_analyzed_once(computed, tmp_path):
    case, first, second = (tmp_path / name for name in ("case.toml", "first.nc", "second.nc"))
    case.write_text(spur_case(torques=[1.0]))
    summary = printed("analyze", case, "-o", first)
    assert printed("analyze", case, "-o", second) == summary | {"file": str(second)}
    assert len(computed) == 1 and first.read_bytes() == second.read_bytes()
    done = loa("analyze", case, "-o", second)
    assert done.exit_code == 0 and "was in the cache" in done.stderr
    printed("analyze", case, "-o", second, "--set", "load.torque_n_m=[2]")
    assert len(computed) == 2


def test_a_case_with_a_cached_table_is_warned_of_all_the_same(computed, tmp_path):
    """Results replace some of these warnings in the table, so they are not taken from it."""
    case = tmp_path / "case.toml"
    case.write_text(spur_case(torques=[8e3]))
    first, second = (loa("analyze", case, "-o", tmp_path / "ste.nc", "--json", "--strict") for _ in range(2))
    assert len(computed) == 1 and first.exit_code == second.exit_code == EXIT_WARNINGS
    assert "warnings under --strict" in first.stderr and first.stderr == second.stderr


def test_another_program_computes_its_own(computed, monkeypatch):
    tabled()
    monkeypatch.setattr(cached_tables, "program_tag", lambda: "edited")
    tabled()
    monkeypatch.setattr(cached_tables, "software_versions", lambda: {"gmsh": "another"})
    tabled()
    assert len(computed) == len(files()) == 3


@pytest.mark.parametrize("damage", [b"", b"not a table", None], ids=["empty", "foreign", "cut off"])
def test_a_damaged_file_is_replaced(computed, damage):
    tabled()
    (file,) = files()
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) // 2] if damage is None else damage)
    tabled()
    tabled()
    assert len(computed) == 2
    assert SteDatabase.from_netcdf(file).n_failed == 0


def test_a_table_with_failed_points_is_not_kept(monkeypatch):
    table = small_table()
    failed = np.zeros(table.status.shape, dtype=bool)
    failed[0] = True
    lost = {name: np.where(failed, np.nan, getattr(table, name)) for name in LOST}
    table = replace(table, status=np.where(failed, 1, 0), **lost)
    monkeypatch.setattr("lineofaction.cli.computed_tables.computed_table", lambda *_: table)
    with pytest.raises(JobFailed):
        tabled()
    assert not files()


def test_what_one_verb_computes_another_finds(computed, tmp_path):
    """`loa ste` of a unit asked for tables that a scene had made, a scene for those of `loa analyze`."""
    unit = tmp_path / "unit"
    unit.mkdir()
    (unit / "spur.toml").write_text(spur_case(torques=[1.0]))
    (unit / "other.toml").write_text(spur_case(torques=[2.0]))
    assert "Make them with: loa analyze" in loa("ste", unit).stderr
    mesh = {"case": read_model(Case, unit / "spur.toml"), "case_file": None}
    tabled(**mesh)
    said = loa("ste", unit, "--torque", "1").stdout
    assert said.count("gear pair") == 1 and f"next: loa analyze {unit}" in said
    assert f"other\nno table: make it with loa analyze {unit}" in said
    for name in ("spur", "other"):
        printed("analyze", unit / f"{name}.toml", "-o", unit / f"{name}.nc")
    assert f"next: loa report {unit / 'spur.nc'}" in loa("ste", unit, "--torque", "1").stdout
    assert len(computed) == len(files()) == 2
    tabled(**mesh | {"case": read_model(Case, unit / "other.toml")})
    assert len(computed) == 2
