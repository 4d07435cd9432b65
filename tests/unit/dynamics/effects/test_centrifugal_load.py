"""Centrifugal load of planets: m r W^2 on the pin, the closed form of a mass on a turning spring, energy."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table
from planetary_scenes import driven_scene, planetary_scene, published_set

from dynamics import FreeRotation, ImposedRotation, Inertia, Integration, Outputs, Shaft, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.bearings import PlanetBearing
from dynamics.integrators import integrate, static_equilibrium
from dynamics.motion.observation import local_state
from dynamics.results import EnergyAudit

MASS, STIFFNESS, SPEED = 2.0, 1e7, 300.0
ARM = np.array([0.06, 0.08])
OUTWARDS = ARM / np.hypot(*ARM)


def turntable(**effects):
    """A mass on a bearing whose pin an imposed speed turns, beside a pair that goes its own way."""
    scene = gear_pair_scene(spring_table(4e8), effects={"centrifugal_load": "on", **effects})
    carrier = Shaft("carrier", 0.05, (1.0, 0.0, 0.0), Inertia(1.0, 0.01, 0.01), "carrier")
    planet = Shaft("planet", 0.05, (1.0 + ARM[0], ARM[1], 0.0), Inertia(MASS, 1e-3, 1e-3), "carrier")
    pin = PlanetBearing("pin", "planet", "carrier", 0.025, STIFFNESS)
    return replace(
        scene,
        shafts=(*scene.shafts, carrier, planet),
        planet_bearings=(pin,),
        drives=(*scene.drives, ImposedRotation("table", "carrier", TimeLaw.constant(SPEED))),
        free_rotations=(FreeRotation("planet spins", "planet", 0.0),),
    )


def at_rest(scene):
    system = assemble(scene)
    start = static_equilibrium(system)
    assert start.status.usable
    return system, start.displacement


def moved(system, q, shaft="planet"):
    return np.array([q[system.freedoms.name.index(f"{shaft}.{kind}")] for kind in ("x", "y")])


@pytest.mark.parametrize("gyroscopic", ["off", "on"])
def test_a_mass_on_a_turning_spring_rests_where_the_closed_form_says(gyroscopic):
    """k u = m (r + u) W^2: u = m r W^2/(k - m W^2); without centripetal terms m r W^2/k."""
    system, q = at_rest(turntable(gyroscopic=gyroscopic, lateral="on"))
    softer = MASS * SPEED**2 if gyroscopic == "on" else 0.0
    exact = MASS * ARM * SPEED**2 / (STIFFNESS - softer)
    np.testing.assert_allclose(moved(system, q), exact, rtol=1e-9)


def balance_of_planets(choice):
    """Radial force on each pin less that of its meshes, N."""
    scene = driven_scene(published_set(3), speed=TimeLaw.constant(2000.0))
    system, q = at_rest(replace(scene, effects={"centrifugal_load": choice, "gyroscopic": "off"}))
    local = local_state(system.arrays, 0.0, q, 0.0 * q)
    on_pin = system.bearing_force(local.force[:, None], q[None], 0.0 * q[None])[..., 0]
    found = []
    for index, rotor in enumerate(system.rotors):
        if rotor.carrier is None:
            continue
        away = (rotor.center - system.rotors[rotor.carrier].center)[:2]
        away = away / np.hypot(*away)
        support = system.supports.name.index(rotor.planet_bearings[0].name)
        rows = system.arrays.direction[system.driving_rows]
        columns = [system.freedoms.find(index, kind) for kind in (0, 1)]
        pushed = -local.force[system.driving_rows] @ rows[:, columns]
        found.append(float(on_pin[support, :2] @ away - pushed @ away))
    return np.array(found)


def test_every_pin_carries_the_load_beside_its_meshes():
    gears = published_set(3)
    carrier = 2000.0 * gears.teeth[0] / (gears.teeth[0] + gears.teeth[2])
    exact = gears.planet_inertia.mass * gears.center_distance * carrier**2
    np.testing.assert_allclose(balance_of_planets("on"), exact, rtol=1e-6)
    np.testing.assert_allclose(balance_of_planets("off"), 0.0, atol=1e-6 * exact)


def test_the_load_grows_with_the_square_of_the_speed_in_a_run_up():
    """Slowly enough that the mass follows: m r W^2 on the pin, and the audit closes as W changes."""
    scene = turntable(gyroscopic="off", lateral="on", backlash="off")
    rising = TimeLaw.ramp(0.0, SPEED, 0.05)
    drives = (scene.drives[0], replace(scene.drives[1], speed=rising))
    result = simulate(replace(scene, drives=drives, duration=0.05, outputs=Outputs(receipt="minimal")))
    late = result.time > 0.025
    force = result.bearing_force[result.bearing.index("pin"), :2]
    exact = MASS * np.hypot(*ARM) * rising(result.time) ** 2
    np.testing.assert_allclose((OUTWARDS @ force)[late], exact[late], rtol=2e-2)
    assert abs(result.energy.residual) < 1e-9 * abs(result.energy.stored_bushings)


@pytest.mark.parametrize("load", ["off", "on"])
def test_the_audit_closes_where_a_carrier_with_gyroscopic_terms_speeds_up(load):
    """The centripetal term stores -m W^2 u^2/2 in a mass that is already away from its place."""
    scene = turntable(gyroscopic="on", centrifugal_load=load, lateral="on", backlash="off")
    rising = TimeLaw.ramp(0.0, SPEED, 0.05)
    drives = (scene.drives[0], replace(scene.drives[1], speed=rising))
    system = assemble(replace(scene, drives=drives, duration=0.05))
    start, velocity = static_equilibrium(system), np.zeros(len(system.freedoms.name))
    velocity[system.freedoms.name.index("planet.x")] = 0.1
    run = integrate(system, start, Integration(tolerance=1e-11), velocity=velocity)
    audit = EnergyAudit.from_arrays(run.work, run.stored)
    assert abs(audit.residual) < 1e-7 * 0.5 * MASS * 0.1**2


def test_it_is_on_where_it_is_a_hundredth_of_what_meshes_push():
    def entry(scene, part="planet 1"):
        return next(e for e in assemble(scene).ledger.of("centrifugal_load") if e.part == part)

    fast, slow = (driven_scene(published_set(3), speed=TimeLaw.constant(w)) for w in (2000.0, 20.0))
    assert (entry(fast).on, entry(slow).on, entry(slow).possible) == (True, False, True)
    assert entry(fast).influence == pytest.approx(1e4 * entry(slow).influence, rel=1e-9)
    assert not entry(fast, "sun").possible
    assert not entry(planetary_scene(published_set(3))).possible  # torques alone turn the carrier
