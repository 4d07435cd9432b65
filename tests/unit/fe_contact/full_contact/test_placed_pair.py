"""Both meshes in conjugate position: they touch, and the approach makes them overlap by as much."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair
from fe_contact.full_contact.meshing import FullContactMesh, reach_of
from fe_contact.full_contact.placed_pair import PlacedGear, no_load_gap, placed_pair
from fe_contact.full_contact.validity import refusal
from fe_contact.geometry import GearBlank
from fe_contact.mesh import MeshRecipe, mesh_gear
from fe_contact.mesh.quadratic import SIDES
from fe_contact.mesh.quality import scaled_jacobian
from fe_contact.types import FloatArray

PINION = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
WHEEL = Gear(teeth=31, normal_module=4e-3, face_width=25e-3, bore_diameter=60e-3)
PAIR = GearPair(PINION, WHEEL, center_distance=102e-3)


@pytest.fixture(scope="module")
def mesh() -> FullContactMesh:
    """Coarse meshes of both gears."""
    recipe = replace(
        MeshRecipe.standard(PINION), flank_size=0.4e-3, tip_size=0.2e-3, growth=0.5, real_teeth=5
    )
    return FullContactMesh((mesh_gear(PINION, recipe), mesh_gear(WHEEL, recipe)), reach=1)


def line_of(gear: PlacedGear, tooth: int) -> FloatArray:
    """Many points of a loaded flank, on the quadratic sides of its elements."""
    t = np.linspace(-1.0, 1.0, 41)[:, None]
    shapes = (0.5 * t * (t - 1.0), 0.5 * t * (t + 1.0), 1.0 - t**2)
    points = []
    for element, side in gear.flanks[tooth]:
        nodes = gear.triangles[element][[*SIDES[side], 3 + side]]
        points.append(sum(shape * gear.points[node] for shape, node in zip(shapes, nodes, strict=True)))
    return np.concatenate(points)


def closest(first: FloatArray, second: FloatArray) -> float:
    """Least distance of two sets of points, m."""
    return float(np.sqrt(((first[:, None] - second[None]) ** 2).sum(axis=2).min()))


@pytest.mark.parametrize("position", [-0.45, 0.0, 0.3])
def test_every_pair_on_the_path_of_contact_touches(mesh: FullContactMesh, position: float) -> None:
    placed = placed_pair(PAIR, mesh, position)
    path = PAIR.path_of_contact
    touching = 0
    for ahead, (first, second) in zip((-1, 0, 1), placed.meetings, strict=True):
        roll = float(PAIR.roll_lengths(position, ahead)[0])
        if path.start + 1e-4 < roll < path.end - 1e-4:
            touching += 1
            # points are 10 um apart along flanks of some 5 mm radius: they lie within 6 um of one another
            assert closest(line_of(placed.gears[0], first), line_of(placed.gears[1], second)) < 6e-6
    assert touching == (1 if position == 0.0 else 2)


def test_the_driving_gear_turns_towards_its_mate(mesh: FullContactMesh) -> None:
    before, after = (placed_pair(PAIR, mesh, 0.0, approach) for approach in (0.0, 50e-6))
    moved = after.gears[0].points - before.gears[0].points
    radius = np.linalg.norm(before.gears[0].points, axis=1)
    np.testing.assert_allclose(np.linalg.norm(moved, axis=1), 50e-6 * radius / PINION.base_radius, rtol=1e-6)
    top = np.argmax(before.gears[0].points[:, 1])
    assert moved[top, 0] > 0.0
    assert np.array_equal(after.gears[1].points, before.gears[1].points)


def test_modified_flanks_are_apart_by_what_was_removed(mesh: FullContactMesh) -> None:
    relieved = replace(PINION, modification=FlankModification(profile_slope=40e-6))
    pair = replace(PAIR, pinion=relieved)
    position = 0.2
    roll = PAIR.roll_lengths(position)[0]
    removed = float(relieved.modification.material_removed(relieved, roll, 0.0))
    assert abs(removed) > 1e-6
    gaps = [no_load_gap(pair, 1, at) for at in (position, position - 1.0, 0.0)]
    assert min(gaps[:2]) <= removed
    plain, modified = placed_pair(PAIR, mesh, position), placed_pair(pair, mesh, position)
    shift = modified.gears[0].points - plain.gears[0].points
    nodes = np.unique(plain.gears[0].triangles[plain.gears[0].flanks[0][:, 0]])
    assert np.linalg.norm(shift[nodes], axis=1).max() == pytest.approx(20e-6, rel=1e-6)
    assert no_load_gap(PAIR, 1, position) == 0.0


def test_high_contact_ratios_need_more_pairs() -> None:
    assert reach_of(PAIR) == 1
    tall = Gear(
        teeth=60, normal_module=2e-3, face_width=20e-3, bore_diameter=40e-3,
        addendum_coefficient=1.4, dedendum_coefficient=1.65, root_radius_coefficient=0.2,
    )  # fmt: skip
    high = GearPair(tall, tall, center_distance=120e-3)
    assert high.transverse_contact_ratio > 2.0
    assert reach_of(high) == 2


def test_what_plane_strain_does_not_hold_is_refused_by_reason() -> None:
    assert refusal(PAIR) is None
    helical = [replace(PINION, helix_angle=angle) for angle in (0.2, -0.2)]
    distance = helical[0].reference_radius * 2.0
    assert "helical" in str(refusal(GearPair(*helical, center_distance=distance)))
    web = replace(PINION, blank=GearBlank(rim_thickness=8e-3, web_thickness=6e-3))
    assert "rim" in str(refusal(replace(PAIR, pinion=web)))
    crowned = replace(WHEEL, modification=FlankModification(helix_crowning=5e-6))
    assert "across the face" in str(refusal(replace(PAIR, wheel=crowned)))
    rounded = replace(WHEEL, modification=FlankModification(tip_rounding=0.1e-3))
    assert "tips" in str(refusal(replace(PAIR, wheel=rounded)))


def test_no_element_is_turned_over_by_a_relief_as_deep_as_it_is_large() -> None:
    relieved = replace(PINION, modification=FlankModification(tip_relief=60e-6, tip_relief_length=1.7e-3))
    recipe = replace(
        MeshRecipe.standard(PINION), flank_size=0.1e-3, tip_size=0.04e-3, growth=0.5, real_teeth=3
    )
    made = mesh_gear(PINION, recipe)
    pair = GearPair(relieved, PINION, center_distance=80e-3)
    placed = placed_pair(pair, FullContactMesh((made, made), reach=1), 0.0)
    for gear in placed.gears:
        assert scaled_jacobian(gear.points[gear.triangles]).min() > 0.1
