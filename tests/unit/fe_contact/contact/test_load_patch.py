"""Load patches: nodal forces along the profile and over the face, and the pressure of their strips."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hertz_laws import edge_contact_length
from scipy.special import j1

from fe_contact.contact import PatchRule, contact_pressure
from fe_contact.contact.face_patch import (
    FaceGrid,
    FaceLoads,
    add_compliance,
    face_loads,
    means_and_differences,
)
from fe_contact.contact.patch import Patches, load_vector, tip_patches
from fe_contact.contact.strip import Gap
from fe_contact.hertz import STRIP_DISTANCE, half_width, lateral_share, peak_pressure


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


def test_a_patch_at_the_tip_edge_carries_all_of_its_load():
    # its end is beside the last node by rounding: a singular load went with the root of that, 1e-8 of it
    tip = UNIFORM[-1]
    for half in np.random.default_rng(3).uniform(1e-5, 1e-3, 200):
        assert patch(UNIFORM, tip - half, half, 1.0).sum() == pytest.approx(1.0, rel=1e-13, abs=0.0)


def test_a_field_is_weighed_alike_on_every_mesh_and_wherever_the_patch_is():
    def work(nodes, center):
        return patch(nodes, center, 3e-4) @ np.cos(500.0 * nodes)

    assert work(UNIFORM, 5.123e-3) == pytest.approx(work(GRADED, 5.123e-3), rel=2e-6, abs=0.0)
    k, half = 500.0, 3e-4
    places = np.linspace(5.0e-3, 5.2e-3, 41)
    found = np.array([patch(UNIFORM, s, half) @ np.cos(k * UNIFORM) for s in places])
    exact = np.cos(k * places) * 2.0 * j1(k * half) / (k * half)
    assert np.max(np.abs(found - exact)) < 2e-6


@MESHES
def test_only_the_touched_elements_carry_and_mirrors_are_alike(nodes):
    out = np.zeros(nodes.size)
    first, last = load_vector(nodes, 5e-3, 3e-4, 0.0, out)
    ends = nodes[::2]
    touched = (ends[1:] > 4.7e-3) & (ends[:-1] < 5.3e-3)
    assert first == 2 * np.flatnonzero(touched)[0]
    assert last == 2 * np.flatnonzero(touched)[-1] + 3
    mirrored = (nodes[-1] - nodes)[::-1].copy()
    forces = patch(nodes, 3.3e-3, 4e-4)
    assert patch(mirrored, nodes[-1] - 3.3e-3, 4e-4)[::-1] == pytest.approx(forces, abs=1e-13)


def test_entries_outside_the_range_are_left_alone():
    out = np.full(UNIFORM.size, np.nan)
    first, last = load_vector(UNIFORM, 5e-3, 3e-4, 0.0, out)
    assert np.isnan(out[:first]).all()
    assert np.isnan(out[last:]).all()
    assert np.isfinite(out[first:last]).all()
    tip = UNIFORM[-1]
    forces = patch(UNIFORM, tip - 2e-4, 2e-4, 1.0)
    assert forces.sum() == pytest.approx(1.0, rel=1e-13, abs=0.0)


TIP, HALF, EDGE_LENGTH = 9e-3, 3e-4, 2e-4


def at(offset):
    offset = np.atleast_1d(offset)
    return tip_patches(TIP - offset, offset, TIP, HALF, EDGE_LENGTH)


def test_patches_are_plain_far_from_the_tip_and_hang_on_its_edge():
    found = at([1e-3, 4e-4])
    assert found.center == pytest.approx(TIP - np.array([1e-3, 4e-4]), rel=1e-15, abs=0.0)
    assert found.half_width.tolist() == [HALF, HALF]
    assert found.edge_share.tolist() == [0.0, 0.0]
    found = at(np.linspace(-1e-3, 1e-3, 101))
    assert np.all(found.center + found.half_width <= TIP + 1e-15)
    assert np.all((found.edge_share >= 0.0) & (found.edge_share <= 1.0))
    for offset in (-1e-3, -1e-5, 0.0, 5e-5):
        found = at(offset)
        forces = patch(UNIFORM, found.center[0], found.half_width[0], found.edge_share[0])
        assert forces @ UNIFORM == pytest.approx(found.centroid[0], rel=1e-12, abs=0.0)
    hang = at([0.5 * EDGE_LENGTH, 0.25 * EDGE_LENGTH, 0.0, -1e-4]).at_edge
    assert hang[0] == 0.0 and 0.0 < hang[1] < 1.0
    assert hang[2:] == pytest.approx([1.0, 1.0], rel=1e-12)
    rule = PatchRule(half_width=3e-4, edge_length=5e-5, edge_load=1e-5)
    lengths = rule.lengths(np.array([-1.0, 0.0, 1.0]), np.array([1e-2, 10.0, 1e-2]))
    assert lengths.tolist() == [5e-5, 6e-4, 6e-4]


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


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_mean_distance_of_two_points_of_the_load(share):
    """Of independent points with the distribution F it is the integral of 2 F (1 - F)."""
    angle = (np.arange(20_000) + 0.5) * math.pi / 20_000 - 0.5 * math.pi
    density = (1.0 - share) * 2.0 * np.cos(angle) ** 2 + share * (1.0 + np.sin(angle))
    distribution = np.cumsum(density) / 20_000 - 0.5 * density / 20_000
    mean = np.sum(2.0 * distribution * (1.0 - distribution) * np.cos(angle)) * math.pi / 20_000
    patches = Patches(np.array([0.0]), np.array([3e-4]), np.array([share]))
    assert patches.mean_distance[0] == pytest.approx(3e-4 * mean, rel=1e-6, abs=0.0)


@pytest.mark.parametrize("poissons_ratio", [0.0, 0.3, 0.45])
def test_patch_on_a_disc_moves_as_its_law_width_says(poissons_ratio):
    """Pressures p_n cos(n t) push the rim of a disc in by p_n R/(2 mu) (2 (1 - nu) n - (1 - 2 nu))/(n^2 - 1).

    Two patches under one load then differ by k ln of their law widths, up to the square of width over R.
    """
    radius, order = 10e-3, np.arange(2.0, 400_000.0)
    widths = np.array([1e-5, 5e-5])

    def approach(half):
        wave = order * half / radius
        along = np.square(2.0 * j1(wave) / wave)  # a semi-ellipse pushes, and weighs what it moves
        yielding = 2.0 * (1.0 - poissons_ratio) * order - (1.0 - 2.0 * poissons_ratio)
        return np.sum(along * yielding / (order**2 - 1.0)) / (2.0 * math.pi)  # times P/mu

    bulge = lateral_share(poissons_ratio) / radius
    patches = Patches(np.zeros(2), widths, np.zeros(2), bulge=bulge)
    law = np.log(patches.law_width[1] / patches.law_width[0]) * (1.0 - poissons_ratio) / math.pi
    difference = approach(widths[0]) - approach(widths[1])
    assert difference == pytest.approx(law, rel=0.0, abs=0.5 * (widths[1] / radius) ** 2)


def test_a_strip_whose_normals_turn_gives_way_by_its_mean_distance():
    """Hertz by boundary elements whose points also move by epsilon |x - y|, as on surfaces with one normal.

    The approach changes by epsilon p STRIP_DISTANCE half-widths, to first order.
    """
    count, radius, p = 400, 1.0, 0.02
    half = math.sqrt(2.0 * p * radius)  # k = 1, so that E* = 2/pi
    ends = 1.2 * half * np.sin(np.linspace(-0.5, 0.5, count + 1) * np.pi)
    middle, width = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)
    a, b = middle[:, None] - ends[None, :-1], middle[:, None] - ends[None, 1:]
    logarithm = -(a * np.log(np.abs(a)) - a - b * np.log(np.abs(b)) + b)
    distance = np.abs(middle[:, None] - middle) * width

    def approach(epsilon):
        kernel, active = logarithm + epsilon * distance, np.ones(count, dtype=bool)
        while True:
            inside = kernel[np.ix_(active, active)]
            pressed = np.linalg.solve(
                np.block([[inside, -np.ones((active.sum(), 1))], [width[active][None], np.zeros((1, 1))]]),
                np.append(-0.5 * middle[active] ** 2 / radius, p),
            )
            if pressed[:-1].min() >= 0.0:
                return pressed[-1]
            active[np.flatnonzero(active)[pressed[:-1] < 0.0]] = False

    step = 1e-3 / half
    rate = (approach(step) - approach(-step)) / (2.0 * step)
    assert rate == pytest.approx(STRIP_DISTANCE * half * p, rel=0.01)


@pytest.mark.parametrize("slope", [0.2, 0.01, 1e-3, 0.0, -1e-3, -5e-3])
def test_patches_at_an_edge_are_as_long_as_the_strip(slope):
    load, modulus, radius = 1e5, 115e9, 30e-3
    rule = PatchRule(half_width=1e-3, edge_length=1e-9, edge_load=4.0 * load / (math.pi * modulus))
    found = rule.lengths(np.array(-slope * radius), np.array(radius))
    strip = float(edge_contact_length(load, slope, radius, modulus))
    assert float(found) == pytest.approx(strip, rel=1e-9, abs=0.0)


def grid(profile: int = 6, layers: int = 4) -> FaceGrid:
    ends = np.array([0.0, *np.cumsum(np.linspace(1.0, 2.0, profile))])
    s = np.sort(np.concatenate([ends, 0.5 * (ends[1:] + ends[:-1])])) * 1e-3
    z = np.linspace(-1.0, 1.0, layers + 1) ** 3 * 0.3e-2 + np.linspace(-1.0, 1.0, layers + 1) * 0.7e-2
    planes, nodes = np.meshgrid(np.arange(2 * layers + 1), np.arange(2 * profile + 1), indexing="ij")
    freedom = np.where((planes % 2 == 1) & (nodes % 2 == 1), -1, 0)
    freedom[freedom == 0] = np.arange(np.count_nonzero(freedom == 0))
    return FaceGrid(s, z, freedom)


def coordinates(mesh: FaceGrid) -> np.ndarray:
    planes = np.sort(np.concatenate([mesh.z, 0.5 * (mesh.z[1:] + mesh.z[:-1])]))
    where = np.array([np.argwhere(mesh.freedom == k)[0] for k in range(mesh.freedom.max() + 1)])
    return np.column_stack([mesh.s[where[:, 1]], planes[where[:, 0]]])


def loads_of(mesh: FaceGrid, *patches: tuple[float, float, float, float, float]) -> FaceLoads:
    center, half_width, share, low, high = (np.array(column) for column in zip(*patches, strict=True))
    return face_loads(mesh, center[:, None], half_width[:, None], share[:, None], low, high)


def dense(mesh: FaceGrid, *patches: tuple[float, float, float, float, float]) -> np.ndarray:
    loads = loads_of(mesh, *patches)
    result = np.zeros((len(patches), mesh.freedom.max() + 1))
    for p in range(len(patches)):
        used = loads.used[p]
        np.add.at(result[p], loads.nodes[p, :used], loads.forces[p, :used])
    return result


PATCHES = [
    (4e-3, 1e-3, 0.0, -2e-3, 1e-3),
    (2.5e-3, 0.3e-3, 0.0, 0.1e-3, 0.2e-3),
    (8.5e-3, 0.5e-3, 0.7, -1e-2, 1e-2),
    (8.0e-3, 1.0e-3, 1.0, 3e-3, 1e-2),
]


@pytest.mark.parametrize("box", PATCHES)
def test_resultant_and_moments(box):
    """Quadratic shape functions carry constants, first moments and pure second moments exactly."""
    mesh = grid()
    center, a, share, low, high = box
    force, (s, z) = dense(mesh, box)[0], coordinates(mesh).T
    assert force.sum() == pytest.approx(1.0, abs=1e-12)
    assert force @ s == pytest.approx(center + 0.5 * share * a, rel=1e-12, abs=0.0)
    assert force @ z == pytest.approx(0.5 * (low + high), rel=1e-11, abs=1e-16)
    assert force @ z**2 == pytest.approx((high**3 - low**3) / (high - low) / 3.0, rel=1e-11, abs=0.0)
    variance = a**2 * (1.0 + share) / 4.0  # of the mixture about the patch's middle
    assert force @ (s - center) ** 2 == pytest.approx(variance, rel=1e-9, abs=0.0)


def test_boxes_over_the_face_add_up_and_follow_their_contact_line():
    mesh = grid()
    box = (4e-3, 1e-3, 0.3, mesh.z[0], mesh.z[-1])
    plane = np.zeros(mesh.s.size)
    first, last = load_vector(mesh.s, *box[:3], plane)
    plane[:first] = plane[last:] = 0.0
    force = dense(mesh, box)[0]
    # on the corner profile nodes and mid-side nodes of linear functions of s both must agree
    assert force @ coordinates(mesh)[:, 0] == pytest.approx(plane @ mesh.s, rel=1e-13)
    assert force @ coordinates(mesh)[:, 0] ** 2 == pytest.approx(plane @ mesh.s**2, rel=1e-12)
    whole = dense(mesh, (4e-3, 1e-3, 0.0, -4e-3, 6e-3))[0]
    parts = dense(mesh, (4e-3, 1e-3, 0.0, -4e-3, -1e-3), (4e-3, 1e-3, 0.0, -1e-3, 6e-3))
    assert 0.3 * parts[0] + 0.7 * parts[1] == pytest.approx(whole, abs=1e-14)
    centers, half, share = (
        np.array([[3e-3, 3.4e-3, 3.8e-3]]),
        np.full((1, 3), 1e-3),
        np.array([[0.0, 0.2, 0.4]]),
    )
    loads = face_loads(mesh, centers, half, share, np.array([-3e-3]), np.array([6e-3]))
    found = np.zeros(mesh.freedom.max() + 1)
    np.add.at(found, loads.nodes[0, : loads.used[0]], loads.forces[0, : loads.used[0]])
    bounds = ((-3e-3, 0.0), (0.0, 3e-3), (3e-3, 6e-3))
    parts = dense(mesh, *((centers[0, q], 1e-3, share[0, q], *bounds[q]) for q in range(3)))
    assert found == pytest.approx(parts.mean(axis=0), abs=1e-15)


@pytest.mark.parametrize("teeth", [[0, 0, 0, 0], [-1, -1, 0, 1], [2, 1, 0, -1]])
def test_compliance_is_the_double_product(teeth):
    mesh = grid()
    rng = np.random.default_rng(3)
    freedoms = mesh.freedom.max() + 1
    blocks = rng.normal(size=(3, freedoms, freedoms))
    blocks[0] += blocks[0].T
    moved = [
        (c + 2e-4, *rest) for c, *rest in PATCHES[:3]
    ]  # at the second position; the last slice is not there
    loads = loads_of(mesh, *PATCHES, *moved)
    lever = np.array([[1.0, 0.9, 1.0, 0.8], [1.1, 0.7, 1.0, 0.6]])
    found = np.zeros((2, 4, 4))
    order = mesh.freedom.ravel()
    at = np.array([[0, 0, 0, 0, 1, 1, 1], [0, 1, 2, 3, 0, 1, 2]])
    add_compliance(blocks, order[order >= 0], np.array(teeth), loads, at, lever, found)
    forces = np.zeros((2, 4, freedoms))
    forces[0], forces[1, :3] = dense(mesh, *PATCHES), dense(mesh, *moved)
    forces *= lever[:, :, None]
    assert np.array_equal(found, found.transpose(0, 2, 1))
    for force, compliance in zip(forces, found, strict=True):
        for i in range(4):
            for j in range(4):
                apart = teeth[i] - teeth[j]
                block = np.zeros_like(blocks[0])
                if abs(apart) < 3:
                    block = blocks[apart] if apart >= 0 else blocks[-apart].T
                assert compliance[i, j] == pytest.approx(force[i] @ block @ force[j], rel=1e-10, abs=1e-12)


MODULUS, RADIUS, WIDTH = 115e9, 6e-3, 25e-3
LOAD = 4000.0
FORCE = np.array([[[LOAD]]])
STRIP = float(half_width(LOAD / WIDTH, RADIUS, MODULUS))


def problem(slope=0.0, low=-math.inf, high=math.inf, place=math.inf, jump=0.0) -> SimpleNamespace:
    one = [np.array([[value]]) for value in (slope, 1.0 / RADIUS, low, high)]
    breaks = [np.array([[[value]]]) for value in (place, jump, 0.0)]

    def gap_at(places):
        return Gap(*(each[places] for each in (*one, *breaks)))

    candidates = SimpleNamespace(gap_at=gap_at, width=np.array([[WIDTH]]))
    return SimpleNamespace(candidates=candidates, modulus=MODULUS)


def pressure(**about) -> float:
    return float(contact_pressure(problem(**about), FORCE)[0][0, 0, 0])


def edge(force=None, **about) -> bool:
    force = FORCE if force is None else force
    contact = problem(**about)
    return bool(contact_pressure(contact, force)[1][0, 0, 0])


HERTZ = float(peak_pressure(LOAD / WIDTH, RADIUS, MODULUS))


def test_a_plain_flank_has_the_pressure_of_hertz_and_a_relief_in_the_strip_more():
    assert pressure() == pytest.approx(HERTZ, rel=1e-12)
    beside = [pressure(place=share * STRIP, jump=0.01) for share in (1.01, 0.5, 0.0)]
    assert beside[0] == pytest.approx(HERTZ, rel=1e-12)
    assert beside[0] < beside[1] < beside[2] < 2.0 * HERTZ


AT_EDGE = [
    {"low": 0.0, "slope": 0.1},
    {"low": -0.99 * STRIP},
    {"high": 0.99 * STRIP},
    {"place": 0.5 * STRIP, "jump": 0.5},
]
BESIDE = [{}, {"low": -1.01 * STRIP}, {"high": 1.01 * STRIP}, {"place": 0.5 * STRIP, "jump": 0.01}]


def test_a_strip_that_reaches_an_edge_or_a_chamfer_is_told_apart():
    for about in ({"low": 0.0, "slope": 0.1}, {"low": -0.3 * STRIP}, {"high": 0.0, "slope": -0.01}):
        assert pressure(**about) == pytest.approx(HERTZ, rel=1e-9)  # an edge does not count
    for about in AT_EDGE:
        assert edge(**about) and not edge(force=0.0 * FORCE, **about), about
    assert not any(edge(**about) for about in BESIDE)


def test_means_and_differences_are_those_of_the_forces_on_every_node():
    draw = np.random.default_rng(7)

    def loads(width):
        """Return loads on six slices; some use all of their numbers, some but one."""
        used = np.array([width, 1, *draw.integers(1, width, 4)])
        nodes = np.array([draw.permutation(40)[:width] for _ in used])
        beyond = np.arange(width) >= used[:, None]
        return FaceLoads(
            np.where(beyond, -1, nodes), np.where(beyond, 0.0, draw.normal(size=nodes.shape)), used
        )

    def on_nodes(given):
        forces = np.zeros((len(given.used), 40))
        for row, nodes, values, used in zip(forces, given.nodes, given.forces, given.used, strict=True):
            np.add.at(row, nodes[:used], values[:used])
        return forces

    first, second = loads(9), loads(5)
    both = on_nodes(means_and_differences(first, second, 0.25))
    assert both[::2] == pytest.approx(0.5 * (on_nodes(first) + on_nodes(second)), rel=1e-14, abs=1e-16)
    assert both[1::2] == pytest.approx(0.25 * (on_nodes(first) - on_nodes(second)), rel=1e-14, abs=1e-16)
