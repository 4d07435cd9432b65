"""Worth of effects without finite elements: the springs against finite elements, laws of their compliance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fe_contact import FlankModification, Gear, GearPair
from fe_contact.analysis import check_request
from fe_contact.compliance import flank_compliance
from fe_contact.contact import ContactModel, PatchRule, Slices, contact_candidates, contact_problem
from fe_contact.effects import EFFECTS
from fe_contact.effects.worth import Worth, estimate_worth, estimate_worths
from fe_contact.effects.worth.slice_compliance import slice_compliance
from fe_contact.effects.worth.slice_model import Springs
from fe_contact.types import FloatArray

M = 3e-3
GEAR = Gear(teeth=24, normal_module=M, face_width=6 * M, bore_diameter=12 * M)
PAIR = GearPair(GEAR, GEAR)
HELICAL = GearPair(replace(GEAR, helix_angle=0.35), replace(GEAR, helix_angle=-0.35))


def worth(pair: GearPair, name: str, **asked: object) -> Worth:
    """Estimate one effect of a request at one load."""
    checked = check_request(pair, **({"normal_forces": [2000.0]} | asked))  # type: ignore[arg-type]
    found = estimate_worth(checked.request.scene, checked.decided, name, EFFECTS)
    assert found is not None
    return found


def compliance(pair: GearPair, model: ContactModel, slices: int) -> FloatArray:
    """Springs of a few positions."""
    candidates = contact_candidates(
        pair, model, np.array([0.1, 0.6]), PatchRule(0.15 * M, 0.0125 * M), Slices.of_pair(pair, slices)
    )
    return slice_compliance(pair, candidates, model)


def test_springs_are_as_soft_as_finite_elements() -> None:
    model, position = ContactModel(couple_teeth=True, corner_contact=True), np.arange(16) / 16
    rule = PatchRule(0.15 * M, 0.0125 * M)
    candidates = contact_candidates(PAIR, model, position, rule, Slices.of_pair(PAIR, 1))
    flank = flank_compliance(GEAR)
    exact = contact_problem(candidates, (flank, flank)).compliance
    springs = slice_compliance(PAIR, candidates, model)
    real = np.isfinite(candidates.gap)
    own = np.diagonal(springs, axis1=1, axis2=2)[real] / np.diagonal(exact, axis1=1, axis2=2)[real]
    assert own == pytest.approx(np.ones(own.size), abs=0.05)
    both = real[:, :, None] & real[:, None, :] & ~np.eye(real.shape[1], dtype=bool)
    between = springs[both] / exact[both]
    assert between.size > 0
    assert between == pytest.approx(np.ones(between.size), abs=0.25)


@pytest.mark.parametrize("pair", [PAIR, HELICAL])
def test_springs_are_symmetric_and_positive(pair: GearPair) -> None:
    model = ContactModel(couple_teeth=True, across_face=True, corner_contact=True)
    for matrix in compliance(pair, model, 9):
        np.testing.assert_allclose(matrix, matrix.T, rtol=1e-12)
        assert np.linalg.eigvalsh(matrix).min() > 0.0


def test_an_even_load_over_the_face_is_the_plane() -> None:
    flat = compliance(PAIR, ContactModel(couple_teeth=True, finite_width=True), 1)[0]
    count = 41
    face = compliance(PAIR, ContactModel(couple_teeth=True, across_face=True), count)[0]
    pairs = flat.shape[0]
    even = face.reshape(pairs, count, pairs, count).mean(axis=3)
    np.testing.assert_allclose(even.mean(axis=1), flat, rtol=1e-3)
    # free ends of the springs reflect: no slice of the face gives way more than another
    assert np.ptp(even, axis=1).max() < 2e-3 * flat.max()


def test_lengths_and_loads_together_change_no_ratio() -> None:
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


def test_a_rigid_gap_under_all_of_the_load_is_seen_whole() -> None:
    relieved = FlankModification(tip_relief=5e-6, tip_relief_length=0.5 * M)
    pair = replace(PAIR, pinion=replace(GEAR, modification=relieved))
    found = worth(pair, "profile_modification", normal_forces=[1.0], effects={"corner_contact": "off"})
    # at next to no load the mesh follows the relief of its one pair outside double contact
    assert 0.0 < -found.peak_to_peak[0] < 5e-6
    assert abs(found.relative_peak_to_peak) < 1.0


def test_what_a_scene_does_not_hold_is_worth_nothing() -> None:
    for name in ("lead_modification", "misalignment", "pitch_error", "shaft_deflection", "thin_rim"):
        assert worth(PAIR, name).largest == 0.0
    checked = check_request(HELICAL, normal_forces=[2000.0])
    assert estimate_worth(checked.request.scene, checked.decided, "face_load_distribution", EFFECTS) is None


def test_misalignment_is_worth_more_the_larger_it_is() -> None:
    small, large = (worth(PAIR, "misalignment", misalignments=[x]) for x in (2e-6, 20e-6))
    assert large.largest > 10.0 * small.largest > 0.0


def test_between_the_loads_that_are_solved_worths_are_interpolated() -> None:
    """Exact at the ends and in the middle, right within the factor that estimates are right by between."""
    checked = check_request(PAIR, normal_forces=[600.0, 900.0, 1200.0, 1500.0, 1800.0])
    wanted = (checked.request.scene, checked.decided, ["corner_contact", "tooth_coupling"], EFFECTS)
    every, some = estimate_worths(*wanted), estimate_worths(*wanted, most_loads=3)
    for name, found in some.items():
        whole = every[name]
        assert found is not None
        assert whole is not None
        np.testing.assert_allclose(found.mean[::2], whole.mean[::2], rtol=1e-6)
        np.testing.assert_allclose(found.peak_to_peak[::2], whole.peak_to_peak[::2], rtol=1e-6)
        np.testing.assert_allclose(found.mean, whole.mean, rtol=0.1)
        assert not np.array_equal(found.mean[1::2], whole.mean[1::2])
