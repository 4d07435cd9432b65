"""Laws of tables over the face: symmetries of space, scaling, and loads that grow."""

import dataclasses
import math

import numpy as np
import pytest
from tilted_gears import TiltedGap

from fe_contact import FlankModification, Gear, GearPair, SteDatabase, analyze
from fe_contact.effects.misalignment import MisalignmentGap

pytestmark = pytest.mark.usefixtures("coarse_sectors")


def helical(hand: int = 1, scale: float = 1.0, **changes: object) -> GearPair:
    pinion = Gear(
        19, 3e-3 * scale, 20e-3 * scale, 30e-3 * scale, helix_angle=hand * math.radians(20.0), **changes
    )
    modification = FlankModification()
    return GearPair(
        pinion,
        dataclasses.replace(pinion, teeth=26, helix_angle=-pinion.helix_angle, modification=modification),
    )


def draft(pair: GearPair, force: float = 2000.0, **options: object) -> SteDatabase:
    return analyze(pair, normal_forces=[force], level="draft", positions=12, **options)


def test_opposite_hand_is_the_mirror_image():
    """Mirroring both gears and the misalignment in the transverse plane changes nothing."""
    skew = 20e-6
    first = draft(helical(+1), misalignments=[-skew, 0.0, skew])
    second = draft(helical(-1), misalignments=[-skew, 0.0, skew])
    assert second.static_transmission_error == pytest.approx(
        first.static_transmission_error[:, :, ::-1], rel=1e-9, abs=0.0
    )
    for name in ("face_centroid", "load_arm"):
        assert getattr(second, name) == pytest.approx(-getattr(first, name)[:, :, ::-1], abs=1e-9)


@pytest.mark.parametrize("hand", [1, 0, -1], ids=["right hand", "spur", "left hand"])
@pytest.mark.law
def test_the_moment_of_the_load_is_what_a_misalignment_works_on(hand):
    """d STE/dm at constant force is d(F arm)/dF / b; the face centroid is the arm of straight teeth alone."""
    force, skew = np.array([1900.0, 2000.0, 2100.0]), np.array([14.5e-6, 15e-6, 15.5e-6])
    table = analyze(helical(hand), normal_forces=force, misalignments=skew, level="draft", positions=12)
    ste = table.static_transmission_error[:, 1, :, 0]
    by_tilt = (ste[:, 2] - ste[:, 0]) / (skew[2] - skew[0])

    def of_moment(arm):
        moment = force[:, None] * arm[..., 0] / table.geometry.face_width
        return np.asarray((moment[:, 2, 1] - moment[:, 0, 1]) / (force[2] - force[0]))

    assert np.ptp(by_tilt) > 0.05
    assert of_moment(table.load_arm) == pytest.approx(by_tilt, abs=2e-3)
    off = np.abs(of_moment(table.face_centroid) - by_tilt).max()
    assert off > 0.01 if hand else np.array_equal(table.load_arm, table.face_centroid)
    np.testing.assert_allclose(table.load_arm, arm_of_pairs(table), rtol=0.0, atol=1e-12)


def arm_of_pairs(table: SteDatabase) -> np.ndarray:
    """Return the arm by shares of pairs and where they touch: z_c / cos^2 beta_b - tan beta_b sum c_j y_j."""
    twist = math.tan(table.geometry.base_helix_angle) * np.sign(table.geometry.helix_hand or 1)
    way = (table.position[:, None] % 1.0 + table.pair) * table.geometry.base_pitch
    along = np.einsum("pfmdn,pn->pfmd", table.load_share, way)
    return np.asarray(table.face_centroid * (1.0 + twist**2) - twist * along)


def test_a_tilted_pair_has_the_ripple_of_gears_that_were_rotated_in_space(monkeypatch):
    """At 60 um, 3 mrad: gaps of the rigid tilted helicoids between the same bodies. A helix slope has not."""

    def ripples():
        table = draft(helical(), force=6000.0, misalignments=[-60e-6, 60e-6])
        return np.ptp(table.static_transmission_error[:, 0, :, 0], axis=0)

    ours = ripples()
    monkeypatch.setattr(
        MisalignmentGap, "__call__",
        lambda gap, pair, *at: TiltedGap(gap.growth / pair.face_width)(pair, *at),
    )  # fmt: skip
    exact = ripples()
    monkeypatch.setattr(
        MisalignmentGap, "__call__",
        lambda gap, pair, roll_1, roll_2, face: gap.growth * face / pair.face_width + 0.0 * roll_1,
    )  # fmt: skip
    slope = ripples()
    assert ours == pytest.approx(exact, rel=5e-3)
    assert np.all(np.abs(slope / exact - 1.0) > 0.05)


@pytest.mark.law
def test_lengths_by_s_and_forces_by_s2():
    s = 3.0
    small, large = draft(helical()), draft(helical(scale=s), force=2000.0 * s**2)
    assert large.static_transmission_error == pytest.approx(
        s * small.static_transmission_error, rel=1e-6, abs=0.0
    )
    assert large.load_share == pytest.approx(small.load_share, abs=1e-6)


def test_swapped_gears_have_the_mirrored_curve():
    """With the wheel driving, positions run backwards; in double contact the shift by STE is invisible."""
    pair = helical()
    swapped = pair.swapped()
    swapped = dataclasses.replace(
        swapped,
        pinion=dataclasses.replace(swapped.pinion, helix_angle=-swapped.pinion.helix_angle),
        wheel=dataclasses.replace(swapped.wheel, helix_angle=-swapped.wheel.helix_angle),
    )
    options = {"effects": {"corner_contact": "off"}}
    first, second = draft(pair, **options), draft(swapped, **options)
    ours = first.static_transmission_error[:, 0, 0, 0]
    theirs = second.static_transmission_error[:, 0, 0, 0]
    mirrored = np.roll(theirs[::-1], 1)
    assert mirrored == pytest.approx(ours, rel=1e-6, abs=0.0)


def test_laws_hold_over_the_face():
    loads = [20.0, 200.0, 2000.0, 8000.0]
    pair = helical(
        modification=FlankModification(helix_crowning=8e-6, tip_relief=6e-6, tip_relief_length=0.8e-3)
    )
    table = analyze(
        pair,
        normal_forces=loads,
        misalignments=[-30e-6, 0.0, 30e-6],
        level="draft",
        positions=12,
    )
    assert table.n_failed == 0
    assert table.residuals.max() < 1e-9
    assert np.all(np.diff(table.static_transmission_error, axis=1) > 0.0)
    assert table.load_share.sum(axis=-1) == pytest.approx(1.0, abs=1e-12)
    assert np.abs(table.face_centroid).max() <= 10e-3
    # the gap grows with the face position, so the load sits on the other side
    assert np.all(table.face_centroid[:, 1:, 2] < table.face_centroid[:, 1:, 0])


def test_force_extraction_covers_all_axes():
    table = draft(helical(), misalignments=[0.0, 20e-6], center_distance_changes=[0.0, 50e-6])
    x = np.linspace(0.0, 1.0, 9)
    force = table.force[0]
    for m, d in ((0.0, 0.0), (20e-6, 50e-6), (8e-6, 20e-6)):
        deflection = table.ste(x, force, misalignment=m, center_distance_change=d)
        sample = table.force_at(x, deflection, misalignment=m, center_distance_change=d)
        assert sample.force == pytest.approx(force * math.cos(table.geometry.base_helix_angle), rel=1e-9)


def test_a_wheel_beside_its_pinion_carries_on_the_common_face():
    gear = Gear(teeth=20, normal_module=4e-3, face_width=20e-3, bore_diameter=40e-3)
    pair = GearPair(gear, gear, 80e-3, axial_offset=8e-3)
    table = draft(pair)
    assert table.geometry.face_width == pytest.approx(12e-3)
    assert np.all((table.face_centroid > -2e-3) & (table.face_centroid < 10e-3))
    assert table.n_failed == 0
