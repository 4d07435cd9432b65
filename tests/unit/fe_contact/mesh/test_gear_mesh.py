"""Laws of the mesh of a gear."""

import math
from itertools import pairwise

import numpy as np
import pytest

from fe_contact.errors import MeshError
from fe_contact.geometry import Gear, Toothing, ToothProfile, tooth_profile
from fe_contact.mesh import GearMesh, MeshRecipe, gear_mesh, mesh_gear, mesh_quality, quadratic_mesh
from fe_contact.mesh.quadratic_mesh import rotated
from host import ChildOutOfMemory

GearAndMesh = tuple[Toothing, GearMesh]


def element_area(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area of six-node triangles by the exact integral of x dy - y dx along their curved sides."""
    total = np.zeros(len(triangles))
    for first, middle, last in ((0, 3, 1), (1, 4, 2), (2, 5, 0)):
        a, m, b = (points[triangles[:, i]] for i in (first, middle, last))
        for p, q, weight in ((a, m, 4.0), (m, b, 4.0), (a, b, -1.0)):
            total += weight / 6.0 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    return total


def tooth_area(profile: ToothProfile) -> float:
    """Area between one tooth's outline and the gear's axis, by the exact profile."""
    edges = [profile.s_space, profile.s_root, profile.s_form, profile.s_tip]
    s = np.unique(np.concatenate([np.linspace(a, b, 4001) for a, b in pairwise(edges)]))
    x, y = profile.flank(s).T
    flank = -0.5 * np.sum(x[:-1] * y[1:] - y[:-1] * x[1:])
    return float(2.0 * -flank + profile.tip_angle * profile.gear.tip_radius**2)


def sides(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All sides as sorted corner pairs, with how often each occurs."""
    pairs = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1
    )
    return np.unique(pairs, axis=0, return_counts=True)


def test_area_is_that_of_the_exact_section(gear_and_mesh):
    gear, mesh = gear_and_mesh
    plain = (gear.teeth - len(mesh.teeth)) * np.pi / gear.teeth * gear.root_radius**2
    toothed = len(mesh.teeth) * tooth_area(tooth_profile(gear)) + plain
    exact = gear.sign * (toothed - np.pi * gear.seat_radius**2)
    # Quadratic edges of up to 12 degrees on the plain rim and the bore miss their segment by a few 1e-6.
    assert element_area(mesh.points, mesh.triangles).sum() == pytest.approx(exact, rel=4e-6)


def test_the_mesh_is_one_ring_without_spare_nodes(gear_and_mesh):
    _, mesh = gear_and_mesh
    pairs, counts = sides(mesh.triangles)
    assert counts.max() == 2
    free = pairs[counts == 1]
    _, uses = np.unique(free, return_counts=True)
    assert np.all(uses == 2)
    vertices, elements = len(np.unique(mesh.triangles[:, :3])), len(mesh.triangles)
    assert vertices - len(pairs) + elements == 0  # Euler characteristic of a ring
    gear, mesh = gear_and_mesh
    assert np.array_equal(np.unique(mesh.triangles), np.arange(len(mesh.points)))
    rounded = np.round(mesh.points / (1e-7 * gear.normal_module)).astype(int)
    assert len(np.unique(rounded, axis=0)) == len(mesh.points)


def test_flank_nodes_lie_on_the_exact_profile_with_exact_middles(gear_and_mesh):
    gear, mesh = gear_and_mesh
    profile = tooth_profile(gear)
    for flank in mesh.flanks:
        turn = flank.tooth * 2.0 * np.pi / gear.teeth
        assert mesh.points[flank.nodes] == pytest.approx(rotated(profile.flank(flank.s), turn), abs=1e-16)
        assert flank.normals == pytest.approx(rotated(profile.normal(flank.s), turn), abs=1e-14)
        assert np.array_equal(flank.s, mesh.flanks[0].s)
    s = mesh.flanks[0].s
    assert s[1::2] == pytest.approx(0.5 * (s[:-2:2] + s[2::2]), abs=1e-18)
    assert np.all(np.diff(s) > 0.0)
    assert s[-1] == profile.s_tip
    assert profile.s_form in s[::2]
    assert s[0] <= profile.s_form - 0.25 * gear.normal_module


def test_the_whole_surface_of_a_tooth_is_exact(gear_and_mesh):
    gear, mesh = gear_and_mesh
    profile, sector = tooth_profile(gear), mesh.sector
    pairs, counts = sides(sector.triangles)
    corners = np.unique(pairs[counts == 1])
    boundary = np.unique(np.concatenate([corners, boundary_middles(sector.triangles, pairs[counts == 1])]))
    x, y = sector.points[boundary].T
    radius, angle = np.hypot(x, y), np.abs(np.arctan2(x, y))
    between = gear.sign * (radius - gear.root_radius) > 0.05 * gear.normal_module
    between &= gear.sign * (gear.tip_radius - radius) > 1e-4 * gear.tip_radius
    between &= angle < 0.999 * 0.5 * profile.pitch_angle
    s = np.linspace(profile.s_root, profile.s_tip, 20_001)
    fx, fy = profile.flank(s)[:: gear.sign].T  # by increasing radius
    exact = np.interp(radius[between], np.hypot(fx, fy), np.arctan2(fx, fy))
    assert between.sum() > 100
    assert angle[between] * radius[between] == pytest.approx(exact * radius[between], abs=1e-10)


def boundary_middles(triangles: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Mid-side nodes of the sides `free`."""
    wanted = {tuple(pair) for pair in free.tolist()}
    found = [
        t[3 + i]
        for t in triangles.tolist()
        for i in range(3)
        if tuple(sorted((t[i], t[(i + 1) % 3]))) in wanted
    ]
    return np.array(found)


def test_bore_teeth_and_sizes_are_as_they_should(gear_and_mesh):
    gear, mesh = gear_and_mesh
    radius = np.linalg.norm(mesh.points, axis=1)
    on_bore = np.flatnonzero(gear.sign * (radius - gear.seat_radius) < 1e-9)
    assert np.array_equal(np.sort(mesh.bore_nodes), on_bore)
    assert radius[on_bore] == pytest.approx(gear.seat_radius, rel=1e-12)
    sector = mesh.sector
    for nodes, tooth in zip(mesh.sector_nodes, mesh.teeth, strict=True):
        expected = rotated(sector.points, tooth * 2.0 * np.pi / gear.teeth)
        assert mesh.points[nodes] == pytest.approx(expected, abs=1e-15)
    assert sector.points[sector.coast_flank] == pytest.approx(sector.points[sector.flank] * [-1.0, 1.0])
    assert 0 in mesh.teeth
    assert np.all(np.diff(mesh.teeth) == 1)
    _, mesh = gear_and_mesh
    quality = mesh_quality(mesh.points, mesh.triangles)
    assert quality.angle.min() > np.radians(20.0)
    assert quality.scaled_jacobian.min() > 0.6
    lengths = np.diff(mesh.flanks[0].s[::2])
    assert lengths.max() <= 0.4e-3 * (1.0 + 1e-12)
    assert lengths[-1] <= 1.5 * 0.02e-3


def test_a_gear_with_fewer_teeth_than_wanted_has_all_of_them():
    gear = Gear(teeth=6, normal_module=4e-3, face_width=25e-3, bore_diameter=6e-3, tip_diameter=29e-3)
    mesh = mesh_gear(gear)
    assert mesh.teeth.tolist() == [-2, -1, 0, 1, 2, 3]


def test_sectors_meshed_ahead_are_those_of_each_gear_to_the_last_bit(monkeypatch):
    """Four meshes of two gears from one process of gmsh; each is taken once."""
    gears = [Gear(teeth=z, normal_module=4e-3, face_width=25e-3, bore_diameter=2e-3 * z) for z in (20, 31)]
    levels = [(gear, MeshRecipe.standard(gear).refined(factor)) for gear in gears for factor in (1.0, 0.6)]
    singly = [mesh_gear(*level) for level in levels]
    processes: list[object] = []
    genuine = quadratic_mesh.ask_gmsh

    def counted(request, *rest):
        processes.append(request)
        return genuine(request, *rest)

    monkeypatch.setattr(quadratic_mesh, "ask_gmsh", counted)
    gear_mesh.mesh_ahead(levels)
    for level, alone in zip(levels, singly, strict=True):
        mesh = mesh_gear(*level)
        assert np.array_equal(mesh.points, alone.points)
        assert np.array_equal(mesh.triangles, alone.triangles)
    assert len(processes) == 1
    mesh_gear(*levels[0])
    assert len(processes) == 2


def test_sections_that_no_mesh_is_made_of_ahead_are_left_to_gears(monkeypatch):
    def refused(*_):
        raise MeshError("no mesh")

    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    recipe = MeshRecipe.standard(gear)
    with monkeypatch.context() as patch:
        patch.setattr(quadratic_mesh, "ask_gmsh", refused)
        gear_mesh.mesh_ahead([(gear, recipe), (gear, recipe.refined(0.6))])
        with pytest.raises(MeshError, match="no mesh"):
            mesh_gear(gear, recipe)
    assert len(mesh_gear(gear, recipe).triangles)


def test_a_mesher_without_memory_is_not_started_again(monkeypatch):
    starts: list[object] = []

    def devoured(*request):
        starts.append(request)
        raise MeshError("gmsh worker: ran out of memory") from ChildOutOfMemory("ran out of memory")

    gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
    recipe = MeshRecipe.standard(gear)
    monkeypatch.setattr(quadratic_mesh, "ask_gmsh", devoured)
    with pytest.raises(MeshError, match="ran out of memory"):
        gear_mesh.mesh_ahead([(gear, recipe), (gear, recipe.refined(0.6))])
    assert len(starts) == 1


@pytest.mark.parametrize("level", [0.5, 0.6, 0.7, 1.0])
def test_a_root_land_shorter_than_an_element_makes_no_poor_one(level):
    """The lowest element of the fillet reaches over it; moved by one corner alone it was bent too far."""
    gear = Gear(
        teeth=50, normal_module=1e-3, face_width=5e-3, bore_diameter=30e-3, profile_shift_coefficient=0.48932,
        addendum_coefficient=0.8, dedendum_coefficient=1.43845, root_radius_coefficient=0.210857,
        normal_pressure_angle=math.radians(22.994),
    )  # fmt: skip
    profile = tooth_profile(gear)
    assert 0.0 < profile.s_root - profile.s_space < 0.05e-3
    mesh_gear(gear, MeshRecipe.standard(gear).refined(level))  # refuses poor elements
