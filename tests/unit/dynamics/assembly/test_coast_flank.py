"""The coast flank: geometry of the gap, mirror rule, what loads it, and when a run calls for it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import (
    BASE_RADIUS,
    RPM,
    gear_pair_scene,
    spring_table,
    square_wave_table,
    with_bushings,
    with_gear,
    with_mesh,
)

from dynamics import CoastFlank, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.mechanism.rotor import build_rotor
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.table_lookup import table_force
from dynamics.meshes.technique import mirrored, table_at
from dynamics.types import StaticStatus

GAP = 80e-6
FORCE = 100.0 / BASE_RADIUS


def with_coast(scene, effect="on", **changes):
    flank = CoastFlank(**{"backlash": GAP, "thickness": 0.48, **changes})
    return with_mesh(replace(scene, effects={**scene.effects, "backlash": effect}), coast=flank)


def helical(scene, angle=0.3):
    return with_gear(with_gear(scene, 0, base_helix_angle=angle), 1, base_helix_angle=-angle)


def involute(angle):
    return math.tan(angle) - angle


def test_backlash_follows_the_center_distance():
    """Pulling the shafts apart by u opens the gap as the involutes do: 2 (r_b1 + r_b2) d(inv alpha_w)."""
    system = assemble(with_coast(gear_pair_scene()))
    x = system.freedoms.name.index("output.x")
    opened = -system.arrays.direction[:, x].sum()
    for u, share in ((1e-4, 0.02), (1e-6, 2e-4)):
        exact = (
            4.0
            * BASE_RADIUS
            * (involute(math.acos(BASE_RADIUS / (0.04 + u / 2))) - involute(math.acos(BASE_RADIUS / 0.04)))
        )
        assert opened * u == pytest.approx(exact, rel=share)
    assert opened == pytest.approx(2.0 * math.sin(math.radians(20.0)), rel=1e-12)


@pytest.mark.parametrize("row", [0, 1])
def test_forces_on_the_two_bodies_cancel(row):
    """Action = reaction: no net force and no net moment about the origin, helical."""
    scene = helical(with_coast(gear_pair_scene()))
    gradient = assemble(scene).elements[row].gradient.reshape(2, 6)
    centers = [build_rotor(scene, shaft).center for shaft in scene.shafts]
    assert abs(gradient[0, 2]) > 0.3
    np.testing.assert_allclose(gradient[:, :3].sum(axis=0), 0.0, atol=1e-15)
    moment = sum(np.cross(c, g[:3]) + g[3:] for c, g in zip(centers, gradient, strict=True))
    np.testing.assert_allclose(moment, 0.0, atol=1e-15)


def test_the_coast_flank_is_the_driving_one_turned_about_the_line_of_centers():
    gradient = [e.gradient.reshape(2, 6) for e in assemble(helical(with_coast(gear_pair_scene()))).elements]
    half_turn = np.array([1.0, -1.0, -1.0, 1.0, -1.0, -1.0])
    # the scene's centers lie at mid-face, so that the turn maps each on itself
    np.testing.assert_allclose(gradient[1], gradient[0] * half_turn, atol=1e-15)


def test_a_mirrored_table_has_the_same_force_at_the_mirrored_position():
    table = table_at(square_wave_table(), 0.0, 0.0)
    packed = pack_tables([table, mirrored(table, 0.37), mirrored(mirrored(table, 0.37), 0.37)])
    rng = np.random.default_rng(1)
    for x, d in zip(rng.random(200), 2e-5 * rng.random(200), strict=True):
        force = table_force(packed, 0, x, d, 0)[:2]
        assert table_force(packed, 1, 0.37 - x, d, 0)[:2] == pytest.approx(force, rel=1e-9, abs=1e-9)
        assert table_force(packed, 2, x, d, 0)[:2] == pytest.approx(force, rel=1e-9, abs=1e-9)


def test_a_reversed_load_rests_on_the_coast_flank():
    scene = with_coast(gear_pair_scene(spring_table(4e8), torque=-100.0), effect="auto")
    system = assemble(scene)
    found = static_equilibrium(system)
    assert found.status is StaticStatus.CONVERGED
    assert found.mesh_force[0] == 0.0
    assert system.arrays.direction[1] @ found.displacement == pytest.approx(GAP + FORCE / 4e8, rel=1e-9)
    result = simulate(replace(scene, duration=1e-3))
    np.testing.assert_allclose(result.coast_force[0], FORCE, rtol=1e-6)
    np.testing.assert_allclose(result.drive_torque, -100.0, rtol=1e-6)


def test_a_reversed_load_without_coast_flank_is_refused():
    for scene in (
        gear_pair_scene(torque=-100.0),
        with_coast(gear_pair_scene(torque=-100.0), effect="off"),
    ):
        with pytest.raises(InputError, match="coast flank"):
            assemble(scene)


def test_off_changes_no_bit():
    scene = gear_pair_scene(spring_table(4e8, 20e-6), speed=TimeLaw.constant(6000.0 * RPM), torque=5.0)
    plain, off = simulate(scene), simulate(with_coast(scene, effect="off"))
    assert np.mean(plain.mesh_force == 0.0) > 0.05
    for name in ("dynamic_transmission_error", "mesh_force", "drive_torque", "bearing_force"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(off, name))
    assert plain.statistics == off.statistics
    assert plain.energy == off.energy
    assert off.coast_force.shape[0] == 0


@pytest.mark.parametrize(
    ("scene", "on"),
    [
        (gear_pair_scene(), True),  # 2660 N, 0.6 kN of ripple, ten times that in resonance
        (with_mesh(gear_pair_scene(), damping_ratio=0.5), False),
        (gear_pair_scene(spring_table(4e8)), False),  # no ripple
        (with_bushings(gear_pair_scene(spring_table(4e8)), damping_ratio=0.0), False),
        (
            replace(
                gear_pair_scene(spring_table(4e8)),
                loads=(replace(gear_pair_scene().loads[0], torque=TimeLaw((0.0, 0.02), (100.0, -1.0))),),
            ),
            True,
        ),
        # the load does not reverse, but the driven side's inertia does, as the drive stops
        (gear_pair_scene(spring_table(4e8), speed=TimeLaw((0.0, 0.04), (0.0, 5e3)), torque=100.0), False),
        (gear_pair_scene(spring_table(4e8), speed=TimeLaw((0.0, 0.04), (5e3, 0.0)), torque=100.0), True),
    ],
)
def test_it_is_called_for_where_the_run_can_unload_the_flank(scene, on):
    ledger = assemble(with_coast(scene, effect="auto")).ledger
    entry = next(e for e in ledger.entries if e.effect == "backlash")
    assert entry.on is on, entry.reason


def test_a_run_without_it_says_whether_the_flanks_parted():
    scene = gear_pair_scene(spring_table(4e8, 20e-6), speed=TimeLaw.constant(6000.0 * RPM), torque=5.0)
    calm = simulate(gear_pair_scene()).effect_ledger["checks"][0]
    assert calm["holds"]
    assert calm["parted"] == 0.0
    blind = simulate(scene)
    check = blind.effect_ledger["checks"][0]
    assert not check["holds"]
    assert check["parted"] == pytest.approx(np.mean(blind.contact == 0.0))
    wide = with_coast(scene, effect="off", backlash=2.0 * check["widest_gap"])
    assert simulate(wide).effect_ledger["checks"][0]["holds"]
    narrow = with_coast(scene, effect="off", backlash=0.5 * check["widest_gap"])
    assert not simulate(narrow).effect_ledger["checks"][0]["holds"]
    checks = simulate(with_coast(scene)).effect_ledger["checks"]
    assert "backlash" not in {one["effect"] for one in checks}
    # a backlash that is not reached changes nothing but round-off
    reached = simulate(with_coast(scene, backlash=2.0 * check["widest_gap"]))
    np.testing.assert_allclose(reached.mesh_force, blind.mesh_force, rtol=0.0, atol=1e-6 * FORCE)


@pytest.mark.parametrize("torque", [100.0, -100.0])
def test_nominal_gears_without_backlash_rest_on_either_flank(torque):
    scene = with_coast(gear_pair_scene(spring_table(4e8), torque=torque), backlash=0.0)
    system = assemble(scene)
    found = static_equilibrium(system)
    assert found.status is StaticStatus.CONVERGED
    drive, coast = (direction @ found.displacement for direction in system.arrays.direction[:2])
    loaded, free = (drive, coast) if torque > 0.0 else (coast, drive)
    assert loaded == pytest.approx(FORCE / 4e8, rel=1e-9)
    assert free < 0.0
    result = simulate(replace(scene, duration=1e-3))
    force = result.mesh_force[0] - result.coast_force[0]
    np.testing.assert_allclose(force, math.copysign(FORCE, torque), rtol=1e-6)


def test_bad_coast_flanks_are_refused_by_name():
    with pytest.raises(InputError, match="backlash"):
        CoastFlank(-1e-9)
    with pytest.raises(InputError, match="thickness"):
        CoastFlank(1e-4, math.nan)
    with pytest.raises(InputError, match="table"):
        CoastFlank(1e-4, table=3)
