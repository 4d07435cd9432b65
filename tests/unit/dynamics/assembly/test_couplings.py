"""Flexible couplings: torque, frequency, energy, matrices, what is refused."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table

from dynamics.assembly.assemble import assemble
from dynamics.bearings import Bushing
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.joints import Coupling, ImposedRotation
from dynamics.linearize import natural_modes
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.shafts import Inertia, Shaft
from dynamics.simulation import simulate

LOAD_INERTIA = 0.02
TORSION = 5e4
UNEVEN = tuple(map(tuple, np.triu(np.ones((6, 6)))))


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
        (lambda: Coupling("c", "a", "b", 0.0), "torsional_stiffness"),
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
