"""Equilibrium and step control where loads are small: by their size, not by that of a usual drive."""

from dataclasses import replace

import numpy as np
import pytest
from drawn_trains import Train
from geared_scenes import gear_pair_scene, spring_table, square_wave_table

from dynamics import Bushing, Integration, LoadTorque, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.integrators import static_equilibrium
from dynamics.simulation.light_loads import with_tolerance_to_scale


def light_train(random, *, table=None, bearing=None, torque=None):
    """A chain of gears on bearings under little load, with tooth errors far above its deflection."""
    train = Train(speed=10.0)
    count = int(random.integers(2, 5))
    for index in range(count):
        train.add(f"gear {index}", int(random.integers(17, 60)), share=0.6)
    for index in range(count - 1):
        train.mesh(f"gear {index}", f"gear {index + 1}", random.uniform(0.3, 0.42), random.uniform(-1, 1))
    scene = train.scene()
    stiff = 10.0 ** random.uniform(7, 9)
    table = table or spring_table(stiff, 10.0 ** random.uniform(-7, -4.5))
    bearing = bearing or 10.0 ** random.uniform(6, 10)
    torque = torque or 10.0 ** random.uniform(-6, 0)
    return replace(
        scene,
        meshes=tuple(replace(mesh, table=table) for mesh in scene.meshes),
        bushings=tuple(
            Bushing(f"{shaft.name} {z}", shaft.name, z, bearing) for shaft in scene.shafts for z in (0.0, 0.2)
        ),
        loads=(LoadTorque("load", scene.gears[-1].shaft, TimeLaw.constant(torque)),),
    )


@pytest.mark.parametrize("draw", range(40))
def test_a_light_load_has_its_equilibrium(draw):
    """All meshes of a chain carry the force that the load has at its last gear."""
    scene = light_train(np.random.default_rng(draw))
    rest = static_equilibrium(assemble(scene))
    assert rest.status.usable
    force = scene.loads[0].torque(0.0) / scene.gears[-1].base_radius
    np.testing.assert_allclose(rest.mesh_force, force, rtol=1e-6)


@pytest.mark.parametrize("torque", [0.005, 0.05, 0.5])
def test_a_light_run_is_integrated_to_a_thousandth_of_what_moves(torque):
    """The stated error is that small, and a much finer run confirms it."""
    scene = gear_pair_scene(square_wave_table(), torque=torque, duration=0.01)
    result = simulate(scene)
    stated = result.receipt["error"]["time_step"]["rms"]
    assert stated < 1e-3 * np.max(np.abs(result.dynamic_transmission_error))
    assert stated == result.case["integration"]["tolerance"]
    finer = simulate(replace(scene, integration=Integration(tolerance=1e-3 * stated)))
    off = result.dynamic_transmission_error - finer.dynamic_transmission_error
    assert np.sqrt(np.mean(off**2)) < 3.0 * stated


def test_usual_loads_and_tolerances_stay_as_stated():
    for tolerance in (1e-9, 1e-7, 1e-13):
        scene = gear_pair_scene(square_wave_table(), duration=0.001)
        system = assemble(replace(scene, integration=Integration(tolerance=tolerance)))
        assert with_tolerance_to_scale(system) is system
    idle = assemble(gear_pair_scene(spring_table(1e8), torque=0.0, duration=0.001))
    assert with_tolerance_to_scale(idle) is idle
    light = gear_pair_scene(square_wave_table(), torque=0.005, duration=0.001)
    fine = assemble(replace(light, integration=Integration(tolerance=1e-15)))
    assert with_tolerance_to_scale(fine) is fine
