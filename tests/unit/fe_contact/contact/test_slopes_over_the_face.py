"""Patches over the face that follow the slope of the flanks: how the compliance changes along them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fe_contact import Gear, GearPair
from fe_contact.compliance import FlankCompliance3D
from fe_contact.contact import (
    ContactModel,
    ContactProblem,
    PatchRule,
    Slices,
    contact_candidates,
    face_contact_problem,
    solve_contact,
    with_face_tilt,
)
from fe_contact.geometry import Toothing

MODULE, HELIX = 3e-3, math.radians(20.0)
SHAPE = {"normal_module": MODULE, "face_width": 20e-3}
PAIR = GearPair(
    Gear(teeth=25, bore_diameter=30e-3, helix_angle=HELIX, **SHAPE),
    Gear(teeth=35, bore_diameter=40e-3, helix_angle=-HELIX, **SHAPE),
)
HALF = 0.25 * MODULE


def smooth_body(gear: Toothing, seed: int) -> FlankCompliance3D:
    """Smooth springs between all points of all flanks, stiffer to the root, and a key at three teeth."""
    tip = float(gear.flank_coordinate(gear.tip_roll_length))
    s = np.linspace(-0.3 * tip, tip, 25)
    z = np.linspace(-0.5, 0.5, 6) * gear.face_width
    index = np.full((2 * z.size - 1, s.size), -1)
    plane, node = np.meshgrid(np.arange(index.shape[0]), np.arange(s.size), indexing="ij")
    there = (plane % 2 == 0) | (node % 2 == 0)
    index[there] = np.arange(there.sum())
    planes = np.sort(np.concatenate([z, 0.5 * (z[1:] + z[:-1])]))
    x, y = s[node[there]] / tip, planes[plane[there]] / gear.face_width
    rng = np.random.default_rng(seed)
    rise = 1.0 + 0.5 * x + 0.2 * x * y
    near = np.exp(-((x[:, None] - x) ** 2) - (y[:, None] - y) ** 2)
    blocks = (
        1e-9 * np.outer(rise, rise) * np.stack([near, *(0.7 * near * np.cos(k + x) for k in (1, 2, 3, 4))])
    )
    rows = rng.normal(size=(9, 2, 1)) + rng.normal(size=(9, 2, 1)) * x + rng.normal(size=(9, 2, 1)) * y
    core = 1e-10 * np.array([[2.0, 0.3], [0.3, 1.0]])
    return FlankCompliance3D(
        s, z, index, blocks, 0.0, tip, 2.3e11, gear.base_helix_angle, gear.teeth, None, 0, {}, "",
        key_rows=rows, key_core=core,
    )  # fmt: skip


BODIES = smooth_body(PAIR.pinion, 1), smooth_body(PAIR.wheel, 2)


@pytest.fixture(scope="module", params=[True, False], ids=["teeth coupled", "each tooth by itself"])
def coupled(request):
    return request.param


@pytest.fixture(scope="module")
def problem(coupled):
    rule, model = PatchRule(HALF, 0.02 * MODULE, 1e-6), ContactModel(corner_contact=True, across_face=True)
    plain = contact_candidates(PAIR, model, np.array([0.1, 0.45]), rule, Slices.of_pair(PAIR, 3))
    return with_face_tilt(face_contact_problem(plain, BODIES, 0.0, coupled), BODIES, 0.0, coupled)


def inside(problem: ContactProblem) -> np.ndarray:
    """Slices of which no patch comes near a tip."""
    slices = problem.candidates.slices
    shape = (*slices.present.shape, -1)
    plain = [
        (patch.half_width == HALF) & (patch.edge_share == 0.0) & (patch.center < body.s[-1] - 1.01 * HALF)
        for patch, body in zip((slices.patch_1, slices.patch_2), BODIES, strict=True)
    ]
    return slices.present & (plain[0] & plain[1]).reshape(shape).all(axis=2)


def displaced(problem: ContactProblem, ways: np.ndarray, coupled: bool) -> np.ndarray:
    """The compliance assembled with the patches of every slice moved so far towards tip 1."""
    slices = problem.candidates.slices
    ways = np.repeat(ways, slices.patch_1.count, axis=1)
    first = replace(slices.patch_1, center=slices.patch_1.center + ways)
    second = replace(slices.patch_2, center=slices.patch_2.center - ways)
    moved = replace(problem.candidates, slices=replace(slices, patch_1=first, patch_2=second))
    return face_contact_problem(moved, BODIES, 0.0, coupled).compliance


@pytest.mark.law
def test_compliance_changes_as_patches_of_slices_are_displaced_to_second_order(problem, coupled):
    free = inside(problem)
    assert free.sum() >= 4
    ways = np.where(free, np.random.default_rng(3).uniform(-1.0, 1.0, free.shape), 0.0)
    there = np.ix_(range(len(free)), free.any(axis=0), free.any(axis=0))
    change = ways[:, :, None] * problem.tilt
    change = np.where(free[:, :, None] & free[:, None], change + np.swapaxes(change, 1, 2), 0.0)
    left = []
    for step in (8e-5, 4e-5):
        found = displaced(problem, step * ways, coupled) - problem.compliance
        found = np.where(free[:, :, None] & free[:, None], found, 0.0)
        left.append(np.abs(found - step * change)[there].max())
        assert left[-1] < 0.1 * step * np.abs(change).max()
    assert left[1] < 0.4 * left[0]  # a quarter is that of the square


def test_patches_of_a_slice_follow_the_mean_way_of_its_points_no_further_than_the_law_reaches(problem):
    c = problem.candidates
    touch = replace(c.touch, shift=np.random.default_rng(4).uniform(-1.0, 1.0, c.gap.shape) * 2e-3)
    found = problem.touching(c.touching(touch)).bodies - problem.bodies
    way = np.clip(touch.shift, -c.slices.law_length, c.slices.law_length)
    there = np.isfinite(c.gap).reshape(*c.slices.present.shape, -1)
    way = np.where(there, way.reshape(there.shape), 0.0).sum(axis=2) / np.maximum(there.sum(axis=2), 1)
    displaced = way[:, :, None] * problem.tilt
    assert found == pytest.approx(displaced + np.swapaxes(displaced, 1, 2), rel=1e-9, abs=1e-16)


def test_flanks_without_slope_press_where_they_did_to_the_last_bit(problem):
    loads = np.array([1000.0, 6000.0])
    staying = replace(problem, tilt=problem.tilt[:0, :0, :0])
    assert np.array_equal(solve_contact(problem, loads).force, solve_contact(staying, loads).force)
    assert problem.rolling.size == 0
    assert not problem.radius.any()
