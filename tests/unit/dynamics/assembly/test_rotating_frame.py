"""Gyroscopic and frame terms in time: derivatives, energy, whirl, the same from both frames."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table
from planetary_scenes import driven_scene, published_set

from dynamics import Bushing, Coupling, FreeRotation, Inertia, Integration, Shaft, TimeLaw
from dynamics.assembly.assemble import assemble
from dynamics.forces.laws import Law
from dynamics.integrators import integrate, static_equilibrium
from dynamics.linearize import whirl_modes
from dynamics.linearize.whirl_modes import speed_terms
from dynamics.motion.force_balance import force_balance
from dynamics.motion.observation import local_state
from dynamics.results import EnergyAudit

SPIN, DISC, LENGTH, STIFFNESS = 300.0, Inertia(4.0, 0.02, 0.0104), 0.2, 1e6
QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])


def disc_scene(frame=None, damping=0.0, choice="on", seats=None, **changes):
    """A disc on two bearings, turned through a soft coupling, in the fixed or its own rotating frame."""
    effects = {"tilt": "on", "lateral": "on", "gyroscopic": choice}
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(SPIN), effects=effects)
    disc = Shaft("disc", LENGTH, (0.0, 0.0, 0.4), DISC, frame)
    ends = seats or tuple(
        Bushing(f"disc.{z}", "disc", z, STIFFNESS, radial_damping=damping) for z in (0.0, 0.9 * LENGTH)
    )
    joint = Coupling("joint", "input", "disc", 100.0)
    scene = replace(scene, shafts=(*scene.shafts, disc), bushings=(*scene.bushings, *ends))
    return replace(scene, couplings=(joint,), **changes)


def planetary(choice="on", **changes):
    scene = driven_scene(published_set(3), speed=TimeLaw.constant(2000.0))
    return replace(scene, effects={**scene.effects, "gyroscopic": choice}, **changes)


def rotating_frame_rows(system):
    elements = system.arrays.elements
    return np.concatenate(
        [
            np.arange(first, end)
            for law, first, end in zip(elements.law, elements.first[:-1], elements.first[1:], strict=True)
            if law == Law.ROTATING_FRAME
        ]
    )


def thrown(system, location, displacement, velocity, duration, tolerance=1e-11):
    """Path of the freedoms `location` from a displacement and velocity of them on top of the equilibrium."""
    start = static_equilibrium(system)
    system = replace(system, scene=replace(system.scene, duration=duration))
    q, v = start.displacement.copy(), np.zeros(start.displacement.size)
    q[location] += displacement
    v[location] = velocity
    run = integrate(system, replace(start, displacement=q), Integration(tolerance=tolerance), velocity=v)
    assert run.status.usable
    return run.time, run.q[:, location] - start.displacement[location]


def free(system, *names):
    return [system.freedoms.name.index(name) for name in names]


@pytest.mark.parametrize(("frame", "torn", "count"), [(None, False, 6), (None, True, 9), ("disc", False, 12)])
def test_derivatives_are_those_of_the_forces_and_no_energy_is_gained(frame, torn, count):
    scene = disc_scene(frame, damping=200.0)
    if torn:
        scene = replace(scene, drives=(), free_rotations=(FreeRotation("train", "input", SPIN),))
    system = assemble(scene)
    arrays, rows = system.arrays, rotating_frame_rows(system)
    assert rows.size == count  # both shafts of the pair tilt too
    rng = np.random.default_rng(6)
    q, v = rng.normal(size=(2, arrays.mass.shape[0])) * np.array([[1e-5], [10.0]])  # w shows too
    local = local_state(arrays, 0.0, q, v)
    balance = force_balance(arrays, 0.0, q, v, 0.0 * q)
    for name, step, matrix in (("q", 1e-7, balance.stiffness), ("v", 1e-4, balance.damping)):
        for i in range(q.size):
            change = np.zeros(q.size)
            change[i] = step
            states = ((q + s * change, v) if name == "q" else (q, v + s * change) for s in (1.0, -1.0))
            high, low = (force_balance(arrays, 0.0, *state, 0.0 * q).force for state in states)
            largest = np.max(np.abs(matrix)) * step
            np.testing.assert_allclose(-(high - low) / 2.0, matrix[:, i] * step, atol=1e-7 * largest)
    undamped = assemble(disc_scene(frame))
    local = local_state(undamped.arrays, 0.0, q, v)
    elements = undamped.arrays.elements
    for first in elements.first[:-1][elements.law == Law.ROTATING_FRAME]:
        pair = slice(first, first + 2)
        power = (local.force[pair] - local.elastic[pair]) * local.rate[pair]
        assert abs(power.sum()) <= 1e-15 * np.max(np.abs(power))
        assert np.max(np.abs(power)) > 0.0


@pytest.mark.parametrize("seats", [False, True])
def test_time_integration_has_the_terms_of_the_whirl_modes(seats):
    """At the equilibrium, in a planetary set and on a disc, with all dampers: G and S of `speed_terms`."""
    matrix = np.diag([2e6, 2e6, 1e6, 2e4, 2e4])
    matrix[0, 4] = matrix[4, 0] = 5e4
    matrix[1, 3] = matrix[3, 1] = -5e4
    rows = tuple(map(tuple, matrix.tolist()))
    damping = tuple(map(tuple, (1e-4 * matrix).tolist()))
    seat = (Bushing("seat", "disc", 0.07, stiffness=rows, damping=damping),)
    for scene in (planetary(), disc_scene("disc", 200.0, seats=seat if seats else None), disc_scene()):
        system = assemble(scene)
        q = static_equilibrium(system).displacement
        full, bare = (
            force_balance(system.arrays, 0.0, q, 0.0 * q, 0.0 * q, gyroscopic=on) for on in (True, False)
        )
        gyroscopic, stiffening = speed_terms(system, 0.0)
        largest = np.max(np.abs(gyroscopic))
        assert largest > 0.0
        np.testing.assert_allclose(full.damping - bare.damping, gyroscopic, rtol=1e-9, atol=1e-9 * largest)
        size = max(float(np.max(np.abs(stiffening))), 1.0)
        # differences of stiffnesses a thousand times larger
        np.testing.assert_allclose(full.stiffness - bare.stiffness, stiffening, rtol=1e-6, atol=1e-6 * size)


@pytest.mark.parametrize("forward", [True, False])
def test_a_disc_whirls_in_time_at_the_frequency_of_its_mode(forward):
    """I_t a'' - i I_p w a' + k a = 0: circular motion at either root."""
    seats = tuple(Bushing(f"disc.{z}", "disc", z, STIFFNESS, damping_ratio=0.0) for z in (0.0, LENGTH))
    system = assemble(disc_scene(seats=seats))
    stiffness = 2.0 * STIFFNESS * (LENGTH / 2.0) ** 2
    roots = np.roots([DISC.transverse, -1j * DISC.polar * SPIN, stiffness]).imag
    omega = float(roots[roots > 0.0][0] if forward else roots[roots < 0.0][0])
    modes = whirl_modes(system)
    assert np.min(np.abs(2.0 * np.pi * modes.frequency - abs(omega))) < 1e-6 * abs(omega)
    location = free(system, "disc.tilt_x", "disc.tilt_y")
    time, path = thrown(system, location, [1e-5, 0.0], [0.0, 1e-5 * omega], 0.1, 1e-11)
    angle = np.unwrap(np.arctan2(path[:, 1], path[:, 0]))
    assert angle[-1] / time[-1] == pytest.approx(omega, rel=1e-6)
    np.testing.assert_allclose(np.hypot(*path.T), 1e-5, rtol=1e-4)


@pytest.mark.parametrize("kinds", [("x", "y"), ("tilt_x", "tilt_y")])
def test_a_body_moves_the_same_from_the_fixed_and_from_a_rotating_frame(kinds):
    """u_fixed = R(W t) u_frame with u_frame' = R^T (u' - W J u), dampers and coupling of tilt and all."""
    names = [f"disc.{kind}" for kind in kinds]
    at, rate = np.array([1e-5, -5e-6]), np.array([2e-3, 1e-3])
    fixed, gyroscopic = (assemble(disc_scene(frame, damping=100.0)) for frame in (None, "disc"))
    time, path = thrown(fixed, free(fixed, *names), at, rate, 0.02, 1e-11)
    _, seen = thrown(gyroscopic, free(gyroscopic, *names), at, rate - SPIN * QUARTER @ at, 0.02, 1e-11)
    c, s = np.cos(SPIN * time), np.sin(SPIN * time)
    back = np.stack([c * seen[:, 0] - s * seen[:, 1], s * seen[:, 0] + c * seen[:, 1]], axis=1)
    swing = np.max(np.abs(path))
    assert np.max(np.abs(back - path)) < 1e-5 * swing
    assert np.max(np.abs(seen - path)) > 0.1 * swing


@pytest.mark.parametrize("name", ["disc", "disc in its frame", "planetary set"])
def test_no_energy_comes_from_the_rotating_frame(name):
    """Undamped and thrown, over many periods: what does not balance, over the energy of the throw."""
    frame = "disc" if name.endswith("frame") else None
    scene = undamped(planetary() if name == "planetary set" else disc_scene(frame))
    system = assemble(replace(scene, duration=0.02))
    start, rng = static_equilibrium(system), np.random.default_rng(7)
    velocity = 1e-3 * rng.normal(size=start.displacement.size) / system.arrays.scale
    run = integrate(system, start, Integration(tolerance=1e-12), velocity=velocity)
    assert run.status.usable
    audit = EnergyAudit.from_arrays(run.work, run.stored)
    thrown_in = 0.5 * velocity @ system.arrays.mass @ velocity
    assert abs(audit.residual) < 1e-4 * thrown_in
    assert abs(audit.stored_bushings) > 1e-3 * thrown_in


def undamped(scene):
    """The scene without dampers, meshes stiff enough never to part."""
    bushings = tuple(replace(part, damping_ratio=0.0, radial_damping=None) for part in scene.bushings)
    pins = tuple(replace(part, damping_ratio=0.0) for part in scene.planet_bearings)
    meshes = tuple(replace(mesh, damping=0.0) for mesh in scene.meshes)
    return replace(scene, bushings=bushings, planet_bearings=pins, meshes=meshes)


def test_it_is_on_where_it_shifts_a_frequency_by_a_hundredth():
    def decision(scene, part):
        ledger = assemble(scene).ledger
        return next(e for e in ledger.entries if e.effect == "gyroscopic" and e.part == part)

    assert decision(disc_scene(choice="auto"), "disc").on
    slow = disc_scene(choice="auto")
    slow = replace(slow, drives=(replace(slow.drives[0], speed=TimeLaw.constant(1.0)),))
    assert not decision(slow, "disc").on
    assert decision(planetary("auto"), "carrier").on
    assert not decision(planetary("off"), "carrier").on
    bare = planetary("off")
    off = assemble(replace(bare, effects={**bare.effects, "centrifugal_load": "off"}))
    assert Law.ROTATING_FRAME not in off.arrays.elements.law
    scene = planetary("on")
    torn = replace(scene, drives=scene.drives[1:], free_rotations=(FreeRotation("train", "sun", 100.0),))
    if scene.drives[0].shaft == "sun":
        assert not decision(torn, "carrier").on


def test_gyroscopic_moments_follow_a_changing_speed():
    law = TimeLaw((0.0, 1.0), (0.0, 100.0))
    scene = replace(disc_scene(), drives=(replace(disc_scene().drives[0], speed=law),))
    system = assemble(scene)
    q = np.zeros(system.arrays.mass.shape[0])
    v = q.copy()
    (x, y) = free(system, "disc.tilt_x", "disc.tilt_y")
    v[y] = 1.0
    ratio = float(system.kinematics.float_ratio[system.scene.shaft_index("disc"), 0])
    for time in (0.0, 0.5, 1.0):
        moment = force_balance(system.arrays, time, q, v, 0.0 * q).force[x]
        rest = force_balance(system.arrays, 0.0, q, v, 0.0 * q).force[x]
        assert moment - rest == pytest.approx(-DISC.polar * ratio * 100.0 * time, rel=1e-12, abs=1e-12)
    assert math.isclose(abs(ratio), 1.0)
