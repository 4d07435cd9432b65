"""Both gears in conjugate position: they touch, external and internal, and an approach turns the driver."""

from dataclasses import replace

import numpy as np
import pytest
from calculix import no_load_gap, placed_pair

from fe_contact import FlankModification, Gear, GearPair, InternalGearPair, RingGear
from fe_contact.geometry import ParallelAxes
from fe_contact.mesh.quality import least_jacobian
from fe_contact.types import FloatArray
from verification.full_contact.condensation.condensed_body import freedoms
from verification.full_contact.condensation.placed_mesh import PlacedBody, placed_bodies
from verification.full_contact.condensation.resolution import Resolution
from verification.full_contact.condensation.sites import Range, contact_sites, least_omitted_gap

PINION = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
WHEEL = Gear(teeth=31, normal_module=4e-3, face_width=25e-3, bore_diameter=60e-3)
PAIR = GearPair(PINION, WHEEL, center_distance=102e-3)
INTERNAL = InternalGearPair(
    Gear(24, 2e-3, 20e-3, bore_diameter=24e-3),
    RingGear(72, 2e-3, 20e-3, rim_diameter=164e-3, addendum_coefficient=0.85),
)
HELD, COARSE = Range((20e3, 200e3), 1e-6), Resolution(2.0)


def bodies_at(pair: ParallelAxes, position: float) -> tuple[PlacedBody, PlacedBody]:
    return placed_bodies(pair, position, contact_sites(pair, position, HELD, COARSE), COARSE)


def line_of(body: PlacedBody, ahead: int) -> FloatArray:
    """Many points of a strip, on the quadratic sides of its elements."""
    nodes = body.points[body.strips[ahead].nodes]
    t = np.linspace(0.0, 1.0, 41)[:, None]
    first, middle, last = nodes[:-2:2], nodes[1::2], nodes[2::2]
    shapes = ((1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0))
    sides = zip(first, middle, last, strict=True)
    return np.concatenate([sum(s * p for s, p in zip(shapes, side, strict=True)) for side in sides])


def closest(first: FloatArray, second: FloatArray) -> float:
    """Least distance of two sets of points, m."""
    return float(np.sqrt(((first[:, None] - second[None]) ** 2).sum(axis=2).min()))


@pytest.mark.drawn
@pytest.mark.parametrize("pair", [PAIR, INTERNAL], ids=["external", "internal"])
@pytest.mark.parametrize("position", [-0.45, 0.0, 0.3])
def test_every_pair_on_the_path_of_contact_touches(pair, position):
    first, second = bodies_at(pair, position)
    path, touching = pair.path_of_contact, 0
    for ahead in first.strips:
        roll = float(pair.roll_lengths(position, ahead)[0])
        if path.start + 1e-4 < roll < path.end - 1e-4:
            touching += 1
            # points are 5 um apart along the flanks: they lie within 3 um of one another
            assert closest(line_of(first, ahead), line_of(second, ahead)) < 3e-6
    assert touching == np.count_nonzero(
        [path.start < float(pair.roll_lengths(position, n)[0]) < path.end for n in range(-3, 4)]
    )


def test_the_driving_gear_turns_towards_its_mate():
    bodies = bodies_at(PAIR, 0.0)
    before, after = (placed_pair(PAIR, bodies, approach) for approach in (0.0, 50e-6))
    moved = after.gears[0].points - before.gears[0].points
    radius = np.linalg.norm(before.gears[0].points, axis=1)
    np.testing.assert_allclose(np.linalg.norm(moved, axis=1), 50e-6 * radius / PINION.base_radius, rtol=1e-6)
    top = np.argmax(before.gears[0].points[:, 1])
    assert moved[top, 0] > 0.0
    assert np.array_equal(after.gears[1].points, before.gears[1].points)
    assert before.meetings == ((0, 0),)
    assert freedoms(np.array([3, 0])).tolist() == [6, 7, 0, 1]


def test_modified_flanks_are_apart_by_what_was_removed_and_turn_no_element_over():
    relieved = replace(PINION, modification=FlankModification(profile_crowning=40e-6))
    pair = replace(PAIR, pinion=relieved)
    roll = float(pair.roll_lengths(0.0)[0])
    removed = float(relieved.modification.material_removed(relieved, roll, 0.0))
    assert removed > 0.0
    assert no_load_gap(pair, 0.0) == pytest.approx(removed, rel=1e-12)
    first, second = bodies_at(pair, 0.0)
    assert closest(line_of(first, 0), line_of(second, 0)) == pytest.approx(removed, abs=2e-6)
    assert no_load_gap(PAIR, 0.3) == 0.0
    relieved = replace(PINION, modification=FlankModification(tip_relief=60e-6, tip_relief_length=1.7e-3))
    for body in bodies_at(GearPair(relieved, PINION, center_distance=80e-3), 0.2):
        assert least_jacobian(body.points[body.triangles]).min() > 0.1


def test_teeth_off_the_path_are_held_where_the_lag_brings_them_to_touch():
    near = contact_sites(PAIR, 0.2, HELD, COARSE)
    gap = least_omitted_gap(PAIR, 0.2, near)
    assert np.isfinite(gap)
    wide = contact_sites(PAIR, 0.2, replace(HELD, lag=1.01 * gap), COARSE)
    assert len(wide) == len(near) + 1
    assert least_omitted_gap(PAIR, 0.2, wide) > gap
