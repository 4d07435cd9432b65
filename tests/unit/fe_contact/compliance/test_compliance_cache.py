"""The disk cache of compliances returns what was computed, or computes it again; all is in the key."""

import os
import tracemalloc
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest
from compliance_gears import HELICAL, SPUR, WEBBED, coarse, coarse_plane
from spur_gears import gear as make_gear

import fe_contact.compliance.cyclic_compliance as cyclic
import fe_contact.compliance.flank_compliance_2d as flow
from fe_contact import FlankModification, Gear, Material, RunOut
from fe_contact.cache_reads import COMPLIANCE_READS
from fe_contact.compliance import (
    FlankCompliance,
    PlaneHypothesis,
    cache,
    condensation_cost,
    default_cache_directory,
    flank_compliance,
    flank_compliance_3d,
    flank_compliances_3d,
    predict_cost,
)
from fe_contact.mesh import ClampedBore, PlaneStrain, SectorRecipe, quadratic_mesh
from host import lock


@pytest.fixture
def counted(monkeypatch):
    """Collect the gears that were computed."""
    computed: list[Gear] = []
    genuine = flow.compute_flank_compliance

    def counting(gear, *arguments):
        computed.append(gear)
        return genuine(gear, *arguments)

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


def test_second_call_reads_the_same_bits(tmp_path, counted):
    gear, before = make_gear(), replace(COMPLIANCE_READS)
    first = flank_compliance(gear, coarse_plane(gear), cache=tmp_path / "deep" / "cache")
    second = flank_compliance(gear, coarse_plane(gear), cache=tmp_path / "deep" / "cache")
    assert len(counted) == 1
    assert (first.from_cache, second.from_cache) == (False, True)
    assert replace(before, hits=before.hits + 1, misses=before.misses + 1) == COMPLIANCE_READS
    assert same(first, second)
    assert [p.suffix for p in (tmp_path / "deep" / "cache").iterdir()] == [".npz"]


@pytest.mark.law
def test_who_wants_a_body_that_is_being_condensed_waits_for_it(tmp_path, monkeypatch, counted):
    gear, all_missed = make_gear(), Barrier(4)
    recipe, read = coarse_plane(gear), cache.read_compliance

    def missed(*arguments):
        result = read(*arguments)
        all_missed.wait(60.0)
        return result

    monkeypatch.setattr(cache, "read_compliance", missed)
    with ThreadPoolExecutor(4) as pool:
        runs = [pool.submit(flank_compliance, gear, recipe, cache=tmp_path) for _ in range(4)]
        results = [run.result() for run in runs]
    assert len(counted) == 1
    assert sorted(result.from_cache for result in results) == [False, True, True, True]
    assert all(same(result, results[0]) for result in results)
    assert [file.suffix for file in tmp_path.iterdir()] == [".npz"]


def test_a_process_that_does_not_come_back_is_not_waited_for(tmp_path, monkeypatch, counted):
    gear, tries = make_gear(), []
    recipe, strain = coarse_plane(gear), PlaneHypothesis.PLANE_STRAIN
    key = flow.compliance_key(gear, recipe, strain, flow.condensed_teeth(gear, recipe, 1))

    def counting(descriptor):
        tries.append(descriptor)
        lock(descriptor)

    monkeypatch.setattr(cache, "PATIENCE_S", 0.2)
    monkeypatch.setattr(cache, "lock", counting)
    held = tmp_path / f"compliance-{key}.lock"
    with held.open("w") as stream:
        lock(stream.fileno())
        assert not flank_compliance(gear, recipe, teeth=1, cache=tmp_path).from_cache
    assert len(tries) > 1
    assert held.exists()  # it is another's
    assert len(counted) == 1


def test_an_interruption_while_it_waits_is_told_as_such(tmp_path, monkeypatch, counted):
    gear, descriptors = make_gear(), []

    def interrupted(descriptor):
        descriptors.append(descriptor)
        raise KeyboardInterrupt

    monkeypatch.setattr(cache, "lock", interrupted)
    with pytest.raises(KeyboardInterrupt):
        flank_compliance(gear, coarse_plane(gear), cache=tmp_path)
    with pytest.raises(OSError):
        os.fstat(descriptors[0])  # closed
    assert not counted


def test_a_failure_where_nothing_can_be_locked_is_that_of_the_computation(tmp_path):
    def failing():
        raise ZeroDivisionError

    file = tmp_path / "no directory"
    file.write_text("a file", "utf-8")
    with pytest.raises(ZeroDivisionError) as failed:
        cache.cached_or_computed(file, "key", FlankCompliance, failing)
    assert failed.value.__context__ is None


@pytest.mark.parametrize("damage", ["flipped bit", "truncated", "empty", "foreign", "another result"])
def test_a_damaged_file_is_computed_again_and_mended(tmp_path, counted, damage):
    gear = make_gear()
    first = flank_compliance(gear, coarse_plane(gear), cache=tmp_path)
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
    again = flank_compliance(gear, coarse_plane(gear), cache=tmp_path)
    assert not again.from_cache
    assert np.array_equal(again.matrix, first.matrix)
    assert flank_compliance(gear, coarse_plane(gear), cache=tmp_path).from_cache
    assert len(counted) == 2


def test_all_that_decides_the_result_is_in_the_key():
    gear, strain = make_gear(), PlaneHypothesis.PLANE_STRAIN
    recipe = coarse_plane(gear)
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


def test_a_new_model_version_does_not_read_old_files(tmp_path, counted, monkeypatch):
    gear = make_gear()
    flank_compliance(gear, coarse_plane(gear), cache=tmp_path)
    monkeypatch.setattr(flow, "MODEL_VERSION", flow.MODEL_VERSION + 1)
    assert not flank_compliance(gear, coarse_plane(gear), cache=tmp_path).from_cache
    assert len(counted) == 2


def test_without_a_directory_nothing_is_kept_and_no_result_lost(counted, tmp_path):
    gear = make_gear()
    for _ in range(2):
        flank_compliance(gear, coarse_plane(gear), cache=None)
    assert len(counted) == 2
    (tmp_path / "file").write_text("in the way")
    assert not flank_compliance(gear, coarse_plane(gear), cache=tmp_path / "file" / "cache").from_cache
    found = flank_compliance(gear, coarse_plane(gear), teeth=1)
    assert not same(found, replace(found, matrix=np.nextafter(found.matrix, 1.0)))


def test_the_default_directory_follows_the_environment(tmp_path, monkeypatch):
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


def test_hands_of_one_pair_share_a_computation(monkeypatch):
    computed = count_runs(monkeypatch)
    left = replace(HELICAL, helix_angle=-HELICAL.helix_angle)
    found = flank_compliances_3d([HELICAL, left, HELICAL], [coarse(HELICAL)] * 3)
    assert len(computed) == 1
    assert found[0] is found[2]
    assert found[1].base_helix_angle == -found[0].base_helix_angle
    assert np.array_equal(found[1].mirrored().blocks, found[0].blocks)
    backwards = flank_compliances_3d([left, HELICAL], [coarse(HELICAL)] * 2)
    assert np.array_equal(backwards[0].blocks, found[1].blocks)
    assert np.array_equal(backwards[1].blocks, found[0].blocks)


def count_runs(monkeypatch: pytest.MonkeyPatch) -> list[Gear]:
    computed: list[Gear] = []
    genuine = cyclic.compute_flank_compliance_3d

    def counting(gear, *arguments, **reports):
        computed.append(gear)
        return genuine(gear, *arguments, **reports)

    monkeypatch.setattr(cyclic, "compute_flank_compliance_3d", counting)
    return computed


def test_the_cache_returns_the_same_bits(tmp_path, monkeypatch):
    computed = count_runs(monkeypatch)
    recipe = coarse(HELICAL)
    first = flank_compliance_3d(HELICAL, recipe, cache=tmp_path)
    second = flank_compliance_3d(HELICAL, recipe, cache=tmp_path)
    left = flank_compliance_3d(replace(HELICAL, helix_angle=-HELICAL.helix_angle), recipe, cache=tmp_path)
    assert len(computed) == 1
    assert (first.from_cache, second.from_cache, left.from_cache) == (False, True, True)
    for name in ("s", "z", "index", "blocks"):
        assert np.array_equal(getattr(first, name), getattr(second, name))
        assert getattr(first, name).dtype == getattr(second, name).dtype
    plain = (
        "s_form",
        "s_tip",
        "contact_modulus",
        "base_helix_angle",
        "teeth",
        "checks",
        "unknowns",
        "seconds",
        "solver",
    )
    assert all(getattr(first, name) == getattr(second, name) for name in plain)
    assert np.array_equal(left.blocks, first.mirrored().blocks)
    (file,) = tmp_path.iterdir()
    content = file.read_bytes()
    file.write_bytes(content[: len(content) // 2])
    assert not flank_compliance_3d(HELICAL, recipe, cache=tmp_path).from_cache


def test_all_that_decides_the_result_in_three_dimensions_is_in_the_key():
    clamped, recipe = ClampedBore(), coarse(SPUR)
    keys = [
        cyclic.compliance_key_3d(SPUR, recipe, 2, clamped),
        cyclic.compliance_key_3d(SPUR, recipe, 1, clamped),
        cyclic.compliance_key_3d(SPUR, recipe, 2, PlaneStrain()),
        cyclic.compliance_key_3d(SPUR, replace(recipe, layers=8), 2, clamped),
    ]
    for change in (
        {"face_width": 21e-3},
        {"bore_diameter": 13e-3},
        {"helix_angle": 0.1},
        {"teeth": 10},
        {"material": Material(poissons_ratio=0.29)},
    ):
        keys.append(cyclic.compliance_key_3d(replace(SPUR, **change), recipe, 2, clamped))
    assert len(set(keys)) == len(keys)
    hands = [cyclic.compliance_key_3d(replace(SPUR, helix_angle=a), recipe, 2, clamped) for a in (0.1, -0.1)]
    assert hands[0] == hands[1]


@pytest.mark.parametrize(
    "gear",
    [replace(SPUR, teeth=20, bore_diameter=40e-3), WEBBED],
    ids=["spur", "helical with a web"],
)
def test_cost_is_known_before_the_run(gear):
    recipe = SectorRecipe.draft(gear)
    flank_compliance_3d(gear, recipe)  # compiled code and libraries are loaded
    predicted = predict_cost(gear, recipe)  # its seconds are held against measured ones in benchmarks/
    tracemalloc.start()
    flank_compliance_3d(gear, recipe)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert 0.8 < predicted.bytes / peak < 1.8
    assert predict_cost(gear).seconds > predicted.seconds


@pytest.mark.law
def test_gears_of_one_shape_cost_the_same_and_are_predicted_once(monkeypatch, tmp_path):
    """Reliefs and deviations change no body; another tip diameter does.

    One elimination tree serves the plan, which knows the host, and the progress, which does not.
    """
    built: list[int] = []
    genuine = condensation_cost.sector_tree
    monkeypatch.setattr(condensation_cost, "sector_tree", lambda sector: built.append(1) or genuine(sector))
    gear = replace(SPUR, face_width=1.07 * SPUR.face_width)  # of no other test
    recipe = SectorRecipe.draft(gear)
    plain = predict_cost(gear, recipe)
    assert predict_cost(gear, recipe, cache=tmp_path).bytes == plain.bytes
    relief = FlankModification(tip_relief=20e-6, tip_relief_length=1e-3)
    relieved = replace(gear, modification=relief, run_out=RunOut(10e-6))
    assert predict_cost(relieved, recipe) == plain
    assert len(built) == 1
    shorter = replace(relieved, tip_diameter=2.0 * gear.tip_radius - 0.2 * gear.normal_module)
    assert predict_cost(shorter, recipe).bytes != plain.bytes
    assert len(built) == 2


def test_one_process_meshes_a_pair_and_the_coarse_meshes_that_follow(tmp_path, monkeypatch):
    """What is in the cache is not meshed, and all is as each gear has it alone, to the last bit."""
    gears = [make_gear(20), make_gear(22)]
    fine = [coarse_plane(gear) for gear in gears]
    rough = [recipe.refined(0.8) for recipe in fine]
    alone = [
        flank_compliance(*each) for recipes in (fine, rough) for each in zip(gears, recipes, strict=True)
    ]
    sizes: list[int] = []
    genuine = quadratic_mesh.ask_gmsh

    def counted(request, *rest):
        sizes.append(len(request["regions"]))
        return genuine(request, *rest)

    monkeypatch.setattr(quadratic_mesh, "ask_gmsh", counted)
    flow.flank_compliance(gears[0], fine[0], cache=tmp_path)
    sizes.clear()
    together = [
        *flow.flank_compliances(gears, fine, cache=tmp_path, later=rough),
        *flow.flank_compliances(gears, rough, cache=tmp_path),
    ]
    assert sizes == [3]
    untimed = [replace(compliance, seconds={}) for compliance in together]
    assert all(map(same, untimed, (replace(compliance, seconds={}) for compliance in alone)))
