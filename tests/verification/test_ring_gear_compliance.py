"""Compliance of ring gears: annulus in torsion, 2-D against 3-D, refinement, thickness of the rim."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from fe_contact.compliance import PlaneHypothesis, flank_compliance, flank_compliance_3d
from fe_contact.compliance.condensed_gear import pressure_forces
from fe_contact.compliance.condensed_sector import freedoms
from fe_contact.compliance.factorization import factorise
from fe_contact.compliance.plane_elasticity import stiffness_matrix
from fe_contact.compliance.ring_checks import uniform_pressure
from fe_contact.geometry import RingGear, tooth_profile
from fe_contact.mesh import MeshRecipe, PlaneStrain, SectorRecipe, mesh_gear
from fe_contact.mesh.quadratic_mesh import rotated

RING = RingGear(
    teeth=41, normal_module=4e-3, face_width=20e-3, rim_diameter=0.204, profile_shift_coefficient=-0.3
)


def by_distance(gear: RingGear, recipe: MeshRecipe, teeth: int = 5) -> np.ndarray:
    """Flank displacement of every condensed tooth under a unit pressure force on tooth 0, m per N/m."""
    found = flank_compliance(gear, recipe, teeth=teeth)
    load = uniform_pressure(found.s, found.s_form, 1.0).forces
    load /= load.sum()
    return np.array([load @ found.block(int(tooth), 0) @ load for tooth in found.teeth])


def coarse(gear: RingGear) -> MeshRecipe:
    module = gear.normal_module
    return replace(MeshRecipe.standard(gear).refined(0.5), flank_size=0.2 * module, tip_size=0.1 * module)


def work_of_twist(gear: RingGear, recipe: MeshRecipe) -> tuple[float, float]:
    """Work of unit pressure on all right flanks less that on all left ones, and its moment about the axis."""
    mesh, profile = mesh_gear(gear, recipe), tooth_profile(gear)
    forces = uniform_pressure(mesh.sector.s, profile.s_form, 1.0).forces[:, None] * -profile.normal(
        mesh.sector.s
    )
    load = np.zeros_like(mesh.points)
    for nodes, tooth in zip(mesh.sector_nodes, mesh.teeth, strict=True):
        turn = tooth * mesh.pitch_angle
        np.add.at(load, nodes[mesh.sector.flank], rotated(forces, turn))
        np.add.at(load, nodes[mesh.sector.coast_flank], rotated(forces * [1.0, -1.0], turn))
    lame = PlaneHypothesis.PLANE_STRAIN.lame_parameters(gear.material)
    matrix = stiffness_matrix(mesh.points, mesh.triangles, lame)
    free = np.setdiff1d(np.arange(load.size), freedoms(mesh.bore_nodes))
    right = load.ravel()[free]
    solve = factorise(sp.csc_array(matrix[free][:, free]), block=2)
    moment = float(np.sum(mesh.points[:, 0] * load[:, 1] - mesh.points[:, 1] * load[:, 0]))
    return float(right @ solve(right[:, None])[:, 0]), moment


def test_a_thicker_rim_adds_the_twist_of_an_annulus(record_figure):
    """Right flanks pushed and left flanks pulled alike: a torque, and no mean radial force.

    Away from the teeth the field is then axisymmetric, whatever they look like, and what the rim beyond R_1
    adds is T^2/(4 pi mu) (1/R_1^2 - 1/R_2^2) of work.
    """
    gears = [replace(RING, rim_diameter=2.0 * radius) for radius in (0.115, 0.16)]
    (thin, moment), (thick, same) = (work_of_twist(gear, coarse(gear)) for gear in gears)
    assert same == pytest.approx(moment, rel=1e-12)
    exact = moment**2 / (4.0 * np.pi * 210e9 / 2.6) * (0.115**-2 - 0.16**-2)
    error = abs((thick - thin) / exact - 1.0)
    record_figure("ring gear, rim as an annulus in torsion", error, "at most 2e-4", "", "closed form")
    assert error < 2e-4
    assert exact > 0.1 * thin


def test_a_rim_held_farther_out_is_softer_and_couples_the_teeth_more():
    """What is held farther in moves less (Rayleigh); a rim that is hardly there leaves the tooth alone."""
    root = 2.0 * RING.root_radius
    rims = [replace(RING, rim_diameter=root * factor) for factor in (1.002, 1.03, 1.1, 1.3)]
    found = np.array([by_distance(gear, coarse(gear))[2:] for gear in rims])
    assert np.all(np.diff(found, axis=0) > 0.0)
    assert np.all(found[:, 0] > found[:, 1])
    assert np.all(found[:, 1] > found[:, 2])
    assert found[0, 1] < 0.01 * found[0, 0]


def test_plane_strain_in_three_dimensions_is_the_transverse_section(record_figure):
    recipe = replace(SectorRecipe.fine(RING), layers=1, merge_rows=(), layer_growth=1.0)
    found = flank_compliance_3d(RING, recipe, reach=2, support=PlaneStrain())
    on = (found.s[:-2:2] >= found.s_form)[None].astype(float)
    load = pressure_forces(found.s, found.z, found.index, on)
    load /= load.sum()
    solid = RING.face_width * np.array([load @ found.block(m, 0) @ load for m in range(3)])
    plane = by_distance(RING, MeshRecipe.standard(RING))[2:]
    worst = float(np.abs(solid / plane - 1.0).max())
    record_figure("ring gear, plane strain in 3-D over 2-D", worst, "at most 1e-3", "", "two methods")
    assert worst < 1e-3


@pytest.mark.law
def test_compliance_converges_under_refinement(record_figure):
    recipe = MeshRecipe.standard(RING)
    half, full, double = (by_distance(RING, recipe.refined(f)) for f in (0.5, 1.0, 2.0))
    coarse_error, error = np.abs(half / double - 1.0), np.abs(full / double - 1.0)
    record_figure("ring gear, standard mesh over refined", error.max(), "at most 5e-4", "", "refinement")
    assert error.max() < 5e-4
    assert np.all(coarse_error > 4.0 * error)  # second order or better
