"""What rim and web do to the flank compliance of a gear, in the plane and over the face."""

import math
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
from compliance_gears import coarse, coarse_plane, moved

import fe_contact.compliance.cyclic_compliance as flow
from fe_contact import STEEL, Gear, GearBlank
from fe_contact.compliance import (
    FlankCompliance,
    FlankCompliance3D,
    PlaneHypothesis,
    flank_compliance,
    flank_compliance_3d,
    unit_root_stress_3d,
)
from fe_contact.compliance.condensed_gear import condensed_gear, probe_loads
from fe_contact.compliance.condensed_sector import freedoms
from fe_contact.compliance.flank_compliance_2d import compliance_key, condensed_ring
from fe_contact.compliance.ring_checks import uniform_pressure
from fe_contact.geometry.web_compliance import torsion_compliance
from fe_contact.mesh import ClampedBore, mesh_gear, quad_sector
from model_studies.stage_clock import StageClock

SOLID = Gear(teeth=21, normal_module=4e-3, face_width=24e-3, bore_diameter=24e-3)
BLANK = GearBlank(rim_thickness=9e-3, web_thickness=8e-3, hub_diameter=32e-3)


def with_blank(**change: float) -> Gear:
    return replace(SOLID, blank=replace(BLANK, **change))


six_layers = partial(coarse, layers=6)


def moved_2d(compliance: FlankCompliance, tooth: int = 0) -> float:
    """Mean displacement of the flank of a tooth under an even pressure of unit force on tooth 0, 1/Pa."""
    forces = uniform_pressure(compliance.s, compliance.s_form, 1.0).forces
    return float(forces @ compliance.block(tooth, 0) @ forces / forces.sum() ** 2)


@cache
def plane(gear: Gear, teeth: int | None = None) -> FlankCompliance:
    return flank_compliance(gear, coarse_plane(gear), PlaneHypothesis.PLANE_STRESS, teeth=teeth)


@cache
def solid_3d(gear: Gear, reach: int | None = None) -> FlankCompliance3D:
    return flank_compliance_3d(gear, six_layers(gear), reach=reach)


@pytest.mark.law
def test_a_web_of_full_width_is_the_solid_gear_to_the_last_bit():
    full = with_blank(web_thickness=24e-3)
    assert np.array_equal(plane(full).matrix, plane(SOLID).matrix)
    assert np.array_equal(solid_3d(full).blocks, solid_3d(SOLID).blocks)
    nearly = with_blank(web_thickness=24e-3 * (1.0 - 1e-3))
    assert moved(solid_3d(nearly)) == pytest.approx(moved(solid_3d(SOLID)), rel=5e-3)
    assert moved_2d(plane(nearly)) == pytest.approx(moved_2d(plane(SOLID)), rel=5e-3)


@pytest.mark.law
@pytest.mark.parametrize(
    ("field", "values"),
    [
        ("web_thickness", (8e-3, 4e-3)),
        ("rim_thickness", (9e-3, 4e-3)),
        ("hub_diameter", (32e-3, 24e-3)),
    ],
)
def test_less_of_a_body_is_softer(field, values):
    gears = [with_blank(**{field: value}) for value in values]
    flat, face = [plane(g) for g in gears], [solid_3d(g) for g in gears]
    for tooth in (0, 1):
        in_plane, over_face = [moved_2d(c, tooth) for c in flat], [moved(c, tooth) for c in face]
        assert np.all(np.diff(in_plane) > 0.01 * in_plane[0])
        assert np.all(np.diff(over_face) > 0.01 * over_face[0])


@pytest.mark.law
def test_torsion_of_web_and_hub_is_that_of_tubes_in_the_plane():
    """A moment at the rim's inside turns it against hub and bore by (1/r_i^2 - 1/r_o^2) / (4 pi G b)."""
    gear, recipe = with_blank(), coarse_plane(SOLID)
    mesh, web = mesh_gear(gear, recipe), gear.web
    ring = condensed_ring(gear, mesh, PlaneHypothesis.PLANE_STRESS)
    radius = np.linalg.norm(mesh.points, axis=1)
    rim, hub = (np.flatnonzero(np.abs(radius - r) < 1e-9) for r in (web.outer_radius, web.inner_radius))
    around = np.stack([-mesh.points[:, 1], mesh.points[:, 0]], axis=1) / radius[:, None]
    forces = np.zeros((ring.matrix.shape[0], 1))
    forces[ring.position[freedoms(rim)], 0] = (around[rim] / (len(rim) * web.outer_radius)).ravel()
    moved = ring.solve(forces)[:, 0]
    turned = [
        float(np.mean(np.sum(moved[ring.position[freedoms(n)]].reshape(-1, 2) * around[n], axis=1)) / r)
        for n, r in ((rim, web.outer_radius), (hub, web.inner_radius))
    ]
    per_width = web.thickness / gear.face_width
    twisted = torsion_compliance(web.inner_radius, web.outer_radius, STEEL) / per_width
    assert turned[0] - turned[1] == pytest.approx(twisted, rel=1e-3)
    below = torsion_compliance(0.5 * gear.bore_diameter, web.inner_radius, STEEL)
    assert turned[1] == pytest.approx(below, rel=1e-3)


def test_torsion_inside_the_web_is_that_of_a_tube_over_the_face():
    """Equal loads on all teeth twist the body; away from rim and hub the web is in pure shear."""
    gear = with_blank(rim_thickness=6e-3, hub_diameter=28e-3, web_thickness=3e-3)
    recipe = replace(six_layers(gear), body_limit=0.4 * gear.normal_module)
    section = quad_sector(gear, recipe)
    solved, loads = condensed_gear(gear, section, recipe, 1, ClampedBore(), StageClock())
    cuts = np.tile(solved.ring.left.sum(axis=0), (2, 1))[:, :1]
    flank = solved.condensed.flank @ loads[:, :1] + solved.condensed.transmitted.T @ cuts
    field = solved.condensation.expand(np.concatenate([flank, cuts]))[:, 0]
    low, high = (section.grid.body_rows + row for row in section.grid.web_rows)
    turned, radii = [], []
    for row in (low + 2, high - 2):
        nodes = solved.sector.nodes[:, section.grid.number[2 * row, :-1:2]]
        freedom = solved.sector.freedoms[nodes[nodes >= 0], 1]
        radii.append(float(np.linalg.norm(section.points[section.grid.number[2 * row, 0]])))
        turned.append(float(field[freedom].mean()) / radii[-1])
    # Loads along the outward normal turn the gear clockwise.
    moment = -SOLID.teeth * SOLID.base_radius * float(loads[:, 0].sum())
    expected = moment * torsion_compliance(*radii, STEEL) / 3e-3
    assert turned[1] - turned[0] == pytest.approx(expected, rel=5e-3)


@pytest.mark.usefixtures("exact_ring")
def test_a_web_off_the_middle_tilts_the_rim_and_its_mirror_image_the_other_way():
    right, left = (solid_3d(with_blank(web_offset=z)) for z in (6e-3, -6e-3))
    assert not np.allclose(right.z, -right.z[::-1])
    image = right.mirrored()
    assert image.z == pytest.approx(left.z, abs=1e-15)
    scale = np.abs(left.blocks).max()
    assert np.abs(image.blocks - left.blocks).max() < 1e-10 * scale
    loads = probe_loads(right.s, right.z, right.index, right.s_form)
    near = loads[:, 1] @ right.blocks[0] @ loads[:, 1]  # the end of the face beside the web
    loads = probe_loads(left.s, left.z, left.index, left.s_form)
    far = loads[:, 1] @ left.blocks[0] @ loads[:, 1]
    assert far > 1.1 * near
    assert moved(right) > 1.05 * moved(solid_3d(with_blank()))


def test_a_left_hand_gear_keeps_its_web_on_its_side():
    left = replace(SOLID, helix_angle=-math.radians(20.0), blank=replace(BLANK, web_offset=6e-3))
    found = solid_3d(left)
    for face in (left.web.low, left.web.high):
        assert np.abs(found.z - face).min() < 1e-15
    alone = flank_compliance_3d(left, six_layers(left))
    together = flow.flank_compliances_3d([left.right_handed(), left], [six_layers(left)] * 2)
    assert np.array_equal(together[1].blocks, alone.blocks)
    assert np.array_equal(together[1].z, alone.z)
    assert np.array_equal(together[0].z, -alone.z[::-1])
    stress = unit_root_stress_3d(left, six_layers(left), reach=0)
    assert np.array_equal(stress.z, alone.z)
    other = unit_root_stress_3d(left.right_handed(), six_layers(left), reach=0)
    assert np.array_equal(stress.station_z, -other.station_z[::-1])
    assert not np.allclose(stress.station_z, other.station_z)


def test_the_key_knows_the_web():
    recipe, clamped, stress = six_layers(SOLID), ClampedBore(), PlaneHypothesis.PLANE_STRESS
    changes: tuple[dict[str, float], ...] = (
        {},
        {"web_thickness": 7e-3},
        {"rim_thickness": 8e-3},
        {"hub_diameter": 33e-3},
        {"web_offset": 1e-3},
    )
    gears = [SOLID, *(with_blank(**change) for change in changes)]
    assert len({flow.compliance_key_3d(g, recipe, 2, clamped) for g in gears}) == len(gears)
    flat = {compliance_key(g, coarse_plane(g), stress, 5) for g in gears}
    assert len(flat) >= len(gears) - 1
    wider = replace(with_blank(), face_width=30e-3)
    assert compliance_key(wider, coarse_plane(wider), stress, 5) not in flat
