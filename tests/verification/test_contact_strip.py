"""The contact strip on a gap of parabolas against closed forms, numbers and boundary elements.

The closed forms are of others; the boundary elements know the conditions of contact only (no tension, no
penetration): neither the ends of the strip nor its middle, nor how the pressure ends.
"""

import math

import numpy as np
import pytest

from fe_contact.contact.parabolic_gap import shifted_gap, touching_offsets
from fe_contact.contact.strip import Gap, gap_table, half_strip, strip_load

MODULUS = 115e9
RADIUS = 6e-3
K = 2.0 / (math.pi * MODULUS)


def gap(*breaks, slope=0.0, curvature=1.0 / RADIUS, low=-math.inf, high=math.inf) -> Gap:
    """One contact; a break is its place, jump and bend."""
    one = [np.array([value]) for value in (slope, curvature, low, high)]
    columns = np.array(breaks, dtype=float).reshape(-1, 3).T
    return Gap(*one, *(column[None].copy() for column in columns))


def half_of(about: Gap, contact: int, load: float, modulus: float) -> tuple[float, float]:
    return half_strip(gap_table(about), contact, load, modulus, 0.0, 0.0)[1:]


def load_on(about: Gap, contact: int, half: float, modulus: float) -> tuple[float, float]:
    return strip_load(gap_table(about), contact, half, modulus)


def approach(about: Gap, load: float, patch: float = 1.0) -> float:
    half, mean = half_of(about, 0, load, MODULUS)
    return mean + K * load * (math.log(patch / half) - 0.25)


def height(about: Gap, x):
    """Gap at x, by its definition."""
    value = about.slope[0] * x + 0.5 * about.curvature[0] * x**2
    for place, jump, bend in zip(about.offset[0], about.jump[0], about.bend[0], strict=True):
        depth = np.maximum(x - place if place >= 0.0 else place - x, 0.0)
        value = value + jump * depth + 0.5 * bend * depth**2
    return np.where((x < about.low[0]) | (x > about.high[0]), np.inf, value)


# Extra approach over Hertz in units of jump times half-width, by kink strength and place: 1200 boundary
# elements over 4.4 half-widths, good to 0.002.
KINKS = {
    (0.1, 0.0): 0.301, (0.1, 0.25): 0.190, (0.1, 0.5): 0.100, (0.1, 0.75): 0.034,
    (0.5, 0.0): 0.242, (0.5, 0.25): 0.146, (0.5, 0.5): 0.072, (0.5, 0.75): 0.021,
    (1.0, 0.0): 0.186, (1.0, 0.25): 0.109, (1.0, 0.5): 0.051, (1.0, 0.75): 0.014,
    (2.0, 0.0): 0.120, (2.0, 0.25): 0.067, (2.0, 0.5): 0.030, (2.0, 0.75): 0.008,
    (3.0, 0.0): 0.086, (3.0, 0.25): 0.048, (3.0, 0.5): 0.021, (3.0, 0.75): 0.005,
}  # fmt: skip


@pytest.mark.parametrize(("strength", "place"), KINKS)
def test_a_kink_in_the_gap(strength, place):
    load = 2e5
    hertz = math.sqrt(4.0 * load * RADIUS / (math.pi * MODULUS))
    jump = strength * hertz / RADIUS
    extra = approach(gap((place * hertz, jump, 0.0)), load) - approach(gap(), load)
    assert extra / (jump * hertz) == pytest.approx(KINKS[strength, place], abs=2e-3)


def test_a_wedge():
    """P = E* a tan(angle), K. L. Johnson, Contact Mechanics, section 5.2."""
    rise, half = 0.02, 1e-4
    wedge = gap((0.0, 2.0 * rise, 0.0), slope=-rise, curvature=1e-9)
    assert load_on(wedge, 0, half, MODULUS)[0] == pytest.approx(MODULUS * half * rise, rel=1e-8, abs=0.0)


@pytest.mark.parametrize("ratio", [0.1, 0.5, 0.9, 0.99])
def test_a_flat_punch_with_rounded_edges(ratio):
    """Load of a strip of half length b on a flat of half length a (M. Ciavarella and others, 1998)."""
    flat = 2e-4
    rounded = gap((flat, 0.0, 1.0 / RADIUS), (-flat, 0.0, 1.0 / RADIUS), curvature=1e-12)
    phi = math.asin(ratio)
    load = (
        0.5
        * MODULUS
        * flat**2
        / RADIUS
        * ((math.pi - 2.0 * phi) / (2.0 * math.sin(phi) ** 2) - 1.0 / math.tan(phi))
    )
    assert load_on(rounded, 0, flat / ratio, MODULUS)[0] == pytest.approx(load, rel=1e-9, abs=0.0)
    assert half_of(rounded, 0, load, MODULUS)[0] == pytest.approx(flat / ratio, rel=1e-8, abs=0.0)


def test_a_truncated_parabola_is_a_punch_once_it_is_full():
    """From the load on that reaches both edges the strip stays, and approach grows in proportion."""
    edge = 1e-4
    truncated = gap(low=-edge, high=edge)
    full = math.pi * MODULUS * edge**2 / (4.0 * RADIUS)
    assert half_of(truncated, 0, 0.5 * full, MODULUS)[0] == pytest.approx(math.sqrt(0.5) * edge, rel=1e-12)
    loads = full * np.array([1.0, 2.0, 5.0])
    assert [half_of(truncated, 0, load, MODULUS)[0] for load in loads] == pytest.approx([edge] * 3, rel=1e-9)
    values = np.array([approach(truncated, load) for load in loads])
    assert np.diff(values) / np.diff(loads) == pytest.approx(K * (-math.log(edge) - 0.25), rel=1e-9)


def boundary_elements(about: Gap, load: float, points: int) -> float:
    """Approach by constant elements of equal size."""
    reach = 1.6 * math.sqrt(4.0 * load / (math.pi * MODULUS * about.curvature[0]))
    ends = np.linspace(max(-reach, about.low[0]), min(reach, about.high[0]), points + 1)
    middle, size = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)
    above, below = ends[1:] - middle[:, None], ends[:-1] - middle[:, None]
    moved = -K * (above * np.log(np.abs(above)) - below * np.log(np.abs(below)) - size)
    apart = height(about, middle)
    touching = apart < np.quantile(apart, 0.5)
    pressure = np.zeros(points)
    for _ in range(200):
        count = touching.sum()
        system = np.zeros((count + 1, count + 1))
        system[:count, :count] = moved[np.ix_(touching, touching)]
        system[:count, count], system[count, :count] = -1.0, size[touching]
        solution = np.linalg.solve(system, np.append(-apart[touching], load))
        pressure[:] = 0.0
        pressure[touching] = solution[:count]
        closed = moved @ pressure + apart - solution[count] <= 0.0
        settled = np.where(touching, pressure > 0.0, closed)
        if np.array_equal(settled, touching):
            return float(solution[count] + K * load * (-0.25 - math.log(2.0)))
        touching = settled
    raise AssertionError("the contact set did not settle")


B = math.sqrt(4.0 * 2e5 * RADIUS / (math.pi * MODULUS))
GAPS = {
    "two reliefs": gap((0.3 * B, 0.01, -3.0), (-0.6 * B, 0.004, 2.0)),
    "a parabolic relief": gap((0.2 * B, 0.0, 100.0)),
    "a kink that touches": gap((0.0, 0.02, 0.0), slope=-0.007),
    "a kink beside an edge": gap((-0.4 * B, 0.01, 0.0), high=0.3 * B),
    "an edge that opens, with a relief": gap((0.5 * B, 0.02, -5.0), slope=0.01, low=0.0),
    "two edges": gap((0.1 * B, 0.01, 0.0), low=-0.3 * B, high=0.4 * B),
    "rounded edges": gap((0.3 * B, 0.0, 5e3), (-0.5 * B, 0.0, 2e3)),
}


@pytest.mark.parametrize("name", GAPS)
def test_against_boundary_elements(name, record_figure):
    load, about = 2e5, GAPS[name]
    expected = approach(about, load)
    errors = [abs(boundary_elements(about, load, n) - expected) / (K * load) for n in (150, 600)]
    record_figure(f"approach over {name}, error", errors[1], "at most 2e-3", "k p", "boundary elements, 600")
    assert errors[1] < 2e-3
    assert errors[1] < 0.6 * errors[0]


@pytest.mark.parametrize("name", GAPS)
def test_the_slope_in_the_load_is_that_of_a_punch(name):
    about = GAPS[name]
    for load in (2e3, 2e4, 1.7e5):
        half, _ = half_of(about, 0, load, MODULUS)
        step = 1e-4 * load
        slope = (approach(about, load + step) - approach(about, load - step)) / (2.0 * step)
        assert slope == pytest.approx(K * (-math.log(half) - 0.25), rel=1e-5, abs=0.0)


@pytest.mark.parametrize("scale", [1e-3, 7.0])
@pytest.mark.parametrize("name", GAPS)
def test_lengths_scale(name, scale):
    about = GAPS[name]
    larger = Gap(
        about.slope, about.curvature / scale, scale * about.low, scale * about.high,
        scale * about.offset, about.jump, about.bend / scale,
    )  # fmt: skip
    small, large = half_of(about, 0, 1e5, MODULUS), half_of(larger, 0, scale * 1e5, MODULUS)
    assert large == pytest.approx((scale * small[0], scale * small[1]), rel=1e-9)


def test_touching_points_are_where_the_gap_is_least():
    rng = np.random.default_rng(3)
    n = 200
    about = Gap(
        rng.normal(0.0, 0.02, n), 1.0 / rng.uniform(2e-3, 15e-3, n),
        -rng.choice([1e-3, 1e-4, 0.0], n), rng.choice([1e-3, 1e-4], n),
        rng.normal(0.0, 2e-4, (n, 3)), rng.choice([0.0, 5e-3, 0.03], (n, 3)),
        rng.choice([0.0, -5.0, 20.0], (n, 3)),
    )  # fmt: skip
    place = touching_offsets(about, about.low, about.high)
    minimum, there = shifted_gap(about, place)
    for i in range(n):
        one = Gap(*(part[i : i + 1] for part in about))
        moved = Gap(*(part[i : i + 1] for part in there))
        x = np.union1d(np.linspace(one.low[0], one.high[0], 20001), one.offset[0])
        values = height(one, x)
        assert minimum[i] == pytest.approx(values.min(), abs=1e-9)
        assert minimum[i] <= values.min() + 1e-15
        beside = np.linspace(moved.low[0], moved.high[0], 41)[1:-1]
        assert height(moved, beside) + minimum[i] == pytest.approx(height(one, beside + place[i]), abs=1e-15)


def test_load_grows_with_the_strip_where_its_end_stays_at_a_kink():
    # a chamfer's edge holds the end of the strip: the middle is then known by the kink's angle alone
    one = [np.array([value]) for value in (0.0, 24.9, -6.8e-3, np.inf)]
    gap = Gap(*one, np.array([[63.47e-6]]), np.array([[0.577]]), np.zeros((1, 1)))
    halves = np.linspace(0.95, 1.6, 5000) * 63.47e-6
    loads = np.array([load_on(gap, 0, half, MODULUS)[0] for half in halves])
    assert np.all(np.diff(loads) > 0.0)
    for half, load in zip(halves[::250], loads[::250], strict=True):
        assert half_of(gap, 0, load, MODULUS)[0] == pytest.approx(half, rel=1e-6)
