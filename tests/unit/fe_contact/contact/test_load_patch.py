"""Consistent nodal forces of load patches: exact moments, locality, and independence of the elements."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hertz_laws import edge_contact_length
from scipy.special import j1

from fe_contact.contact import PatchRule
from fe_contact.contact.patch import Patches, load_vector, tip_patches


def flank(ends: np.ndarray) -> np.ndarray:
    """Nodes of quadratic elements with the given ends."""
    nodes = np.empty(2 * ends.size - 1)
    nodes[::2] = ends
    nodes[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return nodes


UNIFORM = flank(np.linspace(0.0, 10e-3, 51))
GRADED = flank(10e-3 * np.linspace(0.0, 1.0, 41) ** 0.6)
SINGLE = flank(np.array([0.0, 10e-3]))
MESHES = pytest.mark.parametrize("nodes", [UNIFORM, GRADED, SINGLE], ids=["uniform", "graded", "one element"])


def patch(nodes, center, half_width, share=0.0):
    """Nodal forces on all nodes."""
    out = np.full(nodes.size, np.nan)
    first, last = load_vector(nodes, center, half_width, share, out)
    forces = np.zeros(nodes.size)
    forces[first:last] = out[first:last]
    return forces


@MESHES
@pytest.mark.parametrize("half_width", [2e-5, 3e-4, 1.7e-3])
@pytest.mark.parametrize("center", [2e-3, 4.9997e-3, 6.1e-3])
def test_moments_of_the_semi_ellipse(nodes, center, half_width):
    # quadratic shape functions reproduce 1, s and s^2
    forces = patch(nodes, center, half_width)
    assert forces.sum() == pytest.approx(1.0, rel=1e-13, abs=0.0)
    assert forces @ (nodes - center) == pytest.approx(0.0, abs=1e-13 * 10e-3)
    assert forces @ (nodes - center) ** 2 == pytest.approx(half_width**2 / 4.0, abs=1e-13 * 1e-4)


@MESHES
@pytest.mark.parametrize("share", [0.3, 1.0])
def test_moments_of_a_patch_at_an_edge(nodes, share):
    # from the edge: Beta(3/2, 3/2) and Beta(1/2, 3/2) over the length c, mixed
    c, tip = 0.8e-3, 9.5e-3
    forces = patch(nodes, tip - 0.5 * c, 0.5 * c, share)
    first = (1.0 - share) / 2.0 + share / 4.0
    second = (1.0 - share) * 5.0 / 16.0 + share / 8.0
    assert forces.sum() == pytest.approx(1.0, rel=1e-12, abs=0.0)
    assert forces @ (tip - nodes) == pytest.approx(c * first, rel=1e-10, abs=0.0)
    assert forces @ (tip - nodes) ** 2 == pytest.approx(c**2 * second, rel=1e-9, abs=0.0)


def test_a_smooth_field_is_weighed_alike_on_every_mesh():
    def work(nodes, center):
        return patch(nodes, center, 3e-4) @ np.cos(500.0 * nodes)

    assert work(UNIFORM, 5.123e-3) == pytest.approx(work(GRADED, 5.123e-3), rel=2e-6, abs=0.0)


def test_moving_the_patch_through_an_element_does_not_ripple():
    # the mean of cos(k s) over the patch is cos(k s0) 2 J_1(k a)/(k a), wherever in the element it lies
    k, half = 500.0, 3e-4
    places = np.linspace(5.0e-3, 5.2e-3, 41)
    found = np.array([patch(UNIFORM, s, half) @ np.cos(k * UNIFORM) for s in places])
    exact = np.cos(k * places) * 2.0 * j1(k * half) / (k * half)
    assert np.max(np.abs(found - exact)) < 2e-6


@MESHES
def test_only_the_touched_elements_carry(nodes):
    out = np.zeros(nodes.size)
    first, last = load_vector(nodes, 5e-3, 3e-4, 0.0, out)
    ends = nodes[::2]
    touched = (ends[1:] > 4.7e-3) & (ends[:-1] < 5.3e-3)
    assert first == 2 * np.flatnonzero(touched)[0]
    assert last == 2 * np.flatnonzero(touched)[-1] + 3


def test_entries_outside_the_range_are_left_alone():
    out = np.full(UNIFORM.size, np.nan)
    first, last = load_vector(UNIFORM, 5e-3, 3e-4, 0.0, out)
    assert np.isnan(out[:first]).all()
    assert np.isnan(out[last:]).all()
    assert np.isfinite(out[first:last]).all()


@MESHES
def test_mirror(nodes):
    mirrored = (nodes[-1] - nodes)[::-1].copy()
    forces = patch(nodes, 3.3e-3, 4e-4)
    assert patch(mirrored, nodes[-1] - 3.3e-3, 4e-4)[::-1] == pytest.approx(forces, abs=1e-13)


def test_patch_at_the_end_of_the_flank():
    tip = UNIFORM[-1]
    forces = patch(UNIFORM, tip - 2e-4, 2e-4, 1.0)
    assert forces.sum() == pytest.approx(1.0, rel=1e-13, abs=0.0)


TIP, HALF, EDGE_LENGTH = 9e-3, 3e-4, 2e-4


def at(offset):
    offset = np.atleast_1d(offset)
    return tip_patches(TIP - offset, offset, TIP, HALF, EDGE_LENGTH)


def test_patches_far_from_the_tip_are_the_plain_ones():
    found = at([1e-3, 4e-4])
    assert found.center == pytest.approx(TIP - np.array([1e-3, 4e-4]), rel=1e-15, abs=0.0)
    assert found.half_width.tolist() == [HALF, HALF]
    assert found.edge_share.tolist() == [0.0, 0.0]


def test_patches_never_pass_the_tip():
    found = at(np.linspace(-1e-3, 1e-3, 101))
    assert np.all(found.center + found.half_width <= TIP + 1e-15)
    assert np.all((found.edge_share >= 0.0) & (found.edge_share <= 1.0))


@pytest.mark.parametrize("offset", [HALF, 0.5 * EDGE_LENGTH])
def test_patches_change_continuously_as_a_contact_runs_out(offset):
    before, after = at(offset + 1e-12), at(offset - 1e-12)
    for name in ("center", "half_width", "edge_share", "centroid", "law_width"):
        tolerance = 1e-6 if name == "edge_share" else 1e-9
        assert getattr(after, name) == pytest.approx(getattr(before, name), abs=tolerance)


@pytest.mark.parametrize("offset", [5e-5, 0.0, -1e-4, -2e-2])
def test_edge_share_is_that_of_the_edge_pressure(offset):
    # of sqrt((c - x)/x) [phi + (x + c/2)/R] with phi = -t/R, integrated over the strip
    c, radius = EDGE_LENGTH, 6e-3
    angle = (np.arange(200) + 0.5) * math.pi / 200
    x = 0.5 * c * (1.0 - np.cos(angle))
    weight = 0.5 * c * np.sin(angle) * np.sqrt((c - x) / x)
    whole = np.sum(weight * (-offset + x + 0.5 * c) / radius)
    singular = np.sum(weight * (-offset + 0.5 * c) / radius)
    assert at(offset).edge_share[0] == pytest.approx(singular / whole, rel=1e-9, abs=0.0)


def test_centroid_is_that_of_the_nodal_forces():
    for offset in (-1e-3, -1e-5, 0.0, 5e-5):
        found = at(offset)
        forces = patch(UNIFORM, found.center[0], found.half_width[0], found.edge_share[0])
        assert forces @ UNIFORM == pytest.approx(found.centroid[0], rel=1e-12, abs=0.0)


@pytest.mark.parametrize("share", [0.0, 0.4, 0.9, 1.0])
def test_law_width_gives_the_patch_self_approach(share):
    # Mean displacement of a half-plane under the patch, weighted by the patch: -E E ln|x - y|, which is
    # -(ln a - 1/4 - ln 2) for a semi-ellipse. With u = cos of an angle both densities are polynomials over
    # Chebyshev's weight, where -ln|u - v| = ln 2 + sum 2/n T_n(u) T_n(v).
    angle = (np.arange(4000) + 0.5) * math.pi / 4000
    density = ((1.0 - share) * 2.0 * np.sin(angle) ** 2 + share * (1.0 + np.cos(angle))) / math.pi
    weight = density * math.pi / 4000
    series = sum(2.0 / n * (weight @ np.cos(n * angle)) ** 2 for n in range(1, 12))
    half = 1.3e-4
    mean = math.log(2.0) + series - math.log(half)
    patches = Patches(np.array([0.0]), np.array([half]), np.array([share]))
    assert -(math.log(patches.law_width[0]) - 0.25 - math.log(2.0)) == pytest.approx(mean, rel=1e-12, abs=0.0)


@pytest.mark.parametrize("slope", [0.2, 0.01, 1e-3, 0.0, -1e-3, -5e-3])
def test_patches_at_an_edge_are_as_long_as_the_strip(slope):
    load, modulus, radius = 1e5, 115e9, 30e-3
    rule = PatchRule(half_width=1e-3, edge_length=1e-9, edge_load=4.0 * load / (math.pi * modulus))
    found = rule.lengths(np.array(-slope * radius), np.array(radius))
    strip = float(edge_contact_length(load, slope, radius, modulus))
    assert float(found) == pytest.approx(strip, rel=1e-9, abs=0.0)


def test_patches_at_an_edge_keep_their_bounds():
    rule = PatchRule(half_width=3e-4, edge_length=5e-5, edge_load=1e-5)
    lengths = rule.lengths(np.array([-1.0, 0.0, 1.0]), np.array([1e-2, 10.0, 1e-2]))
    assert lengths.tolist() == [5e-5, 6e-4, 6e-4]


def test_a_contact_hangs_on_the_edge_from_the_patch_that_reaches_it_to_the_edge_itself():
    hang = at([0.5 * EDGE_LENGTH, 0.25 * EDGE_LENGTH, 0.0, -1e-4]).at_edge
    assert hang[0] == 0.0 and 0.0 < hang[1] < 1.0
    assert hang[2:] == pytest.approx([1.0, 1.0], rel=1e-12)
