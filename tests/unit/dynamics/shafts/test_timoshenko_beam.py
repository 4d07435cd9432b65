"""Shafts as beams, and their reduction: closed forms, convergence, rigid limit, bad input."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from dynamics import Shaft, hollow_cylinder
from dynamics.errors import InputError
from dynamics.shafts import BeamSection, PointOfApplication, craig_bampton, elastic_shaft, timoshenko_beam

STUBBY = BeamSection(0.3, 0.06, 0.02)
STEPPED = (BeamSection(0.1, 0.04), BeamSection(0.15, 0.06, 0.02), BeamSection(0.08, 0.05))


def deflection(beam, held, force):
    """Displacement under `force` (6 N,) with the freedoms `held` fixed."""
    free = np.setdiff1d(np.arange(force.size), held)
    found = np.zeros(force.size)
    found[free] = np.linalg.solve(beam.stiffness[np.ix_(free, free)], force[free])
    return found


def frequencies(beam, held=()):
    free = np.setdiff1d(np.arange(beam.mass.shape[0]), held)
    square = eigh(beam.stiffness[np.ix_(free, free)], beam.mass[np.ix_(free, free)], eigvals_only=True)
    return np.sqrt(np.maximum(square, 0.0)) / (2.0 * math.pi)


@pytest.mark.parametrize("longest", [math.inf, 0.06, 0.011])
@pytest.mark.parametrize(("kind", "tilt", "sign"), [(0, 4, 1.0), (1, 3, -1.0)])
def test_a_cantilever_bends_and_shears_as_the_closed_form_says(longest, kind, tilt, sign):
    beam = timoshenko_beam([STUBBY], longest=longest)
    force = np.zeros(beam.mass.shape[0])
    force[force.size - 6 + kind] = 1000.0
    found = deflection(beam, np.arange(6), force)[-6:]
    bent, length = STUBBY.youngs_modulus * STUBBY.second_moment, STUBBY.length
    shear = STUBBY.shear_coefficient * STUBBY.shear_modulus * STUBBY.area
    expected = 1000.0 * (length**3 / (3.0 * bent) + length / shear)
    assert found[kind] == pytest.approx(expected, rel=1e-9, abs=0.0)
    assert found[tilt] == pytest.approx(sign * 1000.0 * length**2 / (2.0 * bent), rel=1e-9, abs=0.0)


def test_a_simply_supported_beam_sags_as_the_closed_form_says():
    beam = timoshenko_beam([STUBBY], stations=[0.1])
    force = np.zeros(beam.mass.shape[0])
    force[beam.freedoms(0.1)[0]] = 1000.0
    held = np.concatenate([beam.freedoms(0.0)[[0, 1, 2, 5]], beam.freedoms(0.3)[:2]])
    bent, a, b = STUBBY.youngs_modulus * STUBBY.second_moment, 0.1, 0.2
    shear = STUBBY.shear_coefficient * STUBBY.shear_modulus * STUBBY.area
    expected = 1000.0 * (a**2 * b**2 / (3.0 * bent * 0.3) + a * b / (0.3 * shear))
    assert deflection(beam, held, force)[beam.freedoms(0.1)[0]] == pytest.approx(expected, rel=1e-9, abs=0.0)


def test_a_stepped_shaft_twists_and_stretches_piece_by_piece():
    beam = timoshenko_beam(STEPPED)
    force = np.zeros(beam.mass.shape[0])
    force[-1], force[-4] = 200.0, 5e4
    found = deflection(beam, np.arange(6), force)
    twist = sum(200.0 * part.length / (part.shear_modulus * 2.0 * part.second_moment) for part in STEPPED)
    stretch = sum(5e4 * part.length / (part.youngs_modulus * part.area) for part in STEPPED)
    np.testing.assert_allclose(found[[-1, -4]], [twist, stretch], rtol=1e-10)


def test_as_a_rigid_body_it_is_the_hollow_cylinder():
    beam, body = timoshenko_beam([STUBBY], longest=0.05), hollow_cylinder(0.06, 0.3, 0.02)
    z = beam.position - 0.15
    rigid = np.zeros((beam.position.size, 6, 6))
    rigid[:] = np.eye(6)
    rigid[:, 0, 4], rigid[:, 1, 3] = z, -z
    rigid = rigid.reshape(-1, 6)
    assert np.max(np.abs(beam.stiffness @ rigid)) < 1e-10 * np.max(np.abs(beam.stiffness))
    expected = np.diag([body.mass] * 3 + [body.transverse] * 2 + [body.polar])
    np.testing.assert_allclose(rigid.T @ beam.mass @ rigid, expected, rtol=1e-11, atol=1e-13)


def supported(section):
    """Closed form, Hz: EI k^4 - (rho A + rho I k^2 (1 + E/(kappa G))) w^2 + rho^2 I/(kappa G) w^4 = 0."""
    e, density, area, second = section.youngs_modulus, section.density, section.area, section.second_moment
    reduced, found = section.shear_coefficient * section.shear_modulus, []
    for half_waves in (1, 2):
        k = half_waves * math.pi / section.length
        linear = density * area + density * second * k**2 * (1.0 + e / reduced)
        # the lower root without the difference of nearly equal numbers
        root = math.sqrt(linear**2 - 4.0 * density**2 * second / reduced * e * second * k**4)
        found.append(math.sqrt(2.0 * e * second * k**4 / (linear + root)) / (2.0 * math.pi))
    return np.array(found)


@pytest.mark.parametrize(
    ("section", "power", "level"), [(STUBBY, 2.0, 2e-3), (BeamSection(1.0, 1e-3), 4.0, 2e-5)]
)
def test_frequencies_of_a_supported_beam_converge(section, power, level):
    """Second order where shear matters, since it is constant in an element; fourth in a slender one."""
    exact, errors = supported(section), []
    for parts in (4, 8, 16):
        beam = timoshenko_beam([section], longest=section.length / parts)
        rest = [i for i in range(beam.mass.shape[0]) if i % 6 not in (0, 4)]
        held = np.union1d(rest, [0, beam.mass.shape[0] - 6])
        errors.append(frequencies(beam, held)[:2] / exact - 1.0)
    rate = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    np.testing.assert_allclose(rate, power, atol=0.15)
    assert np.all(np.array(errors) > 0.0)
    assert np.max(errors[2]) < level


def test_the_mass_is_the_integral_over_its_shape_functions():
    """Shapes from the static equations, integrated by Gauss's rule."""
    length = 0.11
    section = replace(STUBBY, length=length)
    beam = timoshenko_beam([section])
    shear = section.shear_coefficient * section.shear_modulus * section.area
    bent = section.youngs_modulus * section.second_moment

    # w = a + b s + c s^2 + d s^3, and -EI slope'' = kappa G A (w' - slope): slope = w' + 6 d EI/(kappa G A)
    def shapes(s):
        lag = 6.0 * bent / shear
        return np.array([[1.0, s, s**2, s**3], [0.0, 1.0, 2.0 * s, 3.0 * s**2 + lag]])

    constants = np.linalg.inv(np.concatenate([shapes(0.0), shapes(length)]))
    location, weight = np.polynomial.legendre.leggauss(5)
    per = np.diag([section.density * section.area, section.density * section.second_moment])
    mass = np.zeros((4, 4))
    for s, w in zip(0.5 * length * (1.0 + location), 0.5 * length * weight, strict=True):
        n = shapes(s) @ constants
        mass += w * n.T @ per @ n
    plane = [0, 4, 6, 10]
    np.testing.assert_allclose(beam.mass[np.ix_(plane, plane)], mass, rtol=1e-10)


def test_torsional_frequencies_of_a_free_shaft():
    beam = timoshenko_beam([STUBBY], longest=0.3 / 64)
    held = [i for i in range(beam.mass.shape[0]) if i % 6 != 5]
    found = frequencies(beam, held)
    expected = math.sqrt(STUBBY.shear_modulus / STUBBY.density) / (2.0 * STUBBY.length)
    assert found[0] < 1e-3 * expected
    assert found[1] == pytest.approx(expected, rel=2e-4)


def test_reduction_is_exact_at_rest_and_falls_to_the_frequencies():
    beam = timoshenko_beam(STEPPED, stations=[0.05, 0.2], longest=0.02)
    interface = np.concatenate([beam.freedoms(z) for z in (0.0, 0.05, 0.2, 0.33)])
    ends = np.concatenate([beam.freedoms(0.0), beam.freedoms(0.33)])
    force = np.zeros(beam.mass.shape[0])
    force[beam.freedoms(0.2)] = [1000.0, -300.0, 50.0, 2.0, -3.0, 10.0]
    exact, full = deflection(beam, ends, force), frequencies(beam, ends)
    errors = []
    for highest in (1.0, 1.5e4, 4e4, math.inf):
        body = craig_bampton(beam.mass, beam.stiffness, interface, highest)
        free = np.setdiff1d(np.arange(body.mass.shape[0]), [*range(6), *range(18, 24)])
        k, m = (a[np.ix_(free, free)] for a in (body.stiffness, body.mass))
        moved = body.motion[:, free] @ np.linalg.solve(k, body.motion[:, free].T @ force)
        np.testing.assert_allclose(moved[interface], exact[interface], rtol=1e-7, atol=1e-15)
        found = np.sqrt(eigh(k, m, eigvals_only=True)) / (2.0 * math.pi)
        errors.append(found[:4] / full[:4] - 1.0)
        assert np.all(body.frequency <= highest)
    worst = np.max(np.abs(errors), axis=1)
    assert worst[0] > 1e-4
    assert worst[1] < worst[0]
    assert worst[2] < 0.1 * worst[0]
    assert worst[3] < 1e-8
    assert np.all(np.array(errors) > -1e-8)  # from above


def test_a_stiff_shaft_on_springs_is_the_rigid_one():
    stiff = replace(STUBBY, youngs_modulus=206e9 * 1e4)
    beam, body, spring = timoshenko_beam([stiff], longest=0.1), hollow_cylinder(0.06, 0.3, 0.02), 1e7
    reduced = craig_bampton(
        beam.mass, beam.stiffness, np.concatenate([beam.freedoms(z) for z in (0.0, 0.3)]), 1.0
    )
    stiffness = reduced.stiffness.copy()
    for location in (0, 1, 6, 7):
        stiffness[location, location] += spring
    plane = [0, 4, 6, 10]
    square = eigh(stiffness[np.ix_(plane, plane)], reduced.mass[np.ix_(plane, plane)], eigvals_only=True)[:2]
    expected = np.sort([2.0 * spring / body.mass, 2.0 * spring * 0.15**2 / body.transverse])
    np.testing.assert_allclose(square, expected, rtol=1e-5)


def test_a_bearing_at_the_end_of_added_lengths_is_at_the_end():
    """Nine pieces of 0.6 m add to 5.3999999999999995 m; a micrometer further is off the beam."""
    pieces = [BeamSection(0.6, 0.4 + 0.01 * k) for k in range(9)]
    assert sum(piece.length for piece in pieces) < 5.4
    beam = timoshenko_beam(pieces, stations=[0.0, 5.4])
    assert beam.position.size == 10
    assert beam.freedoms(5.4).tolist() == list(range(54, 60))
    shaft = Shaft("shaft", 5.4, sections=tuple(pieces))
    ends = tuple(PointOfApplication(location, True, True, True, True) for location in (0.0, 5.4))
    elastic = elastic_shaft(shaft.sections, (), ends, 100.0, 0.0)
    np.testing.assert_array_equal(elastic.motion(5.4), elastic.motion(float(elastic.position[-1])))
    with pytest.raises(InputError, match=r"on the beam, from 0 m to 5\.4 m"):
        timoshenko_beam(pieces, stations=[5.400001])


def test_what_is_no_beam_is_named():
    cases = {
        "bore_diameter": lambda: BeamSection(0.1, 0.04, 0.04),
        "sections": lambda: timoshenko_beam([]),
        "stations[0]": lambda: timoshenko_beam([STUBBY], stations=[0.4]),
        "longest": lambda: timoshenko_beam([STUBBY], longest=0.0),
        "position": lambda: timoshenko_beam([STUBBY]).freedoms(0.1),
        "interface": lambda: craig_bampton(*pair(), np.array([0, 1]), 1e4),
        "highest": lambda: craig_bampton(*pair(), np.arange(6), 0.0),
    }
    for field, make in cases.items():
        with pytest.raises(InputError) as caught:
            make()
        assert caught.value.field == field


def pair():
    beam = timoshenko_beam([STUBBY])
    return beam.mass, beam.stiffness
