"""The compiled local law is the hertz room's, with slope and guards."""

import math

import numpy as np
import pytest
from hertz_laws import edge_contact_length, edge_half_width, line_load_at_half_width, local_approach

from fe_contact.contact.local_law import (
    HALF_STRIP,
    LARGEST_STRIP,
    MIDDLE,
    MODULUS,
    SMALLEST_STRIP,
    LocalLaw,
    approach,
    force_at,
    half_strip_at,
    local_law,
    plain_load,
    plain_strip,
)
from fe_contact.contact.strip import Gap, free_strip, gap_table, strip_at, strip_load
from fe_contact.hertz import contact_modulus, half_width
from fe_contact.material import STEEL, Material

SOFT = Material(2.8e9, 0.4)
RADIUS, WIDTH, LENGTH = 6e-3, 25e-3, 2.6e-4
SLOPES = [math.nan, 0.1, 0.01, 0.0, -1e-3, -0.01, -0.1]
# from strips of a hundredth of the patch to where it is nearly filled
LINE_LOADS = np.geomspace(1e1, 8e4, 25)


def law_of(slope: float, first: Material = STEEL, second: Material = STEEL, scale: float = 1.0) -> LocalLaw:
    gap, width = gap_of(slope, scale * RADIUS), np.array([scale * WIDTH])
    return local_law(gap_table(gap), width, np.array([contact_modulus(first, second)]), scale * LENGTH)


def low(law: LocalLaw) -> float:
    """Line load up to which the law is its secant."""
    return strip_load(law.gap, 0, SMALLEST_STRIP * law.length, law.strip[0, MODULUS])[0]


def high(law: LocalLaw) -> float:
    """Line load above which the law goes on straight."""
    return strip_load(law.gap, 0, LARGEST_STRIP * law.length, law.strip[0, MODULUS])[0]


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
    return rigid + sum(float(local_approach(p, LENGTH, width, m)) for m in (first, second))


def value(law: LocalLaw, p: float) -> float:
    return approach(law, 0, p * WIDTH)[0]


@pytest.mark.parametrize("slope", SLOPES)
@pytest.mark.parametrize("second", [STEEL, SOFT], ids=["steel", "soft"])
def test_value_is_that_of_the_hertz_room(slope, second):
    law = law_of(slope, STEEL, second)
    inside = LINE_LOADS[(low(law) < LINE_LOADS) & (high(law) > LINE_LOADS)]
    assert inside.size > 5
    for p in inside:
        assert value(law, p) == pytest.approx(hertz_room(p, slope, STEEL, second), rel=1e-11, abs=0.0)


@pytest.mark.parametrize("slope", SLOPES)
def test_the_law_is_increasing_concave_and_joined_at_its_guards(slope):
    law = law_of(slope)
    loads = np.geomspace(1e-3 * low(law), 1e3 * high(law), 60)
    for p in loads[(np.abs(loads / low(law) - 1.0) > 0.01) & (np.abs(loads / high(law) - 1.0) > 0.01)]:
        step = 1e-5 * p
        difference = (value(law, p + step) - value(law, p - step)) / (2.0 * step * WIDTH)
        assert approach(law, 0, p * WIDTH)[1] == pytest.approx(difference, rel=1e-6, abs=0.0)
    forces = WIDTH * np.geomspace(1e-3 * low(law), 1e3 * high(law), 400)
    values, slopes, _ = (np.array(v) for v in zip(*(approach(law, 0, f) for f in forces), strict=True))
    assert np.all(np.diff(values) > 0.0)
    assert np.all(slopes > 0.0)
    assert np.all(np.diff(slopes) <= 1e-12 * slopes[:-1])
    for p in (low(law), high(law)):
        assert value(law, p * (1.0 + 1e-12)) == pytest.approx(
            value(law, p * (1.0 - 1e-12)), rel=1e-10, abs=0.0
        )
    above, below = (approach(law, 0, high(law) * WIDTH * f)[1] for f in (1.0 + 1e-9, 1.0 - 1e-9))
    assert above == pytest.approx(below, rel=1e-7, abs=0.0)
    secant = value(law, low(law)) / low(law)
    for share in (1e-6, 0.3, 0.99):
        found, stiffness, _ = approach(law, 0, share * low(law) * WIDTH)
        assert found == pytest.approx(secant * share * low(law), rel=1e-12, abs=0.0)
        assert stiffness == pytest.approx(secant / WIDTH, rel=1e-12, abs=0.0)


def test_guards_lie_at_their_strips_and_flag_what_outgrows_them():
    law = law_of(math.nan)
    modulus = contact_modulus(STEEL, STEEL)
    for found, share in ((low(law), SMALLEST_STRIP), (high(law), LARGEST_STRIP)):
        assert found == pytest.approx(
            line_load_at_half_width(share * LENGTH, RADIUS, modulus), rel=1e-12, abs=0.0
        )
    law = law_of(0.02)
    flags = [approach(law, 0, WIDTH * p)[2] for p in (0.0, low(law), 0.999 * high(law), 1.001 * high(law))]
    assert flags == [False, False, False, True]
    at_zero, slope, _ = approach(law, 0, 0.0)
    assert at_zero == 0.0
    assert approach(law, 0, -1e-9)[0] == pytest.approx(-1e-9 * slope, rel=1e-12, abs=0.0)


@pytest.mark.parametrize("slope", [0.05, 0.0, -0.005])
def test_an_edge_strip_counts_with_half_its_length(slope):
    law = law_of(slope)
    length = edge_contact_length(high(law), slope, RADIUS, contact_modulus(STEEL, STEEL))
    assert length == pytest.approx(2.0 * LARGEST_STRIP * LENGTH, rel=1e-12, abs=0.0)


@pytest.mark.parametrize("slope", SLOPES)
def test_the_force_at_an_approach_is_its_inverse(slope):
    law = law_of(slope)
    for p in np.geomspace(1e-3 * low(law), 1e2 * high(law), 200):
        value, stiffness, _ = approach(law, 0, p * WIDTH)
        force, per_approach = force_at(law, 0, value)
        assert force == pytest.approx(p * WIDTH, rel=1e-11, abs=0.0)
        assert per_approach * stiffness == pytest.approx(1.0, rel=1e-6, abs=0.0)
    assert force_at(law, 0, -1e-9) == (0.0, 0.0)


@pytest.mark.law
def test_a_parabola_needs_no_search():
    # what the solver takes where neither an edge nor a break is near is the same law
    law = law_of(math.nan)
    curvature, gap = 1.0 / RADIUS, gap_of(math.nan, RADIUS)
    for p in np.geomspace(1e-3 * low(law), 1e2 * high(law), 200):
        value = approach(law, 0, p * WIDTH)[0]
        half = plain_strip(curvature, LENGTH, value, 0.0)
        load, stiffness = plain_load(curvature, LENGTH, law.strip[0, MODULUS], half, value)
        found, from_the_last = force_at(law_of(math.nan), 0, value), force_at(law, 0, value)
        assert (WIDTH * load, WIDTH * stiffness) == pytest.approx(found, rel=1e-12)
        assert from_the_last == pytest.approx(found, rel=1e-11)
    assert free_strip(gap_table(gap), 0) == math.inf
    assert free_strip(gap_table(gap._replace(slope=np.array([0.01]))), 0) == 0.0
    assert free_strip(gap_table(gap._replace(low=np.array([-2e-4]), high=np.array([1e-4]))), 0) == 1e-4
    broken = gap._replace(offset=np.array([[-5e-5, 3e-4]]), jump=np.ones((1, 2)), bend=np.ones((1, 2)))
    assert free_strip(gap_table(broken), 0) == 5e-5


def test_equal_patches_far_from_the_edge_give_hertz():
    # an edge farther than the strip changes nothing, to the bit
    far, none = law_of(-0.2), law_of(math.nan)
    assert [value(far, p) for p in LINE_LOADS] == [value(none, p) for p in LINE_LOADS]


@pytest.mark.parametrize("slope", SLOPES)
def test_lengths_scale_and_forces_with_their_square(slope):
    s = 7.3
    small, large = law_of(slope), law_of(slope, scale=s)
    for p in np.geomspace(1e-2 * low(small), 1e2 * high(small), 20):
        expected, stiffness, beyond = approach(small, 0, p * WIDTH)
        found = approach(large, 0, s * s * p * WIDTH)
        assert found[0] == pytest.approx(s * expected, rel=1e-11, abs=0.0)
        assert found[1] == pytest.approx(stiffness / s, rel=1e-9, abs=0.0)  # as exact as the strip
        assert found[2] == beyond


def test_blunt_wedge_keeps_its_digits():
    # phi R is far beyond the strip; c = 4 p/(pi E* phi) there and b_eff = c exp(-1/2)/2
    modulus, wedge, radius, patch = contact_modulus(STEEL, STEEL), 0.3, 2e4, 3e-4
    k, gap = 1.0 / (math.pi * modulus), gap_of(wedge, radius)
    law = local_law(gap_table(gap), np.array([WIDTH]), np.array([modulus]), patch)
    p = 1.5 * low(law)
    half_width_at_edge = 2.0 * p / (math.pi * modulus * wedge) * math.exp(-0.5)
    expected = 2.0 * k * p * (math.log(patch / half_width_at_edge) + 0.25)
    assert value(law, p) == pytest.approx(expected, rel=1e-10, abs=0.0)
    assert approach(law, 0, p * WIDTH)[1] * WIDTH == pytest.approx(
        2.0 * k * (math.log(patch / half_width_at_edge) - 0.75), rel=1e-10, abs=0.0
    )


@pytest.mark.parametrize("jump", [0.0, 2e-3, 2e-2])
def test_newtons_strip_is_the_one_that_is_held_between_bounds(jump):
    """Beside a relief that begins with a slope or a curvature, and between two of them."""
    rng, found = np.random.default_rng(5), 0
    modulus = contact_modulus(STEEL, STEEL)
    for value in np.geomspace(1e-8, 3e-6, 40):
        place = rng.uniform(-1.2, 1.2, (1, 2)) * 1e-4
        bends = rng.uniform(0.0, 2.0, (1, 2)) / RADIUS
        one, away = np.array([1.0 / RADIUS]), np.array([1e-2])
        gap = gap_table(Gap(np.zeros(1), one, -away, away, place, np.full((1, 2), jump), bends))
        law = local_law(gap, np.array([WIDTH]), np.array([modulus]), LENGTH)
        guess = plain_strip(one[0], LENGTH, value, 0.0)
        held = half_strip_at(law, 0, value, guess)
        center, half, first, mean = strip_at(gap, 0, value, LENGTH, 0.0, guess)
        if SMALLEST_STRIP * LENGTH < half < LARGEST_STRIP * LENGTH:
            found += 1
            load, rigid = strip_load(gap, 0, held, modulus)
            assert half == pytest.approx(held, rel=1e-7, abs=0.0)
            assert 0.5 * math.pi * modulus * half * first == pytest.approx(load, rel=1e-7, abs=0.0)
            assert mean == pytest.approx(rigid, rel=1e-7, abs=0.0)
            _, under, _, own = strip_at(gap, 0, half * first, 0.0, 0.0, guess)
            assert under == 0.0 or (under, own) == pytest.approx((half, mean), rel=1e-7, abs=0.0)
            assert strip_at(gap, 0, value, LENGTH, center, half)[1:] == pytest.approx(
                (half, first, mean), rel=1e-12, abs=0.0
            )
    assert found > 20


@pytest.mark.parametrize("slope", [0.1, 0.01, 0.0, -1e-3, -0.01])
def test_a_strip_that_an_edge_holds_follows_from_any_other(slope):
    """From strips of a tenth to ten times the load, held or free, the one between bounds is found."""
    law, held = law_of(slope), 0
    for p in LINE_LOADS:
        expected, stiffness, _ = approach(law_of(slope), 0, p * WIDTH)
        bounded = half_strip_at(law_of(slope), 0, expected, 1e-2 * LENGTH)
        for share in (0.1, 0.7, 1.0, 1.4, 10.0):
            before = approach(law_of(slope), 0, share * p * WIDTH)[0]
            other = law_of(slope)
            force_at(other, 0, before)
            found = force_at(other, 0, expected)
            assert found == pytest.approx((p * WIDTH, 1.0 / stiffness), rel=1e-7, abs=0.0)
            middle, half, *_ = strip_at(law.gap, 0, expected, LENGTH, *other.strip[0, [MIDDLE, HALF_STRIP]])
            if half > SMALLEST_STRIP * LENGTH and middle <= law.gap[0, 2] + 1.001 * half:
                held += 1
                assert half == pytest.approx(bounded, rel=1e-6, abs=0.0)
    assert held >= 10
