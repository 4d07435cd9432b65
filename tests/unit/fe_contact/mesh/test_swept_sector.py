"""Layers and numbering of a swept tooth sector, and meshes of gears with rim, web and hub."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fe_contact.errors import InputError
from fe_contact.geometry import Gear, GearBlank
from fe_contact.mesh import (
    ClampedBore,
    MeshRecipe,
    PlaneStrain,
    SectorRecipe,
    mesh_gear,
    quad_sector,
    swept_sector,
)
from fe_contact.mesh.face_layers import layers_across, layers_to_mid_face
from fe_contact.mesh.sector_grid import SectorGrid
from fe_contact.mesh.swept_sector import SweptSector, inner_breaks

SPUR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
GRID = SectorGrid(body_rows=4, tooth_rows=3, land=1, across=2)
DRAFT = SectorRecipe.draft(SPUR)


@pytest.mark.parametrize(
    ("count", "group", "growth"), [(1, 1, 1.5), (2, 2, 1.5), (8, 2, 1.5), (18, 2, 1.5), (12, 4, 2.0)]
)
def test_layers_fill_the_face_symmetrically(count, group, growth):
    layers = layers_across(25e-3, count, group, growth)
    assert (layers.ends[0], layers.ends[-1]) == (-12.5e-3, 12.5e-3)
    assert np.array_equal(layers.ends, -layers.ends[::-1])
    assert np.diff(layers.ends) == pytest.approx(layers.thickness[layers.kind], rel=1e-12)
    assert np.array_equal(
        layers.kind.reshape(-1, group), np.repeat(layers.kind[::group, None], group, axis=1)
    )
    if count // group > 2:
        assert np.diff(layers.ends).max() / np.diff(layers.ends)[0] == pytest.approx(growth)


def test_half_a_face_slides_on_mid_face_and_is_finest_at_its_end():
    layers = layers_to_mid_face(25e-3, 3, 8.0)
    assert (layers.ends[0], layers.ends[-1]) == (0.0, 12.5e-3)
    thickness = np.diff(layers.ends)
    assert thickness == pytest.approx(layers.thickness[layers.kind], rel=1e-12)
    assert thickness[:-1] / thickness[1:] == pytest.approx(8.0**0.5)
    recipe = replace(DRAFT, layers=2, merge_rows=())
    half = swept_sector(GRID, 25e-3, replace(recipe, half_face=True))
    whole = swept_sector(GRID, 25e-3, recipe)
    middle = half.nodes[0, half.nodes[0] >= 0]
    free = whole.freedoms[middle] >= 0
    assert np.array_equal(half.freedoms[middle] >= 0, free & [True, True, False])
    above = np.setdiff1d(np.arange(len(half.freedoms)), middle)
    assert np.array_equal(half.freedoms[above] >= 0, whole.freedoms[above] >= 0)


def test_nodes_are_where_serendipity_elements_have_them():
    sector = swept_sector(GRID, 25e-3, replace(DRAFT, layers=2, merge_rows=()))
    corners = GRID.corner.sum()
    assert sector.nodes.max() + 1 == 3 * GRID.nodes + 2 * corners
    assert len(sector.elements) == 2 * len(GRID.quads)
    assert np.unique(sector.elements).size == sector.nodes.max() + 1
    held = len(GRID.bore) * 3 + (len(GRID.bore) + 1) // 2 * 2
    assert sector.size == 3 * (sector.nodes.max() + 1 - held)
    bottom_middle = sector.elements[0, 8:12]
    assert np.array_equal(bottom_middle, sector.nodes[0, GRID.quads[0, 4:]])
    assert np.array_equal(sector.elements[0, 16:], sector.nodes[1, GRID.quads[0, :4]])


@pytest.mark.parametrize("rows", [(-1,), (-2,), (-1, -3)])
def test_merged_layers_leave_no_node_of_their_own(rows):
    whole = swept_sector(GRID, 25e-3, replace(DRAFT, layers=8, merge_rows=()))
    merged = swept_sector(GRID, 25e-3, replace(DRAFT, layers=8, merge_rows=rows))
    assert merged.elements.min() >= 0
    assert np.unique(merged.elements).size == merged.nodes.max() + 1
    assert merged.size < whole.size
    elements = 0
    for row in GRID.cells[:, 1]:
        elements += 8 >> sum(row < r for r in rows)
    assert len(merged.elements) == elements
    assert sorted(np.concatenate([b.elements.ravel() for b in merged.batches])) == list(range(elements))
    # Each coarse layer carries one lower and one upper thin one.
    halves = [b.half for b in merged.batches for _ in b.elements]
    assert halves.count(-1) == halves.count(1) == sum(4 >> i for i in range(len(rows)))


def test_cuts_and_flank_name_matching_freedoms():
    sector = swept_sector(GRID, 25e-3, replace(DRAFT, layers=4))
    node_of = np.full(sector.size, -1)
    free = sector.freedoms >= 0
    node_of[sector.freedoms[free]] = np.nonzero(free)[0]
    plane_and_column = {n: (p, c) for p, c in np.argwhere(sector.nodes >= 0) for n in [sector.nodes[p, c]]}
    for left, right in zip(sector.left, sector.right, strict=True):
        (p, c), (q, d) = plane_and_column[node_of[left]], plane_and_column[node_of[right]]
        assert p == q
        assert list(GRID.left).index(c) == list(GRID.right).index(d)
    index = sector.flank_index
    assert (index[1::2, 1::2] == -1).all()
    assert sorted(index[index >= 0]) == list(range(len(sector.flank)))
    p, c = np.argwhere(index == 5)[0]
    assert sector.flank[5] == sector.freedoms[sector.nodes[p, GRID.flank[c]], 0]


def test_supports_hold_what_they_say_and_recipes_follow_the_gear():
    recipe = replace(DRAFT, layers=1, merge_rows=())
    clamped = swept_sector(GRID, 1e-3, recipe, ClampedBore())
    strain = swept_sector(GRID, 1e-3, recipe, PlaneStrain())
    bore = clamped.nodes[:, GRID.bore]
    assert (clamped.freedoms[bore[bore >= 0]] == -1).all()
    assert clamped.size % 3 == 0
    assert strain.size == clamped.size // 3 * 2
    assert (strain.freedoms[:, 2] == -1).all()
    helical, wide = replace(SPUR, helix_angle=0.3), replace(SPUR, face_width=80e-3)
    assert (
        SectorRecipe.draft(SPUR).layers,
        SectorRecipe.standard(SPUR).layers,
        SectorRecipe.fine(SPUR).layers,
    ) == (8, 12, 18)
    assert SectorRecipe.standard(helical).layers == 16
    assert SectorRecipe.standard(wide).layers == 20
    # A helical body keeps at least six layers.
    for recipe in (SectorRecipe.draft(helical), SectorRecipe.standard(helical), SectorRecipe.fine(helical)):
        assert recipe.layers // recipe.layer_group >= 6
    assert SectorRecipe.draft(SPUR).content() != SectorRecipe.standard(SPUR).content()
    assert SectorRecipe.draft(SPUR).content() == SectorRecipe.draft(SPUR).content()


SOLID = Gear(teeth=30, normal_module=4e-3, face_width=40e-3, bore_diameter=30e-3)
BLANK = GearBlank(rim_thickness=10e-3, web_thickness=9e-3, hub_diameter=50e-3, web_offset=4e-3)
WEBBED = replace(SOLID, blank=BLANK)
WEB_DRAFT = SectorRecipe.draft(SOLID)


@pytest.mark.parametrize("breaks", [(-3e-3,), (-10e-3, 10e-3), (3e-3, 4e-3), (-19.9e-3, 1e-3)])
@pytest.mark.parametrize("group", [1, 2])
def test_groups_of_layers_end_at_the_breaks(breaks, group):
    layers = layers_across(40e-3, 8, group, 1.5, breaks)
    assert (layers.ends[0], layers.ends[-1]) == (-20e-3, 20e-3)
    assert np.diff(layers.ends) == pytest.approx(layers.thickness[layers.kind], rel=1e-9)
    for z in breaks:
        assert np.abs(layers.ends[::group] - z).min() < 1e-15
    assert (layers.kind.reshape(-1, group) == layers.kind[::group, None]).all()
    mirrored = layers_across(40e-3, 8, group, 1.5, [-z for z in breaks[::-1]])
    assert mirrored.ends == pytest.approx(-layers.ends[::-1], abs=1e-15)
    # Nowhere coarser than without breaks.
    assert np.diff(layers.ends).max() < 1.3 * np.diff(layers_across(40e-3, 8, group, 1.5).ends).max()


def test_half_a_face_is_half_of_the_web():
    middle = replace(WEBBED, blank=replace(BLANK, web_offset=0.0))
    recipe = replace(WEB_DRAFT, merge_rows=(), half_face=True)
    grid = quad_sector(middle, recipe).grid
    half = swept_sector(grid, 40e-3, recipe, web=middle.web)
    assert (half.layers.ends[0], half.layers.ends[-1]) == pytest.approx((0.0, 20e-3), abs=1e-15)
    assert np.abs(half.layers.ends - 4.5e-3).min() < 1e-15
    on_bore, web_row = grid.number[0, 0], grid.number[2 * (grid.body_rows + grid.web_rows[0]) + 1, 0]
    top = [half.layers.ends[np.flatnonzero(half.nodes[:, n] >= 0).max() // 2] for n in (on_bore, web_row)]
    assert top == pytest.approx([20e-3, 4.5e-3], rel=1e-12)
    with pytest.raises(InputError) as refusal:
        swept_sector(grid, 40e-3, recipe, web=WEBBED.web)
    assert refusal.value.field == "half_face"


def section_areas(points: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Areas of eight-node quadrilaterals: x dy - y dx over their quadratic sides."""
    area = np.zeros(len(quads))
    t, weight = np.polynomial.legendre.leggauss(3)
    for a, (b, m) in enumerate([(1, 4), (2, 5), (3, 6), (0, 7)]):
        start, middle, end = (points[quads[:, i]] for i in (a, m, b))
        for x, w in zip(t, weight, strict=True):
            at = 0.5 * x * (x - 1) * start + (1 - x * x) * middle + 0.5 * x * (x + 1) * end
            slope = (x - 0.5) * start - 2 * x * middle + (x + 0.5) * end
            area += 0.5 * w * (at[:, 0] * slope[:, 1] - at[:, 1] * slope[:, 0])
    return area


def volume(sector: SweptSector, areas: np.ndarray) -> float:
    """Volume of all elements; those that hang on a coarse face do so exactly (spur)."""
    return float(
        sum(batch.thickness * areas[batch.quads].sum() * len(batch.elements) for batch in sector.batches)
    )


@pytest.mark.parametrize("rows", [(), (-1,), (-2,), (-3, -6)])
def test_the_web_takes_away_what_the_drawing_takes_away(rows):
    recipe = replace(WEB_DRAFT, merge_rows=rows)
    section = quad_sector(WEBBED, recipe)
    areas = section_areas(section.points, section.grid.quads)
    solid, webbed = (swept_sector(section.grid, 40e-3, recipe, web=web) for web in (None, WEBBED.web))
    ring = math.pi * (WEBBED.web.outer_radius**2 - 25e-3**2) / 30
    missing = volume(solid, areas) - volume(webbed, areas)
    assert missing == pytest.approx(ring * (40e-3 - 9e-3), rel=1e-5)
    assert webbed.elements.min() >= 0
    assert np.unique(webbed.elements).size == webbed.nodes.max() + 1
    numbers = np.concatenate([batch.elements.ravel() for batch in webbed.batches])
    assert sorted(numbers) == list(range(len(webbed.elements)))
    assert len(webbed.left) == len(webbed.right) < len(solid.left) * 1.3


def test_rows_of_elements_end_at_rim_and_hub_of_a_web_of_any_width():
    grid = (section := quad_sector(WEBBED, WEB_DRAFT)).grid
    low, high = grid.web_rows
    radii = np.linalg.norm(section.points[grid.number[:, 0][: 2 * grid.body_rows + 1]], axis=1)
    assert radii[2 * (grid.body_rows + high)] == pytest.approx(WEBBED.web.outer_radius, rel=1e-12)
    assert radii[2 * (grid.body_rows + low)] == pytest.approx(25e-3, rel=1e-12)
    assert radii[0] == pytest.approx(15e-3, rel=1e-12)
    assert quad_sector(SOLID, WEB_DRAFT).grid.web_rows == (0, 0)
    grid = quad_sector(WEBBED, WEB_DRAFT).grid
    full = replace(WEBBED.web, low=-20e-3, high=20e-3)
    solid, webbed = (swept_sector(grid, 40e-3, WEB_DRAFT, web=web) for web in (None, full))
    assert webbed.size == solid.size
    assert len(webbed.elements) == len(solid.elements)
    assert np.array_equal(webbed.layers.ends, solid.layers.ends)
    assert inner_breaks((-20e-3, 5e-3, 5e-3 + 1e-6, 20e-3 - 1e-6), 40e-3) == (5e-3,)
    assert inner_breaks((-20e-3, 20e-3), 40e-3) == ()


@pytest.mark.parametrize("hub", [None, 50e-3])
@pytest.mark.parametrize("real", [None, 5])
def test_plane_elements_are_as_thick_as_their_ring(hub, real):
    gear = replace(SOLID, blank=replace(BLANK, hub_diameter=hub, web_offset=0.0))
    recipe = replace(MeshRecipe.standard(gear), flank_size=0.4e-3, real_teeth=real)
    mesh = mesh_gear(gear, recipe)
    points = mesh.hub.points[mesh.hub.triangles]
    radius = np.linalg.norm(points[:, :3].mean(axis=1), axis=1)
    web = gear.web
    inside = (radius < web.outer_radius) & (radius > web.inner_radius)
    assert mesh.hub.thickness[inside] == pytest.approx(9.0 / 40.0, rel=1e-12)
    assert (mesh.hub.thickness[~inside] == 1.0).all()
    # No element straddles a circle, and the web is a whole ring.
    corner_radius = np.linalg.norm(points[:, :3], axis=2)
    for circle in (web.outer_radius, web.inner_radius):
        assert (
            (corner_radius < circle - 1e-9).any(axis=1) & (corner_radius > circle + 1e-9).any(axis=1)
        ).sum() == 0
    sides = [points[:, [a, m, b]] for a, b, m in ((0, 1, 3), (1, 2, 4), (2, 0, 5))]
    area = np.zeros(len(points))
    t, weight = np.polynomial.legendre.leggauss(3)
    for side in sides:
        for x, w in zip(t, weight, strict=True):
            at = np.einsum("i,mic->mc", [0.5 * x * (x - 1), 1 - x * x, 0.5 * x * (x + 1)], side)
            slope = np.einsum("i,mic->mc", [x - 0.5, -2 * x, x + 0.5], side)
            area += 0.5 * w * (at[:, 0] * slope[:, 1] - at[:, 1] * slope[:, 0])
    assert area[inside].sum() == pytest.approx(
        math.pi * (web.outer_radius**2 - web.inner_radius**2), rel=1e-4
    )
    # Nodes are shared: every inner edge has two triangles.
    edges = np.sort(np.concatenate([mesh.triangles[:, [a, b]] for a, b in pairwise((0, 1, 2, 0))]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    free = int((count == 1).sum())
    outline = len(mesh.bore_nodes) // 2
    assert free > outline
    assert count.max() == 2
    euler = len(np.unique(mesh.triangles[:, :3])) - len(count) + len(mesh.triangles)
    assert euler == 0  # a ring
