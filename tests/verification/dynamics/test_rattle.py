"""A gear thrown between its driving and coast flanks: against a second integrator, and its energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, square_wave_table, with_mesh
from scipy.integrate import solve_ivp

from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import CoastFlank, GearMesh
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import GearBody, Inertia, Shaft
from dynamics.simulation import simulate

TEETH, MEAN, RIPPLE, GAP, RATE = 20, 0.1, 0.6, 2.0, 0.9
DURATION = 20.0


def scene(method):
    """Unit mass and stiffness; e = RIPPLE cos(RATE t) moves both flanks."""
    gears = tuple(
        GearBody(f"g{k}", f"s{k}", 0.5, TEETH, 1.0, 0.1, 0.0, Inertia(1.0, 1.0, 1.0)) for k in range(2)
    )
    back = CoastFlank(GAP, 0.0, spring_table(1.0, -RIPPLE, positions=512))
    mesh = GearMesh("m", "g0", "g1", spring_table(1.0, RIPPLE, positions=512), damping=0.0, coast=back)
    return Scene(
        (Shaft("s0", 1.0), Shaft("s1", 1.0, (2.2, 0.0, 0.0))),
        gears,
        (mesh,),
        (ImposedRotation("d", "s0", TimeLaw.constant(RATE / TEETH)),),
        duration=DURATION,
        loads=(LoadTorque("l", "s1", TimeLaw.constant(MEAN)),),
        outputs=Outputs(sample_rate=10.0, energy_audit=False, anti_alias=False),
        integration=Integration(method, tolerance=1e-9, largest_step=1.0),
    )


def reference(time):
    """d'' = MEAN - drive + coast with an integrator of order 8 that meets every kink in short steps."""

    def rates(t, state):
        d, e = state[0], RIPPLE * np.cos(RATE * t)
        return [state[1], MEAN - max(d - e, 0.0) + max(-d - GAP + e, 0.0)]

    start = [MEAN + RIPPLE, 0.0]
    return solve_ivp(rates, (0.0, DURATION), start, "DOP853", time, rtol=1e-10, atol=1e-12, max_step=0.02).y[
        0
    ]


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_both_flanks_against_a_second_integrator(method):
    result = simulate(scene(method))
    assert np.mean(result.coast_force > 0.0) > 0.03
    assert np.mean((result.coast_force == 0.0) & (result.mesh_force == 0.0)) > 0.1
    exact = reference(result.time)
    np.testing.assert_allclose(result.dynamic_transmission_error[0], exact, rtol=0.0, atol=2e-7)


def test_the_audit_closes_while_teeth_rattle():
    rattling = gear_pair_scene(
        spring_table(4e8, 20e-6), speed=TimeLaw.constant(6000.0 * RPM), duration=0.05, torque=5.0
    )
    rattling = with_mesh(rattling, coast=CoastFlank(30e-6))
    result = simulate(rattling)
    assert np.mean(result.contact == 2.0) > 0.02
    assert not np.any(result.contact == 3.0)
    assert result.energy.relative < 1e-3


def test_flanks_in_free_flight_keep_their_energy():
    """Undamped at a fixed position, thrown between both flanks, on a table that is C1 at lift-off."""
    still = gear_pair_scene(square_wave_table(), speed=TimeLaw.ramp(0.0, 1e-9, 1.0), duration=0.05)
    still = with_mesh(replace(still, bushings=()), damping=0.0, coast=CoastFlank(5e-6))
    jolt = TimeLaw((0.0, 0.001, 0.0011, 0.0014, 0.0015), (100.0, 100.0, -900.0, -900.0, 0.0))
    thrown = replace(
        still,
        loads=(replace(still.loads[0], torque=jolt),),
        integration=Integration(tolerance=1e-12),
        on_violation="report",  # thrown far beyond the table's loads
    )
    result = simulate(thrown)
    after = result.time > 0.0016
    assert np.any(result.coast_force[0, after] > 0.0)
    assert np.any(result.mesh_force[0, after] > 0.0)
    energy = result.energy
    gained = energy.kinetic + energy.stored_meshes
    assert abs(gained) > 0.5
    assert abs(energy.residual) < 1e-5 * abs(gained)
