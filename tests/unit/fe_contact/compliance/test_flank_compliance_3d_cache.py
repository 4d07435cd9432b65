"""Reuse and cost of compliances in three dimensions: both hands at once, the same bits, all in the key."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from compliance_gears import HELICAL, SPUR, WEBBED, coarse

import fe_contact.compliance.cyclic_compliance as flow
from fe_contact.compliance import (
    FlankCompliance3D,
    flank_compliance_3d,
    flank_compliances_3d,
    predict_cost,
)
from fe_contact.geometry import Gear
from fe_contact.material import Material
from fe_contact.mesh import ClampedBore, PlaneStrain, SectorRecipe


def test_hands_of_one_pair_share_a_computation(monkeypatch: pytest.MonkeyPatch) -> None:
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
    genuine = flow.compute_flank_compliance_3d

    def counting(gear: Gear, *arguments: object, **reports: object) -> FlankCompliance3D:
        computed.append(gear)
        return genuine(gear, *arguments, **reports)  # type: ignore[arg-type]

    monkeypatch.setattr(flow, "compute_flank_compliance_3d", counting)
    return computed


def test_the_cache_returns_the_same_bits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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


def test_all_that_decides_the_result_is_in_the_key() -> None:
    clamped, recipe = ClampedBore(), coarse(SPUR)
    keys = [
        flow.compliance_key_3d(SPUR, recipe, 2, clamped),
        flow.compliance_key_3d(SPUR, recipe, 1, clamped),
        flow.compliance_key_3d(SPUR, recipe, 2, PlaneStrain()),
        flow.compliance_key_3d(SPUR, replace(recipe, layers=8), 2, clamped),
    ]
    for change in (
        {"face_width": 21e-3},
        {"bore_diameter": 13e-3},
        {"helix_angle": 0.1},
        {"teeth": 10},
        {"material": Material(poissons_ratio=0.29)},
    ):
        keys.append(flow.compliance_key_3d(replace(SPUR, **change), recipe, 2, clamped))  # type: ignore[arg-type]
    assert len(set(keys)) == len(keys)
    hands = [flow.compliance_key_3d(replace(SPUR, helix_angle=a), recipe, 2, clamped) for a in (0.1, -0.1)]
    assert hands[0] == hands[1]


@pytest.mark.parametrize(
    "gear",
    [replace(SPUR, teeth=20, bore_diameter=40e-3), WEBBED],
    ids=["spur", "helical with a web"],
)
def test_cost_is_known_before_the_run(gear: Gear) -> None:
    recipe = SectorRecipe.draft(gear)
    flank_compliance_3d(gear, recipe)  # compiled code and libraries are loaded
    predicted = predict_cost(gear, recipe)  # its seconds are held against measured ones in benchmarks/
    tracemalloc.start()
    flank_compliance_3d(gear, recipe)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert 0.8 < predicted.bytes / peak < 1.8
    assert predict_cost(gear).seconds > predicted.seconds
