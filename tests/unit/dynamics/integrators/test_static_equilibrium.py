"""Static equilibrium: deflections by hand, and what happens without one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, gear_pair_scene, spring_table, square_wave_table, with_gear, with_mesh
from planetary_scenes import planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.errors import SolveError
from dynamics.integrators import static_equilibrium
from dynamics.loads import TimeLaw
from dynamics.simulation import simulate
from dynamics.types import RunStatus, StaticStatus

FORCE = 100.0 / BASE_RADIUS


def test_springs_in_series():
    system = assemble(gear_pair_scene(spring_table(4e8)))
    found = static_equilibrium(system)
    assert found.status is StaticStatus.CONVERGED
    assert found.mesh_force[0] == pytest.approx(FORCE, rel=1e-9)
    assert system.arrays.direction[0] @ found.displacement == pytest.approx(FORCE / 4e8, rel=1e-9)
    offset = np.hypot(*found.displacement[:2])
    assert offset == pytest.approx(FORCE / 2e8, rel=1e-9)
    turned = found.displacement[system.freedoms.name.index("output.rotation")] * BASE_RADIUS
    assert turned == pytest.approx(FORCE * (1 / 4e8 + 2 / 2e8), rel=1e-9)  # mesh and both shafts' bushings


def test_a_wrong_nominal_force_only_costs_iterations():
    scene = with_mesh(gear_pair_scene(square_wave_table()), nominal_force=9000.0)
    found = static_equilibrium(assemble(scene))
    assert found.status is StaticStatus.CONVERGED
    assert found.iterations > 1
    assert found.mesh_force[0] == pytest.approx(FORCE, rel=1e-8)


def test_a_mesh_that_softens_is_not_thrown_out_of_contact():
    """From far above the load, a full Newton step on the soft branch lands beyond lift-off."""
    level, deflection, stiffness = [0.0, 1e3, 1e4], [0.0, 1e-6, 1e-4], [1e9, 1e8, 9e7]
    fields = {
        "deflection": deflection,
        "stiffness": stiffness,
        "deflection_slope": 0.0,
        "stiffness_slope": 0.0,
    }
    shaped = {name: np.broadcast_to(value, (1, 1, 1, 3)).copy() for name, value in fields.items()}
    table = replace(spring_table(1e8), position=np.zeros(1), level=np.array(level), **shaped)
    scene = with_mesh(gear_pair_scene(table, torque=500.0 * BASE_RADIUS), nominal_force=9000.0)
    found = static_equilibrium(assemble(scene))
    assert found.status is StaticStatus.CONVERGED
    assert found.mesh_force[0] == pytest.approx(500.0, rel=1e-8)


def test_axial_and_tilting_shafts_carry_a_helical_mesh():
    helix = 0.3
    scene = gear_pair_scene(square_wave_table())
    scene = with_gear(with_gear(scene, 0, base_helix_angle=helix), 1, base_helix_angle=-helix)
    system = assemble(scene)
    found = static_equilibrium(system)
    push = system.bearing_stiffness @ found.displacement
    on_ground = push.reshape(2, 2, 3).sum(axis=1)
    line = system.lines[0].force
    np.testing.assert_allclose(on_ground[0], -FORCE * line, rtol=1e-7, atol=1e-4)
    np.testing.assert_allclose(on_ground[1], FORCE * line, rtol=1e-7, atol=1e-4)
    # moments about the left end of the input shaft: bearings balance the mesh at the pitch point
    point = system.lines[0].point
    mesh = np.cross(point, -FORCE * line)
    right = np.cross([0.0, 0.0, 0.2], -push[1])
    left = np.zeros(3)
    np.testing.assert_allclose((mesh + right + left)[:2], 0.0, atol=1e-4)


def test_no_load_rests_at_lift_off():
    found = static_equilibrium(assemble(gear_pair_scene(spring_table(4e8, 1e-6), torque=0.0)))
    assert found.status is StaticStatus.CONVERGED
    assert found.mesh_force[0] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("planets", [3, 4, 5])
def test_a_planet_set_back_too_far_leaves_its_load_to_the_others(planets):
    """Sun, ring and carrier held across the axis: the others share alike, and it touches nothing."""
    held = {"sun_stiffness": None, "ring_stiffness": None, "carrier_stiffness": None}
    errors = ((0.0, 200e-6), *[(0.0, 0.0)] * (planets - 1))
    gears = published_set(planets, pin_errors=errors, **held)
    found = static_equilibrium(assemble(planetary_scene(gears, sun_torque=200.0)))
    assert found.status is StaticStatus.CONVERGED
    force = 200.0 / gears.base_radius[0]
    np.testing.assert_array_equal(found.mesh_force[:2], 0.0)
    np.testing.assert_allclose(found.mesh_force[2:], force / (planets - 1), rtol=1e-9)


def test_inertia_alone_loads_an_unloaded_pair():
    """Speeding up without a load; the table has no stiffness at lift-off."""
    speed = TimeLaw.ramp(0.0, 100.0, 1.0)
    found = static_equilibrium(assemble(gear_pair_scene(square_wave_table(), torque=0.0, speed=speed)))
    assert found.status is StaticStatus.CONVERGED
    assert found.mesh_force[0] == pytest.approx(1.1344291072112745e-3 * 100.0 / BASE_RADIUS, rel=1e-8)


@pytest.mark.law
def test_a_load_that_pulls_the_flanks_apart_has_no_equilibrium():
    scene = gear_pair_scene(spring_table(4e8), duration=0.01)
    pull = replace(scene.loads[0], torque=TimeLaw.constant(-20.0))
    scene = with_mesh(replace(scene, loads=(pull,)), nominal_force=FORCE)
    assert static_equilibrium(assemble(scene)).status is StaticStatus.UNBALANCED
    with pytest.raises(SolveError, match="no static equilibrium") as caught:
        simulate(scene)
    assert caught.value.partial.status is RunStatus.NO_EQUILIBRIUM
    assert caught.value.partial.time.size == 1
