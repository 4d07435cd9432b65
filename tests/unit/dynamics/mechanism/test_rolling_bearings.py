"""Rolling contacts and spring curves: derivatives, energy, statics, impacts, tangents, bad input."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, with_bushings
from scipy.integrate import quad

from dynamics import Bushing, Coupling, Inertia, Integration, RollingContact, Shaft, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.forces import SpringCurve
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.march import stored_energy
from dynamics.linearize import natural_modes
from dynamics.motion.observation import local_state

STIFFNESS, CLEARANCE, ROLLER, BALL = 5e8, 20e-6, 10.0 / 9.0, 1.5
ON = {"lateral": "on", "axial": "on", "tilt": "on"}
PROGRESSIVE = ((-4e-5, -2e-5, 0.0, 2e-5, 4e-5), (-6000.0, -1500.0, 0.0, 1500.0, 6000.0))


def contact(bushing, exponent=ROLLER, **changes):
    given = {"stiffness": STIFFNESS * (200.0 if exponent == BALL else 1.0), "clearance": CLEARANCE} | changes
    return RollingContact(bushing, exponent=exponent, **given)


def on_rolling_bearings(exponent=ROLLER, table=None, effects=ON, **changes):
    """The 20/20 pair on four rolling bearings that hold the axis linearly."""
    scene = with_bushings(gear_pair_scene(table or spring_table(4e8), effects=effects), radial_stiffness=0.0)
    contacts = tuple(contact(bushing.name, exponent, **changes) for bushing in scene.bushings)
    return replace(scene, rolling_contacts=contacts)


def disc(*contacts, mass=2.0, curves=(), **changes):
    """A disc on one bearing in its middle, turned through a soft coupling by the pair's driver."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.constant(10.0), effects={"lateral": "on"})
    shaft = Shaft("disc", 0.2, (0.0, 0.0, 0.4), Inertia(mass, 0.02, 0.01))
    seat = Bushing("disc seat", "disc", 0.1)
    return replace(
        scene,
        shafts=(*scene.shafts, shaft),
        bushings=(*scene.bushings, seat),
        couplings=(Coupling("joint", "input", "disc", 100.0),),
        rolling_contacts=contacts,
        spring_curves=curves,
        **changes,
    )


def with_curves(scene):
    names = [bushing.name for bushing in scene.bushings]
    tilt = SpringCurve(names[0], "tilt_x", (-1e-3, -1e-4, 2e-4, 1e-3), (-60.0, -2.0, 3.0, 50.0))
    return replace(scene, spring_curves=(tilt, SpringCurve(names[1], "z", *PROGRESSIVE)))


def bearing_rows(system):
    return np.flatnonzero(system.arrays.elements.stiffness > 0.0)


@pytest.mark.parametrize("exponent", [ROLLER, BALL])
def test_derivatives_are_those_of_the_forces(exponent):
    system = assemble(with_curves(on_rolling_bearings(exponent)))
    arrays, rows = system.arrays, bearing_rows(system)
    rng = np.random.default_rng(1)
    for _ in range(5):
        q = 6e-5 * rng.normal(size=arrays.mass.shape[0]) / arrays.scale
        v = 5e-2 * rng.normal(size=q.size) / arrays.scale
        local = local_state(arrays, 0.0, q, v)
        assert np.count_nonzero(local.force[rows]) > 4
        for step, left, tangent in ((1e-10, 1, local.tangent), (1e-6, 0, local.viscous)):
            block = np.zeros((rows.size, arrays.elements.offset.size))
            for e, first in enumerate(arrays.elements.first[:-1]):
                size = arrays.elements.first[e + 1] - first
                if first in rows:
                    own = slice(first, first + size)
                    block[own.start - rows[0] : own.stop - rows[0], own] = tangent[own, :size]
            for i in range(q.size):
                change = np.zeros(q.size)
                change[i] = step / arrays.scale[i]
                high, low = (
                    local_state(arrays, 0.0, q + s * left * change, v + s * (1 - left) * change).force[rows]
                    for s in (1.0, -1.0)
                )
                expected = block @ arrays.direction @ change
                largest = np.max(np.abs(block)) * step
                np.testing.assert_allclose((high - low) / 2.0, expected, rtol=1e-5, atol=1e-5 * largest)


def test_elastic_forces_are_the_slopes_of_the_energy_stored():
    system = assemble(with_curves(on_rolling_bearings(BALL)))
    arrays, rows = system.arrays, bearing_rows(system)
    rng = np.random.default_rng(2)
    q = 6e-5 * rng.normal(size=arrays.mass.shape[0]) / arrays.scale
    local = local_state(arrays, 0.0, q, 0.0 * q)
    push = local.elastic[rows] @ arrays.direction[rows] + arrays.stiffness @ q
    none = np.zeros(arrays.inertial.shape[0], dtype=np.int64)
    for i in range(q.size):
        change = np.zeros(q.size)
        change[i] = 1e-8 / arrays.scale[i]
        high, low = (stored_energy(arrays, 0.0, q + s * change, 0.0 * q, none)[1] for s in (1.0, -1.0))
        assert (high - low) / 2e-8 == pytest.approx(push[i] / arrays.scale[i], rel=1e-5, abs=1e-2)


def test_force_and_damping_together_never_pull():
    system = assemble(on_rolling_bearings(BALL, damping=1e5))
    arrays, rows = system.arrays, bearing_rows(system)
    rng, touched = np.random.default_rng(3), 0
    for _ in range(50):
        q, v = rng.normal(size=(2, arrays.mass.shape[0])) / arrays.scale
        local = local_state(arrays, 0.0, 4e-5 * q, v)
        force, u = local.force[rows].reshape(-1, 2), local.coordinate[rows].reshape(-1, 2)
        assert np.all(np.sum(force * u, axis=1) >= 0.0)
        np.testing.assert_allclose(force[:, 0] * u[:, 1], force[:, 1] * u[:, 0], rtol=1e-9, atol=1e-12)
        touched += np.count_nonzero(force)
    assert touched > 20


@pytest.mark.parametrize("exponent", [ROLLER, BALL])
def test_the_shaft_rests_along_the_load_where_the_closed_form_says(exponent):
    system = assemble(on_rolling_bearings(exponent))
    found = static_equilibrium(system)
    assert found.status.usable
    push = -found.mesh_force[0] * system.lines[0].force[:2]
    part = system.scene.rolling_contacts[0]
    load = float(np.hypot(*push)) / 2.0  # two bearings share it
    expected = push / (2.0 * load) * (CLEARANCE + (load / part.stiffness) ** (1.0 / exponent))
    at = [system.freedoms.name.index(f"input.{kind}") for kind in "xy"]
    np.testing.assert_allclose(found.displacement[at], expected, rtol=1e-8)
    rest = np.zeros((1, found.displacement.size))
    local = local_state(system.arrays, 0.0, found.displacement, rest[0])
    force = system.bearing_force(local.force[:, None], found.displacement[None], rest)[:, :, 0]
    np.testing.assert_allclose(force[0, :2], push / 2.0, rtol=1e-8)


def test_an_unloaded_shaft_floats_in_its_clearance():
    scene = disc(contact("disc seat"), duration=0.02)
    result = simulate(replace(scene, outputs=replace(scene.outputs, displacements=True)))
    assert result.status.usable
    at = [result.freedom.index(f"disc.{kind}") for kind in "xy"]
    np.testing.assert_array_equal(result.displacement[at], 0.0)
    np.testing.assert_array_equal(result.bearing_force[result.bearing.index("disc seat")], 0.0)


def bouncing(method, tolerance, exponent=ROLLER, way=(1.0, 0.0), duration=0.02, damping=0.0):
    """A disc thrown across its clearance at 0.05 m/s: times, displacements, trajectory."""
    mass = 2.0
    scene = disc(contact("disc seat", exponent, damping=damping), mass=mass, duration=duration)
    system = assemble(scene)
    start = static_equilibrium(system)
    velocity = np.zeros(start.displacement.size)
    at = [system.freedoms.name.index(f"disc.{kind}") for kind in "xy"]
    velocity[at] = 0.05 * np.asarray(way)
    run = integrate(system, start, Integration(method=method, tolerance=tolerance), velocity=velocity)
    assert run.status.usable
    return run.time, run.q[:, at], run, scene.rolling_contacts[0]


@pytest.mark.parametrize("exponent", [ROLLER, BALL])
def test_a_thrown_shaft_returns_when_the_closed_form_says(exponent):
    """Undamped: flight over 2 c / v, contact 2 int dr / sqrt(v^2 - 2 V / m); both integrators, by order."""
    speed, mass, higher = 0.05, 2.0, exponent + 1.0
    time, path, _, part = bouncing("implicit", 1e-12, exponent)
    deepest = (mass * speed**2 * higher / (2.0 * part.stiffness)) ** (1.0 / higher)
    # press = deepest sin(phi)^(2/higher) takes the root out of the end
    within, _ = quad(lambda phi: math.sin(phi) ** (2.0 / higher - 1.0), 0.0, math.pi / 2.0, epsabs=1e-13)
    press_time = 2.0 * deepest / speed * 2.0 / higher * within
    period = 2.0 * (2.0 * part.clearance / speed + press_time)
    x, other = path[:, 0], bouncing("explicit", 1e-12, exponent)[1][:, 0]
    np.testing.assert_allclose(x, other, atol=1e-8)
    crossing = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    at = time[crossing] - x[crossing] * (time[crossing + 1] - time[crossing]) / (
        x[crossing + 1] - x[crossing]
    )
    np.testing.assert_allclose(np.diff(at), period, rtol=2e-6)
    assert np.max(np.abs(x)) == pytest.approx(part.clearance + deepest, rel=1e-2)


def test_integrators_agree_and_converge_at_oblique_impacts():
    """Repeated impacts enlarge errors: 3e-9 of a swing of 22 um at a tolerance of 1e-11, 2e-10 at 1e-12."""
    thrown = {"way": (0.8, 0.6), "exponent": BALL, "damping": 300.0, "duration": 0.01}
    fine = bouncing("explicit", 1e-14, **thrown)[1]
    errors = [
        np.max(np.abs(bouncing("implicit", tolerance, **thrown)[1] - fine))
        for tolerance in (1e-10, 1e-11, 1e-12)
    ]
    assert errors[0] < 5e-7
    assert errors[1] < 1e-8
    assert errors[2] < 1e-9
    assert errors[2] < 0.02 * errors[0]


def test_energy_is_conserved_without_damping_and_lost_with_it():
    _, _, run, _ = bouncing("implicit", 1e-12)
    kinetic, bearing = run.stored[:, 0], run.stored[:, 1]
    swing = 0.5 * 2.0 * 0.05**2
    assert abs((kinetic + bearing)[1] - (kinetic + bearing)[0]) < 1e-5 * swing  # 3e-6
    _, _, lossy, _ = bouncing("implicit", 1e-12, damping=1000.0)
    lost = (lossy.stored[0, :2] - lossy.stored[1, :2]).sum()
    assert 0.1 * swing < lost < swing


def test_a_run_closes_its_balance():
    scene = replace(on_rolling_bearings(BALL), meshes=gear_pair_scene().meshes, duration=0.02)
    result = simulate(replace(scene, integration=Integration(tolerance=1e-10)))
    assert result.energy.relative < 1e-3
    assert result.energy.bushings > 0.0


def test_off_is_the_linear_bushing_of_the_tangent_to_the_last_bit():
    scene = replace(on_rolling_bearings(BALL), meshes=gear_pair_scene().meshes, duration=0.005)
    off = replace(scene, effects={**ON, "bearing_clearance": "off"})
    linear = assemble(off).scene
    assert linear.rolling_contacts == ()
    seat, part = linear.bushings[0], scene.rolling_contacts[0]
    static = static_equilibrium(assemble(scene))
    line = assemble(scene).lines[0].force[:2]
    e = -line / np.hypot(*line)
    load = assemble(scene).flanks.nominal_force[0] * np.hypot(*line) / 2.0
    press = (load / part.stiffness) ** (1.0 / BALL)
    along, across = BALL * load / press, load / (CLEARANCE + press)
    expected = along * np.outer(e, e) + across * (np.eye(2) - np.outer(e, e))
    np.testing.assert_allclose(np.array(seat.stiffness)[:2, :2], expected, rtol=1e-8, atol=1e-4)
    mine, other = simulate(off), simulate(replace(linear, effects=ON))
    for name in ("dynamic_transmission_error", "mesh_force", "bearing_force"):
        np.testing.assert_array_equal(getattr(mine, name), getattr(other, name))
    at = static_equilibrium(assemble(off)).displacement
    np.testing.assert_allclose(at, static.displacement, rtol=1e-4, atol=1e-9)
    entry = next(e for e in mine.effect_ledger["entries"] if e["effect"] == "bearing_clearance")
    assert (entry["on"], entry["choice"]) == (False, "off")
    assert entry["influence_m"] > CLEARANCE


def test_modes_about_the_load_are_those_of_the_tangent():
    scene = on_rolling_bearings(BALL)
    on, off = (
        natural_modes(assemble(replace(scene, effects={**ON, "bearing_clearance": choice})))
        for choice in ("on", "off")
    )
    np.testing.assert_allclose(on.frequency, off.frequency, rtol=1e-6, atol=1e-3)
    np.testing.assert_allclose(on.strain_energy.sum(axis=1)[1:], 1.0, rtol=1e-6)


def test_a_straight_curve_is_a_linear_spring():
    k = 1e8
    plain = with_bushings(gear_pair_scene(effects=ON, duration=0.005), damping_ratio=0.0)
    curves = tuple(
        SpringCurve(bushing.name, kind, (-1e-5, 0.0, 3e-5), (-1e-5 * k, 0.0, 3e-5 * k))
        for bushing in plain.bushings
        for kind in "xyz"
    )
    bent = replace(with_bushings(plain, radial_stiffness=0.0, axial_stiffness=0.0), spring_curves=curves)
    a, b = simulate(plain), simulate(bent)
    assert plain.bushings[0].radial_stiffness == k
    np.testing.assert_allclose(b.mesh_force, a.mesh_force, rtol=1e-3)
    np.testing.assert_allclose(b.bearing_force, a.bearing_force, atol=2e-3 * np.max(np.abs(a.bearing_force)))


def test_a_curve_passes_its_points_and_goes_on_straight():
    curve = SpringCurve("b", "x", *PROGRESSIVE)
    system = assemble(disc(curves=(replace(curve, bushing="disc seat"),)))
    arrays, row = system.arrays, bearing_rows(system)[0]
    column = system.freedoms.name.index("disc.x")

    def force(x):
        q = np.zeros(arrays.mass.shape[0])
        q[column] = x
        return local_state(arrays, 0.0, q, 0.0 * q).force[row]

    np.testing.assert_allclose([force(x) for x in PROGRESSIVE[0]], PROGRESSIVE[1], rtol=1e-12, atol=1e-9)
    beyond = [force(4e-5 + step) - 6000.0 for step in (1e-5, 2e-5)]
    assert beyond[1] == pytest.approx(2.0 * beyond[0], rel=1e-9)
    between = np.array([force(x) for x in np.linspace(-5e-5, 5e-5, 101)])
    assert np.all(np.diff(between) > 0.0)


def test_what_is_no_bearing_law_is_named():
    scene = gear_pair_scene()
    name = scene.bushings[0].name
    cases = {
        "stiffness": lambda: RollingContact("b", 0.0),
        "exponent": lambda: RollingContact("b", 1e8, 0.5),
        "clearance": lambda: RollingContact("b", 1e8, clearance=-1e-6),
        "damping": lambda: RollingContact("b", 1e8, damping=-1.0),
        "direction": lambda: SpringCurve("b", "r", (0.0, 1.0), (0.0, 1.0)),
        "displacement": lambda: SpringCurve("b", "x", (0.0, 0.0), (0.0, 1.0)),
        "force": lambda: SpringCurve("b", "x", (0.0, 1.0), (0.0, -1.0)),
        "rolling_contacts[0].bushing": lambda: replace(scene, rolling_contacts=(contact("none"),)),
        "rolling_contacts[1].name": lambda: replace(scene, rolling_contacts=(contact(name),) * 2),
        "spring_curves[0].bushing": lambda: replace(
            scene, spring_curves=(SpringCurve("none", "x", (0.0, 1.0), (0.0, 1.0)),)
        ),
    }
    for field, make in cases.items():
        with pytest.raises(InputError) as caught:
            make()
        assert caught.value.field == field


def test_a_tilt_curve_is_the_same_beside_a_curve_along_the_axis():
    """Tilts are lengths inside: on a radius that all curves of tilt share and no other curve uses."""
    scene = with_bushings(gear_pair_scene(spring_table(4e8), effects=ON), radial_stiffness=1e8)
    name = scene.bushings[0].name
    tilt = SpringCurve(name, "tilt_x", (-1e-3, 0.0, 1e-3), (-60.0, 0.0, 60.0))
    along = SpringCurve(name, "z", (-1e-3, 0.0, 1e-3), (-60.0, 0.0, 60.0))
    for curves in ((tilt,), (tilt, along)):
        system = assemble(replace(scene, spring_curves=curves))
        q = np.zeros(system.arrays.mass.shape[0])
        q[system.freedoms.name.index("input.tilt_x")] = 5e-4
        local = local_state(system.arrays, 0.0, q, 0.0 * q)
        extra = system.arrays.elements.first[len(system.elements) - len(curves)]
        moment = local.force[extra] * system.bearings[0].local_rows[0, 3]
        assert moment == pytest.approx(30.0, rel=1e-9)
