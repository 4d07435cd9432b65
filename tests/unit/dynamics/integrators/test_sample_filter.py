"""What a run stores is its points on the inner grid behind the filter's taps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.integrate import Trajectory
from dynamics.integrators.workspace import Count
from dynamics.loads import TimeLaw
from dynamics.motion.observation import observe
from dynamics.results.histories import filtered
from dynamics.scene import Outputs
from tests.fakes.geared_scenes import RPM, gear_pair_scene, square_wave_table

RATE = 30e3


@pytest.fixture(scope="module")
def made():
    scene = gear_pair_scene(square_wave_table(), speed=TimeLaw.constant(3000.0 * RPM))
    return assemble(replace(scene, duration=0.02, outputs=Outputs(RATE, energy_audit=False)))


@pytest.fixture(scope="module")
def stored(made) -> Trajectory:
    return integrate(made, static_equilibrium(made), made.scene.integration)


@pytest.fixture(scope="module")
def points(made) -> Trajectory:
    """Every point of the inner grid: the steps do not know how they are sampled."""
    every = replace(made.sampling, rate=made.sampling.inner_rate, stop_band=0.0, taps=3)
    return integrate(replace(made, sampling=every), static_equilibrium(made), made.scene.integration)


def behind_the_filter(sampling, values):
    """Every output sample of the values (T, c) on the inner grid that the whole filter sees."""
    taps, half = sampling.filter_taps(), sampling.taps // 2
    whole = np.stack([np.convolve(column, taps, mode="valid") for column in values.T], axis=-1)
    first = -half % sampling.factor
    return whole[first :: sampling.factor], (half + first) // sampling.factor


def test_channels_are_points_behind_the_filter(made, stored, points):
    steps = Count.ACCEPTED, Count.REJECTED
    assert [stored.count[k] for k in steps] == [points.count[k] for k in steps]
    expected, first = behind_the_filter(made.sampling, points.states.filtered)
    ours = stored.states.filtered[first : first + expected.shape[0]]
    scale = np.max(np.abs(expected), axis=0)
    assert expected.shape[0] > 400
    assert np.max(np.abs(ours - expected) / np.where(scale > 0.0, scale, 1.0)) < 1e-12


def test_local_coordinates_follow_from_the_filtered_state(made, stored, points):
    """Transmission errors are not filtered by themselves: they are linear in displacements that are."""
    seen = observe(made.arrays, points.time, points.q, points.v, points.states.moved)
    expected, first = behind_the_filter(made.sampling, seen.coordinate.T)
    there = observe(made.arrays, stored.time, stored.q, stored.v, stored.states.moved)
    ours = filtered(made, stored.states, there).coordinate.T[first : first + expected.shape[0]]
    assert np.ptp(expected[:, 0]) > 1e-7
    assert np.max(np.abs(ours - expected)) < 1e-12 * np.max(np.abs(expected))


def test_what_the_filter_takes_away_is_what_it_leaves_of_the_points(made, stored, points):
    factor = made.sampling.factor
    removed = points.states.filtered[::factor, 0][: stored.time.size] - stored.states.filtered[:, 0]
    assert stored.figures.removed[0] == pytest.approx(np.sqrt(np.mean(removed**2)), rel=1e-9)
