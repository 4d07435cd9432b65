"""Harmonic response to the transmission error: closed form, laws of scaling and phasing, the time domain."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import (
    BASE_RADIUS,
    RPM,
    gear_pair_scene,
    repeated,
    spring_table,
    square_wave_table,
    with_mesh,
)
from planetary_scenes import MESH_STIFFNESS, driven_scene, published_set

from dynamics import Integration, Outputs, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import common_period, harmonic_response
from dynamics.linearize.harmonic_response import extremes

STIFFNESS, RIPPLE = 4e8, 1e-7
INERTIA = 1.1344291072112745e-3
MASS = INERTIA / BASE_RADIUS**2
NATURAL = np.sqrt(STIFFNESS / MASS)


def softening(ripple):
    """F = k(x) d with k = STIFFNESS / (1 + ripple cos 2 pi x): stiffness and error vary together."""
    table = spring_table(STIFFNESS, 0.0, level=2660.0)
    wave = 1.0 + ripple * np.cos(2 * np.pi * table.position)
    slope = -2 * np.pi * ripple * np.sin(2 * np.pi * table.position)
    rows = np.array([0.0, 1.0])[None, :]
    deflection, deflection_slope = (2660.0 / STIFFNESS * w[:, None] * rows for w in (wave, slope))
    stiffness = np.repeat((STIFFNESS / wave)[:, None], 2, axis=1)
    stiffness_slope = np.repeat((-STIFFNESS * slope / wave**2)[:, None], 2, axis=1)
    return replace(
        table,
        deflection=deflection[None, None],
        deflection_slope=deflection_slope[None, None],
        stiffness=stiffness[None, None],
        stiffness_slope=stiffness_slope[None, None],
    )


def test_one_freedom_follows_its_closed_form():
    """M u'' + c u' + k u = k e, from far below to far above resonance."""
    scene = replace(gear_pair_scene(spring_table(STIFFNESS, RIPPLE)), bushings=(), effects={})
    damping = 0.1 * MASS * NATURAL
    speed = np.array([0.01, 0.5, 1.0, 1.7]) * NATURAL / 20
    found = harmonic_response(assemble(with_mesh(scene, damping=damping)), speed, 1)
    r = 20 * speed / NATURAL
    gain = 1.0 / (1.0 - r**2 + 0.1j * r)
    np.testing.assert_allclose(found.dynamic_transmission_error[0, :, 0], RIPPLE * gain, rtol=1e-6)
    force = STIFFNESS * RIPPLE * ((1.0 + 0.1j * r) * gain - 1.0)
    np.testing.assert_allclose(found.mesh_force[0, :, 0], force, rtol=1e-5)
    np.testing.assert_allclose(found.frequency[:, 0], 20 * speed / (2 * np.pi))
    mean = 100.0 / BASE_RADIUS
    np.testing.assert_allclose(found.least_mesh_force[0], mean - np.abs(force), rtol=1e-3)


@pytest.mark.parametrize("rpm", [900.0, 6000.0])
def test_the_time_domain_agrees_off_resonance(rpm, record_figure):
    """A run of 0.6 s has settled; 20 whole pitches of it, all series, as complex amplitudes."""
    scene = gear_pair_scene(spring_table(STIFFNESS, RIPPLE), speed=TimeLaw.constant(rpm * RPM), duration=0.6)
    scene = with_mesh(scene, position_offset=0.3)
    found = harmonic_response(assemble(scene), [rpm * RPM], 1)
    rate = 32 * found.frequency[0, 0]
    run = simulate(
        replace(
            scene,
            outputs=Outputs(rate, energy_audit=False, anti_alias=False),
            integration=Integration(tolerance=1e-12),
        )
    )
    last = slice(-641, -1)
    turn = np.exp(-2j * np.pi * found.frequency[0, 0] * run.time[last]) / 320

    def amplitude(values):
        return values[..., last] @ turn

    pairs = {
        "DTE": (amplitude(run.dynamic_transmission_error), found.dynamic_transmission_error[:, 0, 0]),
        "bearing force": (amplitude(run.bearing_force), found.bearing_force[:, :, 0, 0]),
        "mesh force": (amplitude(run.mesh_force), found.mesh_force[:, 0, 0]),
    }
    worst = {name: float(np.max(np.abs(a - b)) / np.max(np.abs(b))) for name, (a, b) in pairs.items()}
    record_figure(
        f"harmonic response against a run, {rpm:g} rpm", max(worst.values()), "below 2e-5", "1", "own target"
    )
    assert max(worst.values()) < 2e-5, worst


def test_both_excitations_agree_to_second_order_in_the_ripple():
    """They differ by products of stiffness and error variation: four times less at half the ripple."""

    def difference(ripple):
        system = assemble(gear_pair_scene(softening(ripple)))
        a, b = (
            harmonic_response(system, [900.0 * RPM], 2, excitation=kind).dynamic_transmission_error[0, 0]
            for kind in ("static_error", "blocked_force")
        )
        return np.max(np.abs(a - b)) / np.max(np.abs(a))  # relative: one order less

    assert difference(0.1) / difference(0.05) == pytest.approx(2.0, rel=0.1)
    assert 1e-3 < difference(0.1) < 0.1


def test_the_response_is_linear_and_offsets_only_turn_its_phase():
    scene = gear_pair_scene(square_wave_table())
    one = harmonic_response(assemble(scene), [900.0 * RPM], 5)
    moved = harmonic_response(assemble(with_mesh(scene, position_offset=0.2)), [900.0 * RPM], 5)
    turn = np.exp(2j * np.pi * 0.2 * one.order)
    np.testing.assert_allclose(moved.mesh_force, one.mesh_force * turn, rtol=1e-6, atol=1e-6)
    small, large = (
        harmonic_response(assemble(gear_pair_scene(spring_table(STIFFNESS, a))), [300.0], 1)
        for a in (1e-8, 3e-8)
    )
    np.testing.assert_allclose(large.bearing_force, 3.0 * small.bearing_force, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(("teeth", "in_phase"), [((27, 36, 99), True), ((28, 35, 98), False)])
def test_planets_in_phase_turn_the_sun_and_planets_in_sequence_shake_it(teeth, in_phase):
    """With the tooth numbers divisible by the planets the net force on the sun's bearing vanishes.

    Else its torque does: the mesh forces of a planet's neighbors follow a third of a pitch later.
    """
    table = spring_table(MESH_STIFFNESS, RIPPLE)
    gears = published_set(3, teeth=teeth, sun_table=table, ring_table=table)
    found = harmonic_response(assemble(driven_scene(gears)), [200.0], 1)
    lateral = np.max(np.abs(found.displacement[[found.freedom.index(f"sun.{k}") for k in "xy"], 0, 0]))
    force = found.mesh_force[::2, 0, 0]
    apart = np.max(np.abs(np.sum(force))) / np.max(np.abs(force))
    assert bool(lateral < 1e-6 * RIPPLE) is in_phase
    assert bool(apart < 1e-6) is not in_phase


def test_pitches_of_several_teeth_make_fractional_orders():
    table = spring_table(STIFFNESS, RIPPLE)
    raised = repeated(table, 4)
    raised = replace(raised, deflection=raised.deflection + (raised.position[:, None] < 1.0) * 1e-7)
    system = assemble(gear_pair_scene(raised))
    found = harmonic_response(system, [300.0], 2)
    assert found.order[0] == pytest.approx(0.25)
    assert common_period(system).pitches == (4,)


def test_bad_input_is_named():
    system = assemble(gear_pair_scene())
    with pytest.raises(InputError, match="speed\\[1\\]"):
        harmonic_response(system, [100.0, 0.0])
    with pytest.raises(InputError, match="excitation"):
        harmonic_response(system, [100.0], excitation="noise")


def test_extremes_of_orders_are_those_of_their_wave():
    """Orders 3/20 and 1 have a period of 20 pitches; no order is a multiple of the least."""
    order = np.array([3.0 / 20.0, 1.0, 2.0])
    amplitude = np.array([[[1.0 + 0.5j, 0.7 - 0.2j, 0.1j]]])
    turns = 2.0j * np.pi * np.linspace(0.0, 20.0, 200_001)
    wave = np.sum(np.real(amplitude[0, 0, :, None] * np.exp(order[:, None] * turns)), axis=0)
    found = extremes(amplitude, order)
    np.testing.assert_allclose(np.ravel(found), [wave.min(), wave.max()], rtol=0.02)


def test_orders_of_a_long_common_period_meet_in_all_phases():
    """Meshes of 693 and 3880 pitches a period: its extremes are within those of both waves, and near them."""
    cycle, chance = np.arange(1.0, 13.0), np.random.default_rng(1)
    order = np.sort(np.concatenate([cycle, 3880.0 / 693.0 * cycle]))
    amplitude = (chance.normal(size=24) + 1j * chance.normal(size=24))[None, None]
    turns = 2.0j * np.pi * chance.uniform(0.0, 693.0, 20_000)
    wave = np.real(np.exp(turns[:, None] * order) @ amplitude[0, 0])
    minimum, maximum = np.ravel(extremes(amplitude, order))
    assert minimum <= wave.min() < 0.8 * minimum
    assert 0.8 * maximum < wave.max() <= maximum
