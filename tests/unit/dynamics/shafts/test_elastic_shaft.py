"""Elastic shafts: stiffness, inertia, conical sections."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.special import iv, jv, kv, yv

from dynamics import Inertia, Shaft, hollow_cylinder
from dynamics.errors import InputError
from dynamics.shafts import BeamSection, Disc, PointOfApplication, elastic_shaft, timoshenko_beam

# Elastic coordinates of a shaft: closed forms, orthogonality to rigid motion, and the stated errors.


SHAFT = (BeamSection(0.3, 0.04),)
STEPPED = (BeamSection(0.1, 0.03), BeamSection(0.12, 0.05, 0.02), BeamSection(0.08, 0.025))
ENDS = (PointOfApplication(0.0, True, True, True, True), PointOfApplication(0.3, True, True, True, True))
DISC = Disc(0.13, Inertia(2.0, 4e-3, 2.5e-3))


@pytest.mark.parametrize("family", ["torsion", "extension"])
def test_a_free_rod_twists_and_stretches_at_the_frequencies_of_the_closed_form(family):
    """n c/(2 L) with the speed of sound of the family."""
    elastic = elastic_shaft(SHAFT, (), ENDS, 30e3, 0.0)
    section = SHAFT[0]
    modulus = section.shear_modulus if family == "torsion" else section.youngs_modulus
    speed = math.sqrt(modulus / section.density)
    found = getattr(elastic, family).frequency
    count = int(30e3 // (speed / 0.6))
    assert count >= 3
    expected = np.arange(1, count + 1) * speed / 0.6
    assert np.all(np.abs(found[:count] / expected - 1.0) < elastic.mesh_error + elastic.truncation)


def test_a_free_beam_bends_at_the_frequency_of_the_closed_form():
    """22.3733 sqrt(E I/(rho A))/L^2 of a slender one (Euler and Bernoulli)."""
    slender = BeamSection(1.0, 0.01)
    ends = (PointOfApplication(0.0, True, True), PointOfApplication(1.0, True, True))
    elastic = elastic_shaft((slender,), (), ends, 2e3, 0.0)
    speed = math.sqrt(slender.youngs_modulus * slender.second_moment / (slender.density * slender.area))
    assert 2.0 * math.pi * elastic.bending.frequency[0] == pytest.approx(22.37329 * speed, rel=1e-3)


@pytest.mark.parametrize("held", [None, 0.0, 0.3])
def test_elastic_motion_has_no_momentum_but_that_of_a_held_rotation(held):
    elastic = elastic_shaft(
        STEPPED, (DISC,), (*ENDS, PointOfApplication(0.13, True, True, True, True)), 10e3, 0.0, held
    )
    count = elastic.position.size
    assert np.all(elastic.mass > 0.0)
    turn = elastic.torsion.shape.T @ elastic.polar @ np.ones(count)
    scale = np.sum(elastic.polar)
    if held is None:
        assert np.max(np.abs(turn)) < 1e-12 * scale
        assert not np.any(elastic.turned)
    else:
        np.testing.assert_allclose(elastic.turned[elastic.twists], turn, rtol=1e-9, atol=1e-12 * scale)
        np.testing.assert_allclose(elastic.motion(held)[5], 0.0, atol=1e-12)
    total = sum(hollow_cylinder(s.outer_diameter, s.length, s.bore_diameter).polar for s in STEPPED)
    assert scale == pytest.approx(total + DISC.inertia.polar, rel=1e-12)


def test_coordinates_share_no_energy():
    """Modal masses and stiffnesses are all there is: shapes diagonalize the beam's matrices."""
    elastic = elastic_shaft(
        STEPPED, (DISC,), (*ENDS, PointOfApplication(0.13, True, True, True, True)), 10e3, 0.0
    )
    shape, polar = elastic.torsion.shape, elastic.polar
    mass = shape.T @ polar @ shape
    rounding = np.finfo(float).eps * np.linalg.cond(polar)  # of a Cholesky factor, relative
    np.testing.assert_allclose(mass, np.diag(elastic.torsion.mass), atol=rounding * np.max(mass))


@pytest.mark.parametrize("highest", [1e3, 20e3])
def test_static_twist_does_not_depend_on_the_modes_kept(highest):
    """Equal and opposite torques at both ends: T L/(G J) piece by piece."""
    elastic = elastic_shaft(STEPPED, (DISC,), ENDS, highest, 0.0)
    arm = elastic.motion(0.3)[5] - elastic.motion(0.0)[5]
    piece = [s.length / (s.shear_modulus * 2.0 * s.second_moment) for s in STEPPED]
    assert float(arm**2 @ (1.0 / elastic.stiffness)) == pytest.approx(sum(piece), rel=1e-9, abs=0.0)


@pytest.mark.law
def test_the_stated_error_of_the_elements_is_that_of_the_frequencies():
    """Against the closed form of a free rod, whose modes with free ends all lie below the limit."""
    elastic = elastic_shaft(SHAFT, (), ENDS, 60e3, 0.0)
    speed = math.sqrt(SHAFT[0].shear_modulus / SHAFT[0].density)
    count = int(60e3 // (speed / 0.6))
    exact = np.arange(1, count + 1) * speed / 0.6
    worst = np.max(np.abs(elastic.torsion.frequency[:count] / exact - 1.0))
    assert 0.0 < elastic.mesh_error <= 1e-3
    assert worst < elastic.mesh_error + elastic.truncation


def test_a_higher_frequency_of_interest_keeps_more_modes_and_takes_shorter_elements():
    coarse, fine = (elastic_shaft(STEPPED, (DISC,), ENDS, f, 0.0) for f in (2e3, 30e3))
    assert fine.bending.fixed > coarse.bending.fixed
    assert fine.position.size > coarse.position.size
    assert max(coarse.truncation, fine.truncation) <= 0.01


def test_damping_is_the_ratio_of_every_coordinate():
    elastic = elastic_shaft(STEPPED, (DISC,), ENDS, 5e3, 0.02)
    np.testing.assert_allclose(elastic.damping / (2.0 * np.sqrt(elastic.mass * elastic.stiffness)), 0.02)


def test_both_planes_bend_alike():
    """u_x' = tilt_y and u_y' = -tilt_x at every node."""
    elastic = elastic_shaft(STEPPED, (DISC,), ENDS, 5e3, 0.0)
    b = elastic.bending.mass.size
    rows = elastic.motion(0.3)
    np.testing.assert_array_equal(rows[0, :b], rows[1, b : 2 * b])
    np.testing.assert_array_equal(rows[4, :b], -rows[3, b : 2 * b])
    assert np.any(rows[0, :b] != 0.0)


# Inertia of cylinders against the closed forms, by subtraction and by slicing.


def test_a_solid_steel_cylinder():
    part = hollow_cylinder(0.1, 0.2, density=7850.0)
    mass = 7850.0 * math.pi * 0.05**2 * 0.2
    assert part.mass == pytest.approx(mass)
    assert part.polar == pytest.approx(0.5 * mass * 0.05**2)
    assert part.transverse == pytest.approx(mass * (0.05**2 / 4 + 0.2**2 / 12))


def test_a_bore_takes_away_its_own_cylinder():
    hollow, solid, core = (hollow_cylinder(*a) for a in ((0.1, 0.03, 0.04), (0.1, 0.03), (0.04, 0.03)))
    for name in ("mass", "polar", "transverse"):
        assert getattr(hollow, name) == pytest.approx(getattr(solid, name) - getattr(core, name))


@pytest.mark.parametrize(
    "sizes", [(0.0, 0.1, 0.0), (0.1, -0.1, 0.0), (0.1, 0.1, 0.1), (0.1, 0.1, -0.01), (math.nan, 0.1, 0.0)]
)
def test_impossible_sizes_are_refused(sizes):
    with pytest.raises(InputError):
        hollow_cylinder(*sizes)


# Conical sections of shafts: closed forms of a cantilever cone, its body, its frequency, bad input.


LENGTH, DIAMETER = 0.3, 0.05
KINDS = ((jv, -1.0, 1.0), (yv, -1.0, 1.0), (iv, 1.0, 1.0), (kv, -1.0, -1.0))
RATIOS = [0.05, 0.5, 0.9, 2.0, 20.0]


def cone(ratio: float, **other: float) -> BeamSection:
    """Return a solid cone, at its right end `ratio` times as thick."""
    return BeamSection(LENGTH, DIAMETER, end_outer_diameter=ratio * DIAMETER, **other)


def tip_motion(section: BeamSection, freedom: int, load: float) -> np.ndarray:
    """Return the motion of the right end under a load there, clamped at the left end."""
    stiffness = timoshenko_beam([section]).stiffness[6:, 6:]
    force = np.zeros(stiffness.shape[0])
    force[freedom - 6] = load
    return np.linalg.solve(stiffness, force)[-6:]


@pytest.mark.parametrize("r", RATIOS)
def test_a_cantilever_cone_moves_as_the_closed_form_says(r):
    """Integrals of (1 - x)^2, 1 - x and 1 over (1 + (r - 1) x)^4, and of 1 over its square."""
    section = cone(r)
    bent = section.youngs_modulus * math.pi / 64.0 * DIAMETER**4
    area = math.pi / 4.0 * DIAMETER**2
    shear = section.shear_coefficient * section.shear_modulus * area
    moved = tip_motion(section, 0, 1e3)
    assert moved[0] == pytest.approx(1e3 * (LENGTH**3 / (3.0 * bent) + LENGTH / shear) / r, rel=1e-9)
    assert moved[4] == pytest.approx(1e3 * LENGTH**2 / bent * (2.0 * r + 1.0) / (6.0 * r**2), rel=1e-9)
    twisted = LENGTH / (section.shear_modulus * math.pi / 32.0 * DIAMETER**4)
    assert tip_motion(section, 5, 7.0)[5] == pytest.approx(
        7.0 * twisted * (r * r + r + 1) / (3 * r**3), rel=1e-9
    )
    stretched = LENGTH / (section.youngs_modulus * area * r)
    assert tip_motion(section, 2, 5e4)[2] == pytest.approx(5e4 * stretched, rel=1e-9)


@pytest.mark.parametrize("bores", [(0.0, None), (0.01, 0.03), (0.03, 0.01)])
def test_as_a_rigid_body_it_is_a_frustum_less_its_bore(bores):
    section = replace(cone(1.6), bore_diameter=bores[0], end_bore_diameter=bores[1])
    outer = frustum(DIAMETER, 1.6 * DIAMETER)
    bore = frustum(bores[0], bores[0] if bores[1] is None else bores[1])
    mass, moment, second, polar = (section.density * (a - b) for a, b in zip(outer, bore, strict=True))
    body, center = section.body
    assert body.mass == pytest.approx(mass, rel=1e-12)
    assert center == pytest.approx(moment / mass, rel=1e-12)
    assert body.polar == pytest.approx(polar, rel=1e-12)
    assert body.transverse == pytest.approx(second + 0.5 * polar - moment**2 / mass, rel=1e-11)
    beam = timoshenko_beam([section], longest=0.05)
    z = beam.position - center
    rigid = np.tile(np.eye(6), (z.size, 1, 1))
    rigid[:, 0, 4], rigid[:, 1, 3] = z, -z
    rigid = rigid.reshape(-1, 6)
    assert np.max(np.abs(beam.stiffness @ rigid)) < 1e-10 * np.max(np.abs(beam.stiffness))
    expected = np.diag([body.mass] * 3 + [body.transverse] * 2 + [body.polar])
    np.testing.assert_allclose(rigid.T @ beam.mass @ rigid, expected, rtol=1e-11, atol=1e-12)


def frustum(left: float, right: float) -> tuple[float, float, float, float]:
    """Volume, its first and second moment along the axis from the left end, and its polar moment."""
    a, b, length = left / 2.0, right / 2.0, LENGTH
    return (
        math.pi * length / 3.0 * (a * a + a * b + b * b),
        math.pi * length**2 / 12.0 * (a * a + 2.0 * a * b + 3.0 * b * b),
        math.pi * length**3 / 30.0 * (a * a + 3.0 * a * b + 6.0 * b * b),
        math.pi * length / 10.0 * (a**4 + a**3 * b + a * a * b * b + a * b**3 + b**4),
    )


def clamped_frequency(r: float) -> float:
    """First root of Kirchhoff's equation (1880) in sqrt(E I/(rho A))/L^2, I and A of the clamped base.

    With x from the apex, 1 at the base, (x^4 y'')'' = p^2 x^2 y has the solutions x^-1 Z_2(2 sqrt(p x)),
    Z the Bessel functions J, Y, I, K; y = y' = 0 at x = 1, y'' = (x^4 y'')' = 0 at x = r.
    """

    def determinant(p):
        base, tip = 2.0 * math.sqrt(p), 2.0 * math.sqrt(p * r)
        rows = [[f(2, base), s * f(3, base), f(4, tip), t * f(3, tip)] for f, s, t in KINDS]
        return float(np.linalg.det(rows))

    grid = np.linspace(2.0, 40.0, 400)
    values = [determinant(p) for p in grid]
    first = next(k for k in range(399) if values[k] * values[k + 1] < 0.0)
    return float(brentq(determinant, grid[first], grid[first + 1])) * (1.0 - r) ** 2


@pytest.mark.parametrize("r", [0.1, 0.5])
def test_a_slender_cone_clamped_at_its_base_vibrates_at_the_closed_form(r):
    section = BeamSection(1.0, 0.005, end_outer_diameter=r * 0.005)
    beam = timoshenko_beam([section], longest=0.02)
    plane = [i for i in range(6, beam.mass.shape[0]) if i % 6 in (0, 4)]
    own = np.ix_(plane, plane)
    square = eigh(beam.stiffness[own], beam.mass[own], eigvals_only=True)[0]
    unit = math.sqrt(section.youngs_modulus * section.second_moment / (section.density * section.area))
    assert math.sqrt(square) / unit == pytest.approx(clamped_frequency(r), rel=2e-5)


def test_many_steps_come_to_the_cone():
    """The frequencies of a shaft of n cylinders approach those of the cone with 1/n^2."""
    ends = (
        PointOfApplication(0.0, True, True, True, True),
        PointOfApplication(LENGTH, True, True, True, True),
    )

    def first(sections):
        return float(elastic_shaft(sections, (), ends, 4e3, 0.0).bending.frequency[0])

    def stepped(count):
        middles = (np.arange(count) + 0.5) / count
        return tuple(BeamSection(LENGTH / count, DIAMETER * (1.0 - 0.4 * x)) for x in middles)

    exact = first((cone(0.6),))
    coarse, fine = (abs(first(stepped(count)) / exact - 1.0) for count in (8, 16))
    assert coarse < 5e-3
    assert fine < 0.35 * coarse + 1e-4


def test_a_shaft_of_two_cones_weighs_what_they_do_and_lies_on_their_centroid():
    shaft = Shaft("shaft", 0.6, sections=(cone(2.0), replace(cone(1.0), outer_diameter=2.0 * DIAMETER)))
    (first, z), (second, there) = shaft.bodies
    assert second.mass == pytest.approx(first.mass, rel=1e-12)
    assert z + there == pytest.approx(0.6, rel=1e-12)


@pytest.mark.parametrize(
    ("field", "sizes"),
    [
        ("end_bore_diameter", {"end_bore_diameter": 0.05}),
        ("end_bore_diameter", {"bore_diameter": 0.03, "end_outer_diameter": 0.02}),
    ],
)
def test_what_is_no_cone_is_named(field, sizes):
    with pytest.raises(InputError) as caught:
        BeamSection(LENGTH, **{"outer_diameter": DIAMETER, **sizes})
    assert caught.value.field == field
