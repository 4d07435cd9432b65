"""Full contact of helical pairs: laws of the turning sections, of the facing flanks, and of solutions."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from spur_gears import GEAR, PAIR

from fe_contact import STEEL, GearPair
from fe_contact.errors import InputError
from verification.full_contact import (
    FullContactTable,
    HelicalMesh,
    Resolution,
    refusal_helical,
    solve_full_contact_helical,
)
from verification.full_contact.helical.contact_lines import FacingFlanks
from verification.full_contact.helical.flank_bodies import (
    FlankStrip,
    MeshedSection,
    face_body,
    meshed_section,
    section_compliance,
)
from verification.full_contact.helical.twisted_stiffness import outward, section_stiffness, twisted_stiffness
from verification.full_contact.over_face.extruded_stiffness import X, Y, Z, extruded_stiffness
from verification.full_contact.over_face.layers import Layers

COARSE = HelicalMesh(flank=0.35, layers=2, across=9, along=9, per_half_width=2.0)
TORQUES = [20.0, 150.0]
HELIX = math.radians(20.0)


def helical_pair(hand: float) -> GearPair:
    pinion = replace(GEAR, helix_angle=hand * HELIX, face_width=12e-3)
    wheel = replace(pinion, helix_angle=-hand * HELIX)
    return GearPair(pinion, wheel, 2.0 * pinion.reference_radius)


@cache
def solved(hand: float) -> FullContactTable:
    return solve_full_contact_helical(helical_pair(hand), TORQUES, [0.2, -0.2], mesh=COARSE)[0]


@cache
def meshed() -> MeshedSection:
    return meshed_section(helical_pair(1.0).pinion, range(1), 1.2e-3, 1.2e-3, Resolution(1.5, 1.0, 1))


LAYERS = Layers(np.linspace(-6e-3, 6e-3, 3))


def test_rigid_motion_along_and_about_the_axis_needs_no_force():
    """A turn and a shift along the axis are alike in all turning sections; a shift across is not."""
    section = meshed().section
    stiffness = twisted_stiffness(section, LAYERS, STEEL)
    x, y = section.points[stiffness.node].T
    hats = stiffness.function <= LAYERS.count
    turned = np.select([stiffness.component == X, stiffness.component == Y], [-y, x]) * hats
    along = 1e-2 * ((stiffness.component == Z) & hats)
    across = 1e-2 * ((stiffness.component == X) & hats)
    forces = [float(np.abs(stiffness.matrix @ motion).max()) for motion in (turned, along, across)]
    scale = float(np.abs(stiffness.matrix.data).max()) * 1e-2
    assert max(forces[:2]) < 1e-11 * scale
    assert forces[2] > 1e-6 * scale


def test_without_twist_it_is_the_extruded_body():
    section = replace(meshed().section, twist=0.0)
    ours = twisted_stiffness(section, LAYERS, STEEL)
    theirs = extruded_stiffness(section.points, section.triangles, LAYERS, STEEL)
    difference = abs(ours.matrix - theirs.matrix)
    assert difference.max() < 1e-11 * abs(theirs.matrix).max()


def test_a_section_gives_way_to_no_shift():
    section = meshed().section
    matrix = section_stiffness(section, STEEL)
    for component in (X, Y, Z):
        shift = np.zeros(matrix.shape[0])
        shift[component::3] = 1.0
        assert np.abs(matrix @ shift).max() < 1e-10 * np.abs(matrix.data).max()


def test_normals_touch_the_base_circle():
    points = np.array([[0.0, 40e-3], [10e-3, 39e-3]])
    normals = outward(points, 37e-3)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, rtol=1e-14)
    moment = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
    np.testing.assert_allclose(moment, -37e-3, rtol=1e-12)


def test_a_body_gives_way_as_its_functions_add_up():
    """The functions of a flank are one together, also where the middle node stands aside."""
    body = face_body(meshed(), LAYERS, STEEL, 1.5)
    strip = body.meshed.strips[0]
    s = np.linspace(strip.s[0], strip.s[-1], 17)
    shapes = body.shapes(0, s, np.linspace(-6e-3, 6e-3, 17))
    hats = len(strip.nodes) * (LAYERS.count + 1)
    np.testing.assert_allclose(shapes[:, :hats].sum(axis=1), 1.0, atol=1e-12)
    assert np.linalg.eigvalsh(body.compliance).min() > 0.0
    assert np.linalg.eigvalsh(section_compliance(meshed(), STEEL)[0]).min() > 0.0
    aside = FlankStrip(np.arange(3), np.array([0.0, 0.6, 1.0]))
    places = np.linspace(0.0, 1.0, 9)
    np.testing.assert_allclose(aside.shapes(places)[0] @ aside.s, places, atol=1e-12)


def relative_radius(pair: GearPair, roll: float) -> float:
    return 1.0 / float(pair.relative_curvature(roll))


@pytest.mark.parametrize("part", [0.2, 0.8])
def test_conjugate_flanks_touch_on_the_line_of_action(part):
    """No gap there, that of the relative curvature beside it, arms of the base radii."""
    path = PAIR.path_of_contact
    roll = path.start + part * path.length
    flanks = FacingFlanks(PAIR, roll, 0.0)
    own = (roll, float(PAIR.mating_roll_length(roll)))[flanks.slave]
    base = GEAR.base_radius
    s = 0.5 * own**2 / base + np.array([-2e-5, 0.0, 2e-5])
    facing = flanks.facing(np.sqrt(2.0 * base * s))
    np.testing.assert_allclose(facing.gap[1], 0.0, atol=1e-15)
    np.testing.assert_allclose(
        facing.gap[[0, 2]].mean(), 0.5 * 2e-5**2 / relative_radius(PAIR, roll), rtol=1e-3
    )
    first, second = flanks.arms(facing)
    np.testing.assert_allclose([first[1], second[1]], 1.0, rtol=1e-12)
    assert flanks.closest[0] == pytest.approx(own, abs=1e-6)


@pytest.mark.law
def test_equilibrium_holds_and_the_lag_grows():
    table = solved(1.0)
    for row in table.points:
        for point in row:
            assert point.status.usable, point.reason
            assert point.residual < 1e-10
            assert sum(point.load_share.values()) == pytest.approx(1.0, abs=1e-10)
            assert point.torque_ratio == pytest.approx(1.0, abs=5e-3)
            projected = sum(np.trapezoid(own.load, own.face_position) for own in point.line_loads)
            force = projected / math.cos(helical_pair(1.0).base_helix_angle)  # the line is oblique
            assert force == pytest.approx(helical_pair(1.0).normal_force(point.torque), rel=1e-2)
    assert np.all(np.diff(table.transmission_error, axis=1) > 0.0)


@pytest.mark.law
def test_the_mirrored_pair_is_the_same():
    np.testing.assert_allclose(solved(-1.0).transmission_error, solved(1.0).transmission_error, rtol=1e-7)


@pytest.mark.law
def test_driven_or_driving_is_the_same_at_the_mirrored_place():
    """Of two equal gears: positions s and -s about the pitch point, seen from the other side."""
    ahead, behind = solved(1.0).transmission_error
    np.testing.assert_allclose(ahead, behind, rtol=2e-3)


def test_what_it_cannot_hold_is_refused():
    assert refusal_helical(helical_pair(1.0)) is None
    unlike = replace(helical_pair(1.0), wheel=replace(helical_pair(1.0).wheel, face_width=9e-3))
    assert "faces" in str(refusal_helical(unlike))
    with pytest.raises(InputError, match="misalignments"):
        solve_full_contact_helical(helical_pair(1.0), [1.0], [0.0], [])
    with pytest.raises(InputError, match="faces"):
        solve_full_contact_helical(unlike, [1.0], [0.0])
