"""Forced response as a study: peaks, error estimate, blocks of speeds, where the tables are read, files."""

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
from sliced_face import sliced_database

from dynamics import Outputs, TimeLaw, forced_response, modal_analysis, simulate
from dynamics.assembly.assemble import assemble
from dynamics.assembly.varied import operating_points_at, with_static_reference
from dynamics.errors import InputError, SolveError
from dynamics.influence import estimate_influences
from dynamics.integrators import static_equilibrium
from dynamics.linearize import ForcedResponse, harmonic_response, natural_modes, peaks, steady_vibration
from dynamics.linearize.load_harmonics import load_harmonics
from dynamics.linearize.parametric_response import parametric_response
from dynamics.linearize.steady_vibration import excited
from dynamics.mechanism.rotor import build_rotor
from fe_contact.ste import ForceTable

STIFFNESS, RIPPLE = 4e8, 1e-7
MASS = 1.1344291072112745e-3 / BASE_RADIUS**2
NATURAL = np.sqrt(STIFFNESS / MASS)
EFFECTS = ("dynamic_misalignment", "dynamic_center_distance", "moving_application_point")
M, A = (-60e-6, -30e-6, -10e-6, 0.0, 10e-6, 30e-6, 60e-6), (-1e-4, 0.0, 1e-4)


def one_freedom(ratio=0.05, **changes):
    """A wheel on the mesh spring alone."""
    scene = replace(gear_pair_scene(spring_table(STIFFNESS, RIPPLE), **changes), bushings=(), effects={})
    return with_mesh(scene, damping=2.0 * ratio * MASS * NATURAL)


@pytest.fixture(scope="module")
def table():
    return sliced_database(M, A, positions=12).force_table()


def tilted(table, on, speed=900.0):
    """The pair off the middle of its shafts, on unlike bushings: loads tilt and part the gears."""
    effects = {"tilt": "on", **{name: "on" if name in on else "off" for name in EFFECTS}}
    scene = gear_pair_scene(table, speed=TimeLaw.constant(speed * RPM))
    scene = with_gear(with_gear(scene, 0, position=0.06), 1, position=0.06)
    stiffer = replace(scene.bushings[0], radial_stiffness=3e8)
    return replace(scene, effects=effects, bushings=(stiffer, *scene.bushings[1:]))


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_peak_of_one_freedom_is_that_of_its_closed_form(sense):
    ratio = 0.05
    scene = one_freedom(ratio, speed=TimeLaw.constant(sense * 100.0))
    speed = np.linspace(0.9, 1.1, 2001) * NATURAL / 20
    found = forced_response(assemble(scene), speed, 1)
    (peak,) = [p for p in peaks(found) if p.quantity == "mesh_force"]
    # mesh force k e ((1 + 2 z r i)/(1 - r^2 + 2 z r i) - 1) is largest at r^2 = 1/(1 - 2 z^2)
    r = np.sqrt(1.0 / (1.0 - 2.0 * ratio**2))
    assert 20 * peak.speed / NATURAL == pytest.approx(r, abs=1e-4)
    assert peak.amplitude == pytest.approx(
        STIFFNESS * RIPPLE * r**2 / np.abs(1 - r**2 + 2j * ratio * r), rel=1e-5
    )
    assert peak.natural_frequency == pytest.approx(NATURAL / (2 * np.pi), rel=1e-9)
    assert peak.amplification == pytest.approx(1.0 / np.abs(1 - r**2 + 2j * ratio * r), rel=1e-4)


@pytest.mark.parametrize("off", [0.0, 1e-15, -1e-15, 1e-14])
def test_an_undamped_resonance_is_refused_and_a_speed_beside_it_is_not(off):
    undamped = assemble(one_freedom(0.0))
    natural = 2.0 * np.pi * forced_response(undamped, [1.0], 1).natural_frequency[-1]
    hertz = f"{natural / 2.0 / np.pi:.6g}"
    with pytest.raises(SolveError, match="unbounded") as caught:
        forced_response(undamped, [1.0, natural / 20 * (1.0 + off)], 1)
    words = f"{hertz} Hz excite the mode at {hertz} Hz, in which output.rotation moves most"
    assert words in str(caught.value) and "damping, or leave that speed out" in str(caught.value)
    beside = forced_response(undamped, [natural / 20 * (1.0 + 1e-4)], 1)
    amplitude = np.abs(beside.dynamic_transmission_error).max() / RIPPLE
    assert amplitude == pytest.approx(0.5e4, rel=1e-3)


def varying_and_undamped():
    """One freedom on a mesh whose stiffness varies, and the speed at which it would be in resonance."""
    system = assemble(with_mesh(one_freedom(0.0), table=square_wave_table()))
    at = excited(system, 0.0, 3)
    return at, 2.0 * np.pi * natural_modes(at.linear).frequency[-1] / 20


def test_a_varying_stiffness_without_damping_is_refused_where_nothing_bounds_it():
    """The response goes through infinity from one sign to the other: it is never a number out of rounding."""
    at, resonance = varying_and_undamped()
    below, above = 0.97 * resonance, 0.99 * resonance

    def response(speed):
        found, _ = parametric_response(at, np.array([speed]), np.zeros(1), 3)
        return float(found.dynamic_transmission_error[0, 0, 0].real)

    positive = response(below) > 0.0
    assert positive != (response(above) > 0.0)
    with pytest.raises(SolveError, match=r"unbounded: .* Hz excite the mode at .* damping, or leave"):
        while below < (middle := 0.5 * (below + above)) < above:
            here = (response(middle) > 0.0) == positive
            below, above = (middle, above) if here else (below, middle)


def test_a_run_in_an_undamped_resonance_is_computed_and_its_estimates_left_out():
    """In time the amplitude grows with every period; linear theory of the steady state says nothing."""
    natural = 2.0 * np.pi * forced_response(assemble(one_freedom(0.0)), [1.0], 1).natural_frequency[-1]
    scene = one_freedom(0.0, speed=TimeLaw.constant(natural / 20), duration=0.01)
    assert estimate_influences(scene) == {}
    run = simulate(replace(scene, tolerance=0.01, on_violation="report"))
    assert np.all(np.isfinite(run.dynamic_transmission_error))


@pytest.mark.parametrize("blocks", [1, 10**6])
def test_a_vibration_that_is_not_a_number_is_refused(blocks, monkeypatch):
    """An undamped mode at its very frequency divides by zero; a NaN passes any comparison that it loses."""
    system, speed = assemble(gear_pair_scene()), np.linspace(50.0, 500.0, 3)
    solved, calls = steady_vibration.solved, []

    def divided_by_zero(matrix, right):
        calls.append(matrix)
        answer = solved(matrix, right)
        if len(calls) == 1:
            answer[0, 0, 0, 0] = np.nan
        return answer

    monkeypatch.setattr(steady_vibration, "BLOCK", blocks)
    monkeypatch.setattr(steady_vibration, "solved", divided_by_zero)
    with pytest.raises(SolveError, match="unbounded"):
        harmonic_response(system, speed, 4)
    assert calls


def test_loads_that_are_not_a_number_are_not_left_out(monkeypatch):
    def no_number(*arguments):
        return np.full_like(load_harmonics(*arguments), np.nan)

    monkeypatch.setattr(steady_vibration, "load_harmonics", no_number)
    with pytest.raises(SolveError):
        harmonic_response(assemble(gear_pair_scene(spring_table(STIFFNESS, 0.0))), [100.0], 4)


def test_blocks_of_speeds_change_nothing(monkeypatch):
    system, speed = assemble(gear_pair_scene()), np.linspace(50.0, 500.0, 17)
    whole = harmonic_response(system, speed, 4)
    monkeypatch.setattr(steady_vibration, "BLOCK", 300)
    seen: list[float] = []
    parts = harmonic_response(system, speed, 4, progress=seen.append)
    np.testing.assert_allclose(parts.displacement, whole.displacement, rtol=1e-13, atol=0.0)
    assert len(seen) > 2 and seen == sorted(seen) and seen[-1] == 1.0
    assert 0.0 < parts.residual < 1e-12


def test_the_difference_of_the_excitations_grows_with_the_ripple_of_the_stiffness():
    none = forced_response(assemble(gear_pair_scene(spring_table(STIFFNESS, RIPPLE))), [100.0, 200.0], 1)
    some = forced_response(assemble(gear_pair_scene()), [100.0, 200.0], 1)
    assert none.excitation_difference.max() < 1e-6
    assert 0.01 < some.excitation_difference.max() < 0.2


@pytest.mark.parametrize("on", [EFFECTS, EFFECTS[:1], EFFECTS[2:]])
def test_a_slow_response_is_what_the_static_equilibria_of_a_mesh_cycle_give(table, on):
    """The equilibria follow every effect: tables read where the bodies rest, moments of a load that moves."""
    slow, samples = 1e-6 * 900.0, 128
    scene = tilted(table, on, slow)
    system = assemble(scene)
    period = 60.0 / (20 * slow)
    rest = np.array([static_equilibrium(system, period * k / samples).displacement for k in range(samples)])
    lines = 2.0 * np.fft.rfft(rest, axis=0) / samples
    found = harmonic_response(system, [slow * RPM], 2)
    for h in (0, 1):
        size = np.max(np.abs(lines[h + 1]) * system.arrays.scale)
        apart = np.abs(lines[h + 1] - found.displacement[:, 0, h]) * system.arrays.scale
        assert np.max(apart) < 4e-4 * size
    if on == EFFECTS:  # at the fixed operating point of the table the error is another by more than that
        fixed = harmonic_response(assemble(tilted(table, (), slow)), [slow * RPM], 2)
        change = found.static_transmission_error[0] / fixed.static_transmission_error[0] - 1.0
        assert abs(change[0]) > 1e-3


def test_the_static_reference_is_the_table_where_the_bodies_rest(table):
    database = sliced_database(M, A, positions=12)
    scene = tilted(table, EFFECTS)
    run = simulate(replace(scene, outputs=Outputs(20e3, anti_alias=False)))
    system = assemble(scene)
    (location,) = operating_points_at(system, static_equilibrium(system).displacement)
    assert abs(location[0]) > 5e-7 and abs(location[1]) > 1e-6
    expected = database.ste(run.position[0, :50], float(run.nominal_force[0]), *location)
    np.testing.assert_allclose(run.static_transmission_error[0, :50], expected, rtol=1e-9)
    fixed = assemble(tilted(table, ()))
    assert with_static_reference(fixed, static_equilibrium(fixed).displacement) is fixed


def test_modes_take_the_mean_stiffness_wherever_the_scene_starts():
    """Its tangents at the two positions differ by 40 %."""
    one, other = (
        modal_analysis(assemble(with_mesh(gear_pair_scene(), position_offset=x))).natural_frequency
        for x in (0.0, 0.5)
    )
    np.testing.assert_allclose(one, other, rtol=1e-6)


def test_a_file_gives_back_every_bit(tmp_path):
    found = forced_response(assemble(gear_pair_scene()), [100.0, 200.0], 3)
    found.to_netcdf(tmp_path / "response.nc")
    again = ForcedResponse.from_netcdf(tmp_path / "response.nc")
    for name, value in vars(found).items():
        assert np.array_equal(getattr(again, name), value), name
    assert peaks(again) == peaks(found)


@pytest.mark.parametrize(
    ("speed", "field"), [([], "speed"), ([0.0], "speed[0]"), ([2.0, 1.0], "speed[1]"), ([np.inf], "speed[0]")]
)
def test_what_cannot_be_used_is_named(speed, field):
    with pytest.raises(InputError) as caught:
        forced_response(assemble(gear_pair_scene()), speed)
    assert caught.value.field == field


def test_a_scene_that_nothing_excites_has_no_response():
    """Constant stiffness, no transmission error, constant loads: no order is left."""
    scene = replace(gear_pair_scene(spring_table(STIFFNESS)), bushings=(), effects={})
    with pytest.raises(InputError, match="transmission errors and loads are constant"):
        forced_response(assemble(scene), [100.0])


def test_a_system_without_freedoms_has_no_modes_and_its_run_is_whole(tmp_path):
    """Both shafts turn as a free rotation says: relative to it nothing moves."""
    rigid = replace(
        gear_pair_scene(spring_table(STIFFNESS), duration=0.01),
        bushings=(),
        effects={},
        loads=(),
        gears=(),
        meshes=(),
    )
    alone = replace(rigid, shafts=rigid.shafts[:1])
    with pytest.raises(InputError, match="freedoms = 0"):
        modal_analysis(assemble(alone), [0.0])
    assert simulate(alone).modes["frequency"] == []


@pytest.mark.law
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_load_that_travels_on_a_rigid_rotor_shakes_its_two_bearings(sense):
    """k b M/(2 k b^2 - I w^2) on bearings k at b to both sides of the mesh, M = F z of the load's arm z."""
    spring, far, arm = spring_table(STIFFNESS), 8e7, 2e-3
    wave = arm * np.cos(2.0 * np.pi * spring.position)[:, None] * np.ones(spring.level.size)
    table = ForceTable(**vars(spring), load_arm=wave[None, None])
    scene = gear_pair_scene(table, speed=TimeLaw.constant(sense * 900.0 * RPM))
    scene = with_bushings(scene, radial_stiffness=far, radial_damping=0.0, axial_damping=0.0)
    system = assemble(replace(with_mesh(scene, damping=0.0), effects={"tilt": "on"}))
    found = harmonic_response(system, np.array([60.0, 95.0, 700.0]), 3)
    moment, rotor, b = found.load_moment[0, 0], build_rotor(scene, scene.shafts[0]), 0.1
    assert abs(moment) == pytest.approx(found.mean_force[0] * arm, rel=1e-5)  # a cubic between knots
    assert np.abs(found.static_transmission_error).max() < 1e-18
    omega = 2.0 * np.pi * found.frequency[:, 0]
    expected = far * b * abs(moment) / np.abs(2.0 * far * b**2 - rotor.inertia.transverse * omega**2)
    force = found.bearing_force[:, :3, :, 0]
    for left, right in ((0, 1), (2, 3)):  # alike rotors
        np.testing.assert_allclose(np.sqrt(np.sum(np.abs(force[left]) ** 2, axis=0)), expected, rtol=1e-9)
        np.testing.assert_allclose(force[left], -force[right], rtol=0.0, atol=1e-9 * expected.max())
    np.testing.assert_allclose(np.abs(found.friction_force), 0.0)
