"""Laws that unit-load root stresses keep on every mesh, in the plane and over the face."""

import functools
import math
from dataclasses import fields, replace

import numpy as np
import pytest
import scipy.sparse as sp
from compliance_gears import HELICAL, SPUR, coarse, coarse_plane, relative, whole_gear
from scipy.sparse.linalg import splu

import fe_contact.compliance.root_stress_3d as face_module
import fe_contact.compliance.sector_stiffness as stiffness_module
from fe_contact import Gear, Material, RingGear
from fe_contact.compliance import (
    PlaneHypothesis,
    UnitRootStress,
    unit_root_stress,
    unit_root_stress_3d,
    unit_root_stresses,
    unit_root_stresses_3d,
)
from fe_contact.compliance.condensed_gear import pressure_forces
from fe_contact.compliance.condensed_sector import freedoms, inward_loads
from fe_contact.compliance.factorization import factorise
from fe_contact.compliance.plane_elasticity import stiffness_matrix
from fe_contact.compliance.root_stress import refuse_broken_stress
from fe_contact.compliance.root_stress_3d import compute_root_stress_3d, root_functionals
from fe_contact.compliance.root_surface_3d import quad_root
from fe_contact.compliance.unit_root_stress import edge_stress, triangle_root
from fe_contact.contact.face_patch import FaceGrid, face_loads
from fe_contact.contact.patch import load_vector
from fe_contact.errors import SolveError
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.geometry.root_tangent import critical_section, tangent_angle
from fe_contact.mesh import ClampedBore, MeshRecipe, PlaneStrain, SectorRecipe, mesh_gear, quad_sector

GEARS = pytest.mark.parametrize("gear", [SPUR, HELICAL], ids=["spur", "helical"])
PLANE = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
RING = RingGear(41, 4e-3, 20e-3, 0.204, profile_shift_coefficient=-0.3)
RINGS = [(20, 40e-3, None), (40, 40e-3, None), (20, 40e-3, 5)]
RING_NAMES = ["sectors to the bore", "hub", "plain ring"]
STRAIN = PlaneHypothesis.PLANE_STRAIN


two_on_land = functools.partial(coarse, land_elements=2)


in_plane = functools.cache(unit_root_stress)
over_face = functools.cache(unit_root_stress_3d)


def on_flank(found: UnitRootStress) -> np.ndarray:
    upper = found.s[:-2:2] > 0.4 * found.s[0] + 0.6 * found.s[-1]
    if found.across_face:
        return pressure_forces(
            found.s, found.z, found.index, np.tile(upper, (len(found.z) - 1, 1)).astype(float)
        )
    forces, lengths = np.zeros(len(found.s)), np.where(upper, np.diff(found.s[::2]), 0.0)
    for offset, share in enumerate((1.0, 4.0, 1.0)):
        forces[offset : len(found.s) - 2 + offset : 2] += share / 6.0 * lengths
    return forces


def some_forces(count: int) -> np.ndarray:
    """Three loads (count, 3) without any order."""
    return np.random.default_rng(7).normal(size=(count, 3))


@pytest.mark.law
@pytest.mark.parametrize(("teeth", "bore", "real"), RINGS, ids=RING_NAMES)
def test_equals_the_uncondensed_solution_in_the_plane(teeth, bore, real):
    gear = replace(PLANE, teeth=teeth, bore_diameter=bore)
    assert_agrees_with_the_whole_mesh(gear, coarse_plane(gear, real_teeth=real))


def test_equals_the_uncondensed_solution_of_a_ring_gear():
    assert_agrees_with_the_whole_mesh(RING, coarse_plane(RING))


def assert_agrees_with_the_whole_mesh(gear: Toothing, recipe: MeshRecipe) -> None:
    found = in_plane(gear, recipe, teeth=5)
    mesh = mesh_gear(gear, recipe)
    matrix = stiffness_matrix(mesh.points, mesh.triangles, STRAIN.lame_parameters(gear.material))
    free = np.setdiff1d(np.arange(2 * len(mesh.points)), freedoms(mesh.bore_nodes))
    solve = splu(sp.csc_array(matrix[free][:, free])).solve
    own = int(np.flatnonzero(mesh.teeth == 0)[0])
    chains = mesh.sector_nodes[own, triangle_root(mesh.sector, tooth_profile(gear)).nodes]
    forces = some_forces(len(found.s))
    for n, ahead in enumerate(found.distance):
        flank = mesh.flanks[own - ahead]
        moved = np.zeros((2 * len(mesh.points), 3))
        loads = inward_loads(len(mesh.points), flank.nodes, flank.normals) @ forces
        moved[free] = solve(loads[free])
        for side, chain in enumerate(chains):
            expected = edge_stress(mesh.points, chain, gear.material, STRAIN) @ moved
            stress = (found.stress[n, side, :, :, 0] @ forces).reshape(-1, 3)
            assert relative(stress, expected) < 1e-9


def whole_gear_stress(gear: Gear, recipe: SectorRecipe) -> np.ndarray:
    """Root stress of every tooth by forces on tooth 0, (z, r, 3), by one sparse factorisation."""
    section, sector, number, matrix = whole_gear(gear, recipe)
    loads = np.zeros((matrix.shape[0], 3))
    loads[number[0, sector.flank]] = -some_forces(len(sector.flank))  # inwards
    moved = factorise(matrix, block=1)(loads)
    rows = root_functionals(gear, section, sector, quad_root(section, tooth_profile(gear)))
    return np.stack([rows @ moved[each[:-1]] for each in number])


@GEARS
def test_equals_the_uncondensed_solution_over_the_face(gear):
    """To 1e-6 of the stress: what the cuts cannot tell apart by more is dropped (`MIN_SIGNIFICANT`)."""
    recipe = two_on_land(gear)
    found = over_face(gear, recipe, reach=4)
    direct = whole_gear_stress(gear, recipe)
    stress = (found.stress @ some_forces(found.stress.shape[-1])).swapaxes(3, 4).reshape(9, -1, 3)
    for n, ahead in enumerate(found.distance):
        assert np.abs(stress[n] - direct[ahead]).max() < 1e-6 * np.abs(direct[0]).max()
        assert relative(stress[n], direct[ahead]) < 1e-5


@GEARS
def test_checks_hold(gear):
    face = over_face(gear, two_on_land(gear))
    assert face.checks.residual < 1e-11
    assert face.checks.recovery < 2e-6
    plane = in_plane(SPUR, coarse_plane(SPUR))
    assert plane.checks.residual < 1e-10
    assert plane.checks.recovery < 1e-11


@pytest.mark.law
def test_the_load_pulls_its_own_side_and_pushes_the_other():
    ring = replace(SectorRecipe.draft(RING), layers=2, merge_rows=())
    for found in (
        in_plane(PLANE),
        over_face(PLANE, SectorRecipe.draft(PLANE)),
        in_plane(RING),
        over_face(RING, ring),
    ):
        stress = found.stress @ on_flank(found)
        own = len(found.distance) // 2
        profile = stress[own, :, 0]
        fillet = np.radians(20.0) < found.tangent_angle
        assert profile[0][fillet].min() > 0.0 > profile[1][fillet].max()
        assert np.abs(stress[own + 1 :]).max() < np.abs(profile).max()


def patch(found: UnitRootStress, gear: Gear) -> np.ndarray:
    """Forces of a unit patch high on the flank, across the whole face, the same on every mesh."""
    center, half = 0.7 * found.s[-1], 0.3 * gear.normal_module
    forces = np.zeros(found.stress.shape[-1])
    if found.across_face:
        grid = FaceGrid(found.s, found.z, found.index)
        ends = (found.z[:1], found.z[-1:])
        loads = face_loads(grid, np.array([[center]]), np.array([[half]]), np.zeros((1, 1)), *ends)
        forces[loads.nodes[0, : loads.used[0]]] = loads.forces[0, : loads.used[0]]
    else:
        load_vector(found.s, center, half, 0.0, forces)
    return forces


@pytest.mark.law
def test_one_layer_without_axial_displacement_is_the_plane():
    """Two meshes and two ways to condense: eight-node quadrilaterals and triangles."""
    recipe = replace(SectorRecipe.fine(PLANE), layers=1, merge_rows=(), layer_growth=1.0, land_elements=8)
    face, plane = over_face(PLANE, recipe, support=PlaneStrain()), in_plane(PLANE)
    fillet = np.linspace(-0.9, -0.35, 30) * (plane.station_s[-1] - plane.station_s[0])
    for distance in (-1, 0, 1):
        sums = []
        for found, width in ((face, PLANE.face_width), (plane, 1.0)):
            stress = found.stress[len(found.distance) // 2 + distance, :, 0] @ patch(found, PLANE)
            across = stress.mean(axis=-1) * width
            sums.append(np.array([np.interp(fillet, found.station_s, side) for side in across]))
        # straight lines between the stations; what a neighbor passes on is a tenth of it
        assert relative(sums[0], sums[1]) < (0.015 if distance == 0 else 0.03)


def test_opposite_hands_are_mirror_images():
    left = replace(HELICAL, helix_angle=-HELICAL.helix_angle)
    right, found = (over_face(gear, two_on_land(gear), reach=1) for gear in (HELICAL, left))
    assert np.array_equal(found.stress, right.mirrored().stress)
    assert np.array_equal(found.mirrored().stress, right.stress)
    assert relative(found.stress, right.stress) > 0.1
    found = over_face(SPUR, two_on_land(SPUR))
    assert relative(found.mirrored().stress, found.stress) < 2e-6
    shear = found.stress[:, :, 2] @ on_flank(found)
    assert np.abs(shear + shear[..., ::-1]).max() < 1e-6 * np.abs(found.stress @ on_flank(found)).max()


def test_a_gear_swept_the_other_way_is_the_mirror_image(monkeypatch):
    left = replace(HELICAL, helix_angle=-HELICAL.helix_angle)
    mirrored = over_face(left, two_on_land(left), reach=1)
    for module in (stiffness_module, face_module):
        monkeypatch.setattr(module, "twist", lambda gear: math.tan(gear.helix_angle) / gear.reference_radius)
    swept = compute_root_stress_3d(left, two_on_land(left), 1, ClampedBore())
    # single nodal forces hold what the cuts tell apart to 1e-6 only
    assert relative(swept.stress, mirrored.stress) < 2e-6


def test_stress_per_force_goes_with_one_over_length_and_not_with_stiffness():
    """Lengths by s and forces by s^2: the same stress; per unit of width, forces by s."""
    large = replace(SPUR, normal_module=32e-3, face_width=160e-3, bore_diameter=96e-3)
    soft = replace(SPUR, material=Material(youngs_modulus=21e9))
    found, scaled, softer = (over_face(g, two_on_land(g)) for g in (SPUR, large, soft))
    assert relative(64.0 * scaled.stress, found.stress) < 2e-6
    assert relative(softer.stress, found.stress) < 2e-6
    assert scaled.tangent_angle == pytest.approx(found.tangent_angle, rel=1e-9)
    found, scaled, softer = (in_plane(g, coarse_plane(g)) for g in (SPUR, large, soft))
    assert relative(8.0 * scaled.stress, found.stress) < 1e-6
    assert relative(softer.stress, found.stress) < 1e-9


def test_stations_lie_on_the_fillet_with_its_tangents():
    profile = tooth_profile(PLANE)
    for found in (in_plane(PLANE), over_face(PLANE, SectorRecipe.draft(PLANE))):
        assert profile.s_space < found.station_s[0] < found.station_s[-1] < profile.s_form
        assert np.all(np.diff(found.station_s) > 0.0)
        assert np.all(np.diff(found.tangent_angle[found.station_s > profile.s_root]) < 0.0)
    assert found.station_z == pytest.approx(-found.station_z[::-1], rel=1e-12)
    assert np.abs(found.station_z).max() < 0.5 * PLANE.face_width
    for gear in (PLANE, SPUR, HELICAL, replace(PLANE, teeth=80, bore_diameter=60e-3)):
        profile = tooth_profile(gear)
        at = critical_section(profile)
        assert profile.s_root < at < profile.s_form
        step = 1e-4 * gear.normal_module
        low, high = profile.flank(np.array([at - step, at + step]))
        lean = math.degrees(math.atan2(*(low - high) * [1.0, -1.0]))
        assert lean == pytest.approx(30.0, abs=0.05)
        assert float(tangent_angle(profile, profile.s_root)) == pytest.approx(
            0.5 * math.pi - profile.root_angle, rel=1e-6
        )


@pytest.mark.parametrize("gear", [PLANE, RING], ids=["external", "internal"])
def test_nodes_of_the_root_have_their_flank_coordinates(gear):
    profile = tooth_profile(gear)
    section = quad_sector(gear, SectorRecipe.draft(gear))
    sector = mesh_gear(gear, MeshRecipe.standard(gear)).sector
    for points, root in (
        (section.points, quad_root(section, profile)),
        (sector.points, triangle_root(sector, profile)),
    ):
        right, left = points[root.nodes[0]], points[root.nodes[1]]
        assert left == pytest.approx(right * [-1.0, 1.0], abs=1e-15)
        assert root.s[[0, -1]] == pytest.approx([profile.s_space, profile.s_form], abs=1e-9)
        assert np.abs(profile.flank(root.s) - right).max() < 1e-9
        middles = 0.5 * (root.s[:-2:2] + root.s[2::2])
        assert root.s[1::2] == pytest.approx(middles, abs=1e-8)


def test_the_cache_returns_the_same_bits(tmp_path):
    left = replace(HELICAL, helix_angle=-HELICAL.helix_angle)
    recipe = two_on_land(HELICAL)
    first, second = (unit_root_stress_3d(HELICAL, recipe, reach=1, cache=tmp_path) for _ in range(2))
    assert (first.from_cache, second.from_cache) == (False, True)
    for field in fields(UnitRootStress):
        if field.name != "from_cache":
            one, other = getattr(first, field.name), getattr(second, field.name)
            assert np.array_equal(one, other) if isinstance(one, np.ndarray) else one == other
    found = unit_root_stress_3d(left, recipe, reach=1, cache=tmp_path)
    assert found.from_cache
    assert np.array_equal(found.stress, first.mirrored().stress)
    plane = [unit_root_stress(SPUR, coarse_plane(SPUR), cache=tmp_path) for _ in range(2)]
    assert plane[1].from_cache
    assert np.array_equal(plane[0].stress, plane[1].stress)
    for file in tmp_path.iterdir():
        file.write_bytes(file.read_bytes()[:-1000])
    assert not unit_root_stress(SPUR, coarse_plane(SPUR), cache=tmp_path).from_cache


def test_gears_alike_are_computed_once(monkeypatch):
    left = replace(HELICAL, helix_angle=-HELICAL.helix_angle)
    found = unit_root_stresses_3d([HELICAL, left], [two_on_land(HELICAL)] * 2)
    assert np.array_equal(found[1].mirrored().stress, found[0].stress)
    assert found[1].seconds is found[0].seconds
    twins = unit_root_stresses([SPUR, SPUR], [coarse_plane(SPUR)] * 2, STRAIN, teeth=3)
    assert twins[0] is twins[1]


@pytest.mark.parametrize("name", ["residual", "recovery"])
def test_a_broken_law_is_refused_by_name(name):
    found = unit_root_stress(SPUR, coarse_plane(SPUR))
    broken = replace(found, checks=replace(found.checks, **{name: 1e-3}))
    with pytest.raises(SolveError, match=name) as refusal:
        refuse_broken_stress(broken)
    assert refusal.value.partial is broken


def test_checks_see_a_wrong_ring(monkeypatch):
    genuine = face_module.loaded_cuts

    def spoiled(*arguments):
        cuts = genuine(*arguments)
        return replace(cuts, near={m: cuts.near[m] * (1.0 + 1e-3) for m in cuts.near})

    monkeypatch.setattr(face_module, "loaded_cuts", spoiled)
    with pytest.raises(SolveError, match="recovery"):
        unit_root_stress_3d(HELICAL, two_on_land(HELICAL), reach=1)
