"""Meshes of gears with rim, web and hub: nothing missing, nothing too much."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fe_contact.errors import InputError
from fe_contact.geometry import Gear, GearBlank
from fe_contact.mesh import MeshRecipe, SectorRecipe, mesh_gear, quad_sector, swept_sector
from fe_contact.mesh.swept_sector import SweptSector, _inner_breaks, _layers_across

SOLID = Gear(teeth=30, normal_module=4e-3, face_width=40e-3, bore_diameter=30e-3)
BLANK = GearBlank(rim_thickness=10e-3, web_thickness=9e-3, hub_diameter=50e-3, web_offset=4e-3)
WEBBED = replace(SOLID, blank=BLANK)
DRAFT = SectorRecipe.draft(SOLID)


@pytest.mark.parametrize("breaks", [(-3e-3,), (-10e-3, 10e-3), (3e-3, 4e-3), (-19.9e-3, 1e-3)])
@pytest.mark.parametrize("group", [1, 2])
def test_groups_of_layers_end_at_the_breaks(breaks: tuple[float, ...], group: int) -> None:
    layers = _layers_across(40e-3, 8, group, 1.5, breaks)
    assert (layers.ends[0], layers.ends[-1]) == (-20e-3, 20e-3)
    assert np.diff(layers.ends) == pytest.approx(layers.thickness[layers.kind], rel=1e-9)
    for z in breaks:
        assert np.abs(layers.ends[::group] - z).min() < 1e-15
    assert (layers.kind.reshape(-1, group) == layers.kind[::group, None]).all()
    mirrored = _layers_across(40e-3, 8, group, 1.5, [-z for z in breaks[::-1]])
    assert mirrored.ends == pytest.approx(-layers.ends[::-1], abs=1e-15)
    # Nowhere coarser than without breaks.
    assert np.diff(layers.ends).max() < 1.3 * np.diff(_layers_across(40e-3, 8, group, 1.5).ends).max()


def test_breaks_at_the_ends_and_twice_the_same_are_none() -> None:
    assert _inner_breaks((-20e-3, 5e-3, 5e-3 + 1e-6, 20e-3 - 1e-6), 40e-3) == (5e-3,)
    assert _inner_breaks((-20e-3, 20e-3), 40e-3) == ()


def test_half_a_face_is_half_of_the_web() -> None:
    middle = replace(WEBBED, blank=replace(BLANK, web_offset=0.0))
    recipe = replace(DRAFT, merge_rows=(), half_face=True)
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
def test_the_web_takes_away_what_the_drawing_takes_away(rows: tuple[int, ...]) -> None:
    recipe = replace(DRAFT, merge_rows=rows)
    section = quad_sector(WEBBED, recipe)
    areas = section_areas(section.points, section.grid.quads)
    solid, webbed = (swept_sector(section.grid, 40e-3, recipe, web=web) for web in (None, WEBBED.web))
    ring = math.pi * (WEBBED.web.outer_radius**2 - 25e-3**2) / 30  # type: ignore[union-attr]
    missing = volume(solid, areas) - volume(webbed, areas)
    assert missing == pytest.approx(ring * (40e-3 - 9e-3), rel=1e-5)
    assert webbed.elements.min() >= 0
    assert np.unique(webbed.elements).size == webbed.nodes.max() + 1
    numbers = np.concatenate([batch.elements.ravel() for batch in webbed.batches])
    assert sorted(numbers) == list(range(len(webbed.elements)))
    assert len(webbed.left) == len(webbed.right) < len(solid.left) * 1.3


def test_rows_of_elements_end_at_rim_and_hub() -> None:
    grid = (section := quad_sector(WEBBED, DRAFT)).grid
    low, high = grid.web_rows
    radii = np.linalg.norm(section.points[grid.number[:, 0][: 2 * grid.body_rows + 1]], axis=1)
    assert radii[2 * (grid.body_rows + high)] == pytest.approx(WEBBED.web.outer_radius, rel=1e-12)  # type: ignore[union-attr]
    assert radii[2 * (grid.body_rows + low)] == pytest.approx(25e-3, rel=1e-12)
    assert radii[0] == pytest.approx(15e-3, rel=1e-12)
    assert quad_sector(SOLID, DRAFT).grid.web_rows == (0, 0)


def test_a_web_of_full_width_has_the_nodes_of_a_solid_body() -> None:
    grid = quad_sector(WEBBED, DRAFT).grid
    full = replace(WEBBED.web, low=-20e-3, high=20e-3)  # type: ignore[type-var]
    solid, webbed = (swept_sector(grid, 40e-3, DRAFT, web=web) for web in (None, full))
    assert webbed.size == solid.size
    assert len(webbed.elements) == len(solid.elements)
    assert np.array_equal(webbed.layers.ends, solid.layers.ends)


@pytest.mark.parametrize("hub", [None, 50e-3])
@pytest.mark.parametrize("real", [None, 5])
def test_plane_elements_are_as_thick_as_their_ring(hub: float | None, real: int | None) -> None:
    gear = replace(SOLID, blank=replace(BLANK, hub_diameter=hub, web_offset=0.0))
    recipe = replace(MeshRecipe.standard(gear), flank_size=0.4e-3, real_teeth=real)
    mesh = mesh_gear(gear, recipe)
    assert mesh.hub is not None
    points = mesh.hub.points[mesh.hub.triangles]
    radius = np.linalg.norm(points[:, :3].mean(axis=1), axis=1)
    web = gear.web
    assert web is not None
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
