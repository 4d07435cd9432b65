"""Rolling bearings as parts of a scene: their forces, rest, tangents, preload, arrangement, runs."""

from dataclasses import replace

import numpy as np
import pytest
from rotors_on_bearings import (
    ANGULAR,
    CYLINDRICAL,
    DEEP_GROOVE,
    KINDS,
    ON,
    PRELOAD,
    SEATS,
    TAPERED,
    mirrored,
    pair_of,
    rotor,
)

from dynamics.assembly.assemble import assemble
from dynamics.assembly.bearing_rest import bearing_rows
from dynamics.bearings import Bushing, RollingBearing
from dynamics.bearings.loaded_bearing import LoadedBearing
from dynamics.bearings.row_law import row_law
from dynamics.bearings.tangent_bushing import tangent_bushing
from dynamics.errors import InputError
from dynamics.forces.laws import BEARING_LAW_KINDS
from dynamics.integrators import static_equilibrium
from dynamics.integrators.march import stored_energy
from dynamics.linearize import natural_modes
from dynamics.motion.observation import local_state

EVERY = pytest.mark.parametrize("kind", KINDS)
MIRROR = np.array([1.0, 1.0, -1.0, -1.0, -1.0])


def moved(system, q, at):
    """Displacements of the rotor's section at `at` in m from its left end: x, y, z, tilt_x, tilt_y."""
    x, y, z, tilt_x, tilt_y = (
        float(q[system.freedoms.name.index(f"rotor.{kind}")])
        if f"rotor.{kind}" in system.freedoms.name
        else 0.0
        for kind in ("x", "y", "z", "tilt_x", "tilt_y")
    )
    arm = at - 0.1
    return np.array([x + arm * tilt_y, y - arm * tilt_x, z, tilt_x, tilt_y])


def forces(system, q):
    """Force and moment on the ground at all supports, (b, 6)."""
    rest = np.zeros((1, q.size))
    local = local_state(system.arrays, 0.0, q, rest[0])
    return system.bearing_force(local.force[:, None], q[None], rest)[:, :, 0]


@EVERY
def test_derivatives_are_those_of_the_forces(kind):
    system = assemble(
        rotor(pair_of(KINDS[kind]), PRELOAD if kind in ("angular", "tapered") else 0.0, kind=kind)
    )
    arrays, rows = system.arrays, bearing_rows(system.arrays)
    blocks = [
        slice(arrays.elements.first[e], arrays.elements.first[e + 1])
        for e in np.flatnonzero(np.isin(arrays.elements.law, BEARING_LAW_KINDS))
    ]
    assert len(blocks) == 2
    rng = np.random.default_rng(1)
    for _ in range(3):
        q = 3e-5 * rng.normal(size=arrays.mass.shape[0]) / arrays.scale
        if kind == "cross-located":  # so far that the one or the other seat is pressed
            q[system.freedoms.name.index("rotor.z")] *= 10.0
        v = 2e-3 * rng.normal(size=q.size) / arrays.scale
        local = local_state(arrays, 0.0, q, v)
        assert np.all(np.abs([local.force[block] - local.elastic[block] for block in blocks]).max(axis=1) > 0)
        for step, left, tangent in ((2e-10, 1, local.tangent), (1e-6, 0, local.viscous)):
            for block in blocks:
                matrix = tangent[block, :5] @ arrays.direction[block]
                for i in range(q.size):
                    change = np.zeros(q.size)
                    change[i] = step / arrays.scale[i]
                    high, low = (
                        local_state(arrays, 0.0, q + s * left * change, v + s * (1 - left) * change).force[
                            block
                        ]
                        for s in (1.0, -1.0)
                    )
                    largest = np.max(np.abs(matrix @ np.diag(1.0 / arrays.scale)))
                    found = (high - low) / (2.0 * step)
                    np.testing.assert_allclose(found, matrix[:, i] / arrays.scale[i], atol=1e-6 * largest)
    assert rows.size == 10


@EVERY
def test_elastic_forces_are_the_slopes_of_the_energy_stored(kind):
    system = assemble(rotor(pair_of(KINDS[kind]), kind=kind))
    arrays, rows = system.arrays, bearing_rows(system.arrays)
    rng = np.random.default_rng(2)
    q = 3e-5 * rng.normal(size=arrays.mass.shape[0]) / arrays.scale
    local = local_state(arrays, 0.0, q, 0.0 * q)
    push = local.elastic[rows] @ arrays.direction[rows] + arrays.stiffness @ q
    none = np.zeros(arrays.inertial.shape[0], dtype=np.int64)
    for i in [i for i, name in enumerate(system.freedoms.name) if name.startswith("rotor")]:
        change = np.zeros(q.size)
        change[i] = 1e-8 / arrays.scale[i]
        high, low = (stored_energy(arrays, 0.0, q + s * change, 0.0 * q, none)[1] for s in (1.0, -1.0))
        assert (high - low) / 2e-8 == pytest.approx(push[i] / arrays.scale[i], rel=1e-5, abs=1e-2)


@EVERY
def test_the_elements_never_pull_and_damping_takes_energy(kind):
    """Each presses outwards along its own normal: no rate makes its force negative."""
    system = assemble(rotor(pair_of(KINDS[kind]), kind=kind))
    arrays = system.arrays
    rng, lost = np.random.default_rng(3), 0.0
    rows = bearing_rows(arrays)
    for _ in range(30):
        q, v = rng.normal(size=(2, arrays.mass.shape[0])) / arrays.scale
        local = local_state(arrays, 0.0, 3e-5 * q, 0.1 * v)
        power = float((local.force[rows] - local.elastic[rows]) @ local.rate[rows])
        assert power >= -1e-9
        lost += power
        fast = local_state(arrays, 0.0, 3e-5 * q, -1e3 * q)  # everything parts
        np.testing.assert_allclose(fast.force[rows], 0.0, atol=1e-9)
    assert lost > 0.0


@pytest.mark.parametrize("kind", ["deep groove", "cylindrical"])
def test_a_rotor_sags_as_far_as_its_bearings_alone(kind):
    weight, row = 40.0 * 9.81, KINDS[kind]
    system = assemble(rotor((row, row), gravity=(0.0, -9.81, 0.0)))
    found = static_equilibrium(system)
    assert found.status.usable
    alone = LoadedBearing(row, row_law(system.scene.rolling_bearings[0]).copies)
    expected = alone.displacement((0.0, -weight / 2.0, 0.0, 0.0, 0.0))
    for seat in (0.02, 0.18):
        np.testing.assert_allclose(
            moved(system, found.displacement, seat)[:3], expected[:3], rtol=1e-6, atol=1e-13
        )
    on_ground = forces(system, found.displacement)[-2:]
    np.testing.assert_allclose(on_ground[:, 1], -weight / 2.0, rtol=1e-9)
    np.testing.assert_allclose(
        on_ground[:, :3].sum(axis=0), [0.0, -weight, 0.0], atol=1e-6
    )  # action = reaction


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("kind", SEATS)
def test_the_seat_that_holds_carries_all_of_the_axial_force(kind, sense):
    """A floating bearing never, of a cross-located pair the one on the side to which the shaft is pushed."""
    thrust = 400.0 * sense
    scene = rotor((DEEP_GROOVE, DEEP_GROOVE), gravity=(2.0, -5.0, thrust / 40.0), kind=kind)
    system = assemble(scene)
    found = static_equilibrium(system)
    assert found.status.usable
    axial = forces(system, found.displacement)[-2:, 2]
    holding = 0 if kind == "floating" or sense < 0.0 else 1
    assert axial[holding] == pytest.approx(thrust, rel=1e-9)
    assert abs(axial[1 - holding]) < 1e-9 * abs(thrust)
    assert sense * moved(system, found.displacement, 0.1)[2] > 1e-5
    tangent = row_law(scene.rolling_bearings[1 - holding]).loaded.evaluate(
        moved(system, found.displacement, scene.rolling_bearings[1 - holding].position)
    )
    assert not tangent.tangent[2].any()


@pytest.mark.parametrize("kind", ["angular", "tapered"])
def test_the_mirrored_rotor_moves_as_the_mirror_image(kind):
    row, push = KINDS[kind], np.array([0.75, -5.0, 1.0])
    scene = rotor(pair_of(row), PRELOAD, (0.02, 0.15), tuple(push))
    image = rotor(pair_of(mirrored(row)), PRELOAD, (0.18, 0.05), tuple(MIRROR[:3] * push))
    at = []
    for part in (scene, image):
        system = assemble(part)
        found = static_equilibrium(system)
        assert found.status.usable
        at.append(moved(system, found.displacement, 0.1))
    np.testing.assert_allclose(at[1], MIRROR * at[0], rtol=1e-7, atol=1e-12)
    assert np.all(np.abs(at[0][:3]) > 1e-8)


def test_back_to_back_holds_tilt_and_face_to_face_yields():
    """Same rows, same preload: lines of contact that meet the axis far apart hold tilt, together they do not.

    Under an axial force both yield alike, and one row takes what the other loses.
    """
    tilts, along = {}, {}
    for name, rows in (("X", pair_of(TAPERED)), ("O", pair_of(mirrored(TAPERED)))):
        scene = rotor(rows, 1000.0, (0.08, 0.12), gravity=(0.0, 0.0, 10.0))
        system = assemble(scene)
        found = static_equilibrium(system)
        assert found.status.usable
        stiffness = stiffness_at(system, found.displacement)
        tilts[name] = stiffness[system.freedoms.name.index("rotor.tilt_x")]
        along[name] = moved(system, found.displacement, 0.1)[2]
        axial = forces(system, found.displacement)[-2:, 2]
        assert axial.sum() == pytest.approx(400.0, rel=1e-8)
        assert np.prod(axial) < 0.0
        assert np.max(np.abs(axial)) > 1000.0
    assert along["O"] == pytest.approx(along["X"], rel=1e-6)
    assert tilts["O"] > 3.0 * tilts["X"]


def stiffness_at(system, q):
    """Diagonal of the stiffness of all bearings at `q`, (n,)."""
    local, total = local_state(system.arrays, 0.0, q, 0.0 * q), system.arrays.stiffness.copy()
    elements = system.arrays.elements
    for e in np.flatnonzero(np.isin(elements.law, BEARING_LAW_KINDS)):
        rows = slice(elements.first[e], elements.first[e + 1])
        gradient = system.arrays.direction[rows]
        total += gradient.T @ local.tangent[rows, : gradient.shape[0]] @ gradient
    return np.diag(total)


def test_the_pressure_of_a_lamina_is_that_of_a_line_contact():
    """K. L. Johnson, Contact Mechanics, 4.3: p_0 = 2 q/(pi a), a^2 = 4 q R/(pi E*)."""
    load, length = 20.0, CYLINDRICAL.length / CYLINDRICAL.laminae
    radius = 1.0 / (2.0 / 9e-3 + 2.0 / (53.5e-3 - 9e-3))
    half = np.sqrt(4.0 * load / length * radius / np.pi / (210e9 / 2.0 / (1.0 - 0.3**2)))
    assert CYLINDRICAL.peak_pressure(load) == pytest.approx(2.0 * load / length / np.pi / half, rel=1e-9)


def test_preload_is_the_force_at_no_displacement():
    system = assemble(rotor(pair_of(ANGULAR), PRELOAD))
    pressed = forces(system, np.zeros(system.arrays.mass.shape[0]))[-2:]
    np.testing.assert_allclose(pressed[:, 2], [PRELOAD, -PRELOAD], rtol=1e-9)
    np.testing.assert_allclose(pressed[:, :2], 0.0, atol=1e-9)


@pytest.mark.parametrize("kind", ["angular", "floating", "cross-located"])
def test_modes_are_those_of_tangent_bushings_at_the_same_place(kind):
    preload = PRELOAD if kind == "angular" else 0.0
    scene = rotor(pair_of(KINDS[kind]), preload, gravity=(0.0, -9.81, 3.0), kind=kind)
    system = assemble(scene)
    q = static_equilibrium(system).displacement
    seats = []
    for bearing in scene.rolling_bearings:
        law = row_law(bearing)
        d = moved(system, q, bearing.position) + law.shift * np.eye(5)[2]
        place = (bearing.name, bearing.shaft, bearing.position)
        seats.append(tangent_bushing(law.loaded, place, d))
    linear = replace(scene, rolling_bearings=(), bushings=(*scene.bushings, *seats))
    mine, other = natural_modes(system), natural_modes(assemble(linear))
    np.testing.assert_allclose(mine.frequency, other.frequency, rtol=1e-9, atol=1e-4)
    assert mine.frequency.max() > 300.0


def test_off_is_the_tangent_at_rest():
    scene = rotor(pair_of(ANGULAR), PRELOAD, gravity=(0.0, -9.81, 0.0))
    off = replace(scene, effects={**ON, "bearing_clearance": "off"})
    linear = assemble(off)
    assert linear.scene.rolling_bearings == ()
    at, there = (static_equilibrium(assemble(part)).displacement for part in (scene, off))
    np.testing.assert_allclose(there, at, rtol=1e-6, atol=1e-10)
    on_modes, off_modes = natural_modes(assemble(scene)), natural_modes(linear)
    np.testing.assert_allclose(on_modes.frequency, off_modes.frequency, rtol=1e-6, atol=1e-3)


def test_what_is_no_bearing_is_named():
    scene = rotor(pair_of(ANGULAR))
    seat = scene.rolling_bearings[0]
    cases = {
        "axial_preload": lambda: RollingBearing("a", "rotor", ANGULAR, 0.1, -100.0),
        "rolling_bearings[0].shaft": lambda: replace(scene, rolling_bearings=(replace(seat, shaft="x"),)),
        "rolling_bearings[0].position": lambda: replace(
            scene, rolling_bearings=(replace(seat, position=0.3),)
        ),
        "rolling_bearings[1].name": lambda: replace(scene, rolling_bearings=(seat, seat)),
    }
    for field, make in cases.items():
        with pytest.raises(InputError) as caught:
            make()
        assert caught.value.field == field
    with pytest.raises(InputError, match="no axial force"):
        RollingBearing("a", "rotor", CYLINDRICAL, 0.1, 100.0)
    with pytest.raises(InputError, match="a name that no other"):
        replace(scene, bushings=(*scene.bushings, Bushing(seat.name, "rotor", 0.1)))
