"""Ghost orders, sidebands and mesh orders without a run against those of a run next to a resonance."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, Table, gear_pair_scene, spring_table, with_mesh

from dynamics import Outputs, Scene, TimeLaw, forced_response, simulate
from dynamics.assembly.assemble import assemble
from dynamics.linearize import HarmonicResponse, harmonic_response
from dynamics.orders import resample_to_position, spectrum
from dynamics.types import FloatArray

Response = Callable[..., HarmonicResponse]
TEETH, STIFFNESS, PER_PITCH = 20, 4e8, 64
SPEED = 6545.0
"""rpm: the upper sideband of mesh order 2 is at 0.98 of the mode of the mesh, 4563 Hz."""
LINES = (11, TEETH, 2 * TEETH, 2 * TEETH + 1)
"""Of the shaft: ghost order, mesh orders 1 and 2, a sideband."""
AMPLITUDES = {1: 8e-6, 11: 0.2e-6, 20: 1e-6, 40: 0.3e-6, 41: 0.05e-6}


def table(swing: float) -> Table:
    """F = k (d - e) of eccentric gears with waves, the stiffness varying by `swing` once per revolution."""
    angle = 2.0 * np.pi * np.arange(PER_PITCH * TEETH) / (PER_PITCH * TEETH)
    turn = 2.0 * np.pi / TEETH
    error = sum(size * np.cos(line * angle) for line, size in AMPLITUDES.items())
    slope = sum(-size * line * turn * np.sin(line * angle) for line, size in AMPLITUDES.items())
    stiffness = STIFFNESS * (1.0 + swing * np.cos(angle))
    change = -STIFFNESS * swing * turn * np.sin(angle)
    level = np.array([0.0, 1330.0, 2660.0, 5320.0])
    one = np.ones_like(level)
    fields = (
        error[:, None] + level / stiffness[:, None],
        slope[:, None] - level * (change / stiffness**2)[:, None],
        stiffness[:, None] * one,
        change[:, None] * one,
    )
    names = ("deflection", "deflection_slope", "stiffness", "stiffness_slope")
    values = {name: value[None, None] for name, value in zip(names, fields, strict=True)}
    alike = spring_table(STIFFNESS)
    return replace(alike, position=angle / turn, level=level, period=TEETH, **values)


def scene_of(swing: float, revolutions: int) -> Scene:
    made = gear_pair_scene(
        table(swing), speed=TimeLaw.constant(SPEED * RPM), duration=(revolutions + 2) * 60.0 / SPEED
    )
    made = replace(made, outputs=Outputs(energy_audit=False, receipt="minimal"))
    return with_mesh(made, damping_ratio=0.05, damping=None)


def off(swing: float, revolutions: int = 4, response: Response = forced_response) -> FloatArray:
    """Return by how much a response without a run is off at each of `LINES`, dB."""
    scene = scene_of(swing, revolutions)
    linear = response(assemble(scene), np.array([SPEED * RPM]), 3)
    run = simulate(scene)
    signal = resample_to_position(run, run.mesh_force[0], PER_PITCH)[2]
    lines = spectrum(signal[-revolutions * TEETH * PER_PITCH :], float(PER_PITCH)).amplitude
    at = [int(np.argmin(np.abs(linear.order * TEETH - line))) for line in LINES]
    expected = np.abs(linear.mesh_force[0, 0, at])
    return np.asarray(20.0 * np.log10(expected / lines[np.array(LINES) * revolutions]))


@pytest.mark.parametrize("revolutions", [4, 8])
def test_with_constant_stiffness_orders_of_a_run_are_those_of_the_linear_response(revolutions):
    """Window, resampling and length of the run have no part in them: 0.0003 dB."""
    assert np.max(np.abs(off(0.0, revolutions))) < 1e-3


@pytest.mark.parametrize("swing", [0.004, 0.1])
def test_a_stiffness_that_varies_makes_the_sidebands_of_a_run(swing):
    """Once per revolution: it moves a part of mesh order 2 into its sidebands, which the response has."""
    assert np.max(np.abs(off(swing))) < 1e-3


@pytest.mark.law
def test_with_the_mean_stiffness_a_sideband_is_off_by_what_varies():
    some, twice = (off(swing, response=harmonic_response) for swing in (0.002, 0.004))
    assert abs(some[-1]) > 20.0 * np.max(np.abs(some[:-1]))
    assert twice[-1] == pytest.approx(2.0 * some[-1], rel=0.2)
