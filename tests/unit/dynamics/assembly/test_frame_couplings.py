"""Couplings between shafts of frames that turn against each other: forces, energy, either frame the same."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table
from planetary_scenes import driven_scene, published_set

from dynamics import Bushing, Coupling, Inertia, Integration, Shaft, TimeLaw
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.forces.laws import Law
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.march import stored_energy
from dynamics.linearize import common_period, natural_modes
from dynamics.motion.force_balance import force_balance
from dynamics.motion.observation import local_state
from dynamics.results import EnergyAudit

SPIN, DISC, LENGTH = 300.0, Inertia(4.0, 0.02, 0.0104), 0.2
QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
ON = {"tilt": "on", "lateral": "on", "gyroscopic": "on"}
LATERAL, TILTING, CROSS = 2e6, 3e4, 8e4


def joint_matrix(scale=1.0, axial=1e6):
    """Lateral and tilt stiffness with cross terms of a beam, the same in all directions across the axis."""
    matrix = np.diag([LATERAL, LATERAL, axial, TILTING, TILTING, 0.0])
    matrix[0, 4] = matrix[4, 0] = CROSS
    matrix[1, 3] = matrix[3, 1] = -CROSS
    return tuple(map(tuple, (scale * matrix).tolist()))


def coupled_disc(frame, damping=1e-4, bearing=0.0, effects=ON, **changes):
    """A disc behind a coupling to the input shaft of a pair; the disc in the fixed or in its own frame."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(SPIN), effects=effects)
    disc = Shaft("disc", LENGTH, (0.0, 0.0, 0.25), DISC, frame)
    seat = Bushing("disc seat", "disc", 0.03, 1e6, radial_damping=bearing)
    joint = Coupling(
        "joint", "input", "disc", 100.0, 0.0, 0.25, joint_matrix(), joint_matrix(damping) if damping else None
    )
    scene = replace(scene, shafts=(*scene.shafts, disc), bushings=(*scene.bushings, seat))
    return replace(scene, couplings=(joint,), **changes)


def locations(system, *names):
    return [system.freedoms.name.index(name) for name in names]


def thrown(system, displacement, velocity, duration, tolerance=1e-11):
    """Run from a state."""
    start = static_equilibrium(system)
    system = replace(system, scene=replace(system.scene, duration=duration))
    start = replace(start, displacement=displacement)
    run = integrate(system, start, Integration(tolerance=tolerance), velocity=velocity)
    assert run.status.usable
    return run


def test_a_disc_behind_a_coupling_moves_the_same_from_either_frame():
    """u_fixed = R(W t) u_frame: lateral and tilt, cross terms, dampers of coupling and bearing, the pair."""
    names = [f"disc.{kind}" for kind in ("x", "y", "tilt_x", "tilt_y")]
    fixed, rotating = (assemble(coupled_disc(frame, bearing=50.0)) for frame in (None, "disc"))
    assert Law.FRAME_COUPLING in rotating.arrays.elements.law
    assert Law.FRAME_COUPLING not in fixed.arrays.elements.law
    assert fixed.freedoms.name == rotating.freedoms.name
    location = locations(fixed, *names)
    q, v = static_equilibrium(fixed).displacement, np.zeros(len(fixed.freedoms.name))
    q[location] += [1e-5, -5e-6, 4e-5, 2e-5]
    v[location] = [2e-3, 1e-3, -3e-3, 1e-3]
    seen_v = v.copy()
    seen_v[location] -= SPIN * np.kron(np.eye(2), QUARTER) @ q[location]
    one, two = thrown(fixed, q, v, 0.02), thrown(rotating, q, seen_v, 0.02)
    c, s = np.cos(SPIN * one.time), np.sin(SPIN * one.time)
    for pair in (location[:2], location[2:]):
        x, y = two.q[:, pair].T
        back, path = np.stack([c * x - s * y, s * x + c * y], axis=1), one.q[:, pair]
        swing = np.max(np.abs(path))
        assert np.max(np.abs(back - path)) < 1e-5 * swing
        assert np.max(np.abs(two.q[:, pair] - path)) > 0.1 * swing
    others = [index for index in range(len(fixed.freedoms.name)) if index not in location]
    apart = (two.q[:, others] - one.q[:, others]) * fixed.arrays.scale[others]
    assert np.max(np.abs(apart)) < 1e-5 * np.max(np.abs(one.q[:, location[:2]]))


@pytest.mark.law
def test_derivatives_are_those_of_the_forces():
    system = assemble(coupled_disc("disc"))
    arrays = system.arrays
    rng = np.random.default_rng(6)
    q, v = rng.normal(size=(2, arrays.mass.shape[0])) * np.array([[1e-5], [1.0]])
    time, none = 1.23e-3, 0.0 * q
    balance = force_balance(arrays, time, q, v, none)
    for name, step, matrix in (("q", 1e-7, balance.stiffness), ("v", 1e-4, balance.damping)):
        for i in range(q.size):
            change = np.zeros(q.size)
            change[i] = step
            states = ((q + s * change, v) if name == "q" else (q, v + s * change) for s in (1.0, -1.0))
            high, low = (force_balance(arrays, time, *state, none).force for state in states)
            largest = np.max(np.abs(matrix)) * step
            np.testing.assert_allclose(-(high - low) / 2.0, matrix[:, i] * step, atol=1e-7 * largest)


def test_elastic_forces_are_the_slopes_of_the_energy_stored():
    """In the displacements, and in the angle between the frames what a little later makes of the energy."""
    arrays = assemble(coupled_disc("disc")).arrays
    rng = np.random.default_rng(2)
    q, time = 1e-4 * rng.normal(size=arrays.mass.shape[0]), 2.1e-3
    local = local_state(arrays, time, q, 0.0 * q)
    rows = np.repeat(arrays.elements.law == Law.FRAME_COUPLING, np.diff(arrays.elements.first))
    push = local.elastic[rows] @ arrays.direction[rows] + arrays.stiffness @ q
    none = np.zeros(arrays.inertial.shape[0], dtype=np.int64)
    rotating = np.repeat(arrays.elements.law == Law.ROTATING_FRAME, np.diff(arrays.elements.first))
    push += local.elastic[rotating] @ arrays.direction[rotating]
    for i in range(q.size):
        change = np.zeros(q.size)
        change[i] = 1e-7
        high, low = (stored_energy(arrays, time, q + s * change, 0.0 * q, none)[1] for s in (1.0, -1.0))
        assert (high - low) / 2e-7 == pytest.approx(push[i], rel=1e-6, abs=1e-6 * np.max(np.abs(push)))


def test_no_energy_comes_from_frames_that_turn():
    """Undamped and thrown: what does not balance, over the energy of the throw."""
    scene = coupled_disc("disc", damping=0.0)
    bushings = tuple(replace(part, damping_ratio=0.0, radial_damping=0.0) for part in scene.bushings)
    meshes = tuple(replace(mesh, damping=0.0) for mesh in scene.meshes)
    system = assemble(replace(scene, bushings=bushings, meshes=meshes))
    velocity = 1e-3 * np.random.default_rng(7).normal(size=system.arrays.scale.size) / system.arrays.scale
    run = thrown(system, static_equilibrium(system).displacement, velocity, 0.02, 1e-12)
    audit = EnergyAudit.from_arrays(run.work, run.stored)
    thrown_in = 0.5 * velocity @ system.arrays.mass @ velocity
    assert abs(audit.residual) < 1e-5 * thrown_in
    assert abs(audit.position) > 1e-3 * thrown_in


def test_modes_at_the_start_are_those_of_one_frame():
    """At t = 0 the frames coincide; strain energy of the coupling too. Modes hold at standstill."""
    off = {"tilt": "on", "lateral": "on", "gyroscopic": "off"}
    fixed, rotating = (natural_modes(assemble(coupled_disc(frame, effects=off))) for frame in (None, "disc"))
    np.testing.assert_allclose(rotating.frequency[1:], fixed.frequency[1:], rtol=1e-8)
    shares = [
        modes.strain_energy[:, [name == "joint" for name in modes.spring]].sum(axis=1)
        for modes in (fixed, rotating)
    ]
    np.testing.assert_allclose(shares[1][1:], shares[0][1:], atol=1e-6)


def test_a_shaft_without_bearings_floats_on_its_coupling():
    """Held by the coupling alone; without a matrix it stays in place, as before."""
    scene = coupled_disc("disc")
    scene = replace(scene, bushings=scene.bushings[:-1], effects={})
    scene = replace(scene, couplings=(replace(scene.couplings[0], stiffness=joint_matrix()),))
    gear = replace(scene.gears[0], name="idle", shaft="disc", position=0.1)
    names = assemble(replace(scene, gears=(*scene.gears, gear))).freedoms.name
    assert {"disc.tilt_x", "disc.tilt_y"} & set(names) == set()  # no mesh on it: nothing calls for it
    on = {"lateral": "on", "tilt": "on", "axial": "on"}
    names = assemble(replace(scene, effects=on)).freedoms.name
    assert {f"disc.{kind}" for kind in ("x", "y", "tilt_x", "tilt_y")} <= set(names)
    loose = replace(scene, couplings=(replace(scene.couplings[0], stiffness=None, damping=None),))
    assert not [name for name in assemble(replace(loose, effects={})).freedoms.name if name == "disc.x"]


UNEVEN = np.diag([1e6, 2e6, 0.0, 0.0, 0.0, 0.0])
SKEW = np.diag([1e6, 1e6, 1e6, 0.0, 0.0, 0.0])
SKEW[0, 2] = SKEW[2, 0] = 1e5


@pytest.mark.parametrize("matrix", [UNEVEN, SKEW])
def test_what_a_rotating_frame_would_change_is_refused(matrix):
    scene = coupled_disc("disc")
    joint = replace(scene.couplings[0], stiffness=tuple(map(tuple, matrix.tolist())), damping=None)
    with pytest.raises(InputError, match="same in all directions") as caught:
        replace(scene, couplings=(joint,))
    assert caught.value.field == "couplings[0].stiffness"


def test_a_planet_is_not_joined_across_frames():
    gears = published_set(3)
    scene = driven_scene(gears)
    location = (gears.center_distance, 0.0, 0.1)
    shaft = Shaft("outside", 0.1, location, Inertia(1.0, 1e-3, 1e-3))
    joint = Coupling("joint", "outside", "planet 1", 1e5, stiffness=joint_matrix())
    with pytest.raises(InputError, match="on the axis of its carrier") as caught:
        replace(scene, shafts=(*scene.shafts, shaft), couplings=(joint,))
    assert caught.value.field == "couplings[0].second"


def test_a_gear_of_both_frames_is_refused_with_advice():
    gears = published_set(3)
    scene = driven_scene(gears)
    sun = next(gear for gear in scene.gears if gear.name == "sun")
    outside = replace(sun, name="wheel", shaft="layshaft", base_helix_angle=-sun.base_helix_angle)
    location = (2.0 * sun.base_radius / math.cos(0.4), 0.0, 0.0)
    shaft = Shaft("layshaft", 0.1, location, Inertia(1.0, 1e-3, 1e-3))
    mesh = replace(scene.meshes[0], name="out", driver="sun", driven="wheel", nominal_force=1.0)
    scene = replace(
        scene, shafts=(*scene.shafts, shaft), gears=(*scene.gears, outside), meshes=(*scene.meshes, mesh)
    )
    with pytest.raises(InputError, match="Where shaft sun carries gears inside and outside"):
        assemble(scene)


def test_motions_repeat_after_whole_turns_of_the_frames():
    """The teeth of the pair repeat after a twentieth of a turn, what acts across frames after a whole one."""
    fixed, rotating = (common_period(assemble(coupled_disc(frame))) for frame in (None, "disc"))
    assert fixed.revolutions == Fraction(1, 20)
    assert rotating.revolutions == 1
    assert rotating.pitches == (20,)
