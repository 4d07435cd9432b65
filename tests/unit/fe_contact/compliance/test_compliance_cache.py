"""The disk cache returns what was computed, or computes it again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fe_contact.compliance.flank_compliance_2d as flow
from fe_contact.cache_reads import COMPLIANCE_READS
from fe_contact.compliance import (
    FlankCompliance,
    PlaneHypothesis,
    default_cache_directory,
    flank_compliance,
)
from fe_contact.geometry import Gear
from fe_contact.material import Material
from fe_contact.mesh import MeshRecipe

MakeGear = Callable[..., Gear]
MakeRecipe = Callable[..., MeshRecipe]


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[Gear]:
    """Collect the gears that were computed."""
    computed: list[Gear] = []
    genuine = flow.compute_flank_compliance

    def counting(gear: Gear, *arguments: object) -> FlankCompliance:
        computed.append(gear)
        return genuine(gear, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(flow, "compute_flank_compliance", counting)
    return computed


def same(first: FlankCompliance, second: FlankCompliance) -> bool:
    arrays = all(np.array_equal(getattr(first, n), getattr(second, n)) for n in ("s", "teeth", "matrix"))
    plain = (
        "s_form",
        "s_tip",
        "contact_modulus",
        "checks",
        "unknowns",
        "condensed_unknowns",
        "seconds",
        "solver",
    )
    return arrays and all(getattr(first, n) == getattr(second, n) for n in plain)


def test_second_call_reads_the_same_bits(
    tmp_path: Path, make_gear: MakeGear, coarse: MakeRecipe, counted: list[Gear]
) -> None:
    gear, before = make_gear(), replace(COMPLIANCE_READS)
    first = flank_compliance(gear, coarse(gear), cache=tmp_path / "deep" / "cache")
    second = flank_compliance(gear, coarse(gear), cache=tmp_path / "deep" / "cache")
    assert len(counted) == 1
    assert (first.from_cache, second.from_cache) == (False, True)
    assert replace(before, hits=before.hits + 1, misses=before.misses + 1) == COMPLIANCE_READS
    assert same(first, second)
    assert [p.suffix for p in (tmp_path / "deep" / "cache").iterdir()] == [".npz"]


@pytest.mark.parametrize("damage", ["flipped bit", "truncated", "empty", "foreign", "another result"])
def test_a_damaged_file_is_computed_again_and_mended(
    tmp_path: Path, make_gear: MakeGear, coarse: MakeRecipe, counted: list[Gear], damage: str
) -> None:
    gear = make_gear()
    first = flank_compliance(gear, coarse(gear), cache=tmp_path)
    (file,) = tmp_path.iterdir()
    content = file.read_bytes()
    middle = len(content) // 2
    damaged = {
        "flipped bit": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
        "truncated": content[:middle],
        "empty": b"",
        "foreign": b"not a zip file",
    }
    if damage == "another result":
        with np.load(file) as parts:
            changed = {name: parts[name] for name in parts.files}
        changed["matrix"] = 1.001 * changed["matrix"]
        np.savez(file, allow_pickle=False, **changed)
    else:
        file.write_bytes(damaged[damage])
    again = flank_compliance(gear, coarse(gear), cache=tmp_path)
    assert not again.from_cache
    assert np.array_equal(again.matrix, first.matrix)
    assert flank_compliance(gear, coarse(gear), cache=tmp_path).from_cache
    assert len(counted) == 2


def test_all_that_decides_the_result_is_in_the_key(make_gear: MakeGear, coarse: MakeRecipe) -> None:
    gear, strain = make_gear(), PlaneHypothesis.PLANE_STRAIN
    recipe = coarse(gear)
    keys = [
        flow.compliance_key(gear, recipe, strain, 5),
        flow.compliance_key(gear, recipe.refined(), strain, 5),
        flow.compliance_key(gear, recipe, PlaneHypothesis.PLANE_STRESS, 5),
        flow.compliance_key(gear, recipe, strain, 3),
    ]
    for change in (
        {"teeth": 21},
        {"bore_diameter": 39e-3},
        {"profile_shift_coefficient": 0.1},
        {"helix_angle": 0.1},
        {"root_radius_coefficient": 0.3},
        {"thickness_allowance": 1e-5},
        {"tip_diameter": 87e-3},
        {"material": Material(youngs_modulus=2e11)},
        {"material": Material(poissons_ratio=0.29)},
    ):
        keys.append(flow.compliance_key(make_gear(**change), recipe, strain, 5))
    assert len(set(keys)) == len(keys)
    for change in ({"face_width": 30e-3}, {"material": Material(density=7000.0)}):
        assert flow.compliance_key(make_gear(**change), recipe, strain, 5) == keys[0]


def test_a_new_model_version_does_not_read_old_files(
    tmp_path: Path,
    make_gear: MakeGear,
    coarse: MakeRecipe,
    counted: list[Gear],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gear = make_gear()
    flank_compliance(gear, coarse(gear), cache=tmp_path)
    monkeypatch.setattr(flow, "MODEL_VERSION", flow.MODEL_VERSION + 1)
    assert not flank_compliance(gear, coarse(gear), cache=tmp_path).from_cache
    assert len(counted) == 2


def test_without_a_directory_nothing_is_kept(
    make_gear: MakeGear, coarse: MakeRecipe, counted: list[Gear]
) -> None:
    gear = make_gear()
    for _ in range(2):
        flank_compliance(gear, coarse(gear), cache=None)
    assert len(counted) == 2


def test_a_directory_that_cannot_be_made_costs_no_result(
    tmp_path: Path, make_gear: MakeGear, coarse: MakeRecipe
) -> None:
    (tmp_path / "file").write_text("in the way")
    gear = make_gear()
    assert not flank_compliance(gear, coarse(gear), cache=tmp_path / "file" / "cache").from_cache


def test_the_default_directory_follows_the_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LINEOFACTION_CACHE", str(tmp_path))
    assert default_cache_directory() == tmp_path
    for off in ("off", "OFF", "0", ""):
        monkeypatch.setenv("LINEOFACTION_CACHE", off)
        assert default_cache_directory() is None
    monkeypatch.delenv("LINEOFACTION_CACHE")
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert default_cache_directory() == tmp_path / "xdg" / "lineofaction"
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert default_cache_directory() == Path.home() / ".cache" / "lineofaction"


def test_a_changed_copy_is_not_the_same(make_gear: MakeGear, coarse: MakeRecipe) -> None:
    gear = make_gear()
    found = flank_compliance(gear, coarse(gear), teeth=1)
    assert not same(found, replace(found, matrix=np.nextafter(found.matrix, 1.0)))
