"""Static deflection: closed forms, the law of the sum, scaling, mirror images, load against deflection."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import STEEL, bending_stiffness, flexible_pair, torsional_stiffness
from geared_scenes import BASE_RADIUS, gear_pair_scene, spring_table, with_gear
from sliced_face import sliced_database
from two_stage_scenes import mirrored_across, mirrored_along, two_stages

from dynamics import Bushing, FreeRotation, Housing, RollingContact, TimeLaw
from dynamics.assembly.assemble import assemble
from dynamics.deflection import CAUSES, LoadCase, deflect, equivalent_load, loaded_scene
from dynamics.deflection.deflect import cycle_times
from dynamics.deflection.loaded_scene import with_loads
from dynamics.deflection.rest_positions import rest_over
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.mechanism.flank_gradients import misalignment_gradient
from dynamics.motion.observation import local_state

FORCE, FACE = 100.0 / BASE_RADIUS, 0.025
SHAFT, BEARING, CLEARANCE, HOUSING, COUPLING, SET = range(len(CAUSES))
M = (-60e-6, -30e-6, -10e-6, 0.0, 10e-6, 30e-6, 60e-6)


@pytest.fixture(scope="module")
def sliced():
    return sliced_database(M, positions=12).force_table()


def only(scene, case=None, positions=3):
    return deflect(scene, (case or LoadCase("load"),), positions).cases[0]


def rigid_pair(gear=0.06, stiffness=1e8, table=None, **changes):
    """The 20/20 pair, both gears at `gear` along rigid shafts of 200 mm on springs at their ends."""
    scene = gear_pair_scene(table or spring_table(4e8))
    scene = with_gear(with_gear(scene, 0, position=gear), 1, position=gear)
    bushings = tuple(
        Bushing(f"{shaft}.{end}", shaft, z, stiffness)
        for shaft in ("input", "output")
        for end, z in (("left", 0.0), ("right", 0.2))
    )
    return replace(scene, bushings=bushings, **changes)


def parts(case, mesh=0):
    return case.meshes[mesh].causes


def test_a_rigid_shaft_on_springs_tilts_by_its_reactions():
    k, share = 1e8, 0.06 / 0.2
    case = only(rigid_pair())
    expected = 2.0 * FACE * FORCE * ((1.0 - share) - share) / (k * 0.2)  # two gears, apart
    assert case.meshes[0].misalignment == pytest.approx(expected, rel=1e-9)
    assert parts(case)[BEARING] == pytest.approx(expected, rel=1e-9)
    left = next(load for load in case.bearings if load.name == "input.left")
    assert left.radial == pytest.approx((1.0 - share) * FORCE, rel=1e-9)
    assert np.hypot(*left.elastic[:2]) == pytest.approx((1.0 - share) * FORCE / k, rel=1e-9)


def test_the_center_distance_grows_as_the_gears_are_pressed_apart():
    share, k = 0.5, 1e8
    case = only(rigid_pair(gear=0.1))
    apart = 2.0 * FORCE * math.sin(math.radians(20.0)) * share / k
    assert case.meshes[0].center_distance_change == pytest.approx(apart, rel=1e-6)


def test_a_beam_between_two_bearings_slopes_at_the_gear():
    a, b = 0.06, 0.14
    case = only(flexible_pair(gear=a, stiffness=1e9, table=spring_table(4e8)))
    slope = FORCE * a * b * (b - a) / (3.0 * bending_stiffness(STEEL) * (a + b))
    # the gear stands where the line still falls: its slope is against that of its bearings
    assert parts(case)[SHAFT] == pytest.approx(-2.0 * FACE * slope, rel=1e-6)
    assert parts(case)[BEARING] == pytest.approx(2.0 * FACE * FORCE * 0.4 / (1e9 * 0.2), rel=1e-6)


def test_a_torque_from_one_side_twists_the_gear_by_half_its_face():
    scene = flexible_pair(gear=0.1, table=spring_table(4e8))
    case = only(scene)
    half = 0.5 * FACE * 100.0 / torsional_stiffness(STEEL)
    one = only(replace(scene, loads=tuple(replace(load, position=0.1) for load in scene.loads)))
    # the drive holds the left end of the input; the brake takes the output at its own gear: no twist there
    assert abs(one.meshes[0].lead_torsion) == pytest.approx(BASE_RADIUS * half, rel=1e-6)
    assert abs(case.meshes[0].lead_torsion) > 0.0


def test_the_end_nearer_to_the_motor_is_pressed_harder():
    """The motor holds the left end and turns in +z: the pinion's right end lags, its flank backs off there.

    Positive z of the table's gear is towards the left here.
    """
    scene = flexible_pair(gear=0.1, table=spring_table(4e8))
    one = only(replace(scene, loads=tuple(replace(load, position=0.1) for load in scene.loads)))
    assert one.meshes[0].lead_torsion < 0.0


def with_clearance(scene, name, clearance, law=(3e8, 1.0)):
    """The scene with a bearing of this clearance in place of the bushing's springs."""
    bushings = tuple(
        replace(part, radial_stiffness=0.0) if part.name == name else part for part in scene.bushings
    )
    contact = RollingContact(name, law[0], law[1], clearance=clearance)
    return replace(scene, bushings=bushings, rolling_contacts=(*scene.rolling_contacts, contact))


@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_clearance_is_what_the_bearing_moves_before_it_presses(exponent):
    clearance = 12e-6
    stiffness = 3e8 if exponent == 1.0 else 3e10
    scene = with_clearance(rigid_pair(), "input.left", clearance, (stiffness, exponent))
    case = only(scene)
    left = next(load for load in case.bearings if load.name == "input.left")
    assert np.hypot(*left.clearance[:2]) == pytest.approx(clearance, rel=1e-6)
    pressed = (0.7 * FORCE / stiffness) ** (1.0 / exponent)
    assert np.hypot(*left.elastic[:2]) == pytest.approx(pressed, rel=1e-6)
    assert parts(case)[CLEARANCE] == pytest.approx(FACE * clearance / 0.2, rel=1e-6)


def test_a_housing_moves_its_seats_in_series_with_the_bearings():
    scene, own, ground = rigid_pair(), 1e8, 4e8
    seats = tuple(part.name for part in scene.bushings[:2])
    matrix = tuple(tuple(ground if i == j else 0.0 for j in range(6)) for i in range(6))
    case = only(replace(scene, housings=(Housing("box", seats, matrix),)))
    assert parts(case)[HOUSING] == pytest.approx(0.5 * parts(only(scene))[BEARING] * own / ground, rel=1e-9)
    load = case.bearings[0]
    assert load.seat[:2] == pytest.approx(load.force[:2] / ground, rel=1e-9)
    assert load.elastic[:2] == pytest.approx(load.force[:2] / own, rel=1e-9)


def everything(table):
    """The two stages with clearance, an elastic housing and misalignments set."""
    scene = with_clearance(two_stages(table), "mid.left", 8e-6)
    rng = np.random.default_rng(5)
    root = rng.normal(size=(6, 6)) * 1e4
    matrix = root @ root.T + 2e8 * np.eye(6)
    housing = Housing("box", ("in.left", "out.right"), tuple(tuple(map(float, row)) for row in matrix))
    meshes = tuple(replace(mesh, misalignment=m) for mesh, m in zip(scene.meshes, (5e-6, -3e-6), strict=True))
    return replace(scene, housings=(housing,), meshes=meshes)


@pytest.mark.parametrize("direction", ["drive", "coast"])
def test_the_causes_add_up_to_the_misalignment(sliced, direction):
    case = only(everything(sliced), LoadCase("load", direction=direction), 5)
    assert case.status == "converged"
    for mesh in case.meshes:
        assert mesh.causes.sum() == pytest.approx(mesh.misalignment, rel=1e-9)
        assert np.all(mesh.causes[[SHAFT, BEARING, HOUSING, SET]] != 0.0)
        assert mesh.causes[COUPLING] == 0.0
    sign = 1.0 if direction == "drive" else -1.0
    assert case.meshes[0].causes[SET] == sign * 5e-6


def test_without_a_cause_its_part_is_zero():
    rigid = only(two_stages(flexible=False))
    assert [mesh.causes[SHAFT] for mesh in rigid.meshes] == pytest.approx([0.0, 0.0], abs=1e-15)
    stiff = only(two_stages(stiffness=1e13))
    for mesh in stiff.meshes:
        assert abs(mesh.causes[BEARING]) < 1e-4 * abs(mesh.causes[SHAFT])
        assert np.all(mesh.causes[[CLEARANCE, HOUSING, COUPLING, SET]] == 0.0)


def test_with_linear_parts_deflection_doubles_with_the_load():
    scene = two_stages()
    one, two = deflect(scene, (LoadCase("one"), LoadCase("two", factor=2.0)), 3).cases
    for first, second in zip(one.meshes, two.meshes, strict=True):
        assert second.causes == pytest.approx(2.0 * first.causes, rel=1e-8, abs=1e-18)
        assert second.lead_torsion == pytest.approx(2.0 * first.lead_torsion, rel=1e-8)
    assert two.shafts.motion == pytest.approx(2.0 * one.shafts.motion, rel=1e-7, abs=1e-14)


def test_a_gearbox_mirrored_end_for_end_has_the_opposite_misalignment(sliced):
    scene = two_stages(sliced)
    own, other = only(scene), only(mirrored_along(scene))
    for first, second in zip(own.meshes, other.meshes, strict=True):
        assert abs(first.misalignment) > 1e-6
        assert second.causes == pytest.approx(-first.causes, rel=1e-6, abs=1e-13)
        assert second.load_arm == pytest.approx(-first.load_arm, rel=1e-5)
        assert second.lead_torsion == pytest.approx(-first.lead_torsion, rel=1e-6)


def test_the_coast_side_is_the_driving_side_of_the_gearbox_mirrored_across(sliced):
    """The mirror image turns in the other sense: driven as the scene says, it is pushed on its coast side.

    Its gaps grow as those of the original along z, and so against them along the face of the driving gear.
    """
    scene = two_stages(sliced)
    own, other = only(scene), only(mirrored_across(scene), LoadCase("load", direction="coast"))
    for first, second in zip(own.meshes, other.meshes, strict=True):
        assert second.causes == pytest.approx(-first.causes, rel=1e-6, abs=1e-13)
        assert second.center_distance_change == pytest.approx(first.center_distance_change, rel=1e-6)
    for first, second in zip(own.bearings, other.bearings, strict=True):
        assert second.force[:3] == pytest.approx(first.force[:3] * [1.0, -1.0, 1.0], rel=1e-6, abs=1e-6)


def test_the_coast_side_of_a_helical_gearbox_is_another_one(sliced):
    drive, coast = deflect(two_stages(sliced), (LoadCase("a"), LoadCase("b", direction="coast")), 3).cases
    assert abs(coast.meshes[0].misalignment) != pytest.approx(abs(drive.meshes[0].misalignment), rel=0.05)


def test_a_mesh_without_load_has_no_arm(sliced):
    system = assemble(replace(rigid_pair(table=sliced), loads=()))
    rest = rest_over(system, np.zeros(1))
    assert rest.mesh_force.tolist() == [[0.0]]
    assert np.isnan(rest.load_arm).all()


def test_mesh_load_and_shaft_deflection_agree(sliced):
    """The reactions put the load where the table has its arm at the misalignment of the shafts."""
    system = assemble(loaded_scene(rigid_pair(table=sliced), LoadCase("load")))
    rest = rest_over(system, cycle_times(system, 7))
    line, sense = system.lines[0], system.kinematics.mesh_sense[0]
    row = misalignment_gradient(system.scene, system.rotors, 0, line, sense)
    at = int(system.driving_rows[0]) + 1
    assert rest.element[:, at] == pytest.approx(rest.motion @ row, rel=1e-12)
    names = list(system.supports.name)
    left, right = (rest.bearing_force[:, names.index(f"input.{end}"), :2] for end in ("left", "right"))
    total = np.einsum("kd,kd->k", left + right, left + right)
    where = 0.2 * np.einsum("kd,kd->k", right, left + right) / total
    # positive face position is towards -z of a gear that turns in +z
    assert 0.06 - where == pytest.approx(rest.load_arm[:, 0], rel=1e-6)
    assert np.min(np.abs(rest.load_arm)) > 1e-4


def test_every_mesh_takes_every_position_once():
    system = assemble(loaded_scene(two_stages(), LoadCase("load")))
    times = cycle_times(system, 16)
    n = system.freedoms.column.size
    seen = np.array([local_state(system.arrays, t, np.zeros(n), np.zeros(n)).position[:2] for t in times])
    steps = np.arange(times.size) / times.size
    for mesh in range(2):
        turned = seen[:, mesh] - system.phases.position[mesh]
        assert np.sort(np.mod(turned + 1e-9, 1.0)) == pytest.approx(steps, abs=2e-9)
    assert times.size in (16, 17, 18, 19, 20)


def test_a_torque_on_the_leading_shaft_sets_the_factor():
    ratio = 52.0 / 17.0 * 61.0 / 19.0
    case = only(two_stages(), LoadCase("load", torque=50.0, speed=200.0))
    assert (case.torque, case.speed) == pytest.approx((50.0, 200.0), rel=1e-12)
    factor = only(two_stages(), LoadCase("load", factor=50.0 * ratio / 900.0))
    assert case.meshes[1].force == pytest.approx(factor.meshes[1].force, rel=1e-9)
    out = next(load for load in case.bearings if load.name == "out.left")
    assert out.speed == pytest.approx(200.0 / ratio, rel=1e-12)


def test_a_run_up_adds_nothing_to_the_torque_of_a_load_case():
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.ramp(100.0, 300.0, 0.05))
    own = static_equilibrium(assemble(scene)).mesh_force[0]
    loaded = with_loads(scene, LoadCase("load", torque=60.0, speed=200.0))
    force = static_equilibrium(assemble(loaded)).mesh_force[0]
    assert force == pytest.approx(60.0 / BASE_RADIUS, rel=1e-9)
    assert own > 1.01 * 100.0 / BASE_RADIUS  # accelerating the driven gear takes torque, too


def test_a_free_train_is_held_where_its_law_is():
    scene = two_stages()
    free = replace(scene, drives=(), free_rotations=(FreeRotation("motor", "in", 150.0),))
    own, other = only(scene), only(free)
    assert other.meshes[0].causes == pytest.approx(own.meshes[0].causes, rel=1e-9, abs=1e-18)


def test_cases_that_cannot_be_are_refused_by_name():
    scene = two_stages()
    with pytest.raises(InputError, match="factor"):
        LoadCase("load", torque=10.0, factor=2.0)
    with pytest.raises(InputError, match="load_cases"):
        deflect(scene, (LoadCase("same"), LoadCase("same")))
    still = replace(scene, drives=(), free_rotations=(FreeRotation("motor", "in"),))
    with pytest.raises(InputError, match="speed"):
        deflect(still)
    idle = replace(scene, loads=tuple(replace(load, torque=TimeLaw.constant(0.0)) for load in scene.loads))
    with pytest.raises(InputError, match=r"load_cases\[1\]\.torque"):
        deflect(idle, (LoadCase("own"), LoadCase("load", torque=10.0)))


def test_a_misalignment_beyond_the_table_is_flagged():
    narrow = sliced_database((-1e-6, 0.0, 1e-6), positions=8).force_table()
    assert not only(rigid_pair(table=narrow)).meshes[0].in_table
    assert only(rigid_pair(gear=0.1, table=narrow)).meshes[0].in_table


def test_the_equivalent_load_adds_damage():
    assert equivalent_load((10.0, 20.0), (1.0, 1.0), (1.0, 1.0), 3.0) == pytest.approx(4500.0 ** (1 / 3))
    assert equivalent_load((7.0, 0.0), (5.0, 2.0), (1.0, 0.0)) == pytest.approx(7.0)
    assert equivalent_load((7.0,), (0.0,), (1.0,)) == 0.0
