"""The compiled local law is the hertz room's, with slope and guards."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fe_contact.contact.local_law import LARGEST_STRIP, SMALLEST_STRIP, LocalLaw, approach, local_law
from fe_contact.contact.strip import Gap
from fe_contact.hertz import (
    contact_modulus,
    edge_contact_length,
    edge_half_width,
    half_width,
    line_load_at_half_width,
    local_approach,
)
from fe_contact.material import STEEL, Material

SOFT = Material(2.8e9, 0.4)
RADIUS, WIDTH, PATCH_1, PATCH_2 = 6e-3, 25e-3, 3e-4, 2.2e-4
SLOPES = [math.nan, 0.1, 0.01, 0.0, -1e-3, -0.01, -0.1]
# from strips of a hundredth of the patch to where it is nearly filled
LINE_LOADS = np.geomspace(1e1, 8e4, 25)


def law_of(slope: float, first: Material = STEEL, second: Material = STEEL, scale: float = 1.0) -> LocalLaw:
    k1, k2 = (2.0 / (math.pi * m.plane_strain_modulus) for m in (first, second))
    width, a1, a2 = (np.array([scale * v]) for v in (WIDTH, PATCH_1, PATCH_2))
    return local_law(gap_of(slope, scale * RADIUS), width, a1, a2, contact_modulus(first, second), k1, k2)


def gap_of(slope: float, radius: float) -> Gap:
    """Gap beside an edge: flanks open by a slope > 0; one < 0 is -t/R at a distance t; NaN is no edge."""
    edge = math.inf if math.isnan(slope) else max(-slope, 0.0) * radius
    opening = slope if slope > 0.0 else 0.0
    slopes, curvatures, low, high = (np.array([v]) for v in (opening, 1.0 / radius, -edge, math.inf))
    none = np.zeros((1, 0))
    return Gap(slopes, curvatures, low, high, none, none, none)


def hertz_room(p: float, slope: float, first: Material, second: Material) -> float:
    """Approach by the functions of `fe_contact.hertz`."""
    modulus = contact_modulus(first, second)
    width = half_width(p, RADIUS, modulus)
    rigid = 0.0
    if not math.isnan(slope) and width > -slope * RADIUS:
        width = edge_half_width(edge_contact_length(p, slope, RADIUS, modulus), slope, RADIUS)
        rigid = 0.5 * slope**2 * RADIUS if slope < 0.0 else 0.0
    bodies = ((PATCH_1, first), (PATCH_2, second))
    return rigid + sum(float(local_approach(p, a, width, m)) for a, m in bodies)


def value(law: LocalLaw, p: float) -> float:
    return approach(law, 0, p * WIDTH)[0]


@pytest.mark.parametrize("slope", SLOPES)
@pytest.mark.parametrize("second", [STEEL, SOFT], ids=["steel", "soft"])
def test_value_is_that_of_the_hertz_room(slope, second):
    law = law_of(slope, STEEL, second)
    inside = LINE_LOADS[(law.low[0] < LINE_LOADS) & (law.high[0] > LINE_LOADS)]
    assert inside.size > 5
    for p in inside:
        assert value(law, p) == pytest.approx(hertz_room(p, slope, STEEL, second), rel=1e-11, abs=0.0)


@pytest.mark.parametrize("slope", SLOPES)
def test_slope_is_the_derivative(slope):
    law = law_of(slope)
    loads = np.geomspace(1e-3 * law.low[0], 1e3 * law.high[0], 60)
    for p in loads[(np.abs(loads / law.low[0] - 1.0) > 0.01) & (np.abs(loads / law.high[0] - 1.0) > 0.01)]:
        step = 1e-5 * p
        difference = (value(law, p + step) - value(law, p - step)) / (2.0 * step * WIDTH)
        assert approach(law, 0, p * WIDTH)[1] == pytest.approx(difference, rel=1e-6, abs=0.0)


@pytest.mark.parametrize("slope", SLOPES)
def test_increasing_and_concave(slope):
    law = law_of(slope)
    forces = WIDTH * np.geomspace(1e-3 * law.low[0], 1e3 * law.high[0], 400)
    values, slopes, _ = (np.array(v) for v in zip(*(approach(law, 0, f) for f in forces), strict=True))
    assert np.all(np.diff(values) > 0.0)
    assert np.all(slopes > 0.0)
    assert np.all(np.diff(slopes) <= 1e-12 * slopes[:-1])


@pytest.mark.parametrize("slope", SLOPES)
def test_guards_join_continuously(slope):
    law = law_of(slope)
    for p in (law.low[0], law.high[0]):
        assert value(law, p * (1.0 + 1e-12)) == pytest.approx(
            value(law, p * (1.0 - 1e-12)), rel=1e-10, abs=0.0
        )
    above, below = (approach(law, 0, law.high[0] * WIDTH * f)[1] for f in (1.0 + 1e-9, 1.0 - 1e-9))
    assert above == pytest.approx(below, rel=1e-7, abs=0.0)


def test_guards_lie_at_their_strips():
    law = law_of(math.nan)
    patch = math.sqrt(PATCH_1 * PATCH_2)  # equal bodies weigh alike
    modulus = contact_modulus(STEEL, STEEL)
    for found, share in ((law.low[0], SMALLEST_STRIP), (law.high[0], LARGEST_STRIP)):
        assert found == pytest.approx(
            line_load_at_half_width(share * patch, RADIUS, modulus), rel=1e-12, abs=0.0
        )


@pytest.mark.parametrize("slope", [0.05, 0.0, -0.005])
def test_an_edge_strip_counts_with_half_its_length(slope):
    law = law_of(slope)
    length = edge_contact_length(law.high[0], slope, RADIUS, contact_modulus(STEEL, STEEL))
    assert length == pytest.approx(2.0 * LARGEST_STRIP * math.sqrt(PATCH_1 * PATCH_2), rel=1e-12, abs=0.0)


def test_outgrown_patch_is_flagged_and_nothing_else():
    law = law_of(0.02)
    flags = [
        approach(law, 0, WIDTH * p)[2] for p in (0.0, law.low[0], 0.999 * law.high[0], 1.001 * law.high[0])
    ]
    assert flags == [False, False, False, True]


@pytest.mark.parametrize("slope", SLOPES)
def test_straight_below_the_smallest_strip(slope):
    law = law_of(slope)
    secant = value(law, law.low[0]) / law.low[0]
    for share in (1e-6, 0.3, 0.99):
        found, stiffness, _ = approach(law, 0, share * law.low[0] * WIDTH)
        assert found == pytest.approx(secant * share * law.low[0], rel=1e-12, abs=0.0)
        assert stiffness == pytest.approx(secant / WIDTH, rel=1e-12, abs=0.0)


def test_no_force_no_approach_and_straight_through_zero():
    law = law_of(0.02)
    at_zero, slope, _ = approach(law, 0, 0.0)
    assert at_zero == 0.0
    assert approach(law, 0, -1e-9)[0] == pytest.approx(-1e-9 * slope, rel=1e-12, abs=0.0)


def test_equal_patches_far_from_the_edge_give_hertz():
    # an edge farther than the strip changes nothing, to the bit
    far, none = law_of(-0.2), law_of(math.nan)
    assert [value(far, p) for p in LINE_LOADS] == [value(none, p) for p in LINE_LOADS]


@pytest.mark.parametrize("slope", SLOPES)
def test_lengths_scale_and_forces_with_their_square(slope):
    s = 7.3
    small, large = law_of(slope), law_of(slope, scale=s)
    for p in np.geomspace(1e-2 * small.low[0], 1e2 * small.high[0], 20):
        expected, stiffness, beyond = approach(small, 0, p * WIDTH)
        found = approach(large, 0, s * s * p * WIDTH)
        assert found[0] == pytest.approx(s * expected, rel=1e-11, abs=0.0)
        assert found[1] == pytest.approx(stiffness / s, rel=1e-11, abs=0.0)
        assert found[2] == beyond


def test_blunt_wedge_keeps_its_digits():
    # phi R is far beyond the strip; c = 4 p/(pi E* phi) there and b_eff = c exp(-1/2)/2
    modulus, wedge, radius, patch = contact_modulus(STEEL, STEEL), 0.3, 2e4, 3e-4
    k = 1.0 / (math.pi * modulus)
    one = np.ones(1)
    law = local_law(gap_of(wedge, radius), WIDTH * one, patch * one, patch * one, modulus, k, k)
    p = 1.5 * law.low[0]
    half_width_at_edge = 2.0 * p / (math.pi * modulus * wedge) * math.exp(-0.5)
    expected = 2.0 * k * p * (math.log(patch / half_width_at_edge) + 0.25)
    assert value(law, p) == pytest.approx(expected, rel=1e-10, abs=0.0)
    assert approach(law, 0, p * WIDTH)[1] * WIDTH == pytest.approx(
        2.0 * k * (math.log(patch / half_width_at_edge) - 0.75), rel=1e-10, abs=0.0
    )
