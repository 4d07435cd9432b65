"""Whirl modes over speed: closed forms of a disc, branches that cross, critical speeds, files."""

from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import flexible_pair
from geared_scenes import gear_pair_scene, spring_table, with_gear
from planetary_scenes import driven_scene, published_set

from dynamics import Bushing, Coupling, Inertia, Outputs, Shaft, TimeLaw, modal_analysis
from dynamics.assembly.assemble import System, assemble
from dynamics.errors import InputError
from dynamics.linearize import ModalAnalysis, campbell, critical_speeds, linearize, natural_modes, whirl_modes
from dynamics.linearize.campbell import (
    FINEST,
    INTERVALS,
    branches_up_to,
    continued_branches,
    likeness,
    modes_at,
    whirl_branches,
)
from dynamics.linearize.flank_cycles import averaged, flank_cycles, resting
from dynamics.linearize.linear_system import LinearSystem
from dynamics.linearize.whirl_modes import WhirlModes, whirl_sense

DISC = Inertia(4.0, 0.02, 0.0104)
STIFFNESS, LENGTH, TEETH = 1e6, 0.2, 20
TILT_STIFFNESS = 2.0 * STIFFNESS * (LENGTH / 2.0) ** 2
SPEEDS = np.linspace(0.0, 400.0, 21)


def disc_scene(sense=1.0):
    """A disc without damping on two bearings, turned by a geared shaft through a soft coupling."""
    scene = gear_pair_scene(
        spring_table(4e8),
        speed=TimeLaw.constant(sense * 300.0),
        effects={"tilt": "on", "lateral": "on", "gyroscopic": "on"},
    )
    disc = Shaft("disc", LENGTH, (0.0, 0.0, 0.4), DISC)
    ends = tuple(Bushing(f"disc.{z}", "disc", z, STIFFNESS, damping_ratio=0.0) for z in (0.0, LENGTH))
    joint = Coupling("joint", "input", "disc", 100.0)
    return replace(scene, shafts=(*scene.shafts, disc), bushings=(*scene.bushings, *ends), couplings=(joint,))


def tilting(found: ModalAnalysis) -> np.ndarray:
    """Branches in which the disc tilts."""
    columns = [found.freedom.index(f"disc.{kind}") for kind in ("tilt_x", "tilt_y")]
    return np.flatnonzero(found.kinetic_energy[-1][:, columns].sum(axis=1) > 0.9)


@pytest.fixture(scope="module")
def disc():
    return modal_analysis(assemble(disc_scene()), SPEEDS, orders=3)


def test_branches_of_a_tilting_disc_are_the_roots_of_its_closed_form(disc):
    for index, speed in enumerate(SPEEDS):
        # I_t a'' - i I_p w a' + k a = 0: forward above, backward below
        roots = np.roots([DISC.transverse, -1j * DISC.polar * speed, TILT_STIFFNESS]).imag / (2.0 * np.pi)
        found = np.sort(disc.frequency[index, tilting(disc)])
        np.testing.assert_allclose(found, np.sort(np.abs(roots)), rtol=1e-9)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_forward_whirl_rises_and_backward_whirl_falls_whatever_the_sense_of_rotation(sense):
    found = modal_analysis(assemble(disc_scene(sense)), SPEEDS)
    low, high = sorted(tilting(found), key=lambda mode: found.frequency[-1, mode])
    np.testing.assert_allclose(found.whirl[1:, high], 1.0, rtol=1e-6)
    np.testing.assert_allclose(found.whirl[1:, low], -1.0, rtol=1e-6)
    assert found.frequency[-1, high] > 1.3 * found.frequency[-1, low]
    # at rest any combination of the two is a mode
    np.testing.assert_allclose(found.whirl[0, [low, high]], 0.0, atol=1e-6)


def test_critical_speeds_are_those_of_the_closed_form(disc):
    """With w_mode = r w, r = order x teeth: I_t r^2 w^2 -+ I_p r w^2 = k."""
    for mode in tilting(disc):
        sense = disc.whirl[-1, mode]
        for order in (1, 2, 3):
            r = order * TEETH
            exact = np.sqrt(TILT_STIFFNESS / (DISC.transverse * r**2 - sense * DISC.polar * r))
            met = (disc.critical_mode == mode) & (disc.critical_order == order)
            np.testing.assert_allclose(disc.critical_speed[met], [exact], rtol=1e-8)
    assert np.all(np.abs(disc.critical_residual) <= 1e-9 * disc.critical_frequency)
    assert np.all(np.diff(disc.critical_speed) >= 0.0)


def test_branches_cross_without_changing_their_shapes(disc):
    """Sorted by frequency at each speed they would swap."""
    linear = linearize(assemble(disc_scene()))
    order = np.argsort(disc.frequency, axis=1)
    assert np.any(order != order[0])
    for before, after in zip(disc.shape[1:-1], disc.shape[2:], strict=True):
        alone = np.diag(likeness(linear, before, after))[tilting(disc)]
        np.testing.assert_allclose(alone, 1.0, atol=1e-6)


def test_shares_of_energy_add_up_and_name_their_parts(disc):
    np.testing.assert_allclose(disc.strain_energy.sum(axis=-1), 1.0, rtol=1e-9)
    np.testing.assert_allclose(disc.kinetic_energy.sum(axis=-1), 1.0, rtol=1e-9)
    mode = tilting(disc)[0]
    strain, kinetic = disc.strain_energy[-1, mode], disc.kinetic_energy[-1, mode]
    held = disc.strain_shares(strain)
    assert list(held)[:2] == ["disc.0.0", "disc.0.2"] or list(held)[:2] == ["disc.0.2", "disc.0.0"]
    assert held["disc.0.0"] == pytest.approx(0.5, rel=1e-6)
    assert disc.kinetic_shares(kinetic)["disc tilting"] == pytest.approx(1.0, rel=1e-6)
    assert disc.kind(strain, kinetic) == "tilting on bearing"
    kinds = dict(zip(disc.spring_part, disc.spring_kind, strict=True))
    assert (kinds["mesh"], kinds["joint"], kinds["disc.0.0"]) == ("mesh", "coupling", "bearing")


def test_without_speed_terms_the_modes_stay_and_meet_every_order():
    system = assemble(gear_pair_scene(spring_table(4e8)))
    found = modal_analysis(system, [0.0, 500.0, 1500.0], orders=4)
    assert np.ptp(found.frequency, axis=0).max() < 1e-9 * found.frequency.max()
    rate = TEETH / (2.0 * np.pi)
    np.testing.assert_allclose(
        found.critical_frequency, found.critical_order * rate * found.critical_speed, rtol=1e-8
    )
    inside = sum(int(np.sum(found.frequency[0] <= k * rate * 1500.0)) for k in (1, 2, 3, 4))
    assert found.critical_speed.size == inside > 4
    # lateral modes of both shafts share one frequency; any circle in them has its mirror image
    np.testing.assert_allclose(found.whirl, 0.0, atol=1e-6)
    # the same stiffness at every position: the mean is that of one
    np.testing.assert_allclose(found.natural_frequency, natural_modes(system).frequency, rtol=1e-9)


def test_branches_of_a_planetary_set_are_its_whirl_modes():
    system = assemble(driven_scene(published_set(3), speed=TimeLaw.constant(800.0)))
    found = modal_analysis(system, [0.0, 400.0, 800.0], orders=2)
    np.testing.assert_allclose(np.sort(found.frequency[-1]), whirl_modes(system).frequency, rtol=1e-12)
    # all six meshes have one mesh frequency: orders count once
    assert set(found.critical_mesh) == {0}


def test_the_whirl_of_repeated_modes_does_not_depend_on_their_combination():
    """The disc moves across its axis alike in x and y: circles of one sense are no better than lines."""
    system = assemble(disc_scene())
    linear = linearize(system)
    modes = modes_at(system, linear, 100.0)
    columns = [modes.freedom.index(f"disc.{kind}") for kind in ("x", "y")]
    pair = np.flatnonzero(np.max(np.abs(modes.shape[:, columns]), axis=1) > 0.9)
    assert pair.size == 2
    circles = modes.shape.copy()
    circles[pair] = 0.0
    circles[np.ix_(pair, columns)] = [[1.0, -1.0j], [1.0, -0.5j]]
    np.testing.assert_allclose(
        whirl_sense(system, linear, 100.0, replace(modes, shape=circles))[pair], 0.0, atol=1e-9
    )


def test_a_file_gives_back_every_bit(disc, tmp_path):
    for number, found in enumerate((disc, modal_analysis(assemble(disc_scene())))):
        path = tmp_path / f"modes_{number}.nc"
        found.to_netcdf(path)
        again = ModalAnalysis.from_netcdf(path)
        for name, value in vars(found).items():
            other = getattr(again, name)
            if isinstance(value, np.ndarray):
                assert value.dtype == other.dtype and np.array_equal(value, other, equal_nan=True), name
            else:
                assert value == other, name


@pytest.mark.law
def test_the_axis_of_a_rigid_shaft_moves_with_its_center_and_tilts_about_it(disc):
    """u_x = x + tilt_y (z - c), u_y = y - tilt_x (z - c): the freedoms are those of the center of mass."""
    own = disc.axis_shaft == disc.shaft.index("disc")
    arm = disc.axis_position[own] - LENGTH / 2.0
    columns = [disc.freedom.index(f"disc.{kind}") for kind in ("x", "y", "tilt_x", "tilt_y")]
    for shape in disc.shape[-1]:
        x, y, tilt_x, tilt_y = shape[columns]
        motion = (disc.axis_motion @ shape)[own]
        np.testing.assert_allclose(motion[:, 0], x + tilt_y * arm, atol=1e-12)
        np.testing.assert_allclose(motion[:, 1], y - tilt_x * arm, atol=1e-12)
        np.testing.assert_allclose(motion[:, 3:5], [[tilt_x, tilt_y]] * arm.size, atol=1e-12)


@pytest.mark.parametrize(
    ("speed", "orders", "field"),
    [
        ([1.0, 1.0], 5, "speed[1]"),
        ([-1.0, 1.0], 5, "speed[0]"),
        ([1.0, np.nan], 5, "speed[1]"),
        ([1.0], 0, "orders"),
    ],
)
def test_what_cannot_be_used_is_named(speed, orders, field):
    with pytest.raises(InputError) as caught:
        modal_analysis(assemble(gear_pair_scene()), speed, orders)
    assert caught.value.field == field


def test_critical_speeds_follow_eigenvectors_and_agree_with_the_dense_solve(monkeypatch):
    """One dense solve per speed of the diagram, none per trial; each crossing is a mode there to 1e-8."""
    system = assemble(driven_scene(published_set(4), speed=TimeLaw.constant(800.0)))
    solved: list[float] = []
    dense = campbell.modes_at

    def counted(of, linear, speed):
        solved.append(speed)
        return dense(of, linear, speed)

    for module in (campbell, critical_speeds):
        monkeypatch.setattr(module, "modes_at", counted)
    speeds = np.linspace(0.0, 800.0, 5)
    found = modal_analysis(system, speeds, orders=4)
    assert found.critical_speed.size > 20
    assert len(solved) <= speeds.size + 0.1 * found.critical_speed.size
    linear = averaged_linear(system)
    for index in range(0, found.critical_speed.size, 4):
        modes = dense(system, linear, found.critical_speed[index])
        nearest = np.argmin(np.abs(modes.frequency - found.critical_frequency[index]))
        assert modes.frequency[nearest] == pytest.approx(found.critical_frequency[index], rel=1e-8)
        assert modes.damping_ratio[nearest] == pytest.approx(found.critical_damping_ratio[index], abs=1e-8)


def averaged_linear(system: System) -> LinearSystem:
    linear = linearize(system)
    at_rest = resting(system, linear)
    return averaged(system, linear, flank_cycles(system, linear, at_rest), at_rest)


@pytest.mark.law
def test_modes_resolve_to_a_frequency_of_their_own():
    """However finely the run is sampled, shafts have the coordinates that the frequency needs."""
    scene = flexible_pair(speed=TimeLaw.constant(100.0))
    sizes = [
        modal_analysis(assemble(replace(scene, outputs=Outputs(rate))), [0.0, 100.0], orders=3).freedom
        for rate in (2e3, 2e5)
    ]
    assert sizes[0] == sizes[1]
    coarse, fine = (
        modal_analysis(assemble(scene), [0.0, 100.0], orders=3, highest_frequency=f) for f in (1e3, 4e4)
    )
    assert coarse.metadata["highest_frequency"] == 1e3
    assert len(coarse.freedom) < len(fine.freedom)
    low = fine.natural_frequency[fine.natural_frequency < 1e3]
    np.testing.assert_allclose(coarse.natural_frequency[: low.size], low, rtol=2e-2, atol=1e-3)
    with pytest.raises(InputError, match="highest_frequency"):
        modal_analysis(assemble(scene), highest_frequency=-1.0)


@pytest.mark.parametrize("frequency", [(101.0, 198.0), (198.0, 101.0)])
def test_of_shapes_that_are_equally_alike_the_nearest_frequency_goes_on(frequency):
    """Motions along two axes become circles, each half like either of them."""
    linear = replace(linearize(assemble(disc_scene())), mass=np.eye(2))
    along, round_about = np.eye(2) + 0j, np.array([[1.0, 1.0j], [1.0, -1.0j]])
    before, after = (
        WhirlModes(np.array(each), np.zeros(2), shape, ("disc.x", "disc.y"), np.ones(2))
        for each, shape in (((100.0, 200.0), along), (frequency, round_about))
    )
    assert continued_branches(linear, before, [4, 7], after) == [
        4 if each < 150.0 else 7 for each in frequency
    ]


def unlike_shafts():
    """An elastic pair whose shafts bend unlike, at 24 000 rpm."""
    return with_gear(flexible_pair(speed=TimeLaw.constant(2500.0)), 0, position=0.09)


@pytest.mark.law
@pytest.mark.parametrize(("scene", "maximum"), [(disc_scene(), FINEST), (unlike_shafts(), 2 * INTERVALS)])
def test_fewer_speeds_tell_the_same_branches(scene, maximum):
    """Those of 33 speeds: the same modes at speeds of both, between them within 0.2 % of straight lines."""
    system = assemble(scene)
    linear, highest = linearize(system), float(system.scene.references[0].speed.extreme)
    every = whirl_branches(system, linear, np.linspace(0.0, highest, FINEST + 1))
    found = branches_up_to(system, linear, highest)
    assert INTERVALS < found.speed.size <= maximum
    assert found.speed[[0, -1]].tolist() == [0.0, highest]
    rows = np.searchsorted(every.speed, found.speed)
    np.testing.assert_array_equal(every.speed[rows], found.speed)
    np.testing.assert_allclose(found.frequency, every.frequency[rows], rtol=1e-9)
    apart = np.abs(np.diff(np.sort(found.frequency, axis=1), axis=1)) > 1e-6 * found.frequency[:, :1]
    if np.all(apart[1:]):  # repeated modes, as of equal shafts, change their places
        np.testing.assert_array_equal(found.whirl[1:], every.whirl[rows[1:]])
    for branch, exact in zip(found.frequency.T, every.frequency.T, strict=True):
        np.testing.assert_allclose(np.interp(every.speed, found.speed, branch), exact, rtol=2e-3)


def test_a_mode_that_changes_its_shape_is_looked_at_between(monkeypatch):
    """Held to more likeness than there is, every part is halved to the finest."""
    system = assemble(disc_scene())
    linear = linearize(system)
    monkeypatch.setattr(campbell, "ALIKE", 1.1)
    assert branches_up_to(system, linear, 300.0).speed.size == FINEST + 1
