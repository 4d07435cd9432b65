"""Helical planetary sets at rest: thrusts, overturning moments, load sharing, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from planetary_scenes import MESH_STIFFNESS, PRESSURE_ANGLE, planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.bearings import BearingStiffness
from dynamics.integrators import static_equilibrium
from dynamics.motion.observation import local_state

HELIX = math.radians(22.0)  # on the base cylinder
FORCE = 8000.0  # N, of all meshes of the sun together
PIN = BearingStiffness(1e8, 2e8, 4e5)
HELD = BearingStiffness(1e8, 3e8, 6e5)
FLOATING = BearingStiffness(1.0, 1e9)


def helical(planets=3, helix=HELIX, **changes):
    changed = {
        "sun_stiffness": HELD,
        "ring_stiffness": HELD,
        "carrier_stiffness": HELD,
        "planet_stiffness": PIN,
        "base_helix_angle": helix,
    }
    return published_set(planets, **{**changed, **changes})


def at_rest(gears, split=None, **changes):
    """The system, its equilibrium, and forces and moments of all bearings in the carrier's frame, by name."""
    scene = planetary_scene(gears, sun_torque=FORCE * gears.base_radius[0], **changes)
    if split is not None:
        scene = split(scene)
    system = assemble(scene)
    found = static_equilibrium(system)
    assert found.status.usable
    q = found.displacement
    local = local_state(system.arrays, 0.0, q, 0.0 * q)
    seats = system.bearing_force(local.force[:, None], q[None], 0.0 * q[None])[:, :, 0]
    return system, found, dict(zip(system.supports.name, seats, strict=True))


def directions(gears, planet):
    """Away from the carrier's axis at a planet, and along z x (away)."""
    angle = 2.0 * math.pi * planet / gears.planets
    return np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])


def paired_bearings(apart):
    """Each planet on two bearings without tilt stiffness, `apart` from each other."""

    def split(scene):
        bearings = []
        for part in scene.planet_bearings:
            half = {"radial_stiffness": 0.5e8, "axial_stiffness": 1e8, "stiffness": None}
            bearings += [
                replace(part, name=f"{part.name} {k}", position=part.position + k * apart / 2.0, **half)
                for k in (-1, 1)
            ]
        return replace(scene, planet_bearings=tuple(bearings))

    return split


@pytest.mark.parametrize("planets", [3, 4, 5])
def test_pins_carry_the_overturning_moment_of_both_thrusts(planets):
    """Thrusts of both meshes balance; their couple is 2 F tan(beta_b) r_w about the tangent of the pins."""
    gears = helical(planets)
    _, found, bearings = at_rest(gears)
    np.testing.assert_allclose(
        found.mesh_force, FORCE / planets, rtol=1e-9
    )  # alike, and as large as required
    thrust = FORCE / planets * math.tan(HELIX)
    radius = gears.base_radius[1] / math.cos(PRESSURE_ANGLE)
    # right-hand sun, rotating in +z: its thrust is along +z, that of planets at the sun along -z and at the
    # ring along +z, further out: r x F = (away r) x (z thrust) points against z x (away)
    for planet in range(planets):
        _, across = directions(gears, planet)
        x, y, z, *moment = bearings[f"planet {planet + 1} bearing"]
        push = 2.0 * FORCE / planets * math.cos(PRESSURE_ANGLE)
        np.testing.assert_allclose([x, y], push * across, atol=1e-8 * push)
        assert abs(z) < 1e-8 * thrust
        expected = -2.0 * thrust * radius * across
        np.testing.assert_allclose(moment[:2], expected, atol=1e-8 * np.max(np.abs(expected)))


def test_two_pin_bearings_carry_it_as_a_couple():
    apart = 0.018
    gears = helical(3)
    _, _, bearings = at_rest(gears, paired_bearings(apart))
    radius = gears.base_radius[1] / math.cos(PRESSURE_ANGLE)
    couple = 2.0 * FORCE / 3.0 * math.tan(HELIX) * radius / apart
    for planet in range(3):
        away, across = directions(gears, planet)
        low, high = (bearings[f"planet {planet + 1} bearing {k}"] for k in (-1, 1))
        push = FORCE / 3.0 * math.cos(PRESSURE_ANGLE)
        # the couple about -(z x away) pushes the upper bearing inwards
        np.testing.assert_allclose(high[:2], push * across - couple * away, atol=1e-8 * couple)
        np.testing.assert_allclose(low[:2], push * across + couple * away, atol=1e-8 * couple)


def test_central_members_carry_the_sum_of_thrusts():
    _, _, bearings = at_rest(helical(4))
    thrust = FORCE * math.tan(HELIX)
    assert bearings["sun bearing"][2] == pytest.approx(thrust, rel=1e-9)
    assert bearings["ring bearing"][2] == pytest.approx(-thrust, rel=1e-9)
    for kind in (0, 1, 3, 4):
        assert abs(bearings["sun bearing"][kind]) < 1e-8 * thrust
    assert np.max(np.abs(bearings["carrier bearing"])) < 1e-8 * thrust


def test_all_reactions_balance_with_displaced_pins():
    """Nothing but torques about z acts from outside: forces and moments on the ground sum to zero."""
    errors = ((15e-6, -20e-6), (0.0, 8e-6), (-5e-6, 0.0))
    gears = helical(3, pin_errors=errors, planet_stiffness=BearingStiffness(1e8, 1e7, 2e5))
    system, found, bearings = at_rest(gears)
    assert np.ptp(found.mesh_force) > 0.1 * FORCE / 3.0  # a state without any symmetry
    total, moment = np.zeros(3), np.zeros(2)
    largest = 0.0
    for rotor in system.rotors:
        for part in rotor.bushings:
            x, y, z, about_x, about_y, _ = bearings[part.name]
            lever = rotor.shaft.origin[2] + part.position - gears.face_width / 2.0
            total += (x, y, z)
            moment += (about_x - lever * y, about_y + lever * x)
            largest = max(largest, abs(about_x), abs(about_y))
    assert largest > 1.0
    np.testing.assert_allclose(total, 0.0, atol=1e-7 * FORCE)
    np.testing.assert_allclose(moment, 0.0, atol=1e-7 * largest)


def test_the_other_hand_is_the_mirror_image():
    errors = ((15e-6, -20e-6), (0.0, 8e-6), (-5e-6, 0.0))
    (system, one, _), (_, other, _) = (at_rest(helical(3, h, pin_errors=errors)) for h in (HELIX, -HELIX))
    np.testing.assert_allclose(one.mesh_force, other.mesh_force, rtol=1e-9)
    kinds = [name.rsplit(".")[-1] for name in system.freedoms.name]
    turned = np.array([-1.0 if kind in ("z", "tilt_x", "tilt_y") else 1.0 for kind in kinds])
    mine, mirrored = (found.displacement * system.arrays.scale for found in (one, other))
    size = np.max(np.abs(mine))
    np.testing.assert_allclose(mirrored, turned * mine, atol=1e-9 * size)
    assert np.max(np.abs(mine[turned < 0.0])) > 0.01 * size


@pytest.mark.parametrize("sun", ["fixed", "floating"])
@pytest.mark.parametrize("planets", [3, 4, 5])
def test_tilting_planets_share_the_load_as_the_closed_form_says(planets, sun, record_figure):
    """A planet's tilt under 2 F tan(beta_b) r_w is one more spring in series, so errors count for less:

    1/k_eff = 1/k_sp + 1/k_rp + 4 cos(alpha)^2/k_p + (2 tan(beta_b) r_w)^2/k_tilt.
    """
    error, cosine = 20e-6, math.cos(PRESSURE_ANGLE)
    gears = helical(
        planets,
        sun_stiffness=None if sun == "fixed" else FLOATING,
        ring_stiffness=None,
        carrier_stiffness=None,
        pin_errors=((0.0, -error), *[(0.0, 0.0)] * (planets - 1)),
    )
    _, found, _ = at_rest(gears)
    lever = 2.0 * math.tan(HELIX) * gears.base_radius[1] / cosine
    tilting = lever**2 / PIN.tilt
    stiffness = 1.0 / (2.0 / MESH_STIFFNESS + 4.0 * cosine**2 / PIN.radial + tilting)
    gain = 2.0 * cosine * stiffness * error / FORCE
    angle = 2.0 * np.pi * np.arange(planets) / planets
    weight = 1.0 + (2.0 * np.cos(angle) if sun == "floating" else 0.0)
    expected = 1.0 / planets + gain * ((np.arange(planets) == 0) - weight / planets)
    off = float(np.max(np.abs(found.mesh_force[::2] / FORCE - expected)))
    name = f"load sharing of tilting planets, {planets} planets, {sun} sun"
    record_figure(name, off, "at most 1e-6", "1", "closed form")
    assert off < 1e-6
    assert tilting > 0.1 / stiffness  # and the tilt counts
