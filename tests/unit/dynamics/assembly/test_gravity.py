"""Gravity: bearings carry the weight, nothing else changes; dampers to the ground."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import flexible_pair
from geared_scenes import gear_pair_scene
from planetary_scenes import driven_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.bearings import Bushing
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.simulation import simulate

DOWN = (2.0, -9.81, 0.5)
EVERY = {"lateral": "on", "axial": "on", "tilt": "on"}


@pytest.mark.parametrize("make", [gear_pair_scene, flexible_pair], ids=["rigid", "flexible"])
def test_the_bearings_carry_the_weight_and_only_that_changes(make) -> None:
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


def test_a_run_starts_at_rest_under_gravity_and_its_energy_balances() -> None:
    scene = gear_pair_scene(effects=EVERY, gravity=DOWN, duration=0.02)
    run = simulate(scene)
    assert run.energy.relative < 1e-3
    bare = simulate(replace(scene, gravity=(0.0, 0.0, 0.0)))
    mass = sum(rotor.inertia.mass for rotor in assemble(scene).rotors)
    carried = np.sum(run.bearing_force - bare.bearing_force, axis=0)[:3]
    np.testing.assert_allclose(np.mean(carried, axis=-1), mass * np.array(DOWN), rtol=1e-2)


def test_gravity_across_a_rotating_frame_is_refused() -> None:
    scene = driven_scene(published_set(3))
    replace(scene, gravity=(0.0, 0.0, -9.81))
    with pytest.raises(InputError) as caught:
        replace(scene, gravity=(0.0, -9.81, 0.0))
    assert caught.value.field == "gravity"


def test_a_bushing_may_be_a_damper_alone() -> None:
    scene = gear_pair_scene(effects=EVERY)
    damper = Bushing("damper", "input", 0.1, radial_damping=500.0)
    damped, bare = (assemble(replace(scene, bushings=b)) for b in ((*scene.bushings, damper), scene.bushings))
    x = bare.freedoms.name.index("input.x")
    np.testing.assert_allclose(damped.arrays.stiffness, bare.arrays.stiffness, rtol=1e-14)
    fixed = [replace(b, radial_damping=0.0, axial_damping=0.0) for b in scene.bushings]
    alone = assemble(replace(scene, bushings=(*fixed, damper)))
    assert alone.arrays.damping[x, x] == pytest.approx(500.0, rel=1e-12)
