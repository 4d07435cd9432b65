"""Bearings by geometry: closed forms, published displacements and lives, laws of an elastic contact."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from dynamics.bearings import BallBearing, EllipticContact, RollerBearing
from dynamics.bearings.ball_elements import BallElements, RowPlacement
from dynamics.bearings.loaded_bearing import LoadedBearing
from dynamics.bearings.rating_life import rating_life
from dynamics.errors import SolveError

STEEL = 206e9 / (2.0 * (1.0 - 0.3**2))
MANY = 400  # copies of an element: the sum over them is the integral
DEEP_GROOVE = BallBearing(count=7, diameter=11.5e-3, pitch_diameter=43.5e-3)
ANGULAR = BallBearing(count=8, diameter=11.5e-3, pitch_diameter=43.5e-3, contact_angle=0.6, clearance=-2e-5)
CYLINDRICAL = RollerBearing(count=14, diameter=9e-3, length=13.6e-3, pitch_diameter=53.5e-3, clearance=1e-5)
TAPERED = RollerBearing(
    count=17, diameter=9e-3, length=13.6e-3, pitch_diameter=65e-3, contact_angle=-0.25, clearance=-1e-5
)
KINDS = {"deep groove": DEEP_GROOVE, "angular": ANGULAR, "cylindrical": CYLINDRICAL, "tapered": TAPERED}
PLACE = {
    "deep groove": (2e-5, 1e-5, 1.2e-4, 4e-4, -3e-4),
    "angular": (2e-5, -5e-6, 1e-5, 2e-4, -6e-4),
    "cylindrical": (2e-5, 1e-5, 0.0, 1e-4, -2e-4),
    "tapered": (5e-6, 1e-5, -3e-5, 2e-4, -1e-4),
}
STRAIGHT = {"angular": {}, "tapered": {"profile": "straight"}}
ANGLE = 0.3


@pytest.mark.parametrize(
    ("radii", "load", "approach", "axes", "pressure"),
    [
        ((10e-3, 10e-3), 1000.0, 16.3748358e-6, (0.404658323e-3, 0.404658323e-3), 2915.84499e6),
        ((10e-3, 1.0), 1000.0, 5.97398624e-6, (3.02891822e-3, 0.166542094e-3), 946.520050e6),
        ((4.0, 8e-3), 2000.0, 6.68838488e-6, (6.57674592e-3, 0.143202600e-3), 1013.93338e6),
    ],
)
def test_elliptic_contact_is_that_of_exact_integrals(radii, load, approach, axes, pressure):
    # elliptic integrals of both kinds, evaluated independently to the digits shown; E 206 GPa, nu 0.3
    contact = EllipticContact(*radii, STEEL)
    assert contact.approach(load) == pytest.approx(approach, rel=2e-8)
    assert contact.axes(load) == pytest.approx(axes, rel=2e-8)
    assert contact.peak_pressure(load) == pytest.approx(pressure, rel=2e-8)
    assert contact.spring_constant * approach**1.5 == pytest.approx(load, rel=2e-8)


def test_nearly_round_contacts_join_the_round_one():
    round_one = EllipticContact(1e-2, 1e-2, STEEL).approach(100.0)
    for distance in (1e-3, 1e-6, 1e-9, 1e-12):
        near = EllipticContact(1e-2, 1e-2 * (1.0 + distance), STEEL).approach(100.0)
        assert near == pytest.approx(round_one * (1.0 - distance / 6.0), rel=distance**2 + 1e-11)


def test_a_single_ball_is_both_contacts_in_series():
    bearing = replace(DEEP_GROOVE, count=3, clearance=1e-5)
    load = 800.0
    approach = sum(contact.approach(load) for contact in bearing.contacts())
    d = (approach + 0.5e-5, 0.0, 0.0, 0.0, 0.0)
    assert LoadedBearing(bearing).evaluate(d).force == pytest.approx([load, 0, 0, 0, 0], rel=1e-10, abs=1e-9)


@pytest.mark.parametrize("clearance", [0.0, 1e-5])
def test_thrust_on_all_balls_turns_the_contact_angle(clearance):
    bearing = replace(DEEP_GROOVE, clearance=clearance)
    free, angle, reach = bearing.free_contact_angle, 0.3, bearing.groove_distance
    z = reach * math.cos(free) * math.tan(angle)
    load = bearing.element_stiffness * (reach * (math.cos(free) / math.cos(angle) - 1.0)) ** 1.5
    force = LoadedBearing(bearing).evaluate((0.0, 0.0, z, 0.0, 0.0)).force
    assert force[2] == pytest.approx(7 * load * math.sin(angle), rel=1e-10)
    assert force[[0, 1, 3, 4]] == pytest.approx(np.zeros(4), abs=1e-9)


@pytest.mark.parametrize("extent", [0.2, 0.5, 0.8])
@pytest.mark.parametrize("kind", ["deep groove", "cylindrical", "tapered"])
def test_radial_load_is_that_of_sjoevall_integrals(kind, extent):
    # T. A. Harris, Rolling Bearing Analysis: J_r(eps), the share of the circle that is loaded
    bearing = KINDS[kind]
    exponent = 1.5 if kind == "deep groove" else 10.0 / 9.0
    if kind != "deep groove":
        bearing = replace(bearing, profile="straight")
    cosine, sine = math.cos(bearing.contact_angle), math.sin(bearing.contact_angle)
    press = 2e-5  # of the most loaded element
    x = press / (2.0 * extent) / cosine
    z = 0.0
    if kind == "tapered":
        z = (press - x * cosine + bearing.play) / sine
    else:
        bearing = replace(bearing, clearance=2.0 * (x - press))
    end = math.acos(1.0 - 2.0 * extent)

    def loads(angle):
        return max(0.0, 1.0 - (1.0 - math.cos(angle)) / (2.0 * extent)) ** exponent

    radial = quad(lambda psi: loads(psi) * math.cos(psi), 0.0, end, epsabs=1e-12)[0] / math.pi
    axial = quad(loads, 0.0, end, epsabs=1e-12)[0] / math.pi
    stiffness = (
        bearing.element_stiffness if kind == "deep groove" else 35948e6 * bearing.length ** (8.0 / 9.0)
    )
    maximum = bearing.count * stiffness * press**exponent
    force = LoadedBearing(bearing, copies=MANY).evaluate((x, 0.0, z, 0.0, 0.0), ANGLE).force
    assert force[0] == pytest.approx(maximum * radial * cosine, rel=1e-6)
    assert force[2] == pytest.approx(maximum * axial * sine, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("clearance", "load", "displacement", "life"),
    [
        (0.0, (1000.0, 0.0), 15.1101e-6, 13163.019),
        (0.0, (0.0, 1000.0), 133.5381e-6, 2222.7318),
        (1e-5, (1000.0, 0.0), 21.223e-6, 10795.7948),
        (1e-5, (0.0, 1000.0), 149.1717e-6, 3115.8781),
    ],
)
def test_published_displacements_and_lives(clearance, load, displacement, life):
    # github.com/minzhun/ISO16281, Test_BallBearing.py: MASTA by ISO/TS 16281;
    # E 210 GPa, grooves 0.52 and 0.53, C 23.4 kN; displacement from the middle of the clearance
    bearing = replace(DEEP_GROOVE, clearance=clearance)
    loaded = LoadedBearing(bearing)
    d = loaded.displacement((load[0], 0.0, load[1], 0.0, 0.0))
    assert max(d[0], d[2]) == pytest.approx(displacement, rel=2e-5)
    lives = rating_life(bearing, loaded.evaluate(d).load, 23400.0)
    assert lives.revolutions == pytest.approx(1e6 * life, rel=1e-4)


def test_published_displacement_under_combined_load():
    # as above; the tilt there is 1 % larger: moments about the pitch circle, not the groove's center
    d = LoadedBearing(replace(DEEP_GROOVE, clearance=1e-5)).displacement((1000.0, 0.0, 1000.0, 0.0, 0.0))
    assert d[[0, 2]] == pytest.approx([19.5923e-6, 146.4603e-6], rel=1e-4)
    assert abs(d[4]) == pytest.approx(2.6872e-3, rel=1.2e-2)


@pytest.mark.parametrize("kind", KINDS)
def test_force_and_tangent_are_derivatives_of_the_energy(kind):
    loaded, d = LoadedBearing(KINDS[kind]), np.array(PLACE[kind])
    # lengths, so that rows compare; 2.2e-7 of a lever: no contact starts or ends within a step
    lever = KINDS[kind].pitch_diameter / 2.0
    unit = np.diag([1.0, 1.0, 1.0, 1.0 / lever, 1.0 / lever])
    at = loaded.evaluate(d, ANGLE)
    assert at.load.max() > 100.0
    h = 2e-9
    ahead = [loaded.evaluate(d + h * row, ANGLE) for row in unit]
    back = [loaded.evaluate(d - h * row, ANGLE) for row in unit]
    slopes = np.array([(a.force - b.force) for a, b in zip(ahead, back, strict=True)]) / (2.0 * h)
    gained = np.array([(a.energy - b.energy) for a, b in zip(ahead, back, strict=True)]) / (2.0 * h)
    tangent = unit @ at.tangent @ unit
    assert slopes @ unit == pytest.approx(tangent, abs=1e-6 * np.abs(tangent).max())
    assert gained == pytest.approx(unit @ at.force, abs=1e-6 * np.abs(unit @ at.force).max())
    assert at.tangent == pytest.approx(at.tangent.T, rel=1e-12, abs=1e-6)
    turned = [loaded.evaluate(d, ANGLE + s).energy for s in (-1e-6, 1e-6)]
    assert at.slope == pytest.approx((turned[1] - turned[0]) / 2e-6, rel=1e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_a_turned_bearing_answers_with_a_turned_force(kind):
    by = 0.83
    c, s = math.cos(by), math.sin(by)
    turn = np.zeros((5, 5))
    turn[:2, :2] = turn[3:, 3:] = [[c, -s], [s, c]]
    turn[2, 2] = 1.0
    loaded, d = LoadedBearing(KINDS[kind]), np.array(PLACE[kind])
    straight, turned = loaded.evaluate(d, ANGLE), loaded.evaluate(turn @ d, ANGLE + by)
    assert turned.force == pytest.approx(turn @ straight.force, rel=1e-11, abs=1e-8)
    again = loaded.evaluate(d, ANGLE + 2.0 * math.pi / KINDS[kind].count)
    assert again.force == pytest.approx(straight.force, rel=1e-11, abs=1e-8)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("clearance", [-3e-5, 0.0, 3e-5])
@pytest.mark.parametrize("kind", ["angular", "tapered"])
def test_axial_clearance_is_the_way_to_contact(kind, clearance, sign):
    angle = sign * abs(KINDS[kind].contact_angle)
    bearing = LoadedBearing(replace(KINDS[kind], contact_angle=angle, clearance=clearance, **STRAIGHT[kind]))
    short, beyond = (
        bearing.evaluate((0, 0, sign * (clearance + way), 0, 0)).force[2] for way in (-1e-9, 1e-9)
    )
    assert short == 0.0
    assert sign * beyond > 0.0


@pytest.mark.parametrize("kind", ["angular", "tapered"])
def test_the_mirrored_bearing_answers_with_the_mirrored_force(kind):
    bearing, d = KINDS[kind], np.array(PLACE[kind])
    mirror = np.array([1.0, 1.0, -1.0, -1.0, -1.0])
    mirrored = replace(bearing, contact_angle=-bearing.contact_angle)
    force = LoadedBearing(bearing).evaluate(d, ANGLE).force
    assert LoadedBearing(mirrored).evaluate(mirror * d, ANGLE).force == pytest.approx(
        mirror * force, rel=1e-11
    )


def test_force_and_moment_are_those_of_the_balls_on_the_ring():
    loaded, d = LoadedBearing(ANGULAR), np.array(PLACE["angular"])
    at, laws = loaded.evaluate(d, ANGLE), BallElements.packed([(ANGULAR, RowPlacement())])
    arm_radius, arm_axial, radial, axial = (
        float(laws[index][0])
        for index in map(laws._fields.index, ("arm_radius", "arm_axial", "radial", "axial"))
    )
    force, moment = np.zeros(3), np.zeros(3)
    for ball in range(8):
        angle = ANGLE + ball * math.pi / 4.0
        out, up = np.array([math.cos(angle), math.sin(angle), 0.0]), np.array([0.0, 0.0, 1.0])
        arm = arm_radius * out + arm_axial * up
        center = d[:3] + np.cross([d[3], d[4], 0.0], arm)
        line = (radial + center @ out) * out + (axial + center @ up) * up
        pushed = at.load[ball, 0] * line / np.linalg.norm(line)
        force += pushed
        moment += np.cross(arm, pushed)
    assert at.force == pytest.approx([*force, *moment[:2]], rel=1e-11)


def test_averaged_elements_do_not_feel_the_cage():
    d = (1.6e-5, 0.0, 0.0, 0.0, 0.0)
    angles = np.linspace(0.0, 2.0 * math.pi / 7, 15)
    forces = {
        copies: [LoadedBearing(DEEP_GROOVE, copies).evaluate(d, angle).force[0] for angle in angles]
        for copies in (1, 16)
    }
    assert np.ptp(forces[1]) > 1e-2 * np.mean(forces[1])
    assert np.ptp(forces[16]) < 1e-4 * np.mean(forces[16])
    assert np.mean(forces[1][:-1]) == pytest.approx(forces[16][0], rel=1e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_the_displacement_carries_the_load(kind):
    loaded = LoadedBearing(KINDS[kind])
    load = loaded.evaluate(PLACE[kind], ANGLE).force
    d = loaded.displacement(load, ANGLE)
    assert loaded.evaluate(d, ANGLE).force == pytest.approx(load, rel=1e-9, abs=1e-8)


def test_a_roller_without_laminae_effects_is_one_spring():
    # all laminae alike: ISO/TS 16281's line contact, whatever their number
    loads = [
        LoadedBearing(replace(CYLINDRICAL, profile="straight", laminae=laminae)).evaluate(
            (*PLACE["cylindrical"][:3], 0.0, 0.0)
        )
        for laminae in (1, 7, 30)
    ]
    assert loads[1].force == pytest.approx(loads[0].force, rel=1e-11)
    assert loads[2].force == pytest.approx(loads[0].force, rel=1e-11)


def test_the_reference_load_of_an_aligned_bearing_is_its_load():
    # ISO 281 rates a bearing without clearance; the figures of both standards differ by some per cent
    for bearing in (DEEP_GROOVE, replace(CYLINDRICAL, clearance=0.0, profile="straight")):
        loaded = LoadedBearing(bearing, copies=MANY)
        life = rating_life(
            bearing, loaded.evaluate(loaded.displacement((2000.0, 0.0, 0.0, 0.0, 0.0))).load, 30000.0
        )
        assert life.equivalent_load == pytest.approx(2000.0, rel=0.15)
        twice = loaded.evaluate(loaded.displacement((4000.0, 0.0, 0.0, 0.0, 0.0))).load
        exponent = 3.0 if bearing is DEEP_GROOVE else 10.0 / 3.0
        assert rating_life(bearing, twice, 30000.0).revolutions == pytest.approx(
            life.revolutions / 2.0**exponent, rel=1e-6
        )


def test_half_of_a_row_carries_at_the_thrust_it_induces():
    # straight tapered rollers without clearance, tilt held: epsilon = 0.5 at F_a = 1.26 F_r tan(alpha)
    # (J_r = 0.2453, J_a = 0.3090 of line contact; ISO 281 takes 1.25)
    row = RollerBearing(
        count=17,
        diameter=9e-3,
        length=13.6e-3,
        pitch_diameter=65e-3,
        contact_angle=0.25,
        profile="straight",
    )
    loaded = LoadedBearing(row, MANY)
    d = loaded.displacement([5000.0, 0.0, 1.2596 * 5000.0 * math.tan(0.25), 0.0, 0.0], fixed=(3, 4))
    carried = loaded.evaluate(d).load.sum(axis=-1) > 0.0
    assert carried.mean() == pytest.approx(0.5, abs=0.005)
    assert list(d[3:]) == [0.0, 0.0]


def test_a_row_that_slips_off_says_so():
    # below 0.75 of that thrust, or against the contact angle, nothing holds a ring that may tilt
    row = RollerBearing(count=18, diameter=14e-3, length=16.5e-3, pitch_diameter=86e-3, contact_angle=0.26)
    for thrust in (285.0, 2850.0, -2850.0):
        with pytest.raises(SolveError, match="does not carry the load"):
            LoadedBearing(row, 8).displacement([11400.0, 0.0, thrust, 0.0, 0.0])
