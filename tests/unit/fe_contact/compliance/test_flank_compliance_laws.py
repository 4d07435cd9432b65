"""Laws that a flank compliance keeps on every mesh."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp
from compliance_gears import coarse_plane, relative
from scipy.sparse.linalg import splu
from spur_gears import gear as make_gear

import fe_contact.mesh.gear_mesh
from fe_contact.compliance import (
    ComplianceChecks,
    FlankCompliance,
    PlaneHypothesis,
    flank_compliance,
    flank_compliances,
    ring_2d,
)
from fe_contact.compliance.condensed_sector import freedoms, inward_loads
from fe_contact.compliance.flank import refuse_broken_laws
from fe_contact.compliance.plane_elasticity import stiffness_matrix
from fe_contact.compliance.ring_checks import uniform_pressure
from fe_contact.errors import InputError, SolveError
from fe_contact.geometry import Gear, RingGear, Toothing
from fe_contact.material import Material
from fe_contact.mesh import MeshRecipe, mesh_gear

STRAIN, STRESS = PlaneHypothesis.PLANE_STRAIN, PlaneHypothesis.PLANE_STRESS
SIZE = {"normal_module": 4e-3, "face_width": 25e-3}
RINGS = {
    "sectors to the bore": (Gear(20, bore_diameter=40e-3, **SIZE), None),
    "hub": (Gear(40, bore_diameter=40e-3, **SIZE), None),
    "plain ring": (Gear(20, bore_diameter=40e-3, **SIZE), 5),
    "ring gear, sectors to the rim": (RingGear(50, rim_diameter=240e-3, **SIZE), None),
    "ring gear, thick rim": (RingGear(50, rim_diameter=320e-3, **SIZE), None),
    "ring gear, plain ring": (RingGear(50, rim_diameter=240e-3, **SIZE), 5),
}
ALL_RINGS = pytest.mark.parametrize(("gear", "real"), RINGS.values(), ids=RINGS)


@cache
def of_ring(gear: Toothing, recipe: MeshRecipe) -> FlankCompliance:
    """Compliance of the five teeth that two laws look at."""
    return flank_compliance(gear, recipe, teeth=5)


def along_flank(mesh: fe_contact.mesh.gear_mesh.GearMesh, middle: int, found: FlankCompliance) -> np.ndarray:
    """Unit vectors (k, 2) across the normals of a flank that point towards its tip."""
    flank = [flank for flank in mesh.flanks if flank.tooth in found.teeth][middle]
    turned = flank.normals @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    towards_tip = np.gradient(mesh.points[flank.nodes], axis=0)
    return turned * np.sign((turned * towards_tip).sum(axis=1))[:, None]


@pytest.mark.drawn
@pytest.mark.law
@ALL_RINGS
def test_equals_the_solution_of_the_whole_uncondensed_mesh(gear, real):
    recipe = coarse_plane(gear, real_teeth=real)
    found = of_ring(gear, recipe)
    mesh = mesh_gear(gear, recipe)
    matrix = stiffness_matrix(mesh.points, mesh.triangles, STRAIN.lame_parameters(gear.material))
    free = np.setdiff1d(np.arange(2 * len(mesh.points)), freedoms(mesh.bore_nodes))
    flanks = [flank for flank in mesh.flanks if flank.tooth in found.teeth]
    loads = sp.hstack([inward_loads(len(mesh.points), f.nodes, f.normals) for f in flanks], format="csc")[
        free
    ]
    moved = splu(sp.csc_array(matrix[free][:, free])).solve(loads.toarray())
    direct = loads.T @ moved
    assert relative(found.matrix, direct) < 1e-10
    middle = len(flanks) // 2
    own = slice(middle * len(found.s), (middle + 1) * len(found.s))
    towards_tip = inward_loads(len(mesh.points), flanks[middle].nodes, -along_flank(mesh, middle, found))
    assert relative(found.along, towards_tip[free].T @ moved[:, own]) < 1e-10
    assert found.unknowns == len(free)


@ALL_RINGS
def test_checks_hold_to_rounding(gear, real):
    found = of_ring(gear, coarse_plane(gear, real_teeth=real))
    checks = found.checks
    assert checks.residual < 1e-10
    assert checks.reciprocity < 1e-13
    assert checks.bore_moment < 1e-10
    assert checks.energy < 1e-11
    assert checks.least_eigenvalue > 0.0
    assert np.array_equal(found.matrix, found.matrix.T)
    assert np.linalg.eigvalsh(found.matrix)[0] == pytest.approx(checks.least_eigenvalue, rel=1e-6)


def under_pressure(compliance: FlankCompliance) -> np.ndarray:
    """Compliance from tooth to tooth (t, t) under uniform pressure, which no mesh changes much."""
    forces = uniform_pressure(compliance.s, compliance.s_form, 1.0).forces
    return np.array(
        [[forces @ compliance.block(i, j) @ forces for j in compliance.teeth] for i in compliance.teeth]
    )


def test_teeth_around_the_ring_are_all_alike():
    gear = make_gear()
    found = flank_compliance(gear, coarse_plane(gear))
    for distance in (0, 1, 2):
        first = found.block(-2, -2 + distance)
        for tooth in range(-1, 3 - distance):
            assert relative(found.block(tooth, tooth + distance), first) < 1e-10
    assert np.trace(found.block(0, 1)) > 1.05 * np.trace(found.block(0, 2)) > 0.0
    gear = make_gear(teeth=11, bore_diameter=16e-3)
    found = flank_compliance(gear, coarse_plane(gear), teeth=11)
    # Around eleven teeth, ten steps one way are one step the other.
    assert relative(found.block(-5, 5), found.block(0, -1)) < 1e-10
    assert relative(found.block(-5, 4), found.block(0, -2)) < 1e-10
    gear = make_gear()
    five, seven = (flank_compliance(gear, coarse_plane(gear), teeth=n) for n in (5, 7))
    for tooth in five.teeth:
        assert relative(five.block(0, tooth), seven.block(0, tooth)) < 1e-11


def test_compliance_scales_with_modulus_and_is_free_of_length():
    steel, soft = make_gear(), make_gear(material=Material(youngs_modulus=3e9))
    ratio = (
        flank_compliance(soft, coarse_plane(soft)).matrix
        / flank_compliance(steel, coarse_plane(steel)).matrix
    )
    assert ratio == pytest.approx(210e9 / 3e9, rel=1e-9)
    small, large = make_gear(), make_gear(normal_module=32e-3, bore_diameter=320e-3)
    found, scaled = (flank_compliance(gear, coarse_plane(gear)) for gear in (small, large))
    assert scaled.s == pytest.approx(8.0 * found.s, rel=1e-12)
    assert relative(scaled.matrix, found.matrix) < 1e-9
    nu = 0.3
    thin = make_gear(material=Material(youngs_modulus=210e9, poissons_ratio=nu))
    young = 210e9 * (1.0 + 2.0 * nu) / (1.0 + nu) ** 2
    wide = make_gear(material=Material(youngs_modulus=young, poissons_ratio=nu / (1.0 + nu)))
    stress, strain = (
        flank_compliance(thin, coarse_plane(thin), STRESS),
        flank_compliance(wide, coarse_plane(wide), STRAIN),
    )
    assert relative(stress.matrix, strain.matrix) < 1e-11
    assert stress.contact_modulus == pytest.approx(strain.contact_modulus, rel=1e-14)
    assert np.trace(stress.matrix) > 1.05 * np.trace(
        flank_compliance(thin, coarse_plane(thin), STRAIN).matrix
    )
    gear = make_gear()
    twins = flank_compliances([gear, replace(gear, face_width=50e-3)], [coarse_plane(gear)] * 2)
    assert twins[0] is twins[1]
    other = flank_compliances([gear, make_gear(bore_diameter=20e-3)], [coarse_plane(gear)] * 2)
    assert other[0] is not other[1]
    assert np.trace(other[1].matrix) > np.trace(other[0].matrix)


def test_fewer_real_teeth_are_softer():
    gear = make_gear()
    found = [
        under_pressure(flank_compliance(gear, coarse_plane(gear, real_teeth=n))) for n in (5, 7, 11, None)
    ]
    for tooth in range(5):
        compliances = [matrix[2, tooth] for matrix in found]
        assert compliances == sorted(compliances, reverse=True)
    assert 1e-4 < found[0][2, 2] / found[-1][2, 2] - 1.0 < 3e-3


def test_hub_and_sectors_to_the_bore_agree(monkeypatch):
    gear = make_gear()
    recipe = coarse_plane(gear)
    sectors = flank_compliance(gear, recipe)
    monkeypatch.setattr(fe_contact.mesh.gear_mesh, "SLENDER", 0.0)
    with_hub = flank_compliance(gear, recipe)
    assert with_hub.condensed_unknowns != sectors.condensed_unknowns
    assert under_pressure(with_hub) == pytest.approx(under_pressure(sectors), rel=2e-4)


def test_another_factorization_gives_the_same_compliance(monkeypatch):
    gear = make_gear()
    matrix = flank_compliance(gear, coarse_plane(gear)).matrix
    monkeypatch.setattr(ring_2d, "factorise", lambda matrix, block: splu(matrix).solve)  # COLAMD, pivoting
    assert relative(flank_compliance(gear, coarse_plane(gear)).matrix, matrix) < 1e-10


def test_a_singular_matrix_is_a_solve_error():
    singular = sp.csc_array(
        np.array([[1.0, -1.0, 0.0, 0.0], [-1.0, 1.0, 0.0, 0.0], [0, 0, 1.0, 0], [0, 0, 0, 1.0]])
    )
    with pytest.raises(SolveError, match="SuperLU"):
        ring_2d.factorise(singular, block=2)


def test_condensed_teeth_are_centred_and_bounded_by_the_real_ones():
    gear = make_gear()
    recipe = coarse_plane(gear, real_teeth=7)
    assert flank_compliance(gear, recipe).teeth.tolist() == [-2, -1, 0, 1, 2]
    assert flank_compliance(gear, recipe, teeth=7).teeth.tolist() == [-3, -2, -1, 0, 1, 2, 3]
    three = flank_compliance(gear, replace(recipe, real_teeth=3))
    assert three.teeth.tolist() == [-1, 0, 1]
    for wrong in (9, 4, 0):
        with pytest.raises(InputError) as refusal:
            flank_compliance(gear, recipe, teeth=wrong)
        assert refusal.value.field == "teeth"
    with pytest.raises(KeyError):
        three.block(0, 2)


@pytest.mark.parametrize("name", ["residual", "reciprocity", "bore_moment", "energy", "least_eigenvalue"])
def test_a_broken_law_is_refused_by_name(name):
    gear = make_gear()
    found: FlankCompliance = flank_compliance(gear, coarse_plane(gear), teeth=1)
    assert refuse_broken_laws(found) is found
    broken: ComplianceChecks = replace(found.checks, **{name: -1.0 if name == "least_eigenvalue" else 1e-3})
    with pytest.raises(SolveError, match=name.replace("_", ".")) as refusal:
        refuse_broken_laws(replace(found, checks=broken))
    assert refusal.value.partial is not None
    with pytest.raises(SolveError, match=name.replace("_", ".")):
        refuse_broken_laws(replace(found, checks=replace(broken, **{name: float("nan")})))
