"""The edge law against numerical solutions of the half-plane contact.

Two routes, neither of which uses the inversion formula that `fe_contact.hertz` comes from:

- the logarithmic equation expanded in Chebyshev polynomials, where the end of the strip is found from the
  vanishing of its singularity;
- boundary elements with the conditions of contact only (no tension, no penetration), where no end behavior
  and no contact length is assumed.

A pressure q moves the surfaces together by -(2/(pi E*)) times the integral of q(s) ln|x - s| ds plus a
constant. `local_approach` counts from the patch: that constant is ln(a) + 1/4 - 1/2 - ln(2) for every
pressure of resultant one.
"""

import math

import numpy as np
import pytest
from hertz_laws import edge_contact_length, edge_half_width, local_approach
from numpy.polynomial import chebyshev

from fe_contact.hertz import contact_modulus, half_width
from fe_contact.material import STEEL

MODULUS = contact_modulus(STEEL, STEEL)
RADIUS, PATCH = 6e-3, 3e-4
PATCH_CONSTANT = math.log(PATCH) - 0.25 - math.log(2.0)


def edge_law(load, slope):
    """Contact length and approach of both bodies by the room under test."""
    length = edge_contact_length(load, slope, RADIUS, MODULUS)
    rigid = np.where(np.asarray(slope) < 0.0, 0.5 * np.asarray(slope) ** 2 * RADIUS, 0.0)
    width = edge_half_width(length, slope, RADIUS)
    return length, 2.0 * local_approach(load, PATCH, width, STEEL) + rigid


def chebyshev_solution(length, slope):
    """Load and approach at the edge for a strip of given length.

    With x = length (1 + xi)/2 and q = sum a_n T_n(xi)/sqrt(1 - xi^2), the integral of q ln|x - s| has the
    coefficients -pi a_n/n (n > 0) and -pi a_0 ln 2, in units of length/2. Surface plus gap is the same all
    over the strip.
    """
    gap = chebyshev.chebinterpolate(
        lambda xi: slope * length * (1 + xi) / 2 + (length * (1 + xi) / 2) ** 2 / (2 * RADIUS), 6
    )
    factor = 2.0 / (math.pi * MODULUS) * 0.5 * length
    n = np.arange(1, gap.size)
    higher = -gap[1:] * n / (math.pi * factor)
    mean = -higher.sum()  # no singularity at xi = 1
    load = 0.5 * length * math.pi * mean
    uniform = factor * math.pi * mean * math.log(2.0) - 2.0 / (math.pi * MODULUS) * load * math.log(
        0.5 * length
    )
    approach = uniform + gap[0]
    rigid = 0.5 * slope**2 * RADIUS if slope < 0.0 else 0.0
    return load, approach + 2.0 / (math.pi * MODULUS) * load * PATCH_CONSTANT + rigid


@pytest.mark.parametrize("slope", [0.1, 0.02, 1e-3, 0.0, -1e-3, -0.01])
@pytest.mark.parametrize("length", [1.3e-4, 2.5e-4, 6e-4])
def test_edge_law_against_chebyshev_expansion(slope, length):
    load, approach = chebyshev_solution(length, slope)
    found_length, found = edge_law(load, slope)
    assert found_length == pytest.approx(length, rel=1e-12, abs=0.0)
    assert found == pytest.approx(approach, rel=1e-11, abs=0.0)


def boundary_elements(load, slope, points):
    """Contact length and approach by constant elements graded towards the edge."""
    reach = 2.2 * max(float(half_width(load, RADIUS, MODULUS)), -slope * RADIUS)
    ends = reach * np.linspace(0.0, 1.0, points + 1) ** 2
    middle, size = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)
    above, below = ends[1:] - middle[:, None], ends[:-1] - middle[:, None]
    kernel = above * np.log(np.abs(above)) - below * np.log(np.abs(below)) - size
    moved = -2.0 / (math.pi * MODULUS) * kernel
    gap = slope * middle + middle**2 / (2 * RADIUS)
    touching = middle < 0.5 * reach
    pressure = np.zeros(points)
    for _ in range(100):
        count = touching.sum()
        system = np.zeros((count + 1, count + 1))
        system[:count, :count] = moved[np.ix_(touching, touching)]
        system[:count, count], system[count, :count] = -1.0, size[touching]
        solution = np.linalg.solve(system, np.append(-gap[touching], load))
        pressure[:] = 0.0
        pressure[touching] = solution[:count]
        open_ = moved @ pressure + gap - solution[count] > 0.0
        settled = np.where(touching, pressure > 0.0, ~open_)
        if np.array_equal(settled, touching):
            break
        touching = settled
    else:
        raise AssertionError("the contact set did not settle")
    rigid = 0.5 * slope**2 * RADIUS if slope < 0.0 else 0.0
    approach = solution[count] + 2.0 / (math.pi * MODULUS) * load * PATCH_CONSTANT + rigid
    return ends[1:][touching].max(), approach


@pytest.mark.parametrize("slope", [0.03, 0.0, -0.01])
def test_edge_law_against_boundary_elements(slope, record_figure):
    load = 2e5
    expected_length, expected = edge_law(load, slope)
    errors = []
    for points in (100, 200, 400):
        length, approach = boundary_elements(load, slope, points)
        errors.append(abs(approach / float(expected) - 1.0))
    assert length == pytest.approx(float(expected_length), rel=0.01, abs=0.0)  # one element
    assert errors[-1] < 2e-4
    assert errors[-1] < 0.6 * errors[0]
    record_figure(
        f"approach at an edge of angle {slope:g} rad, error",
        errors[-1],
        "at most 2e-4",
        "1",
        "boundary elements, 400",
    )


@pytest.mark.parametrize("distance", [1e-5, 1e-4, 3e-4])
def test_edge_law_joins_hertz(distance):
    # at b_H = t, that is c = 2t, value and slope agree
    load = math.pi * MODULUS * distance**2 / (4.0 * RADIUS)
    slope = -distance / RADIUS
    length, approach = edge_law(load, slope)

    def hertz(p):
        return 2.0 * local_approach(p, PATCH, half_width(p, RADIUS, MODULUS), STEEL)

    assert length == pytest.approx(2.0 * distance, rel=1e-12, abs=0.0)
    assert approach == pytest.approx(hertz(load), rel=1e-12, abs=0.0)
    step = 1e-4 * load
    above = (edge_law(load + step, slope)[1] - edge_law(load, slope)[1]) / step
    below = (hertz(load) - hertz(load - step)) / step
    assert above == pytest.approx(below, rel=3e-4, abs=0.0)


def test_far_edge_is_no_edge():
    # before the strip reaches the edge the law must not be used; there c < 2t
    distance = 5e-4
    load = 0.9 * math.pi * MODULUS * distance**2 / (4.0 * RADIUS)
    assert edge_contact_length(load, -distance / RADIUS, RADIUS, MODULUS) < 2.0 * distance
