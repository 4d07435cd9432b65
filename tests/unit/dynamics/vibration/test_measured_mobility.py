"""Measured mobilities in place of modes: lines, what lies between them, what is left out."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, square_wave_table
from reduced_housings import random_housing

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import forced_response
from dynamics.vibration import (
    Direction,
    MeasuredMobility,
    bearing_shares,
    measured_vibration,
    transfer_functions,
)

LINES = np.arange(20.0, 2001.0, 2.0)


def oscillator(hertz, natural=700.0, ratio=0.002):
    """Mobility of mass 1 kg on a spring; half-power bandwidth 2 ratio natural, 2.8 Hz."""
    omega, own = 2j * np.pi * hertz, 2.0 * np.pi * natural
    return omega / (own**2 + 2.0 * ratio * own * omega + omega**2)


def measured(values=None, **changed):
    column = oscillator(LINES) if values is None else values
    part = MeasuredMobility(LINES, (Direction("lid", 1),), (Direction("left", 0),), column[:, None, None])
    return replace(part, **changed)


def forces(frequency, force, bearing=("left",)):
    """Bearing harmonics: forces (b, 3 or 6, S, H) at frequencies (S, H)."""
    shape = np.shape(frequency)
    return SimpleNamespace(
        bearing=bearing,
        bearing_force=np.asarray(force, dtype=complex),
        speed=np.arange(1.0, shape[0] + 1.0),
        order=np.arange(1.0, shape[1] + 1.0),
        frequency=np.asarray(frequency),
        in_contact=np.ones(shape[0], dtype=bool),
        floor=None,
    )


def db(first, second):
    return 20.0 * np.log10(np.abs(first) / np.abs(second))


def test_lines_are_the_measured_values_and_nothing_is_known_outside_the_band():
    found = measured()
    np.testing.assert_allclose(found.at(LINES)[:, 0, 0], oscillator(LINES), rtol=1e-12)
    assert np.all(np.isnan(found.at(np.array([19.999, 2000.001]))))
    assert found.covers(np.array([19.9, 20.0, 2000.0, 2001.0])).tolist() == [False, True, True, False]


def test_a_light_resonance_between_lines_is_not_cut_off():
    """A straight line is 3.6 dB off, low at the peak; the quotient follows it within 0.02 dB."""
    values, hertz = oscillator(LINES, 701.0), np.linspace(695.0, 707.0, 121)
    truth = oscillator(hertz, 701.0)
    straight = np.interp(hertz, LINES, values.real) + 1j * np.interp(hertz, LINES, values.imag)
    assert db(straight, truth).min() < -1.5
    assert np.abs(db(measured(values).at(hertz)[:, 0, 0], truth)).max() < 0.02


@pytest.mark.parametrize(("apart", "close", "bias"), [(0.5, 0.02, 1e-3), (1.0, 0.2, 5e-3)])
def test_modes_that_overlap_are_followed_without_bias(apart, close, bias):
    """Of 23 modes, lines so many half-power bandwidths apart, in dB: 99 % of all values, mean near peaks."""
    housing = random_housing()
    light = replace(housing, damping=0.25 * housing.damping)  # of the critical: 0.005
    step = apart * 0.01 * housing.frequency[0]
    lines = np.arange(0.5 * housing.frequency[0], 3200.0, step)
    middle = lines[:-1] + step * np.random.default_rng(1).uniform(size=lines.size - 1)
    rows = np.concatenate([point.motion for point in housing.points])
    values, truth = (transfer_functions(light, hertz, rows) for hertz in (lines, middle))
    ends = (tuple(Direction(f"{k}", 0) for k in range(count)) for count in values.shape[1:])
    off = db(MeasuredMobility(lines, *ends, values).at(middle), truth)
    share = ((middle - lines[:-1]) / step)[:, None, None]
    straight = db((1.0 - share) * values[:-1] + share * values[1:], truth)
    peaks = np.abs(truth) > 0.3 * np.abs(truth).max(axis=0)
    assert np.percentile(np.abs(off), 99.0) < close < 0.15 * np.percentile(np.abs(straight), 99.0)
    assert abs(off[peaks].mean()) < bias < -0.03 * straight[peaks].mean()


def test_noise_between_lines_stays_near_the_lines():
    """Of random values a pole could lie between two lines anywhere; the mean has no larger size there."""
    draw = np.random.default_rng(4)
    noise = draw.normal(size=LINES.size) + 1j * draw.normal(size=LINES.size)
    hertz = np.linspace(20.0, 2000.0, 40001)
    below = np.clip(np.searchsorted(LINES, hertz, side="right") - 1, 0, LINES.size - 2)
    largest = np.maximum(np.abs(noise[below]), np.abs(noise[below + 1]))
    assert np.all(np.abs(measured(noise).at(hertz)[:, 0, 0]) <= np.sqrt(2.0) * largest * (1.0 + 1e-9))


def test_forces_act_along_the_axes_of_the_measurement():
    """The file's x is the scene's y, its y against the scene's x: a force along y alone moves the point."""
    turned = measured(axes=np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    hertz = np.array([[100.0]])
    for scene_axis, moved in ((0, 0.0), (1, 3.0 * oscillator(hertz)[0, 0]), (2, 0.0)):
        force = np.zeros((1, 3, 1, 1))
        force[0, scene_axis] = 3.0
        found = measured_vibration(forces(hertz, force), turned)
        assert found.velocity[0, 1, 0, 0] == pytest.approx(moved)
        assert np.all(np.isnan(found.velocity[0, [0, 2]]))
    assert found.omitted == (Direction("left", 2),)


def test_the_result_says_what_is_left_out():
    force = np.zeros((2, 6, 1, 3), dtype=complex)
    force[0, 0], force[0, 2], force[1, 1], force[1, 4] = 3.0, 4.0j, 12.0, 0.5
    hertz = np.array([[10.0, 100.0, 5000.0]])
    found = measured_vibration(forces(hertz, force, ("left", "right")), measured())
    assert found.covered.tolist() == [[False, True, False]]
    assert found.omitted == (Direction("left", 2), Direction("right", 1))
    np.testing.assert_allclose(found.omitted_force, 160.0 / 169.0)
    assert found.moments
    assert np.isnan(found.rms[0, 0]).tolist() == [True, False, True]
    expected = 3.0 * abs(oscillator(np.array([100.0]))[0]) / np.sqrt(2.0)
    assert found.overall[0, 0] == pytest.approx(expected)
    assert found.rms[0, 0, 1] == pytest.approx(expected)


def test_shares_of_bearings_add_up_and_one_against_the_sum_is_negative():
    """At a line: 5 of the left and -2 of the right make 3; shares 5/3 and -2/3."""
    both = measured(
        excitation=(Direction("left", 0), Direction("right", 0)),
        mobility=np.stack([oscillator(LINES), -2.0 * oscillator(LINES)], axis=1)[:, None],
    )
    force = np.zeros((2, 3, 1, 2))
    force[0, 0], force[1, 0] = 5.0, 1.0
    shares = bearing_shares(forces(np.array([[100.0, 5000.0]]), force, ("left", "right")), both)
    np.testing.assert_allclose(shares[:, 0, 0, 0], [5.0 / 3.0, -2.0 / 3.0])
    assert np.all(np.isnan(shares[..., 1]))


def test_the_forces_of_a_response_move_the_points():
    """Of a scene on springs to the ground; by hand on a line between two lines of equal mobility."""
    response = forced_response(
        assemble(gear_pair_scene(square_wave_table())), np.array([60.0, 150.0]), orders=3
    )
    names = tuple(Direction(name, axis) for name in response.bearing for axis in range(3))
    gains = np.arange(1.0, len(names) + 1.0) * (1e-3 + 1e-4j)
    flat = MeasuredMobility(
        np.array([0.1, 1e5]), (Direction("lid", 2),), names, np.tile(gains, (2, 1))[:, None, :]
    )
    found = measured_vibration(response, flat)
    expected = np.einsum("e,esh->sh", gains, response.bearing_force[:, :3].reshape(len(names), 2, 3))
    np.testing.assert_allclose(found.velocity[0, 2], expected, rtol=1e-9)
    assert np.abs(expected).max() > 0.0
    assert found.omitted == ()


def test_what_cannot_be_used_is_refused():
    force, hertz = np.ones((1, 3, 1, 1)), np.array([[100.0]])
    with pytest.raises(InputError, match=r"excitation\[0\].*one of right"):
        measured_vibration(forces(hertz, force, ("right",)), measured())
    with pytest.raises(InputError, match="measured from 20 Hz to 2"):
        measured_vibration(forces(3e4 + hertz, force), measured())
    broken = oscillator(LINES)
    broken[7] = np.nan
    with pytest.raises(InputError, match=r"lid y per left x.*finite at every line; it is not at 34"):
        measured(broken)
    with pytest.raises(InputError, match="lines above 0 Hz that rise"):
        measured(frequency=LINES[::-1])
    with pytest.raises(InputError, match=r"shape \(991, 1, 1\)"):
        measured(mobility=np.ones((990, 1, 1), dtype=complex))
    with pytest.raises(InputError, match="right-handed"):
        measured(axes=np.diag([1.0, 1.0, -1.0]))
