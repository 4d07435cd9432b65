"""Laws of the parts of the transmission error: each follows what yields, and nothing else."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair
from fe_contact.body import Shaft, Shafts
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.effects.influence.deflection_budget import DeflectionBudget, Springs, deflection_budget
from fe_contact.effects.influence.slice_compliance import _tooth_bending, half_plane
from fe_contact.hertz import contact_modulus, half_width, relative_radius

PLANE = {"face_load_distribution": "off", "finite_width": "off", "corner_contact": "off"}
TORQUE = 50.0
PLAIN = FlankModification()


def spur_pair(bore: float = 20e-3, relief: float = 0.0) -> GearPair:
    gear = Gear(teeth=25, normal_module=2e-3, face_width=12e-3, bore_diameter=bore)
    flank = FlankModification(tip_relief=relief, tip_relief_length=0.5e-3)
    return GearPair(replace(gear, modification=flank), replace(gear, teeth=31))


def helical_pair(flank: FlankModification = PLAIN, shafts: Shafts = (None, None)) -> GearPair:
    gear = Gear(
        teeth=25, normal_module=2e-3, face_width=12e-3, bore_diameter=20e-3, helix_angle=math.radians(20.0)
    )
    wheel = replace(gear, teeth=31, helix_angle=-gear.helix_angle)
    return GearPair(replace(gear, modification=flank), wheel, shafts=shafts)


def scene(pair: GearPair, skew: float = 0.0) -> ContactScene:
    return ContactScene(pair, np.array([TORQUE]), EFFECTS, np.array([skew]))


def budget(pair: GearPair, skew: float = 0.0, **choices: str) -> DeflectionBudget:
    return deflection_budget(scene(pair, skew), choices)


def test_the_parts_are_the_deflection_of_the_springs() -> None:
    pair = helical_pair(FlankModification(tip_relief=15e-6, tip_relief_length=1e-3))
    parts = budget(pair, skew=10e-6)
    curve = Springs(pair).curve(compose(scene(pair, 10e-6), {})[0], pair.normal_force(np.array([TORQUE])))
    assert float(np.mean(parts.total)) == pytest.approx(float(curve.mean[0]), rel=1e-9)


def test_hertz_is_what_two_half_planes_approach_down_to_the_middles_of_the_teeth() -> None:
    """K. L. Johnson, Contact Mechanics, eq. 5.57, where one pair carries all: at the pitch point."""
    pair = spur_pair()
    parts = budget(pair, **PLANE)
    line_load = float(pair.normal_force(TORQUE)) / pair.face_width
    roll = pair.path_of_contact.pitch_point
    rolls = roll, float(pair.mating_roll_length(roll))
    modulus = contact_modulus(pair.pinion.material, pair.wheel.material)
    width = float(half_width(line_load, relative_radius(*rolls), modulus))
    expected = 0.0
    for gear, length in zip((pair.pinion, pair.wheel), rolls, strict=True):
        bending, ratio = _tooth_bending(gear), gear.material.poissons_ratio
        depth = float(bending.at(bending.depth, np.array(length**2 / (2.0 * gear.base_radius))))
        expected += (
            half_plane(gear) * line_load * (math.log(2.0 * depth / width) - 0.5 * ratio / (1.0 - ratio))
        )
    assert parts.contact[0] == pytest.approx(expected, rel=1e-6)


def test_a_wider_bore_stiffens_the_bodies_alone_where_one_pair_carries() -> None:
    thick, thin = (budget(spur_pair(bore), **PLANE) for bore in (15e-3, 30e-3))
    for part in ("teeth", "bodies"):
        for side in (0, 1):
            ratio = getattr(thin, part)[side][0] / getattr(thick, part)[side][0]
            assert ratio == pytest.approx(1.0, rel=1e-6) if part == "teeth" else ratio < 0.7
    assert thin.contact[0] == pytest.approx(thick.contact[0], rel=1e-6)


def test_plain_flanks_close_no_gap_and_modified_ones_do() -> None:
    plain, relieved = budget(spur_pair(), **PLANE), budget(spur_pair(relief=10e-6), **PLANE)
    for gap in (plain.modification, plain.misalignment, plain.corner):
        np.testing.assert_allclose(gap, 0.0, atol=1e-15)
    assert 0.0 < relieved.modification.max() <= 10e-6
    np.testing.assert_allclose(relieved.corner, 0.0, atol=1e-15)


def test_misalignment_and_tip_corners_have_parts_of_their_own() -> None:
    aligned, skewed = budget(helical_pair()), budget(helical_pair(), skew=20e-6)
    np.testing.assert_array_equal(aligned.misalignment, 0.0)
    np.testing.assert_array_equal(skewed.modification, 0.0)
    assert np.abs(skewed.misalignment).max() > 0.5e-6
    assert aligned.corner.max() > 0.0
    np.testing.assert_allclose(budget(helical_pair(), corner_contact="off").corner, 0.0, atol=1e-15)


def test_shafts_add_their_own_part() -> None:
    shaft = Shaft(diameter=20e-3, length=100e-3, position=30e-3)
    rigid, bent = budget(helical_pair()), budget(helical_pair(shafts=(shaft, None)))
    np.testing.assert_array_equal(rigid.shafts, 0.0)
    assert np.mean(bent.shafts) == pytest.approx(np.mean(bent.total - rigid.total), rel=0.1)
