"""Power of a forced response: the balance of all parts, closed forms, the losses of a run in steady state."""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, spring_table, square_wave_table, with_mesh
from planetary_scenes import driven_scene, published_set
from two_stage_scenes import two_stages

from dynamics import Housing, Integration, Outputs, RollingContact, TimeLaw, forced_response, simulate
from dynamics.assembly.assemble import assemble
from dynamics.loads import Unbalance

NAMES = ("input.left", "input.right", "output.left", "output.right")
STIFF, INERT = 3e8 * np.eye(4) + 5e7 * (4.0 * np.eye(4) - 1.0), 6.75 * np.eye(12)
SPEEDS = np.linspace(50.0, 600.0, 12)


def rows(matrix):
    return tuple(map(tuple, np.asarray(matrix).tolist()))


def in_housing(scene, **changes):
    """Four seats of 6.75 kg on springs, tied to each other: modes from 1061 to 1369 Hz."""
    fields = {"mass": rows(INERT), "damping_ratio": 0.03} | changes
    return replace(scene, housings=(Housing("case", NAMES, rows(np.kron(STIFF, np.eye(3))), **fields),))


def all_square(scene):
    meshes = tuple(replace(mesh, table=square_wave_table()) for mesh in scene.meshes)
    return replace(scene, meshes=meshes)


def on_curves(scene):
    bushings = tuple(replace(part, radial_stiffness=0.0) for part in scene.bushings)
    laws = tuple(RollingContact(part.name, 1e8, 1.0) for part in bushings)
    return replace(scene, bushings=bushings, rolling_contacts=laws)


ON = {"lateral": "on", "tilt": "on"}
FRICTION = ON | {"friction": "on", "dynamic_misalignment": "on"}
SCENES = {
    "pair": gear_pair_scene,
    "housing with mass": lambda: in_housing(gear_pair_scene(effects=ON)),
    "housing without mass": lambda: in_housing(
        gear_pair_scene(), mass=None, damping=rows(1e-6 * np.kron(STIFF, np.eye(3)))
    ),
    "bearings of laws in it": lambda: on_curves(in_housing(gear_pair_scene(effects=ON))),
    "friction": lambda: gear_pair_scene(effects=FRICTION),
    "shafts that bend": lambda: all_square(two_stages()),
    "planets": lambda: all_square(
        driven_scene(published_set(3), effects=ON | {"axial": "on", "gyroscopic": "on"})
    ),
    "unbalance": lambda: gear_pair_scene(effects=ON, unbalances=(Unbalance("off", "input", 0.05, 1e-3),)),
}


@pytest.mark.parametrize("name", SCENES)
def test_what_excitation_puts_in_is_lost_in_the_parts(name):
    power = forced_response(assemble(SCENES[name]()), SPEEDS, 3).power
    assert np.sum(power.input) > 0.0
    assert power.residual < 1e-9
    assert len(set(zip(power.sink, power.kind, strict=True))) == len(power.sink)


def test_one_freedom_loses_its_power_in_its_damper():
    stiffness, ripple, ratio = 4e8, 1e-7, 0.05
    scene = replace(gear_pair_scene(spring_table(stiffness, ripple)), bushings=(), effects={})
    mass = 1.1344291072112745e-3 / BASE_RADIUS**2
    damping = 2.0 * ratio * math.sqrt(stiffness * mass)
    response = forced_response(assemble(with_mesh(scene, damping=damping)), SPEEDS, 1)
    found, omega = response.power, 20.0 * SPEEDS
    error = response.static_transmission_error[0, 0]  # that of the table, off by 1e-7
    assert abs(error) == pytest.approx(ripple, rel=1e-6)
    moved = stiffness * error / (stiffness - mass * omega**2 + 1j * omega * damping)
    expected = 0.5 * damping * omega**2 * np.abs(moved) ** 2
    assert (found.sink, found.kind) == (("mesh",), ("mesh",))
    np.testing.assert_allclose(found.loss[0, :, 0], expected, rtol=1e-9)
    np.testing.assert_allclose(found.input[0, :, 0], expected, rtol=1e-9)


def test_power_grows_with_the_square_of_the_error_that_excites():
    def losses(ripple):
        scene = gear_pair_scene(spring_table(4e8, ripple), effects=ON)
        return forced_response(assemble(in_housing(scene)), SPEEDS, 1).power.loss

    np.testing.assert_allclose(losses(2e-8), 4.0 * losses(1e-8), rtol=1e-9)


def test_a_housing_loses_what_the_damping_of_its_modes_takes():
    response = forced_response(assemble(in_housing(gear_pair_scene(effects=ON))), SPEEDS, 4)
    modes = [index for index, name in enumerate(response.freedom) if name.startswith("case.")]
    square = np.repeat(np.linalg.eigvalsh(np.kron(STIFF, np.eye(3)) / 6.75)[::3], 3)
    velocity = 2.0 * math.pi * response.frequency * np.abs(response.displacement[modes])
    expected = 0.5 * np.einsum("m,msh->sh", 2.0 * 0.03 * np.sqrt(square), velocity**2)
    found = response.power.loss[response.power.sink.index("case")]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * expected.max())
    total = response.power.by_kind()
    assert total["housing"].max() > 0.01 * sum(total.values()).max()


def test_a_run_in_steady_state_loses_what_linear_theory_says():
    """A weak ripple on a spring: meshes stay linear. Whole periods of the mesh, transients gone."""
    rpm, settled, periods = 3300.0, 0.08, 40
    pair = gear_pair_scene(spring_table(4e8, 1e-7), speed=TimeLaw.constant(rpm * RPM), effects=ON)
    settings = {"integration": Integration(tolerance=1e-11), "outputs": Outputs(energy_audit=True)}
    scene = replace(in_housing(pair), **settings)
    lasts = periods * 60.0 / (20.0 * rpm)
    first, second = (simulate(replace(scene, duration=time)).energy for time in (settled, settled + lasts))

    def power(*parts):
        return sum(getattr(second, part) - getattr(first, part) for part in parts) / lasts

    found = forced_response(assemble(scene), [rpm * RPM], 1).power
    kinds = {kind: float(value[0]) for kind, value in found.by_kind().items()}
    assert kinds["housing"] > 0.05 * sum(kinds.values())
    assert power("meshes") == pytest.approx(kinds["mesh"], rel=0.01)
    assert power("bushings") == pytest.approx(kinds["bearing"] + kinds["housing"], rel=0.01)
    assert power("position", "axes") == pytest.approx(float(np.sum(found.input)), rel=0.01)
