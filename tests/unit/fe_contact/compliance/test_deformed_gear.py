"""Expanded gears move as their compliance says, are in equilibrium, and stress exactly where they must."""

import math
from dataclasses import replace

import numpy as np
import pytest
from compliance_gears import HELICAL, SPUR, coarse, coarse_plane
from spur_gears import gear as make_gear

from fe_contact.compliance import PlaneHypothesis, flank_compliance, flank_compliance_3d
from fe_contact.compliance.deformation_3d import deformed_solids
from fe_contact.compliance.deformed_gear import DeformedGear, stress_of
from fe_contact.compliance.deformed_section import deformed_sections, element_stress
from fe_contact.compliance.hexahedron_stiffness import REFERENCE, determinants, hexahedra
from fe_contact.compliance.sector_elements import SectorElements, sector_elements
from fe_contact.errors import InputError
from fe_contact.geometry import BoreSeat, Gear, GearBlank, Key, RingGear, Toothing, tooth_profile
from fe_contact.mesh import mesh_gear, quad_sector, swept_sector

LEFT = replace(SPUR, helix_angle=math.radians(-25.0))
RING = RingGear(30, 4e-3, 20e-3, 150e-3, cutter_teeth=15, addendum_coefficient=0.6)
WEB = Gear(
    21,
    4e-3,
    24e-3,
    24e-3,
    helix_angle=math.radians(-20.0),
    blank=GearBlank(rim_thickness=9e-3, web_thickness=8e-3, web_offset=4e-3, hub_diameter=32e-3),
)
SOLIDS = pytest.mark.parametrize(
    "gear", [SPUR, HELICAL, LEFT, RING, WEB], ids=["spur", "right", "left", "ring", "left with web"]
)
GRADIENT = np.array([[2e-4, -1e-4, 3e-5], [5e-5, -1e-4, 2e-5], [1e-5, 4e-5, 6e-5]])


def random_load(size: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.0, 1.0, size)


@SOLIDS
@pytest.mark.usefixtures("exact_ring")
def test_flanks_move_as_compliance_times_force(gear):
    """Several loaded teeth at once, two sets of loads in one go; every tooth shown, loaded or not."""
    recipe = coarse(gear)
    flank = flank_compliance_3d(gear, recipe, reach=4)
    size = flank.blocks.shape[1]
    loads = [{0: -random_load(size, 1), 1: -random_load(size, 2)}, {-2: random_load(size, 3)}]
    for load, found in zip(loads, deformed_solids(gear, recipe, loads, unloaded=2), strict=True):
        assert len(found.flank_displacement) == len(load) + 4
        for tooth, moved in found.flank_displacement.items():
            expected = sum(flank.block(tooth, other) @ forces for other, forces in load.items())
            assert moved == pytest.approx(expected, rel=1e-10, abs=1e-10 * np.abs(expected).max())
        assert found.residual < 1e-10


@pytest.mark.law
@pytest.mark.parametrize("teeth", [None, 5])
def test_sections_move_as_compliance_times_force(teeth):
    gear = make_gear()
    recipe = coarse_plane(gear, real_teeth=teeth)
    strain = PlaneHypothesis.PLANE_STRAIN
    flank = flank_compliance(gear, recipe, strain, teeth=5)
    load = {0: random_load(flank.s.size, 1), -1: random_load(flank.s.size, 2)}
    (found,) = deformed_sections(gear, recipe, strain, [load])
    for tooth in flank.teeth:
        expected = sum(flank.block(int(tooth), other) @ forces for other, forces in load.items())
        moved = found.flank_displacement[int(tooth)]
        assert moved == pytest.approx(expected, rel=1e-10, abs=1e-10 * np.abs(expected).max())
    assert found.residual < 1e-10


@pytest.mark.parametrize("hypothesis", list(PlaneHypothesis))
def test_sections_bear_along_their_axis_what_their_hypothesis_says(hypothesis):
    gear = make_gear()
    recipe = coarse_plane(gear)
    size = flank_compliance(gear, recipe, hypothesis, teeth=1).s.size
    (found,) = deformed_sections(gear, recipe, hypothesis, [{0: random_load(size, 1)}])
    x, y, z = (found.stress[:, axis, axis] for axis in range(3))
    strain = hypothesis is PlaneHypothesis.PLANE_STRAIN
    expected = gear.material.poissons_ratio * (x + y) if strain else np.zeros_like(z)
    assert z == pytest.approx(expected, abs=1e-9 * np.abs(x).max())


@SOLIDS
def test_elements_agree_and_a_linear_displacement_gives_its_constant_stress(gear):
    """At every node of every element, those that hang on coarser ones too."""
    elements = sector_of(gear)
    moved = elements.nodes @ GRADIENT.T
    expected = stress_of(GRADIENT, PlaneHypothesis.PLANE_STRAIN.lame_parameters(gear.material))
    assert np.abs(elements.stress(moved) - expected).max() < 1e-9 * np.abs(expected).max()
    assert elements.points > len(elements.sector.freedoms)  # some do hang
    field = np.sin(np.arange(elements.sector.size, dtype=float))
    for values in (elements.nodes, elements.displacement(field)):
        first = np.full((elements.points, 3), np.nan)
        first[elements.numbers] = values
        assert np.abs(first[elements.numbers] - values).max() < 1e-12 * np.abs(values).max()


def sector_of(gear: Toothing) -> SectorElements:
    right = gear.right_handed()
    recipe = coarse(gear)
    section = quad_sector(right, recipe)
    return sector_elements(
        right, section, swept_sector(section.grid, right.face_width, recipe, None, right.web)
    )


@pytest.mark.parametrize("hypothesis", list(PlaneHypothesis))
def test_linear_displacement_gives_its_constant_plane_stress(hypothesis):
    """Against Hooke's law in E and nu."""
    gear = make_gear()
    mesh = mesh_gear(gear, coarse_plane(gear))
    lame = hypothesis.lame_parameters(gear.material)
    strain = hypothesis is PlaneHypothesis.PLANE_STRAIN
    found = element_stress(mesh, mesh.points @ GRADIENT[:2, :2].T, lame, lame[0] if strain else 0.0)
    E, nu = gear.material.youngs_modulus, gear.material.poissons_ratio
    x, y, xy = GRADIENT[0, 0], GRADIENT[1, 1], GRADIENT[0, 1] + GRADIENT[1, 0]
    if strain:
        c = E / ((1 + nu) * (1 - 2 * nu))
        expected = [c * ((1 - nu) * x + nu * y), c * ((1 - nu) * y + nu * x), c * nu * (x + y)]
    else:
        expected = [E / (1 - nu**2) * (x + nu * y), E / (1 - nu**2) * (y + nu * x), 0.0]
    tensor = np.diag(expected)
    tensor[0, 1] = tensor[1, 0] = E / (2 * (1 + nu)) * xy
    assert np.abs(found - tensor).max() < 1e-9 * np.abs(tensor).max()


@SOLIDS
def test_solids_are_whole_and_right_side_out(gear):
    """Each point is used; neighbors share their cut; volumes are positive; tips are where they belong."""
    recipe = coarse(gear)
    size = flank_compliance_3d(gear, recipe, reach=0).blocks.shape[1]
    load = {1: -random_load(size, 5)}
    (one,) = deformed_solids(gear, recipe, [load], unloaded=0)
    (three,) = deformed_solids(gear, recipe, [load], unloaded=1)
    elements = sector_of(gear)
    cut = elements.sector.nodes[:, elements.sector.grid.left]
    assert len(one.points) == elements.points
    assert len(three.points) == 3 * elements.points - 2 * np.count_nonzero(cut >= 0)
    assert sorted(set(three.tooth.tolist())) == [0, 1, 2]
    for found in (one, three):
        assert np.array_equal(np.unique(found.cells), np.arange(len(found.points)))
        mesh = hexahedra(found.points[found.cells])
        assert determinants(mesh, 0.5 * (REFERENCE[:8].T * 0.5 + 1.0)).min() > 0.0
        assert found.quality["scaled_jacobian"].min() > 0.0
    helix = math.tan(gear.helix_angle) / gear.reference_radius
    tip = tip_at(three, gear, 0.5 * gear.face_width), tip_at(three, gear, -0.5 * gear.face_width)
    turned = math.remainder(tip[0] - tip[1], 2.0 * math.pi)
    assert turned == pytest.approx(helix * gear.face_width, abs=1e-9)


def tip_at(found: DeformedGear, gear: Toothing, z: float) -> float:
    """Angle of the loaded tip edge of tooth 1 in the plane z."""
    angle = 2.0 * math.pi / gear.teeth + math.tan(gear.helix_angle) / gear.reference_radius * z
    x, y = tooth_profile(gear).flank(np.array([tooth_profile(gear).s_tip]))[0]
    c, s = math.cos(angle), math.sin(angle)
    wanted = np.array([c * x - s * y, s * x + c * y, z])
    nearest = found.points[np.linalg.norm(found.points - wanted, axis=1).argmin()]
    assert nearest == pytest.approx(wanted, abs=1e-9)
    return math.atan2(nearest[1], nearest[0])


def test_a_whole_ring_closes():
    recipe = coarse(SPUR)
    size = flank_compliance_3d(SPUR, recipe, reach=0).blocks.shape[1]
    (found,) = deformed_solids(SPUR, recipe, [{0: -random_load(size, 5)}], unloaded=20)
    elements = sector_of(SPUR)
    cut = elements.sector.nodes[:, elements.sector.grid.left]
    assert len(found.points) == SPUR.teeth * (elements.points - np.count_nonzero(cut >= 0))
    assert found.residual < 1e-10


def test_a_gear_on_an_elastic_seat_moves_as_its_compliance_and_a_key_is_refused():
    seat = BoreSeat(5e13, 3e13, 5e13, width=12e-3)
    gear, recipe = replace(LEFT, seat=seat), coarse(LEFT)
    flank = flank_compliance_3d(gear, recipe, reach=1)
    load = {0: -random_load(flank.blocks.shape[1], 1)}
    (found,) = deformed_solids(gear, recipe, [load])
    for tooth, moved in found.flank_displacement.items():
        expected = flank.block(tooth, 0) @ load[0]
        assert moved == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())
    assert found.residual < 1e-9
    assert len(np.unique(np.sort(found.cells, axis=1), axis=0)) == len(found.cells) == len(found.tooth)
    with pytest.raises(InputError, match=r"seat\.key"):
        deformed_solids(replace(gear, seat=replace(seat, key=Key(1e-3))), recipe, [load])


def test_invariants_of_known_stresses():
    uniaxial, shear = np.diag([0.0, 7.0, 0.0]), np.zeros((3, 3))
    shear[0, 2] = shear[2, 0] = 2.0
    nodes = np.zeros((2, 3))
    cells = np.zeros((1, 6), dtype=int)
    found = DeformedGear(nodes, cells, cells[:, 0], nodes, np.stack([uniaxial, shear]), {}, {}, 0.0)
    assert found.von_mises == pytest.approx([7.0, 2.0 * math.sqrt(3.0)])
    assert found.principal_stress == pytest.approx(np.array([[0.0, 0.0, 7.0], [-2.0, 0.0, 2.0]]), abs=1e-12)
    turned = found.placed(0.3, (0.0, 0.1, 0.0))
    assert turned.von_mises == pytest.approx(found.von_mises)
    assert turned.stress[0, 0, 0] == pytest.approx(7.0 * math.sin(0.3) ** 2)
