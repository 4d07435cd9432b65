"""Misalignment is a tilt of the axes: its gap is that of rigid gears rotated in space."""

import math

import numpy as np
import pytest
from tilted_gears import TiltedGap, rigid_gap

from fe_contact.effects.misalignment import MisalignmentGap
from fe_contact.geometry import Gear, GearPair, InternalGearPair, RingGear

SHAPE = {"normal_module": 3e-3, "face_width": 24e-3}
GROWTH = 1e-6


def external(degrees: float) -> GearPair:
    pinion, wheel = (
        Gear(teeth=teeth, bore_diameter=25e-3, helix_angle=math.radians(angle), **SHAPE)
        for teeth, angle in ((19, degrees), (32, -degrees))
    )
    return GearPair(pinion, wheel)


def internal(degrees: float) -> InternalGearPair:
    angle = math.radians(degrees)
    pinion = Gear(teeth=19, bore_diameter=25e-3, helix_angle=angle, **SHAPE)
    ring = RingGear(teeth=61, rim_diameter=230e-3, addendum_coefficient=0.8, helix_angle=angle, **SHAPE)
    return InternalGearPair(pinion, ring)


PAIRS = {
    "right hand": external(25.0),
    "left hand": external(-25.0),
    "spur": external(0.0),
    "ring": internal(20.0),
    "ring of left-hand pinion": internal(-20.0),
}


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
def test_the_gap_is_that_of_rigid_gears_rotated_in_space(pair):
    """All over the flanks, along the line of action as well as over the face."""
    path, tilt = pair.path_of_contact, GROWTH / pair.face_width
    rolls = np.linspace(path.start, path.end, 5)[:, None]
    face = 0.5 * pair.face_width * np.array([-1.0, -0.3, 0.4, 1.0])
    ours = MisalignmentGap(GROWTH)(pair, rolls, pair.mating_roll_length(rolls), face)
    exact = TiltedGap(tilt)(pair, rolls, pair.mating_roll_length(rolls), face)
    np.testing.assert_allclose(ours, exact, atol=1e-4 * GROWTH)
    slope = np.ptp(ours, axis=0)
    assert slope == pytest.approx(tilt * abs(math.tan(pair.base_helix_angle)) * path.length, rel=1e-12)


@pytest.mark.parametrize("name", ["right hand", "left hand"])
def test_before_the_path_the_tip_edge_opens_as_its_place_along_the_line_of_action(name):
    """There the wheel's edge touches beside the line of action: to the first order of the way beyond it."""
    pair, face, beyond = PAIRS[name], 5e-3, 0.2e-3
    roll, face = np.array(pair.path_of_contact.start - beyond), np.array(face)
    tilt = GROWTH / pair.face_width
    assert rigid_gap(pair, roll, face, 0.0) > 1e-6  # the corner gap of aligned gears
    opened = TiltedGap(tilt)(pair, roll, roll, face)
    ours, held = (MisalignmentGap(GROWTH)(pair, at, at, face) for at in (roll, roll + beyond))
    assert abs(ours - opened) < 0.1 * abs(held - opened)


def test_the_largest_gap_is_at_a_corner_of_the_plane_of_action():
    for pair in PAIRS.values():
        path, tangent = pair.path_of_contact, abs(math.tan(pair.base_helix_angle))
        reach = max(path.pitch_point - path.start, path.end - path.pitch_point)
        expected = GROWTH * (0.5 + tangent * reach / pair.face_width)
        assert MisalignmentGap(-GROWTH).reach(pair) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", PAIRS)
def test_along_a_line_of_contact_the_arm_grows_with_the_face_over_the_squared_cosine(name):
    """And pairs one base pitch apart are offset by tan(beta_b) times it."""
    pair, face = PAIRS[name], np.array([-8e-3, 0.0, 5e-3])
    angle = pair.base_helix_angle
    arms = [
        pair.tilt_arm(pair.roll_lengths(0.3, index)[0] - face * math.tan(angle), face) for index in (0, 1)
    ]
    assert np.diff(arms[0]) == pytest.approx(np.diff(face) / math.cos(angle) ** 2, rel=1e-12)
    assert arms[1] - arms[0] == pytest.approx(-math.tan(angle) * pair.base_pitch, rel=1e-9, abs=1e-15)


def test_the_middle_of_the_common_face_stays():
    """A wheel beside its pinion: the axes tilt about the pitch point in the middle of what meshes."""
    gear = PAIRS["spur"].pinion
    pair = GearPair(gear, gear, axial_offset=6e-3)
    pitch, middle = np.array(pair.path_of_contact.pitch_point), np.array(pair.common_face_center)
    assert MisalignmentGap(GROWTH)(pair, pitch, pitch, middle) == 0.0
    end = MisalignmentGap(GROWTH)(pair, pitch, pitch, middle + 0.5 * pair.face_width)
    assert end == pytest.approx(0.5 * GROWTH, rel=1e-12)
