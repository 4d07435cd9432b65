"""Friction over reversal, start-stop and creep: against a two-body brake's closed forms, losses only grow."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, spring_table, with_mesh
from scipy.integrate import quad
from sliced_face import rigid_share_database

from dynamics import CoastFlank, FreeRotation, Integration, LoadTorque, Outputs, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.integrators import static_equilibrium
from dynamics.linearize import natural_modes
from dynamics.meshes.mesh_table import FIELDS
from dynamics.meshes.sliding_friction import CREEP_SPEED
from dynamics.meshes.technique import PlainTable
from dynamics.motion.force_balance import force_balance

MU, TORQUE, LEVER = 0.06, 100.0, 4e-3
DRAG = MU * TORQUE / BASE_RADIUS * LEVER  # friction torque on either gear, N m
OUTPUTS = Outputs(receipt="minimal")


def two_contacts(lever=LEVER):
    """Two contacts at +-lever that share the load equally, everywhere."""
    table = spring_table(4e8, positions=4)
    names = ("position", "level", "misalignment", "center_distance_change", *FIELDS)
    full = np.ones_like(table.deflection)
    fields = [getattr(table, name) for name in names]
    return PlainTable(*fields, sliding_share=0.0 * full, sliding_lever=lever * full)


def brake(speed, push=0.0, **changes):
    """Two gears pressed on each other by equal torques, one larger by `push`, that nothing else turns."""
    scene = gear_pair_scene(two_contacts(), torque=TORQUE, outputs=OUTPUTS, **changes)
    pressing = LoadTorque("pressing", "input", TimeLaw.constant(-TORQUE - push))
    train = FreeRotation("train", "input", speed)
    scene = replace(scene, drives=(), free_rotations=(train,), loads=(*scene.loads, pressing))
    return with_mesh(scene, friction=MU)


def polar(scene):
    """Inertia of one shaft with its gear, kg m^2."""
    return scene.shafts[0].inertia.polar + scene.gears[0].inertia.polar


def driven(law, table=None, **changes):
    scene = gear_pair_scene(table or two_contacts(), speed=law, torque=TORQUE, outputs=OUTPUTS, **changes)
    return with_mesh(scene, friction=MU)


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_a_two_body_brake_stops_and_creeps_as_the_closed_form_says(method, record_figure):
    """I w' = -mu F kappa g: straight down to the creep speed, then s = sqrt(3 C/(1 + C)), C decaying."""
    speed, stop = 20.0, CREEP_SPEED / (2.0 * LEVER)
    scene = brake(speed, duration=0.05, integration=Integration(method))
    inertia = polar(scene)
    reached = inertia * (speed - stop) / DRAG
    run = simulate(scene)
    rate = DRAG * 2.0 * LEVER / (inertia * CREEP_SPEED)
    left = 0.5 * np.exp(-3.0 * rate * np.maximum(run.time - reached, 0.0))
    creeping = stop * np.sqrt(3.0 * left / (1.0 + left))
    expected = np.where(run.time < reached, speed - DRAG / inertia * run.time, creeping)
    assert 0.02 < reached < 0.045
    np.testing.assert_allclose(run.speed[0], expected, rtol=0.0, atol=2e-5 * speed)
    np.testing.assert_allclose(run.speed[1], -expected, rtol=0.0, atol=2e-5 * speed)
    assert run.energy.friction == pytest.approx(inertia * speed**2, rel=1e-4)
    assert run.energy.relative < 1e-3
    assert run.energy.fallen <= 1e-6 * run.energy.friction
    record_figure(
        f"loss of a two-body brake down to rest over the closed form, {method}",
        run.energy.friction / (inertia * speed**2), "1 within 0.1 %", "1", "closed form",
    )  # fmt: skip


def test_below_the_limit_of_friction_flanks_creep_at_the_stated_speed():
    """push = 2 mu F kappa s (3 - s^2)/2 at s times the creep speed."""
    push = 0.5 * 2.0 * DRAG
    run = simulate(brake(0.0, push, duration=0.02))
    s = 2.0 * math.sin(math.asin(0.5) / 3.0)
    assert s * (3.0 - s * s) / 2.0 == pytest.approx(0.5)
    # the larger torque presses the flanks by half of it more
    pressed = push / (2.0 * TORQUE)
    assert run.speed[0, -1] == pytest.approx(s * CREEP_SPEED / (2.0 * LEVER), rel=2.0 * pressed)
    assert run.speed[0, -1] < CREEP_SPEED / (2.0 * LEVER)
    assert run.energy.fallen <= 1e-12 * run.energy.turnover


@pytest.mark.parametrize(
    "law",
    [
        TimeLaw((0.0, 0.02, 0.08, 0.1), (25.0, 25.0, -25.0, -25.0)),
        TimeLaw((0.0, 0.03, 0.05, 0.08, 0.1), (0.0, 25.0, 0.0, 0.0, 25.0)),
        TimeLaw((0.0, 0.02, 0.04, 0.1), (-25.0, -25.0, 0.0, 0.0)),
    ],
    ids=["reversal", "start-stop-start", "stop"],
)
def test_the_loss_of_a_drive_is_that_of_the_sliding_path(law, record_figure):
    """F = (T + I w')/(r_b - mu kappa g) on the driven gear, loss mu F kappa |w_1 - w_2|; none at rest."""
    scene = driven(law, duration=law.time[-1], integration=Integration(largest_step=1e-5))
    energy, inertia, sense = simulate(scene).energy, polar(scene), np.sign(law.extreme)

    def power(time):
        speed, rate = sense * float(law(time)), sense * float(law(time + 1e-9) - law(time)) / 1e-9
        s = float(np.clip(2.0 * LEVER * speed / CREEP_SPEED, -1.0, 1.0))
        g = 0.5 * s * (3.0 - s * s)
        force = (TORQUE + inertia * rate) / (BASE_RADIUS - MU * LEVER * g)
        return MU * force * LEVER * g * 2.0 * speed

    expected = quad(power, 0.0, law.time[-1], points=law.time, limit=500)[0]
    record_figure(
        "loss over reversal, start and stop over the closed form", energy.friction / expected,
        "1 within 0.1 %", "1", "closed form",
    )  # fmt: skip
    assert energy.friction == pytest.approx(expected, rel=1e-3)
    assert energy.relative < 1e-3
    assert energy.fallen <= 1e-6 * energy.friction


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_over_a_reversal_with_handovers_and_both_flanks_losses_only_grow(method):
    """The load turns round with the drive, so that the coast flank carries behind it."""
    law = TimeLaw((0.0, 0.01, 0.04, 0.05), (50.0, 50.0, -50.0, -50.0))
    scene = driven(
        law, rigid_share_database(40).force_table(), duration=0.05, integration=Integration(method)
    )
    load = TimeLaw((0.0, 0.024, 0.026, 0.05), (TORQUE, TORQUE, -TORQUE, -TORQUE))
    scene = with_mesh(scene, coast=CoastFlank(backlash=5e-6, thickness=0.48))
    run = simulate(replace(scene, loads=(replace(scene.loads[0], torque=load),), effects={"backlash": "on"}))
    assert run.coast_force.max() > 2000.0
    assert run.energy.friction > 0.0
    assert run.energy.fallen <= 1e-6 * run.energy.turnover
    assert run.energy.relative < 1e-3


@pytest.mark.parametrize("back", [False, True])
def test_friction_takes_power_at_any_sliding(back):
    """Also across the line of action alone, near the pitch point and on the coast flank; derivatives too."""
    scene = driven(TimeLaw.constant(-0.3), rigid_share_database(40).force_table(), duration=0.001)
    scene = with_mesh(scene, coast=CoastFlank(backlash=5e-6, thickness=0.48), position_offset=0.999)
    scene = replace(scene, effects={"backlash": "on"})
    if back:
        scene = replace(scene, loads=(replace(scene.loads[0], torque=TimeLaw.constant(-TORQUE)),))
    system = assemble(scene)
    arrays, rng = system.arrays, np.random.default_rng(7)
    q = static_equilibrium(system).displacement
    none = np.zeros(q.size)
    for size in (1e-5, 1e-3, 1e-1):
        v = rng.normal(size=q.size) * size / arrays.scale
        found = force_balance(arrays, 0.0, q, v, none)
        local, first = found.local, 3 * back
        assert local.force[first] > 0.0
        rows = slice(first + 1, first + 3)
        assert local.force[rows] @ (local.rate[rows] + local.drift[rows]) >= 0.0
        for column in range(q.size):
            e = 1e-7 * (np.arange(q.size) == column) / arrays.scale
            up, down = (force_balance(arrays, 0.0, q, v + sign * e, none).force for sign in (1.0, -1.0))
            slope = -(up - down) / (2.0 * e[column])
            size_of = np.abs(found.damping[:, column]).max()
            np.testing.assert_allclose(found.damping[:, column], slope, rtol=1e-4, atol=1e-4 * size_of)


def test_small_motions_are_those_of_running_gears():
    """Modes at standstill are not damped by the creep of friction that would stick."""
    running = natural_modes(assemble(driven(TimeLaw.constant(25.0))))
    starting = natural_modes(assemble(driven(TimeLaw.ramp(0.0, 25.0, 0.05))))
    np.testing.assert_allclose(starting.frequency, running.frequency, rtol=1e-6)
    np.testing.assert_allclose(starting.damping_ratio, running.damping_ratio, rtol=1e-3)


def test_at_constant_speed_the_shafts_hold_the_steady_torque():
    """The drive's torque is the load's and the friction's in either sense: 100 N m and what is lost."""
    for speed in (60.0 * RPM, -60.0 * RPM):
        run = simulate(driven(TimeLaw.constant(speed), duration=0.01))
        lost = MU * TORQUE / (BASE_RADIUS - MU * LEVER) * LEVER
        assert abs(run.drive_torque[0, -1]) == pytest.approx((TORQUE + lost) + lost, rel=1e-6)
