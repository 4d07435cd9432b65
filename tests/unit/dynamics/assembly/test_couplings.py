"""Couplings, gravity, idle rattle, and matrices that are sparse."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import flexible_pair
from geared_scenes import gear_pair_scene, spring_table, square_wave_table, with_mesh
from planetary_scenes import driven_scene, published_set

from benchmarks.stages import stages
from dynamics.arrays.sparse_rows import subtract_resistance
from dynamics.assembly.assemble import assemble
from dynamics.bearings import Bushing
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.integrators.stage_preparation import invert
from dynamics.joints import Coupling, ImposedRotation
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.linearize import modal_analysis, natural_modes
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.meshes import CoastFlank
from dynamics.results.mesh_figures import dynamic_factor
from dynamics.scene import Scene
from dynamics.shafts import Inertia, Shaft
from dynamics.simulation import simulate

# Flexible couplings: torque, frequency, energy, matrices, what is refused.


LOAD_INERTIA = 0.02
TORSION = 5e4


def coupled(coupling=None, table=None, **changes):
    """The pair, its output coupled to a load inertia on the same axis, which is braked."""
    scene = gear_pair_scene(table, **changes)
    machine = Shaft("machine", 0.1, (0.08, 0.0, 0.2), Inertia(4.0, LOAD_INERTIA, 0.02))
    brake = LoadTorque("brake", "machine", scene.loads[0].torque)
    joint = coupling or Coupling("joint", "output", "machine", TORSION, 5.0)
    return replace(scene, shafts=(*scene.shafts, machine), loads=(brake,), couplings=(joint,))


def test_the_load_reaches_the_mesh_through_the_coupling():
    result = simulate(coupled(duration=0.05))
    assert result.coupling_torque[0].mean() == pytest.approx(-100.0, rel=2e-3)  # the output turns in -z
    assert result.drive_torque[0].mean() == pytest.approx(100.0, rel=2e-3)
    assert result.energy.relative < 1e-3


def test_a_stiff_coupling_is_one_shaft():
    stiff = Coupling("joint", "output", "machine", 1e10)
    one = gear_pair_scene(spring_table(4e8, 1e-6), duration=0.02)
    polar = one.shafts[1].inertia.polar + LOAD_INERTIA
    output = replace(one.shafts[1], inertia=replace(one.shafts[1].inertia, polar=polar))
    one = replace(one, shafts=(one.shafts[0], output), meshes=(replace(one.meshes[0], damping=500.0),))
    two = coupled(stiff, spring_table(4e8, 1e-6), duration=0.02)
    two = replace(two, meshes=(replace(two.meshes[0], damping=500.0),))
    forces = [simulate(scene).mesh_force for scene in (one, two)]
    np.testing.assert_allclose(forces[1], forces[0], rtol=2e-4)


def test_torsional_frequency_of_two_inertias():
    """sqrt(k (1/I1 + 1/I2)) with everything else held: the gear's side rigid against the mesh."""
    scene = coupled(table=spring_table(1e13, level=1e5), effects={"lateral": "off"})
    modes = natural_modes(assemble(scene))
    assert modes.frequency[0] == pytest.approx(math.sqrt(TORSION / LOAD_INERTIA) / (2.0 * math.pi), rel=1e-4)
    share = modes.strain_energy[0, modes.spring.index("joint")]
    assert share == pytest.approx(1.0, abs=1e-4)


def test_a_matrix_holds_the_shafts_together_in_all_directions():
    """Radial and tilting stiffness join the shafts' freedoms into one block."""
    radial, tilting = 1e7, 1e3
    matrix = np.diag([radial, radial, 0.0, tilting, tilting, 0.0])
    joint = Coupling("joint", "output", "machine", TORSION, stiffness=tuple(map(tuple, matrix)), position=0.2)
    scene = coupled(joint)
    bearing = Bushing("machine bearing", "machine", 0.05, 1e3)
    scene = replace(scene, bushings=(*scene.bushings, bearing), effects={"lateral": "on"})
    system = assemble(scene)
    names = system.freedoms.name
    stiffness = system.arrays.stiffness
    machine, output = names.index("machine.x"), names.index("output.x")
    assert stiffness[machine, machine] == pytest.approx(radial + 1e3)
    assert stiffness[machine, output] == pytest.approx(-radial)
    np.testing.assert_allclose(stiffness, stiffness.T)
    joined = system.arrays.sparse.coupling
    assert output in joined.column[joined.first[machine] : joined.first[machine + 1]]


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: Coupling("c", "a", "a", 1.0), "second"),
        (lambda: Coupling("c", "a", "b", 1.0, stiffness=((1.0,),)), "stiffness"),
        (lambda: Coupling("c", "a", "b", 1.0, damping=tuple(map(tuple, -np.eye(6)))), "damping"),
        (
            lambda: Coupling("c", "a", "b", 1.0, stiffness=tuple(map(tuple, np.triu(np.ones((6, 6)))))),
            "stiffness",
        ),
        (lambda: coupled(Coupling("c", "output", "nobody", 1.0)), "couplings[0].second"),
        (
            lambda: coupled(Coupling("c", "input", "machine", 1.0, stiffness=tuple(map(tuple, np.eye(6))))),
            "couplings[0].second",
        ),
        (lambda: solve_kinematics(coupled(Coupling("c", "input", "output", 1.0))), "couplings[0].second"),
    ],
)
def test_couplings_that_cannot_be_are_refused(make, field):
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.field == field


def test_a_coupled_shaft_turns_with_the_train():
    scene = coupled(speed=TimeLaw.constant(50.0))
    assert solve_kinematics(scene).ratio[2] == (-1,)


def test_a_drive_behind_a_coupling_takes_its_torque_from_it():
    """Motor shaft driven rigidly, gear behind a coupling: drive torque = coupling torque = load."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(50.0), duration=0.02)
    motor = Shaft("motor", 0.1, (0.0, 0.0, -0.1), Inertia(4.0, 0.5, 0.02))
    drive = replace(scene.drives[0], shaft="motor")
    joint = Coupling("joint", "motor", "input", TORSION, 5.0)
    scene = replace(scene, shafts=(*scene.shafts, motor), drives=(drive,), couplings=(joint,))
    result = simulate(scene)
    assert result.drive_torque[0].mean() == pytest.approx(100.0, rel=1e-6)
    assert result.coupling_torque[0].mean() == pytest.approx(100.0, rel=1e-6)
    assert result.energy.relative_to_throughput < 1e-8


def test_a_bearing_between_shafts_carries_weight_and_leaves_their_speeds_alone():
    """A shaft of 4 kg at a speed of its own, held by two such bearings alone: each yields by m g / (2 k)."""
    radial, weight = 1e7, 4.0 * 9.81
    rows = tuple(map(tuple, np.diag([radial, radial, radial, 0.0, 0.0, 0.0])))
    scene = coupled(effects={"lateral": "on", "axial": "on", "tilt": "on"}, gravity=(0.0, -9.81, 0.0))
    bearings = tuple(
        Coupling(name, "machine", "output", 0.0, stiffness=rows, position=position)
        for name, position in (("left", 0.02), ("right", 0.08))
    )
    motor = ImposedRotation("machine motor", "machine", TimeLaw.constant(7.0))
    scene = replace(scene, couplings=bearings, drives=(*scene.drives, motor), loads=())
    kinematics = solve_kinematics(scene)
    assert kinematics.ratio[2] == (0, 1)
    assert kinematics.ratio[1][1] == 0
    system = assemble(scene)
    at_rest = static_equilibrium(system).displacement
    strains = np.einsum("cki,i->ck", system.freedoms.keep(system.couplings.motion), at_rest)
    assert strains[:, 1] == pytest.approx(np.full(2, 0.5 * weight / radial), rel=1e-9)
    assert strains[:, 0] == pytest.approx(np.zeros(2), abs=1e-12)


# Gravity: bearings carry the weight, nothing else changes; dampers to the ground.


DOWN = (2.0, -9.81, 0.5)
EVERY = {"lateral": "on", "axial": "on", "tilt": "on"}


@pytest.mark.parametrize("make", [gear_pair_scene, flexible_pair], ids=["rigid", "flexible"])
def test_the_bearings_carry_the_weight_and_only_that_changes(make):
    scene = make(effects=EVERY)
    heavy, light = (assemble(replace(scene, gravity=g)) for g in (DOWN, (0.0, 0.0, 0.0)))
    forces = [
        np.sum(system.bearing_stiffness[:, :3] @ static_equilibrium(system).displacement, axis=0)
        for system in (heavy, light)
    ]
    mass = sum(rotor.inertia.mass for rotor in heavy.rotors)
    np.testing.assert_allclose(forces[0] - forces[1], mass * np.array(DOWN), rtol=1e-6)
    for name in ("mass", "stiffness", "damping", "direction"):
        np.testing.assert_array_equal(getattr(heavy.arrays, name), getattr(light.arrays, name))


def test_a_run_starts_at_rest_under_gravity_and_its_energy_balances():
    scene = gear_pair_scene(effects=EVERY, gravity=DOWN, duration=0.02)
    run = simulate(scene)
    assert run.energy.relative < 1e-3
    bare = simulate(replace(scene, gravity=(0.0, 0.0, 0.0)))
    mass = sum(rotor.inertia.mass for rotor in assemble(scene).rotors)
    carried = np.sum(run.bearing_force - bare.bearing_force, axis=0)[:3]
    np.testing.assert_allclose(np.mean(carried, axis=-1), mass * np.array(DOWN), rtol=1e-2)


def test_gravity_across_a_rotating_frame_is_refused():
    scene = driven_scene(published_set(3))
    replace(scene, gravity=(0.0, 0.0, -9.81))
    with pytest.raises(InputError) as caught:
        replace(scene, gravity=(0.0, -9.81, 0.0))
    assert caught.value.field == "gravity"


def test_a_bushing_may_be_a_damper_alone():
    scene = gear_pair_scene(effects=EVERY)
    damper = Bushing("damper", "input", 0.1, radial_damping=500.0)
    damped, bare = (assemble(replace(scene, bushings=b)) for b in ((*scene.bushings, damper), scene.bushings))
    x = bare.freedoms.name.index("input.x")
    np.testing.assert_allclose(damped.arrays.stiffness, bare.arrays.stiffness, rtol=1e-14)
    fixed = [replace(b, radial_damping=0.0, axial_damping=0.0) for b in scene.bushings]
    alone = assemble(replace(scene, bushings=(*fixed, damper)))
    assert alone.arrays.damping[x, x] == pytest.approx(500.0, rel=1e-12)


# Gears that nothing loads: they rattle between their flanks as the drive's speed swings.


BACKLASH = 20e-6
SWING = TimeLaw((0.0, 0.005, 0.01, 0.015, 0.02), (80.0, 81.0, 79.0, 81.0, 80.0), "smooth")


def idle(speed: TimeLaw = SWING, **changes: object) -> Scene:
    """A pair on a table that a line contact makes: no stiffness at lift-off."""
    scene = gear_pair_scene(square_wave_table(16), torque=0.0, duration=0.02, speed=speed)
    return with_mesh(scene, coast=CoastFlank(BACKLASH, thickness=0.48), **changes)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("loads", ["zero", "none"])
def test_idle_gears_rattle_between_both_flanks(loads):
    scene = idle()
    run = simulate(replace(scene, loads=()) if loads == "none" else scene)
    assert run.nominal_force[0] == 0.0
    assert run.mesh_force.max() > 1.0
    assert run.coast_force.max() > 1.0
    assert not np.any(run.contact == 3.0)
    assert 0.1 < np.mean(run.contact == 0.0) < 0.99
    assert run.energy.meshes > 0.0
    assert run.energy.relative < 1e-2
    deflection = run.dynamic_transmission_error
    assert deflection.min() > -BACKLASH - 1e-6


@pytest.mark.filterwarnings("error")
def test_an_idle_mesh_has_stiffness_and_damping_of_the_lowest_load_of_its_table():
    table = square_wave_table(16)
    flanks = assemble(idle()).flanks
    expected = float(np.mean(table.stiffness[0, 0, :, 1]))
    assert flanks.mean_stiffness[0] == pytest.approx(expected, rel=1e-9)
    assert np.all(flanks.law.damping > 0.0)
    assert modal_analysis(assemble(idle())).natural_frequency.size > 0


def test_a_constant_torque_of_none_is_refused_and_says_what_to_do():
    with pytest.raises(InputError, match=r"nominal_force, or use .variable_torque.") as caught:
        simulate(idle(technique="constant_torque"))
    assert caught.value.field == "meshes[0].technique"
    assert simulate(idle(technique="constant_torque", nominal_force=1000.0)).coast_force.max() > 1.0
    with pytest.raises(InputError, match="An idle mesh has no dynamic factor"):
        dynamic_factor(simulate(idle()), pitches=1)


# Matrices by their entries: nothing of them is lost, and they grow with the parts of a scene alone.


SPAN = 1e-5


@compiled
def resistance_left(sparse, q, v, force):
    subtract_resistance(sparse, q, v, force)


def _arrays(count):
    return assemble(stages(spring_table(3e8), count, 0.1, TimeLaw.constant(50.0))).arrays


def _dense(rows, columns):
    row = np.repeat(np.arange(rows.first.size - 1), np.diff(rows.first))
    matrix = np.zeros((rows.first.size - 1, columns))
    matrix[row, rows.column] = rows.weight
    return matrix


def test_entries_are_those_of_the_matrices():
    arrays = _arrays(2)
    size = arrays.mass.shape[0]
    for name in ("damping", "stiffness", "direction", "position_gradient"):
        np.testing.assert_array_equal(_dense(getattr(arrays.sparse, name), size), getattr(arrays, name))
    moved = _dense(arrays.sparse.mobility, size) @ arrays.mass
    np.testing.assert_allclose(moved, np.eye(size), atol=1e-14)


def test_couplings_hold_every_entry_of_the_inverse_of_a_stage():
    arrays = _arrays(3)
    stage = arrays.mass + SPAN * (arrays.damping + SPAN * arrays.stiffness)
    inverse = stage.copy()
    invert(inverse)
    np.testing.assert_allclose(inverse @ stage, np.eye(stage.shape[0]), atol=1e-12)
    joined = _dense(arrays.sparse.coupling, stage.shape[0]) != 0.0
    assert not np.all(joined)
    assert not np.any(inverse[~joined])


def test_entries_grow_in_proportion_to_the_stages():
    """So that the cost of a step grows with the meshes, not with meshes times freedoms."""
    few, many = (_arrays(count).sparse for count in (3, 6))
    for rows in ("direction", "stiffness", "mobility"):
        assert getattr(many, rows).column.size <= 2 * getattr(few, rows).column.size + 8


def test_changed_matrices_take_their_entries_along():
    arrays = _arrays(1)
    changed = arrays.with_matrices(damping=2.0 * arrays.damping)
    np.testing.assert_array_equal(_dense(changed.sparse.damping, arrays.mass.shape[0]), 2.0 * arrays.damping)


def test_dampers_and_springs_act_by_both_matrices_wherever_either_has_entries():
    arrays = _arrays(2)
    size, rng = arrays.mass.shape[0], np.random.default_rng(2)
    arrays = arrays.with_matrices(
        damping=np.where(rng.random((size, size)) < 0.2, rng.random((size, size)), 0.0),
        stiffness=np.where(rng.random((size, size)) < 0.2, rng.random((size, size)), 0.0),
    )
    q, v, force = rng.random(size), rng.random(size), rng.random(size)
    left = force.copy()
    resistance_left(by_address(arrays.sparse), q, v, left)
    np.testing.assert_allclose(left, force - arrays.damping @ v - arrays.stiffness @ q, rtol=1e-13)
