"""Flanks in space: derivatives, reaction, signs, static limit, energy, and what is said beyond the axes."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, with_bushings, with_gear, with_mesh
from sliced_face import FACE_WIDTH, sliced_database

from dynamics import CoastFlank, Integration, Outputs, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.forces.elements import SPATIAL_FLANK
from dynamics.integrators import static_equilibrium
from dynamics.linearize import natural_modes
from dynamics.mechanism.rotor import build_rotor
from dynamics.motion.force_balance import force_balance
from dynamics.types import StaticStatus

EFFECTS = ("dynamic_misalignment", "dynamic_center_distance", "moving_application_point")
M, A = (-60e-6, -30e-6, -10e-6, 0.0, 10e-6, 30e-6, 60e-6), (-1e-4, 0.0, 1e-4)


@pytest.fixture(scope="module")
def database():
    return sliced_database(M, A, positions=12)


@pytest.fixture(scope="module")
def table(database):
    return database.force_table()


def scene_on(table, on=EFFECTS, *, speed=900.0, duration=0.02, **changes):
    """The pair with the gears off the middle of their shafts, so that loads tilt them unlike."""
    effects = {"tilt": "on", **{name: "on" if name in on else "off" for name in EFFECTS}}
    scene = gear_pair_scene(table, speed=TimeLaw.constant(speed * RPM), duration=duration, **changes)
    scene = with_gear(with_gear(scene, 0, position=0.06), 1, position=0.06)
    stiffer = replace(scene.bushings[0], radial_stiffness=3e8)
    return replace(scene, effects=effects, bushings=(stiffer, *scene.bushings[1:]))


def state(system, rng):
    """A random state in contact, on both axes."""
    n = system.freedoms.column.size
    q = static_equilibrium(system).displacement + rng.normal(size=n) * 1e-6 / system.arrays.scale
    return q, rng.normal(size=n) * 1e-3 / system.arrays.scale


@pytest.mark.drawn
@pytest.mark.parametrize("on", [EFFECTS, EFFECTS[:1], EFFECTS[1:2], EFFECTS[2:], EFFECTS[:2]])
def test_the_stage_matrices_are_the_derivatives_of_the_forces(table, on):
    system = assemble(scene_on(table, on))
    arrays, rng = system.arrays, np.random.default_rng(2)
    none = np.zeros(system.freedoms.column.size)
    for time in (0.0, 1e-4, 2e-3):
        q, v = state(system, rng)
        found = force_balance(arrays, time, q, v, none)
        assert found.local.force[0] > 0.0
        for column in range(none.size):
            e = (np.arange(none.size) == column) / arrays.scale[column]
            for matrix, at_q, at_v in ((found.stiffness, 1e-10 * e, none), (found.damping, none, 1e-6 * e)):
                up = force_balance(arrays, time, q + at_q, v + at_v, none).force
                down = force_balance(arrays, time, q - at_q, v - at_v, none).force
                difference = -(up - down) / (2.0 * (at_q + at_v)[column])
                scale = np.abs(matrix[:, column]).max()
                np.testing.assert_allclose(matrix[:, column], difference, rtol=1e-4, atol=1e-5 * scale)


def test_no_net_force_and_moment_of_any_row(table):
    scene = scene_on(table)
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.3), 1, base_helix_angle=-0.3, position=0.063)
    scene = with_mesh(scene, coast=CoastFlank(50e-6))
    system = assemble(replace(scene, effects={**scene.effects, "backlash": "on"}))
    centers = [build_rotor(scene, shaft).center for shaft in scene.shafts]
    assert [element.gradient.shape[0] for element in system.elements] == [3, 3]
    for element in system.elements:
        for row in element.gradient.reshape(3, 2, 6):
            np.testing.assert_allclose(row[:, :3].sum(axis=0), 0.0, atol=1e-15)
            moment = sum(np.cross(c, g[:3]) + g[3:] for c, g in zip(centers, row, strict=True))
            np.testing.assert_allclose(moment, 0.0, atol=1e-15)


@pytest.mark.parametrize(("body", "sense"), list(product((0, 1), (1.0, -1.0))))
def test_the_load_moves_to_the_end_that_a_tilt_presses_together(table, body, sense):
    """A rotor is turned so that its flank advances at the +z end: there the load's centroid goes."""
    scene = scene_on(table, speed=sense * 900.0)
    system = assemble(scene)
    line = system.lines[0]
    advances = np.cross([0.0, 0.0, 1.0], line.force * [1.0, 1.0, 0.0])  # r x z along n is r (z x n)
    q = static_equilibrium(assemble(scene_on(table, (), speed=sense * 900.0))).displacement
    for kind in range(2):
        location = system.freedoms.find(body, 3 + kind)
        q[location] += (1.0 if body == 0 else -1.0) * 5e-4 * advances[kind]
    found = force_balance(system.arrays, 0.0, q, np.zeros(q.size), np.zeros(q.size)).local
    lever = -found.force[1] / found.force[0]
    assert -sense * lever > 0.05  # of the face, towards +z
    # the moment on the driver turns it back: its flank recedes at the +z end
    on_driver = -found.force[1] * system.elements[0].gradient[1].reshape(2, 6)[0, 3:5]
    assert on_driver @ advances[:2] < 0.0


@pytest.mark.law
def test_the_static_limit_is_the_database_at_the_operating_point_of_the_bodies(table, database):
    scene = with_mesh(scene_on(table), misalignment=5e-6, center_distance_change=2e-5)
    system = assemble(scene)
    found = static_equilibrium(system)
    assert found.status is StaticStatus.CONVERGED
    assert system.arrays.elements.offset.tolist() == [0.0, 5e-6, 2e-5]  # the mesh's constant parts
    d, m, a = (system.arrays.direction @ found.displacement) + system.arrays.elements.offset
    assert abs(m - 5e-6) > 1e-6
    assert abs(a - 2e-5) > 1e-6
    assert d == pytest.approx(float(database.ste(0.0, found.mesh_force[0], m, a)), rel=1e-9)
    remote = float(database.ste(0.0, found.mesh_force[0], 0.0, 0.0))
    assert abs(d / remote - 1.0) > 2e-3
    slow = simulate(replace(scene_on(table, speed=1.0, duration=0.5), outputs=scene.outputs))
    still = database.ste(slow.position[0], slow.mesh_force[0], slow.misalignment[0],
                         slow.center_distance_change[0])  # fmt: skip
    np.testing.assert_allclose(slow.dynamic_transmission_error[0], still, rtol=1e-3)


def test_a_table_that_does_not_depend_on_its_axes_runs_like_one_without_them():
    """Three equal knots: the spatial element gives what the plane one does, Newton with three rows too."""
    flat = sliced_database((0.0,), (0.0,), positions=12)
    fields = {name: getattr(flat.force_table(), name) for name in
              ("deflection", "deflection_slope", "stiffness", "stiffness_slope")}  # fmt: skip
    wide = {name: np.broadcast_to(values, (3, 3, *values.shape[2:])) for name, values in fields.items()}
    derivative = {}
    for name in ("deflection", "stiffness"):
        numbers = np.zeros((2, 2, 2, *wide[name].shape))
        numbers[0, 0, 0], numbers[0, 0, 1] = wide[name], wide[f"{name}_slope"]
        derivative[f"{name}_derivative"] = numbers
    knots = np.array([-1e-4, 0.0, 1e-4])
    spread = replace(flat.force_table(), misalignment=knots, center_distance_change=knots, load_arm=None,
                     sliding_share=None, sliding_lever=None,
                     **wide, **derivative)  # fmt: skip
    plain, spatial = (simulate(scene_on(t, EFFECTS[:2])) for t in (flat.force_table(), spread))
    assert spatial.misalignment.shape == plain.mesh_force.shape
    assert plain.misalignment.size == 0
    for name in ("dynamic_transmission_error", "mesh_force", "bearing_force"):
        scale = np.abs(getattr(plain, name)).max()
        np.testing.assert_allclose(getattr(spatial, name), getattr(plain, name), rtol=0.0, atol=2e-6 * scale)


def jolted(table, on):
    """Undamped and all but still, so that nothing but the vibration turns energy over; the load jolts it."""
    scene = scene_on(table, on, speed=1e-7)
    jolt = TimeLaw((0.0, 1e-3, 1.1e-3, 3e-3, 3.1e-3), (100.0, 100.0, 160.0, 160.0, 100.0))
    scene = with_mesh(with_bushings(scene, damping_ratio=0.0), damping=0.0)
    return replace(
        scene,
        loads=(replace(scene.loads[0], torque=jolt),),
        integration=Integration("implicit", tolerance=1e-10),
    )


@pytest.mark.parametrize("on", [EFFECTS, EFFECTS[:1], EFFECTS[1:2], EFFECTS[:2]])
def test_the_work_of_the_axes_closes_the_audit(table, on):
    energy = simulate(jolted(table, on)).energy
    assert abs(energy.axes) > 5e-6  # the two axes work against each other: alone 3.1e-5 and -3.9e-5 J
    assert abs(energy.residual) < 2e-3 * abs(energy.axes)
    assert energy.relative < 1e-6


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_the_audit_of_a_run_closes(table, method):
    scene = scene_on(table, speed=3000.0, duration=0.1)
    energy = simulate(replace(scene, integration=Integration(method, tolerance=1e-11))).energy
    assert energy.meshes > 1e-3
    assert energy.relative < 1e-3


@pytest.mark.parametrize("lead", [0.0, 0.3, -0.3], ids=["spur", "one hand", "other hand"])
def test_the_moment_belongs_to_the_same_potential(lead):
    """Where the force has its arm, the axes supply little: F arm = -b dV/dm, by reciprocity.

    Lines of contact whose middle lies off the pitch point are opened by `lead` of the tilt more.
    """
    fine = sliced_database(np.linspace(-20e-6, 20e-6, 25), positions=8, forces=np.geomspace(50.0, 6000.0, 12))
    opened = lead * fine.misalignment[:, None]
    helical = replace(
        fine,
        static_transmission_error=fine.static_transmission_error + opened,
        no_load_transmission_error=fine.no_load_transmission_error + opened,
        support_transmission_error=fine.support_transmission_error + opened,
        load_arm=fine.face_centroid + lead * FACE_WIDTH,
    )
    works = [simulate(jolted(helical.force_table(), on)).energy.axes for on in (EFFECTS[::2], EFFECTS[:1])]
    assert abs(works[0]) < 0.15 * abs(works[1])
    if lead:
        centered = replace(helical, load_arm=fine.face_centroid).force_table()
        assert abs(simulate(jolted(centered, EFFECTS[::2])).energy.axes) > 0.3 * abs(works[1])


def test_both_integrators_agree_and_smaller_steps_converge(table):
    scene = scene_on(table, duration=0.01)
    runs = {
        (method, tolerance): simulate(replace(scene, integration=Integration(method, tolerance=tolerance)))
        for method, tolerance in (("implicit", 1e-11), ("explicit", 1e-11), ("implicit", 1e-9))
    }
    exact = runs["explicit", 1e-11].dynamic_transmission_error
    errors = [
        float(np.sqrt(np.mean((runs["implicit", tolerance].dynamic_transmission_error - exact) ** 2)))
        for tolerance in (1e-11, 1e-9)
    ]
    assert errors[0] < 1e-11
    assert errors[1] < 1e-9
    mean = {key: run.statistics.newton_mean for key, run in runs.items()}
    assert mean["implicit", 1e-9] < 3.0


@pytest.mark.parametrize("technique", ["variable_torque", "constant_torque"])
def test_off_changes_no_bit(table, technique):
    """Effects off: a table with axes and load arm runs as the same arrays without either."""
    bare = replace(table, load_arm=None, deflection_derivative=None, stiffness_derivative=None)
    plain, off = (simulate(scene_on(t, (), technique=technique)) for t in (bare, table))
    for name in ("dynamic_transmission_error", "mesh_force", "drive_torque", "bearing_force"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(off, name))
    assert plain.statistics == off.statistics
    assert plain.energy == off.energy
    assert off.energy.axes == 0.0
    assert off.load_arm.size == off.misalignment.size == off.center_distance_change.size == 0


def test_a_run_beyond_the_axis_says_so_and_holds_the_last_value(database):
    narrow = sliced_database((-1e-7, 1e-7), positions=12).force_table()
    points = Outputs(20e3, anti_alias=False)
    result = simulate(replace(scene_on(narrow, EFFECTS[:1], duration=2e-3), outputs=points))
    check = next(c for c in result.effect_ledger["checks"] if c["effect"] == "dynamic_misalignment")
    assert not check["holds"]
    assert "tilt beyond the axis" in check["reason"]
    assert check["beyond"] > 0.9
    farthest = np.abs(result.misalignment[0]).max() - 1e-7
    assert check["farthest"] == pytest.approx(farthest)
    wide = simulate(scene_on(database.force_table(), duration=2e-3)).effect_ledger["checks"]
    assert all(c["holds"] for c in wide)
    assert {c["effect"] for c in wide} >= set(EFFECTS[:2])


def test_auto_follows_the_table_and_the_freedoms(table):
    def on(scene):
        return {e.effect: e.on for e in assemble(scene).ledger.entries if e.effect in EFFECTS}

    free = replace(scene_on(table), effects={"tilt": "on"})
    assert on(free) == dict.fromkeys(EFFECTS, True)
    assert on(replace(free, effects={"tilt": "off"})) == {**dict.fromkeys(EFFECTS, False), EFFECTS[1]: True}
    assert on(replace(free, bushings=())) == dict.fromkeys(EFFECTS, False)
    secant = with_mesh(free, technique="constant_torque")
    assert on(secant) == {**dict.fromkeys(EFFECTS, False), EFFECTS[2]: True}
    single = with_mesh(free, table=sliced_database((0.0,), positions=8).force_table())
    assert on(single) == dict.fromkeys(EFFECTS, False)
    influence = {e.effect: e.influence for e in assemble(free).ledger.entries}
    assert all(influence[name] > 1e-9 for name in EFFECTS)


def test_secant_and_coast_flank_have_the_arm_too(table):
    secant = scene_on(table, EFFECTS[2:], technique="constant_torque")
    secant = with_mesh(secant, misalignment=30e-6)
    assert np.abs(simulate(secant).load_arm).min() > 1e-3
    back = scene_on(table, torque=-100.0)
    back = with_mesh(back, coast=CoastFlank(50e-6), misalignment=20e-6)
    result = simulate(replace(back, effects={**back.effects, "backlash": "on"}))
    assert np.all(result.coast_force > 0.0)
    assert result.energy.relative_to_throughput < 1e-7


@pytest.mark.parametrize("on", [EFFECTS, *((effect,) for effect in EFFECTS)])
def test_a_coast_flank_bends_the_shafts_as_the_driving_one_of_the_reversed_pair(table, on):
    """Misalignment is that of the driving flank, positions count from where the flanks are mirrored."""
    reversed_pair = with_mesh(scene_on(table, on, speed=-900.0), misalignment=2e-5)
    back = with_mesh(scene_on(table, on, torque=-100.0), misalignment=-2e-5, coast=CoastFlank(50e-6, 0.0))
    scenes = reversed_pair, replace(back, effects={**back.effects, "backlash": "on"})
    driving, coasting = (static_equilibrium(assemble(scene)).displacement for scene in scenes)
    assert np.abs(driving[:-1]).max() > 1e-5
    np.testing.assert_allclose(coasting[:-1], driving[:-1], rtol=1e-9, atol=1e-15)
    assert BASE_RADIUS * (driving[-1] - coasting[-1]) == pytest.approx(50e-6, rel=1e-9)


def test_modes_about_a_tilted_equilibrium(table):
    stiffness = {}
    for on in (EFFECTS, ()):
        system = assemble(scene_on(table, on))
        assert (system.arrays.elements.law[0] == SPATIAL_FLANK) == bool(on)
        stiffness[on] = natural_modes(system).frequency
    assert stiffness[EFFECTS] == pytest.approx(stiffness[()], rel=0.05)
    assert stiffness[EFFECTS] != pytest.approx(stiffness[()], rel=1e-4)


def test_levers_of_another_shape_are_refused_by_name(table):
    for name in ("load_arm", "deflection_derivative"):
        with pytest.raises(InputError, match=name):
            scene_on(replace(table, **{name: np.zeros((2, 2))}))


def test_the_driver_off_the_common_middle_keeps_the_position_of_the_load(table):
    """The load arm counts from the driver's mid-face, the moment from the middle of the common face."""
    scene = with_mesh(scene_on(table, EFFECTS[2:]), misalignment=30e-6)
    wide = with_gear(scene, 0, face_width=2 * FACE_WIDTH, position=0.06 + 2e-3)
    centered, shifted = (simulate(s).load_arm.mean() for s in (scene, wide))
    assert shifted - centered == pytest.approx(2e-3, rel=0.05)
