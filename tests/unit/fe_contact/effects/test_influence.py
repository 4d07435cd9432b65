"""Influence of effects and parts of the deflection without finite elements: springs, and laws of both."""

import math
from dataclasses import replace

import numpy as np
import pytest
from analysis_requests import table_request

from fe_contact import FlankModification, Gear, GearPair, Shaft, TableAxes
from fe_contact.analysis.pairs.pair_contact import pair_contact
from fe_contact.analysis.request.request_check import check_request
from fe_contact.compliance import flank_compliance
from fe_contact.contact import ContactModel, PatchRule, Slices, contact_candidates, contact_problem
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.effects.influence.axial_compliance import _bent
from fe_contact.effects.influence.deflection_budget import DeflectionBudget, deflection_budget
from fe_contact.effects.influence.estimate import EstimatedInfluence, estimate_influence
from fe_contact.effects.influence.estimated_curve import Springs
from fe_contact.effects.influence.slice_compliance import slice_compliance
from fe_contact.effects.influence.tooth_bending import half_plane, tooth_bending
from fe_contact.hertz import contact_modulus, half_width, relative_radius
from fe_contact.planning.plan import make_plan
from fe_contact.shaft import Shafts
from fe_contact.types import FloatArray

M = 3e-3
GEAR = Gear(teeth=24, normal_module=M, face_width=6 * M, bore_diameter=12 * M)
PAIR = GearPair(GEAR, GEAR)


HELICAL = GearPair(replace(GEAR, helix_angle=0.35), replace(GEAR, helix_angle=-0.35))


def influence(pair: GearPair, name: str, **asked: object) -> EstimatedInfluence:
    """Estimate one effect of a request at one load."""
    checked = check_request(pair, *table_request(**{"normal_forces": [2000.0]} | asked))
    found = estimate_influence(checked.request.scene, checked.decision, name)
    assert found is not None
    return found


def compliance(pair: GearPair, model: ContactModel, slices: int) -> FloatArray:
    """Springs of a few positions."""
    candidates = contact_candidates(
        pair, model, np.array([0.1, 0.6]), PatchRule(0.15 * M, 0.0125 * M), Slices.of_pair(pair, slices)
    )
    return slice_compliance(pair, candidates.slices, model)


@pytest.mark.law
def test_springs_are_as_soft_as_finite_elements():
    model, position = ContactModel(couple_teeth=True, corner_contact=True), np.arange(16) / 16
    rule = PatchRule(0.15 * M, 0.0125 * M)
    candidates = contact_candidates(PAIR, model, position, rule, Slices.of_pair(PAIR, 1))
    flank = flank_compliance(GEAR)
    exact = contact_problem(candidates, (flank, flank)).compliance
    springs = slice_compliance(PAIR, candidates.slices, model)
    real = np.isfinite(candidates.gap)
    own = np.diagonal(springs, axis1=1, axis2=2)[real] / np.diagonal(exact, axis1=1, axis2=2)[real]
    assert own == pytest.approx(np.ones(own.size), abs=0.05)
    both = real[:, :, None] & real[:, None, :] & ~np.eye(real.shape[1], dtype=bool)
    between = springs[both] / exact[both]
    assert between.size > 0
    assert between == pytest.approx(np.ones(between.size), abs=0.25)


@pytest.mark.law
def test_springs_of_helical_teeth_are_as_soft_as_finite_elements(tmp_path):
    """A force with an axial part bends the discs: without that teeth move their neighbors half as far."""
    narrow = {name: replace(getattr(HELICAL, name), face_width=4 * M) for name in ("pinion", "wheel")}
    checked = check_request(
        replace(HELICAL, **narrow), *table_request(normal_forces=[2000.0], level="draft", positions=8)
    )
    request = checked.request
    plan = make_plan(request.pair, request.load, request.options, checked.model)
    problem = pair_contact(request.pair, plan, tmp_path).problem(checked.model, np.array([0.25]))
    candidates, exact = problem.candidates, problem.compliance[0]
    springs = slice_compliance(request.pair, candidates.slices, checked.model)[0]
    real, pair = candidates.slices.present[0], candidates.slices.pair
    same = pair[:, None] == pair
    for between, bound in ((same, 0.05), (~same, 0.15)):
        both = between & real[:, None] & real
        assert springs[both].mean() == pytest.approx(exact[both].mean(), rel=bound)


def test_a_narrow_disc_bends_as_a_cantilever():
    """Held inside or outside: the plate's even harmonic is a beam as long as the ring is wide."""
    length, above = 1e-3, 0.2e-3
    beam = length**3 / 3.0 + above * length**2 + above**2 * length
    for ratio in (1.0 - length, 1.0 + length):
        assert _bent(0, ratio, above, 0.3) == pytest.approx(beam, rel=5e-3)
        assert _bent(1, ratio, above, 0.3) == pytest.approx(beam, rel=5e-3)


@pytest.mark.parametrize("pair", [PAIR, HELICAL])
def test_springs_are_symmetric_and_positive(pair):
    model = ContactModel(couple_teeth=True, across_face=True, corner_contact=True)
    for matrix in compliance(pair, model, 9):
        np.testing.assert_allclose(matrix, matrix.T, rtol=1e-12)
        assert np.linalg.eigvalsh(matrix).min() > 0.0


def test_an_even_load_over_the_face_is_the_plane():
    flat = compliance(PAIR, ContactModel(couple_teeth=True, finite_width=True), 1)[0]
    count = 41
    face = compliance(PAIR, ContactModel(couple_teeth=True, across_face=True), count)[0]
    pairs = flat.shape[0]
    even = face.reshape(pairs, count, pairs, count).mean(axis=3)
    np.testing.assert_allclose(even.mean(axis=1), flat, rtol=1e-3)
    # free ends of the springs reflect: no slice of the face gives way more than another
    assert np.ptp(even, axis=1).max() < 2e-3 * flat.max()


def test_lengths_and_loads_together_change_no_ratio():
    large = replace(
        PAIR,
        **{
            name: replace(GEAR, normal_module=2 * M, face_width=12 * M, bore_diameter=24 * M)
            for name in ("pinion", "wheel")
        },
        center_distance=2.0 * PAIR.center_distance,
    )
    model = ContactModel(couple_teeth=True, corner_contact=True)
    small, big = (Springs(pair).curve(model, np.array([f])) for pair, f in ((PAIR, 1e3), (large, 4e3)))
    np.testing.assert_allclose(big.mean, 2.0 * small.mean, rtol=1e-9)
    np.testing.assert_allclose(big.peak_to_peak, 2.0 * small.peak_to_peak, rtol=1e-9)


def test_a_rigid_gap_under_all_of_the_load_is_seen_whole():
    relieved = FlankModification(tip_relief=5e-6, tip_relief_length=0.5 * M)
    pair = replace(PAIR, pinion=replace(GEAR, modification=relieved))
    found = influence(pair, "profile_modification", normal_forces=[1.0], effects={"corner_contact": "off"})
    # at next to no load the mesh follows the relief of its one pair outside double contact
    assert 0.0 < -found.peak_to_peak[0] < 5e-6
    assert found.largest < 1.0


def test_what_a_scene_does_not_hold_changes_nothing_and_more_more():
    for name in ("lead_modification", "misalignment", "pitch_error", "shaft_deflection", "thin_rim"):
        assert influence(PAIR, name).largest == 0.0
    checked = check_request(HELICAL, TableAxes(normal_forces=[2000.0]))
    assert estimate_influence(checked.request.scene, checked.decision, "face_load_distribution") is None
    small, large = (influence(PAIR, "misalignment", misalignments=[x]) for x in (2e-6, 20e-6))
    assert large.largest > 10.0 * small.largest > 0.0


PLANE = {"face_load_distribution": "off", "finite_width": "off", "corner_contact": "off"}
TORQUE = 50.0
PLAIN = FlankModification()


def spur_pair(bore: float = 20e-3, relief: float = 0.0) -> GearPair:
    gear = Gear(teeth=25, normal_module=2e-3, face_width=12e-3, bore_diameter=bore)
    flank = FlankModification(tip_relief=relief, tip_relief_length=0.5e-3)
    return GearPair(replace(gear, modification=flank), replace(gear, teeth=31))


def helical_pair(flank: FlankModification = PLAIN, shafts: Shafts = (None, None)) -> GearPair:
    gear = Gear(25, 2e-3, 12e-3, 20e-3, helix_angle=math.radians(20.0))
    wheel = replace(gear, teeth=31, helix_angle=-gear.helix_angle)
    return GearPair(replace(gear, modification=flank), wheel, shafts=shafts)


def scene(pair: GearPair, skew: float = 0.0) -> ContactScene:
    return ContactScene(pair, np.array([TORQUE]), EFFECTS, np.array([skew]))


def budget(pair: GearPair, skew: float = 0.0, **choices: str) -> DeflectionBudget:
    return deflection_budget(scene(pair, skew), choices)


def test_the_parts_are_the_deflection_of_the_springs():
    pair = helical_pair(FlankModification(tip_relief=15e-6, tip_relief_length=1e-3))
    parts = budget(pair, skew=10e-6)
    curve = Springs(pair).curve(compose(scene(pair, 10e-6), {})[0], pair.normal_force(np.array([TORQUE])))
    assert float(np.mean(parts.total)) == pytest.approx(float(curve.mean[0]), rel=1e-9)


def test_hertz_is_what_two_half_planes_approach_down_to_the_middles_of_the_teeth():
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
        bending, ratio = tooth_bending(gear), gear.material.poissons_ratio
        depth = float(bending.at(bending.depth, np.array(length**2 / (2.0 * gear.base_radius))))
        expected += (
            half_plane(gear) * line_load * (math.log(2.0 * depth / width) - 0.5 * ratio / (1.0 - ratio))
        )
    assert parts.contact[0] == pytest.approx(expected, rel=1e-6)


def test_a_wider_bore_stiffens_the_bodies_alone_where_one_pair_carries():
    thick, thin = (budget(spur_pair(bore), **PLANE) for bore in (15e-3, 30e-3))
    for part in ("teeth", "bodies"):
        for side in (0, 1):
            ratio = getattr(thin, part)[side][0] / getattr(thick, part)[side][0]
            assert ratio == pytest.approx(1.0, rel=1e-6) if part == "teeth" else ratio < 0.7
    assert thin.contact[0] == pytest.approx(thick.contact[0], rel=1e-6)


def test_every_cause_has_a_part_of_its_own():
    plain, relieved = budget(spur_pair(), **PLANE), budget(spur_pair(relief=10e-6), **PLANE)
    for gap in (plain.modification, plain.misalignment, plain.corner):
        np.testing.assert_allclose(gap, 0.0, atol=1e-15)
    assert 0.0 < relieved.modification.max() <= 10e-6
    np.testing.assert_allclose(relieved.corner, 0.0, atol=1e-15)
    aligned, skewed = budget(helical_pair()), budget(helical_pair(), skew=20e-6)
    np.testing.assert_array_equal(aligned.misalignment, 0.0)
    np.testing.assert_array_equal(skewed.modification, 0.0)
    assert np.abs(skewed.misalignment).max() > 0.5e-6
    assert aligned.corner.max() > 0.0
    np.testing.assert_allclose(budget(helical_pair(), corner_contact="off").corner, 0.0, atol=1e-15)
    shaft = Shaft(diameter=20e-3, length=100e-3, position=30e-3)
    rigid, bent = budget(helical_pair()), budget(helical_pair(shafts=(shaft, None)))
    np.testing.assert_array_equal(rigid.shafts, 0.0)
    assert np.mean(bent.shafts) == pytest.approx(np.mean(bent.total - rigid.total), rel=0.1)
