"""Planets of one set: bearings inside them, and copies in unequal places."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import spring_table
from planetary_scenes import MESH_STIFFNESS, PRESSURE_ANGLE, driven_scene, planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.bearings import BearingStiffness
from dynamics.errors import InputError
from dynamics.forces import RollingContact, SpringCurve
from dynamics.integrators import static_equilibrium
from dynamics.joints import ImposedRotation
from dynamics.linearize import natural_modes
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.mechanism import with_planets
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.mechanism.train_phases import train_phases
from dynamics.motion.observation import local_state
from dynamics.scene import Integration, ring_phase
from dynamics.shafts import DiscBody, Inertia
from dynamics.simulation import simulate

# Planet bearings with matrices, clearance and curves: rest, tangents, load sharing, drives, energy.


FORCE, STIFFNESS, CLEARANCE, ROLLER = 8000.0, 5e8, 20e-6, 10.0 / 9.0
HELIX = math.radians(20.0)
RIGID = {"sun_stiffness": None, "ring_stiffness": None, "carrier_stiffness": None}
SOFT_ACROSS = tuple(  # a pin that yields along the carrier's motion
    tuple({(0, 0): 3e8, (1, 1): 0.5e8, (3, 3): 2e5, (4, 4): 4e5}.get((i, j), 0.0) for j in range(5))
    for i in range(5)
)


def contacts(scene, clearances, exponent=ROLLER):
    """Rolling contacts in place of the linear radial stiffness of the pins."""
    pins = tuple(replace(pin, radial_stiffness=0.0) for pin in scene.planet_bearings)
    laws = tuple(
        RollingContact(pin.name, STIFFNESS, exponent, clearance)
        for pin, clearance in zip(pins, clearances, strict=True)
    )
    return replace(scene, planet_bearings=pins, rolling_contacts=laws)


def loaded(planets=3, **changes):
    gears = published_set(planets, **{**RIGID, **changes})
    return planetary_scene(gears, sun_torque=FORCE * gears.base_radius[0])


def at_rest(scene):
    """The system, its equilibrium, and strain (b, 3) and force of every bearing in the carrier's frame."""
    system = assemble(scene)
    found = static_equilibrium(system)
    assert found.status.usable
    q = found.displacement
    local = local_state(system.arrays, 0.0, q, 0.0 * q)
    force = system.bearing_force(local.force[:, None], q[None], 0.0 * q[None])[:, :, 0]
    strain = system.freedoms.keep(system.supports.motion) @ q - system.supports.error
    names = system.supports.name
    return system, found, dict(zip(names, strain, strict=True)), dict(zip(names, force, strict=True))


def own_axes(planet, planets):
    angle = 2.0 * math.pi * planet / planets
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, s], [-s, c]])


@pytest.mark.parametrize("exponent", [ROLLER, 1.5])
def test_planets_cross_their_clearance_along_the_carriers_motion(exponent):
    _, _, strain, force = at_rest(contacts(loaded(), [CLEARANCE] * 3, exponent))
    push = 2.0 * FORCE / 3.0 * math.cos(PRESSURE_ANGLE)
    way = CLEARANCE + (push / STIFFNESS) ** (1.0 / exponent)
    for planet in range(3):
        name, turn = f"planet {planet + 1} bearing", own_axes(planet, 3)
        np.testing.assert_allclose(turn @ strain[name][:2], [0.0, way], rtol=1e-8, atol=1e-8 * way)
        np.testing.assert_allclose(turn @ force[name][:2], [0.0, push], rtol=1e-8, atol=1e-8 * push)


def test_more_clearance_is_a_pin_that_lies_further_back():
    """Planets are pressed along the carrier's motion, so only the sum of clearance and error counts."""
    more, back = 12e-6, tuple((0.0, error) for error in (12e-6, 0.0, 0.0, 0.0))
    clearer = at_rest(contacts(loaded(4), [CLEARANCE + more, *[CLEARANCE] * 3]))[1]
    moved = at_rest(contacts(loaded(4, pin_errors=back), [CLEARANCE] * 4))[1]
    np.testing.assert_allclose(clearer.mesh_force, moved.mesh_force, rtol=1e-8)
    assert np.ptp(clearer.mesh_force[::2]) > 0.01 * FORCE


def test_without_the_effect_pins_have_their_tangents_at_the_load():
    """Planets alike rest where they rested and vibrate as they did, on linear bearings with preload."""
    scene = loaded(base_helix_angle=HELIX, planet_stiffness=BearingStiffness(1e8, 1e8, 2e5))
    curve = SpringCurve("planet 2 bearing", "x", (-1e-4, 0.0, 1e-4), (-9e3, 0.0, 4e3))
    scene = replace(contacts(scene, [CLEARANCE] * 3), spring_curves=(curve,))
    (system, rest, strain, force) = at_rest(scene)
    linear = replace(scene, effects={**scene.effects, "bearing_clearance": "off"})
    other, tangent, strain_off, force_off = at_rest(linear)
    assert len(system.bearings) == 4
    assert not other.bearings
    np.testing.assert_allclose(tangent.mesh_force, rest.mesh_force, rtol=1e-7)
    for name in strain:
        np.testing.assert_allclose(strain_off[name], strain[name], atol=1e-7 * CLEARANCE)
        np.testing.assert_allclose(force_off[name], force[name], atol=1e-6 * FORCE)
    one, two = (natural_modes(each).frequency for each in (system, other))
    np.testing.assert_allclose(one[1:], two[1:], rtol=1e-6)


def test_a_matrix_turns_with_its_planet():
    """Radial and tangential stiffness of a pin: the same displacement of all planets in their own axes."""
    scene = loaded(4)
    pins = tuple(replace(pin, radial_stiffness=0.0, stiffness=SOFT_ACROSS) for pin in scene.planet_bearings)
    _, found, strain, force = at_rest(replace(scene, planet_bearings=pins))
    np.testing.assert_allclose(found.mesh_force, FORCE / 4.0, rtol=1e-9)
    push = 2.0 * FORCE / 4.0 * math.cos(PRESSURE_ANGLE)
    for planet in range(4):
        name, turn = f"planet {planet + 1} bearing", own_axes(planet, 4)
        np.testing.assert_allclose(turn @ strain[name][:2], [0.0, push / 0.5e8], atol=1e-8 * push / 0.5e8)
        np.testing.assert_allclose(turn @ force[name][:2], [0.0, push], atol=1e-8 * push)


def test_two_bearings_of_matrices_and_one_of_numbers_are_the_same_bearing():
    """Springs as numbers, on the diagonal of a matrix, and with the error as a preload."""
    errors = ((3e-6, 5e-6), (0.0, 0.0), (0.0, -4e-6))
    plain = loaded(pin_errors=errors)
    diagonal = tuple(tuple(1e8 if i == j < 2 else 0.0 for j in range(5)) for i in range(5))
    pins = tuple(replace(p, radial_stiffness=0.0, stiffness=diagonal) for p in plain.planet_bearings)
    preloaded = tuple(
        replace(p, radial_error=0.0, tangential_error=0.0,
                preload=(1e8 * p.radial_error, 1e8 * p.tangential_error, 0.0, 0.0, 0.0))
        for p in plain.planet_bearings
    )  # fmt: skip
    one = at_rest(plain)
    for changed in (pins, preloaded):
        other = at_rest(replace(plain, planet_bearings=changed))
        np.testing.assert_allclose(other[1].mesh_force, one[1].mesh_force, rtol=1e-9)
        for name, force in one[3].items():
            np.testing.assert_allclose(other[3][name][:3], force[:3], atol=1e-6)


@pytest.mark.parametrize("kind", ["matrix", "rolling"])
def test_a_driven_carrier_takes_the_torque_of_its_pins(kind):
    """Rigidly driven, its torque is what the bearings hand on: that of the sun times the ratio."""
    gears = published_set(3, driver="ring")
    scene = driven_scene(gears)
    pins = tuple(replace(pin, radial_stiffness=0.0, stiffness=SOFT_ACROSS) for pin in scene.planet_bearings)
    scene = replace(scene, planet_bearings=pins) if kind == "matrix" else contacts(scene, [CLEARANCE] * 3)
    drives = (
        ImposedRotation("input", "carrier", TimeLaw.constant(20.0)),
        ImposedRotation("ring held", "ring", TimeLaw.constant(0.0)),
    )
    loads = (LoadTorque("brake", "sun", TimeLaw.constant(300.0)),)
    scene = replace(scene, drives=drives, loads=loads, duration=1e-4)
    result = simulate(scene)
    ratio = 1.0 + gears.teeth[2] / gears.teeth[0]
    assert result.drive_torque[0, 0] == pytest.approx(300.0 * ratio, rel=1e-7)


def test_the_balance_of_energy_closes_over_clearances_and_tilts():
    gears = published_set(
        3,
        base_helix_angle=HELIX,
        sun_stiffness=BearingStiffness(1e7, 1e8, 1e5),
        planet_stiffness=BearingStiffness(1e8, 1e8, 2e5),
        pin_errors=((0.0, 10e-6), (0.0, 0.0), (0.0, 0.0)),
        sun_table=spring_table(MESH_STIFFNESS, 2e-6),
        ring_table=spring_table(MESH_STIFFNESS, 2e-6),
    )
    law = TimeLaw((0.0, 0.01), (300.0, 400.0))
    scene = contacts(driven_scene(gears, speed=law, duration=0.01), [2.0 * CLEARANCE, CLEARANCE, CLEARANCE])
    result = simulate(replace(scene, integration=Integration(tolerance=1e-11)))
    assert result.status.usable
    assert np.any(result.bearing_moment != 0.0)
    assert result.energy.bushings > 1e-2
    assert result.energy.relative < 1e-4  # 1e-2 at the default tolerance of 1 nm


def test_copies_of_a_planet_have_its_laws():
    gears = published_set(3)
    parts = replace(gears, planets=1, pin_errors=None).parts()
    scene = planetary_scene(replace(gears, planets=1))
    curve = SpringCurve("planet 1 bearing", "tilt_x", (-1e-3, 1e-3), (-10.0, 10.0))
    contact = RollingContact("planet 1 bearing", STIFFNESS)
    scene = replace(scene, rolling_contacts=(contact,), spring_curves=(curve,))
    found = with_planets(scene, "planet 1", 3)
    names = [pin.name for pin in found.planet_bearings]
    assert len(names) == 3 == len(set(names))
    assert len(parts.planet_bearings) == 1
    assert [law.bushing for law in found.rolling_contacts] == names
    assert [law.bushing for law in found.spring_curves] == names


def test_a_law_of_a_bearing_that_is_not_there_is_refused():
    scene = loaded()
    with pytest.raises(InputError, match=r"rolling_contacts\[0\]\.bushing"):
        replace(scene, rolling_contacts=(RollingContact("planet 9 bearing", STIFFNESS),))


# Several planets from one: the same scene as from the set's numbers, whatever drives what.


def only_first(scene):
    kept = {"planet 1", "sun", "ring", "carrier"}
    return replace(
        scene,
        shafts=tuple(s for s in scene.shafts if s.name in kept),
        gears=tuple(g for g in scene.gears if g.name in kept),
        planet_bearings=tuple(b for b in scene.planet_bearings if b.shaft in kept),
        meshes=tuple(m for m in scene.meshes if {m.driver, m.driven} <= kept),
    )


@pytest.mark.parametrize(("driver", "sense"), [("sun", "+z"), ("sun", "-z"), ("ring", "+z")])
def test_copies_have_the_phases_and_positions_of_the_set(driver, sense):
    """A sun that turns backwards, and a ring that drives, meet the planets in the other order."""
    teeth = (28, 35, 98)  # a third of a pitch from planet to planet
    gears = published_set(3, teeth=teeth, driver=driver, ring_phase=0.3)
    speed = -100.0 if sense == "-z" else 100.0
    whole = driven_scene(gears)
    sun = replace(whole.drives[0], speed=replace(whole.drives[0].speed, value=(speed,)))
    whole = replace(whole, drives=(sun, whole.drives[1]), loads=())
    copied = with_planets(only_first(whole), "planet 1", 3)
    locations = {tuple(np.round(shaft.origin, 12)) for shaft in whole.shafts}
    assert {tuple(np.round(shaft.origin, 12)) for shaft in copied.shafts} == locations
    assert len(copied.meshes) == 6
    here, there = (
        train_phases(scene, solve_kinematics(scene).mesh_sense).position for scene in (whole, copied)
    )
    for index, mesh in enumerate(whole.meshes):
        twin = next(k for k, m in enumerate(copied.meshes) if placed(copied, m) == placed(whole, mesh))
        off = there[twin] - here[index]
        assert off - round(off) == pytest.approx(0.0, abs=1e-9)


def stepped(scene):
    """The planets with a second gear of 26 teeth, which meshes with a ring gear of 89."""
    steps = tuple(
        replace(gear, name=f"{gear.name} step", teeth=26, base_radius=gear.base_radius * 26 / gear.teeth)
        for gear in scene.gears
        if gear.name.startswith("planet")
    )
    gears = tuple(
        replace(gear, teeth=89, base_radius=gear.base_radius * 89 / gear.teeth)
        if gear.name == "ring"
        else gear
        for gear in scene.gears
    )
    meshes = tuple(
        replace(mesh, driver=f"{mesh.driver} step") if mesh.driver.startswith("planet") else mesh
        for mesh in scene.meshes
    )
    return replace(scene, gears=(*gears, *steps), meshes=meshes)


def test_a_stepped_planet_turns_by_both_of_its_gears():
    """i = 1 + z_ring z_1 / (z_2 z_sun)."""
    run = simulate(stepped(planetary_scene(published_set(3, teeth=(27, 36, 99)), duration=0.002)))
    speed = dict(zip(run.shaft, run.speed[:, 0], strict=True))
    assert speed["sun"] / speed["carrier"] == pytest.approx(1.0 + 89 * 36 / (26 * 27), rel=1e-6)


@pytest.mark.parametrize(("number", "fits"), [(1, True), (2, False), (3, True), (4, False), (5, False)])
def test_copies_of_a_stepped_planet_fit_with_both_gears_or_are_refused(number, fits):
    """36 and 26 teeth between 27 and 89: three copies of one part can be put in, two, four or five cannot."""
    whole = stepped(planetary_scene(published_set(3, teeth=(27, 36, 99))))
    kept = {"planet 1", "sun", "ring", "carrier"}
    one = replace(
        whole,
        shafts=tuple(s for s in whole.shafts if s.name in kept),
        gears=tuple(g for g in whole.gears if g.shaft in kept),
        planet_bearings=tuple(b for b in whole.planet_bearings if b.shaft in kept),
        meshes=tuple(m for m in whole.meshes if m.name.endswith(" 1")),
    )
    if fits:
        assert len(with_planets(one, "planet 1", number).meshes) == 2 * number
        return
    with pytest.raises(InputError, match=r"number = .*planet 2, off by .* a stepped planet .* Change tooth"):
        with_planets(one, "planet 1", number)


def test_discs_of_a_planet_are_on_all_planets():
    first = only_first(driven_scene(published_set(3)))
    disc = DiscBody("disc", "planet 1", 0.01, Inertia(0.5, 1e-3, 1e-3))
    bare, copied = (with_planets(replace(first, discs=d), "planet 1", 3) for d in ((), (disc,)))
    assert [part.shaft for part in copied.discs] == ["planet 1", "planet 1 2", "planet 1 3"]
    added = [b.inertia.mass - a.inertia.mass for a, b in zip(*map(rotors, (bare, copied)), strict=True)]
    np.testing.assert_allclose(sorted(added), [0.0] * (len(added) - 3) + [0.5] * 3, atol=1e-12)


def rotors(scene):
    return assemble(scene).rotors


def placed(scene, mesh):
    gears = [scene.gear(name) for name in (mesh.driver, mesh.driven)]
    shafts = [next(s for s in scene.shafts if s.name == gear.shaft) for gear in gears]
    return tuple(
        (gear.internal, *np.round(shaft.origin, 9)) for gear, shaft in zip(gears, shafts, strict=True)
    )


def test_planets_meet_one_after_the_other_as_tooth_numbers_say():
    """27 + 99 teeth, three planets: sun and ring in phase (both divisible by 3); 28 + 100, four: in phase."""
    positions = assemble(driven_scene(published_set(3))).arrays.reference.offset % 1.0
    np.testing.assert_allclose(np.minimum(positions, 1.0 - positions), 0.0, atol=1e-9)
    gears = published_set(4, teeth=(30, 36, 102))  # 30 = 4 * 7 + 2: neighbors half a pitch apart
    sun = assemble(driven_scene(gears)).arrays.reference.offset[::2] % 1.0
    np.testing.assert_allclose(sun, [0.0, 0.5, 0.0, 0.5], atol=1e-9)


def test_ring_phase_of_even_and_odd_planets():
    assert ring_phase(36) == pytest.approx(0.5)
    assert ring_phase(35) % 1.0 == pytest.approx(0.0)
    thick = ring_phase(35, (math.pi / 70 + 1e-3, math.pi / 70 + 1e-3))
    assert thick == pytest.approx(2e-3 * 35 / (2 * math.pi))
    mirrored = ring_phase(35, (math.pi / 70 + 1e-3,) * 2, driver="ring")
    assert (thick + mirrored) % 1.0 == pytest.approx(0.0, abs=1e-12)


def test_planets_that_do_not_fit_are_refused():
    one = only_first(driven_scene(published_set(3)))
    with pytest.raises(InputError, match=r"number = 'planet 2, off by -?0\.5 teeth'"):
        with_planets(one, "planet 1", 4)
    with pytest.raises(InputError, match="angles"):
        with_planets(one, "planet 1", 3, [0.1, 2.0, 4.0])
    with pytest.raises(InputError, match="off its axis"):
        with_planets(one, "sun", 3)


def test_pin_errors_go_to_their_planets():
    one = only_first(planetary_scene(published_set(3)))
    bearings = with_planets(one, "planet 1", 3, None, [(0.0, 1e-6), (2e-6, 0.0), (0.0, 0.0)]).planet_bearings
    assert [(b.radial_error, b.tangential_error) for b in bearings] == [(0.0, 1e-6), (2e-6, 0.0), (0.0, 0.0)]
