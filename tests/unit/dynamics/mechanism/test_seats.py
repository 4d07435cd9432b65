"""Bushings with matrices and preload, and housings under them: transport, statics, series, bad input."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, with_bushings

from dynamics import Bushing, Coupling, Housing, Inertia, Integration, RunResult, Shaft, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.integrators import static_equilibrium
from dynamics.joints import read_housing
from dynamics.linearize import natural_modes, whirl_modes
from dynamics.mechanism.connections import condense_housing

ON = {"lateral": "on", "axial": "on", "tilt": "on"}
SCENE = gear_pair_scene(spring_table(4e8), duration=0.002, effects=ON)
RADIAL, AXIAL = 1e8, 5e7
GENERAL = np.array(
    [
        [3e8, 2e7, 1e7, 1e5, 4e6],
        [2e7, 2e8, -2e7, -3e6, 2e5],
        [1e7, -2e7, 1e8, 3e5, -1e5],
        [1e5, -3e6, 3e5, 2e5, 1e4],
        [4e6, 2e5, -1e5, 1e4, 3e5],
    ]
)


def rows(matrix):
    return tuple(tuple(float(value) for value in row) for row in np.asarray(matrix))


def on_bushings(*, shaft="input", **changes):
    """The pair with the bushings of one shaft replaced by one at its middle."""
    others = tuple(bushing for bushing in SCENE.bushings if bushing.shaft != shaft)
    given = {"name": "seat", "shaft": shaft, "position": 0.1} | changes
    return replace(SCENE, bushings=(Bushing(**given), *others))


def housed(matrix, **changes):
    names = tuple(bushing.name for bushing in SCENE.bushings if bushing.shaft == "input")
    return replace(SCENE, housings=(Housing("case", names, rows(matrix), **changes),))


def test_a_diagonal_matrix_is_the_bushing_without_one():
    plain = with_bushings(SCENE, radial_stiffness=RADIAL, axial_stiffness=AXIAL)
    full = with_bushings(
        SCENE,
        radial_stiffness=0.0,
        axial_stiffness=0.0,
        stiffness=rows(np.diag([RADIAL, RADIAL, AXIAL, 0, 0])),
    )
    a, b = assemble(plain), assemble(full)
    assert a.freedoms.name == b.freedoms.name
    np.testing.assert_allclose(b.arrays.stiffness, a.arrays.stiffness, rtol=1e-12, atol=1e-6)
    np.testing.assert_allclose(natural_modes(b).frequency, natural_modes(a).frequency, rtol=1e-9, atol=1e-6)
    share = a.rotors[0].inertia.mass / 2.0
    assert b.seats.damping[0, 0] == pytest.approx(2.0 * 0.05 * np.sqrt(RADIAL * share), rel=1e-12)


def test_two_bushings_are_one_between_them_that_holds_tilt():
    tilt = 2.0 * RADIAL * 0.1**2
    matrix = np.diag([2 * RADIAL, 2 * RADIAL, 2 * AXIAL, tilt, tilt])
    two = assemble(with_bushings(SCENE, radial_stiffness=RADIAL, axial_stiffness=AXIAL))
    one = assemble(on_bushings(stiffness=rows(matrix)))
    np.testing.assert_allclose(
        one.arrays.stiffness[:5, :5], two.arrays.stiffness[:5, :5], rtol=1e-12, atol=1e-6
    )
    for name in ("radial_stiffness", "axial_stiffness", "tilt_stiffness"):
        assert getattr(one.rotors[0], name) == pytest.approx(getattr(two.rotors[0], name), rel=1e-12)


def test_a_matrix_written_for_another_point_of_the_axis_is_the_same_bearing():
    """u there = u here + tilt x lever: K here = T^T K there T, cross terms and all."""
    lever = 0.07
    transport = np.eye(5)
    transport[0, 4], transport[1, 3] = lever, -lever
    there = assemble(on_bushings(position=0.1 + lever, stiffness=rows(GENERAL)))
    here = assemble(on_bushings(stiffness=rows(transport.T @ GENERAL @ transport)))
    np.testing.assert_allclose(here.arrays.stiffness, there.arrays.stiffness, rtol=1e-10, atol=1e-2)
    assert here.rotors[0].elastic_lever == pytest.approx(there.rotors[0].elastic_lever, rel=1e-10)
    assert here.rotors[0].tilt_stiffness == pytest.approx(there.rotors[0].tilt_stiffness, rel=1e-10)


def test_forces_and_moments_of_bearings_balance_the_mesh():
    system = assemble(
        on_bushings(position=0.16, stiffness=rows(GENERAL), preload=(10.0, -20.0, 5.0, 0.3, -0.2))
    )
    found = static_equilibrium(system)
    assert found.status.usable
    rest = np.zeros((1, found.displacement.size))
    on_ground = system.bearing_force(found.mesh_force[:, None], found.displacement[None], rest)[0, :, 0]
    line = system.lines[0]
    push = -found.mesh_force[0] * line.force  # on the driver
    arm = line.point - np.array([0.0, 0.0, 0.16])
    np.testing.assert_allclose(on_ground[:3], push, rtol=1e-8, atol=1e-6)
    np.testing.assert_allclose(on_ground[3:5], np.cross(arm, push)[:2], rtol=1e-8, atol=1e-7)
    assert on_ground[5] == 0.0


def test_preload_moves_the_shaft_until_the_bearing_answers():
    preload = np.array([100.0, -50.0, 20.0, 1.0, -2.0])
    scene = replace(on_bushings(stiffness=rows(GENERAL), preload=tuple(preload)), loads=())
    scene = replace(scene, meshes=(replace(scene.meshes[0], nominal_force=100.0),))
    system = assemble(scene)
    free = np.linalg.solve(GENERAL, preload)
    pushed = system.arrays.constant
    np.testing.assert_allclose(pushed[:5], preload, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.solve(system.arrays.stiffness[:5, :5], pushed[:5]), free, rtol=1e-9)


def test_a_run_stores_moments_and_closes_its_balance(tmp_path):
    scene = on_bushings(position=0.12, stiffness=rows(GENERAL), preload=(100.0, 0.0, 0.0, 0.0, 1.0))
    scene = replace(scene, meshes=gear_pair_scene(effects=ON).meshes, duration=0.01)
    result = simulate(replace(scene, integration=Integration(tolerance=1e-11)))
    assert result.energy.relative < 1e-4  # as with plain bushings; 6e-4 at the default tolerance
    assert result.bearing_moment.shape == result.bearing_force.shape
    seat = result.bearing.index("seat")
    assert np.max(np.abs(result.bearing_moment[seat, :2])) > 1.0
    np.testing.assert_array_equal(np.delete(result.bearing_moment, seat, axis=0), 0.0)
    result.to_netcdf(tmp_path / "run.nc")
    back = RunResult.from_netcdf(tmp_path / "run.nc")
    np.testing.assert_array_equal(back.bearing_moment, result.bearing_moment)
    plain = simulate(SCENE)
    assert plain.bearing_moment.shape == (0, 3, plain.time.size)


def test_a_rigid_housing_is_none_and_a_soft_one_is_in_series():
    stiff, soft = assemble(housed(1e20 * np.eye(6))), assemble(housed(RADIAL * np.eye(6)))
    plain = assemble(SCENE)
    np.testing.assert_allclose(stiff.arrays.stiffness, plain.arrays.stiffness, rtol=1e-9, atol=1e-4)
    k = SCENE.bushings[0].radial_stiffness
    assert soft.seats.stiffness[0, 0] == pytest.approx(k * RADIAL / (k + RADIAL), rel=1e-12)
    np.testing.assert_allclose(
        natural_modes(stiff).frequency, natural_modes(plain).frequency, rtol=1e-8, atol=1e-6
    )
    assert natural_modes(soft).frequency[1] < natural_modes(plain).frequency[1]


def test_housings_condense_as_if_their_freedoms_were_there():
    """Static condensation of bearings and a full housing matrix, rotations about z free of moment."""
    rng = np.random.default_rng(4)
    factor = rng.normal(size=(12, 12))
    ground = 1e8 * (factor @ factor.T) / 12.0
    bearing = np.kron(np.eye(2), GENERAL)
    location = [row for row in range(12) if row % 6 != 5]
    whole = ground.copy()
    whole[np.ix_(location, location)] += bearing
    to_shaft = np.zeros((12, 10))
    to_shaft[location] = bearing
    expected = bearing - to_shaft.T @ np.linalg.solve(whole, to_shaft)
    found, _, preload = condense_housing(
        Housing("case", ("a", "b"), rows(ground)), bearing, 0.0 * bearing, np.arange(10.0)
    )
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1.0)
    np.testing.assert_allclose(found, found.T, rtol=0.0, atol=0.0)
    assert abs(found[0, 5]) > 1e-3 * found[0, 0]  # one bearing feels the other
    # the bearing's own preload moves the housing as a force there does
    moved = np.zeros(12)
    moved[location] = np.arange(10.0)
    answered = np.arange(10.0) - bearing @ np.linalg.solve(whole, moved)[location]
    np.testing.assert_allclose(preload, answered, rtol=1e-7, atol=1e-9)


def test_condensed_damping_is_the_first_order_of_the_dynamic_stiffness():
    """Against the complex stiffness with housing freedoms: what is left over falls with the square."""
    rng = np.random.default_rng(5)
    factor, lossy = rng.normal(size=(2, 10, 10))
    ground, loss = 1e8 * factor @ factor.T / 10.0, 1e3 * lossy @ lossy.T / 10.0
    bearing, damping = np.kron(np.eye(2), GENERAL), 1e-5 * np.kron(np.eye(2), GENERAL)
    k, c, _ = condense_housing(
        Housing("case", ("a", "b"), rows(ground), rows(loss)), bearing, damping, np.zeros(10)
    )

    def left_over(omega):
        own = bearing + 1j * omega * damping
        exact = own - own @ np.linalg.solve(own + ground + 1j * omega * loss, own)
        return np.max(np.abs(exact - k - 1j * omega * c))

    assert left_over(20.0) / left_over(10.0) == pytest.approx(4.0, rel=1e-2)
    assert left_over(10.0) < 1e-6 * np.max(np.abs(k))


def test_a_bearing_seen_from_a_rotating_frame_whirls_as_in_the_fixed_one():
    spin, disc = 300.0, Inertia(4.0, 0.02, 0.0104)
    matrix = np.diag([1e6, 1e6, 1e6, 2e4, 2e4])
    matrix[0, 4] = matrix[4, 0] = 5e4
    matrix[1, 3] = matrix[3, 1] = -5e4

    def frequencies(frame):
        shaft = Shaft("disc", 0.2, (0.0, 0.0, 0.4), disc, frame)
        seat = Bushing("seat", "disc", 0.1, stiffness=rows(matrix), damping=rows(2e-5 * matrix))
        scene = gear_pair_scene(
            spring_table(4e8), speed=TimeLaw.constant(spin), effects={"tilt": "on", "lateral": "on"}
        )
        joint = Coupling("joint", "input", "disc", 100.0)
        scene = replace(
            scene, shafts=(*scene.shafts, shaft), bushings=(*scene.bushings, seat), couplings=(joint,)
        )
        modes = whirl_modes(assemble(scene))
        size = np.abs(modes.shape * modes.scale)
        own = [
            index
            for index, name in enumerate(modes.freedom)
            if name.startswith("disc.") and "rot" not in name
        ]
        chosen = np.max(size[:, own], axis=1) > 0.5 * np.max(size, axis=1)
        omega, ratio = 2.0 * np.pi * modes.frequency[chosen], modes.damping_ratio[chosen]
        return np.sort(omega), np.sort(ratio * omega / np.sqrt(1.0 - ratio**2))

    fixed, decay = frequencies(None)
    rotating, decay_rotating = frequencies("disc")
    np.testing.assert_allclose(decay_rotating, decay, rtol=1e-5)
    shifted = np.abs(np.concatenate([fixed - spin, fixed + spin]))
    assert all(np.min(np.abs(shifted - omega)) < 1e-6 * omega for omega in rotating)


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
def test_a_housing_comes_from_a_file(tmp_path, suffix):
    matrix = 1e8 * (np.eye(6) + 0.1)
    file = tmp_path / f"case{suffix}"
    if suffix == ".csv":
        np.savetxt(file, matrix, delimiter=",", header="x1 y1 z1 x2 y2 z2, N/m")
    else:
        np.savez(file, stiffness=matrix, damping=1e-5 * matrix)
    found = read_housing(file, "case", ("a", "b"))
    np.testing.assert_allclose(found.stiffness, matrix, rtol=1e-15)
    assert (found.damping is None) == (suffix == ".csv")


def bad_file(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    return tmp_path / name


def test_what_is_no_housing_is_named(tmp_path):
    cases = {
        "stiffness_file": [
            lambda: read_housing(tmp_path / "none.csv", "case", ("a",)),
            lambda: read_housing(bad_file(tmp_path, "x.txt", "1"), "case", ("a",)),
            lambda: read_housing(bad_file(tmp_path, "x.csv", "1,2\n3"), "case", ("a",)),
            lambda: read_housing(bad_file(tmp_path, "x.npz", "1,2"), "case", ("a",)),
        ],
        "stiffness": [
            lambda: Housing("case", ("a",), rows(np.eye(4))),
            lambda: Housing("case", ("a",), rows(np.eye(3) + np.eye(3, k=1))),
            lambda: Housing("case", ("a",), rows(-np.eye(3))),
            lambda: Bushing("b", "input", 0.0, stiffness=rows(np.eye(6))),
            lambda: Bushing("b", "input", 0.0, stiffness=rows(np.diag([1.0, 1.0, np.nan, 0.0, 0.0]))),
        ],
        "damping": [lambda: Housing("case", ("a",), rows(np.eye(3)), rows(np.eye(5)))],
        "preload": [lambda: Bushing("b", "input", 0.0, preload=(1.0, 2.0))],
        "bushings": [lambda: Housing("case", (), rows(np.eye(3)))],
        "housings[0].bushings[0]": [
            lambda: replace(SCENE, housings=(Housing("case", ("none",), rows(np.eye(3))),))
        ],
        "housings[1].bushings[0]": [
            lambda: replace(
                SCENE,
                housings=tuple(
                    Housing(name, (SCENE.bushings[0].name,), rows(np.eye(3))) for name in ("one", "two")
                ),
            )
        ],
    }
    for field, makers in cases.items():
        for make in makers:
            with pytest.raises(InputError) as caught:
                make()
            assert caught.value.field == field
