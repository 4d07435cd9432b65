"""Strips of rough flanks against half planes that are solved by another method."""

import math

import numpy as np
import pytest
from scipy.optimize import nnls

from fe_contact.analysis.estimates.rough_flank_errors import BETWEEN_LOADS
from fe_contact.contact.rough_strip import rough_strip
from fe_contact.contact.strip import gap_table, half_strip

RADIUS = 8e-3
MODULUS = 1.1e11
CELLS = 240


def waves(seed: int, amplitude: float, length: float):
    """Return random waves of some 0.7 to 2 lengths as a function of ways along the flank, m."""
    draw = np.random.default_rng(seed)
    sizes, phases = draw.normal(size=6), draw.uniform(0.0, 6.3, 6)
    numbers = 2.0 * np.pi / (length * np.linspace(0.7, 2.0, 6))
    size = amplitude / np.abs(sizes).sum()
    return lambda x: size * sum(a * np.cos(k * x + p) for a, k, p in zip(sizes, numbers, phases, strict=True))


def pressed(gap, window: float, load: float) -> float:
    """Approach under a load in N/m beyond a point at 1 m, by non-negative least squares on even cells.

    Of all forces >= 0 with that sum the contact's have the least energy.
    """
    cell = window / CELLS
    at = (np.arange(CELLS) + 0.5) * cell - 0.5 * window
    apart = np.abs(at[:, None] - at)
    far, near = apart + 0.5 * cell, apart - 0.5 * cell
    moved = 1.0 - (far * np.log(far) - near * np.log(np.abs(near))) / cell
    scaled = 2.0 * load / (np.pi * MODULUS)
    # min f A f / 2 + f g with sum f = P: A = R'R, the sum by a heavy row
    root = np.linalg.cholesky(moved + 20.0)
    heavy = 1e4
    rows = np.vstack([root.T, heavy * np.ones(CELLS)])
    right = np.concatenate([-np.linalg.solve(root, gap(at)), [heavy * scaled]])
    force = nnls(rows, right, maxiter=20 * CELLS)[0]
    off = moved @ force + gap(at)
    return float(np.average(off, weights=force))


def approach_of(strip, load: float) -> float:
    _, half, rigid = half_strip(gap_table(strip.gap), 0, load, MODULUS, 0.0, 0.0)
    patch = math.log(2.0) + 0.25  # what is taken off with a patch of half-width 1
    scaled = 2.0 * load / (math.pi * MODULUS)
    return rigid - scaled * (math.log(half) + 0.25) + patch * scaled


def strip_of(rough, span: float):
    """Return the strip of plain flanks with `rough` deviations about their least gap, and that place, m."""
    x = np.linspace(-0.3e-3, 0.3e-3, 60001)
    place = x[np.argmin(0.5 * x**2 / RADIUS + rough(x))]

    def gap(way, _of):
        return 0.5 * way**2 / RADIUS + rough(way)

    one = np.ones(1)
    return rough_strip(gap, place * one, one / RADIUS, span * one), place


def test_plain_flanks_have_a_parabola():
    strip, _ = strip_of(lambda x: 0.0 * x, 0.0)
    assert strip.gap.curvature * RADIUS == pytest.approx([1.0], rel=1e-9)
    assert strip.gap.bend * RADIUS == pytest.approx(np.zeros(strip.gap.bend.shape), abs=1e-6)
    assert strip.center == pytest.approx([0.0], abs=1e-12)


def misses(seed: int, amplitude: float, length: float) -> list[tuple[float, float, float]]:
    """Return error, stated error and error of the crest's parabola of an approach under four loads, m."""
    rough, rows = waves(seed, amplitude, length), []
    strip, place = strip_of(rough, 2.0 * amplitude)
    level = 0.5 * place**2 / RADIUS + rough(place)

    def gap(way):
        return 0.5 * (place + way) ** 2 / RADIUS + rough(place + way) - level

    for part in (0.008, 0.012, 0.02, 0.03):
        half = part * RADIUS
        load, scaled = 0.25 * np.pi * MODULUS * half**2 / RADIUS, 0.5 * half**2 / RADIUS
        window = 2.0 * np.sqrt((3.0 * half) ** 2 + 4.0 * amplitude * RADIUS)
        plain = pressed(lambda way: 0.5 * way**2 / RADIUS, window, load)
        hertz = scaled * (0.5 - math.log(half) + math.log(2.0))
        truth = pressed(gap, window, load) - plain + hertz
        crest = hertz + 0.5 * scaled * math.log(float(strip.gap.curvature[0]) * RADIUS)
        stated = BETWEEN_LOADS * float(strip.approach_error[0]) * math.sqrt(scaled * RADIUS)
        rows.append((approach_of(strip, load) - truth, min(stated, scaled), crest - truth))
    return rows


@pytest.mark.parametrize(
    ("amplitude", "length", "part"), [(1e-6, 0.6e-3, 0.4), (0.6e-6, 0.2e-3, 0.125), (0.3e-6, 0.12e-3, 0.125)]
)
def test_rough_flanks_give_way_as_half_planes_do(amplitude, length, part):
    """Nearer than the crest's parabola, eight times on short waves; nine of ten within what is stated."""
    rows = [misses(seed, amplitude, length) for seed in range(6)]
    error, stated, crest = np.abs(np.concatenate(rows)).T
    assert np.sqrt(np.mean(error**2)) < part * np.sqrt(np.mean(crest**2))
    assert np.mean(error <= stated + 1e-9) >= 0.9
