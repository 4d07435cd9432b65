"""Outer hull of a housing: areas of hollow boxes in closed form, rigid motion, coarse panels."""

from functools import cache

import numpy as np
import pytest
from lattice_meshes import box
from reduced_housings import bare_housing

from dynamics.acoustics import Air, ElementalRadiators, outer_hull, resistance
from dynamics.housings import TetrahedralMesh
from dynamics.housings.reduced_housing import SurfaceMotion
from dynamics.housings.rigid_body import rigid_motions
from dynamics.noise import radiating_hull
from dynamics.vibration import surface_weight

SIZE, WALL = np.array([0.36, 0.24, 0.18]), 0.02
OUTER = 2.0 * (SIZE[0] * SIZE[1] + SIZE[0] * SIZE[2] + SIZE[1] * SIZE[2])
INNER = 2.0 * sum((SIZE[i] - 2 * WALL) * (SIZE[j] - 2 * WALL) for i, j in ((0, 1), (0, 2), (1, 2)))
HOLE = 0.06


@cache
def housing_of(opening: str):
    """A box with walls of 20 mm: closed, with four square bores in its cover and floor, without a cover."""
    mesh = box(tuple(SIZE), tuple(np.round(SIZE / WALL).astype(int)))
    middle = mesh.points[mesh.tetrahedra[:, :4]].mean(axis=1)
    removed = np.all((middle > WALL) & (middle < SIZE - WALL), axis=1)
    if opening == "bores":
        near = [np.all(np.abs(middle[:, :2] - [x, 0.11]) < HOLE / 2.0, axis=1) for x in (0.11, 0.25)]
        removed |= near[0] | near[1]
    elif opening == "no cover":
        removed |= np.all((middle > WALL) & (middle < np.append(SIZE[:2] - WALL, 1.0)), axis=1)
    used, nodes = np.unique(mesh.tetrahedra[~removed], return_inverse=True)
    rest = TetrahedralMesh(mesh.points[used], nodes.reshape(-1, 10))
    corners, triangles = np.unique(rest.surface, return_inverse=True)
    points = rest.points[corners]
    motion = rigid_motions(points, SIZE / 2.0).reshape(-1, 3, 6)
    swelling = (points - SIZE / 2.0)[:, :, None]
    bulge = np.prod(np.sin(np.pi * points[:, :2] / SIZE[:2]), axis=1)[:, None, None] * motion[:, :, 2:3]
    motion = np.concatenate([motion, swelling, 1e-3 * motion[:, :, 2:3] + bulge], axis=2)
    housing = bare_housing(("a",), modal=3)
    object.__setattr__(housing, "surface", SurfaceMotion(points, triangles.reshape(-1, 6), motion))
    return housing


def hull_of(opening: str):
    return outer_hull(housing_of(opening))


def test_the_walls_of_a_closed_cavity_are_left_out():
    outer = hull_of("closed")
    outer.hull.require_closed()
    assert outer.hull.area == pytest.approx(OUTER, rel=1e-12)
    assert outer.hull.volume == pytest.approx(float(np.prod(SIZE)), rel=1e-12)
    assert outer.inner_area == pytest.approx(INNER, rel=1e-12)
    assert outer.cap_area == 0.0


@pytest.mark.law
def test_the_mean_square_of_a_motion_leaves_out_the_walls_of_a_cavity():
    along_z = surface_weight(housing_of("closed"))[2, 2]
    assert along_z == pytest.approx(2.0 * SIZE[0] * SIZE[1] / OUTER, rel=1e-12)


def test_bores_are_closed_by_caps_and_the_walls_behind_them_are_left_out():
    outer = hull_of("bores")
    outer.hull.require_closed()
    wall = 4 * 4 * HOLE * WALL  # of the bores: outside or inside
    assert 4 * HOLE**2 <= outer.cap_area * (1 + 1e-9) < 1.15 * 4 * HOLE**2  # rims along the mesh
    faces = outer.hull.area - outer.cap_area
    assert OUTER - 4 * HOLE**2 <= faces * (1 + 1e-9) <= OUTER - 4 * HOLE**2 + wall + 1e-9
    assert faces + outer.inner_area == pytest.approx(OUTER + INNER - 8 * HOLE**2 + wall, rel=1e-9)


def test_both_sides_of_an_open_tub_are_outside():
    outer = hull_of("no cover")
    outer.hull.require_closed()
    assert outer.inner_area == 0.0
    rim = SIZE[0] * SIZE[1] - np.prod(SIZE[:2] - 2 * WALL)
    tub = np.prod(SIZE[:2] - 2 * WALL) + 2 * np.sum(SIZE[:2] - 2 * WALL) * (SIZE[2] - WALL)
    assert outer.hull.area == pytest.approx(OUTER - SIZE[0] * SIZE[1] + rim + tub, rel=1e-9)


@pytest.mark.law
@pytest.mark.parametrize("opening", ["closed", "bores", "no cover"])
def test_a_rigid_motion_displaces_no_volume_and_a_swelling_its_own(opening):
    outer = hull_of(opening)
    flow = outer.hull.areas @ outer.shapes
    np.testing.assert_allclose(flow[:6], 0.0, atol=1e-12)
    assert flow[6] == pytest.approx(3.0 * outer.hull.volume, rel=1e-9)


@pytest.mark.parametrize("opening", ["closed", "bores"])
def test_coarse_panels_radiate_as_the_fine_ones(opening):
    outer, air = hull_of(opening), Air()
    coarse = radiating_hull(outer, 300.0, air.sound_speed)
    assert len(coarse.hull.triangles) < 0.5 * len(outer.hull.triangles)
    coarse.hull.require_closed()
    np.testing.assert_allclose(coarse.hull.areas @ coarse.shapes, outer.hull.areas @ outer.shapes, atol=1e-12)
    assert coarse.hull.area == pytest.approx(outer.hull.area, rel=0.03)
    few, fine = (_alone(part.hull, part.shapes, air) for part in (coarse, outer))
    np.testing.assert_allclose(10.0 * np.log10(few / fine), 0.0, atol=0.3)


def _alone(hull, shapes, air):
    return np.diag(resistance(ElementalRadiators(), hull, 300.0, shapes, air))


def test_panels_are_as_coarse_as_the_wavelength_allows():
    outer = hull_of("closed")
    hulls = [radiating_hull(outer, frequency, 343.0).hull for frequency in (300.0, 1200.0, 9000.0)]
    assert len(hulls[0].triangles) < len(hulls[1].triangles) < len(hulls[2].triangles)
    assert hulls[1].highest_wavenumber >= 2.0 * np.pi * 1200.0 / 343.0
    assert hulls[2] is outer.hull
