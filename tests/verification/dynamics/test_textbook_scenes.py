"""Textbook benchmarks as scene files: what their sources and independent computations say."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from dynamics.assembly.assemble import assemble
from dynamics.linearize import natural_modes
from dynamics.scene import Scene
from dynamics.simulation import simulate
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.subjects import scene_of

EXAMPLES = Path(__file__).parents[3] / "examples"
ROTATIONAL = (1475.75, 1930.35, 2658.32, 7462.80, 11775.27)
TRANSLATIONAL = (743.16, 1102.42, 1896.02, 2276.38, 6986.30, 9647.91)


def example(name: str) -> Scene:
    return dynamic_scene(scene_of(EXAMPLES / name)[0], {})


def test_the_planetary_set_of_lin_and_parker_has_its_natural_frequencies() -> None:
    """Lin and Parker 1999, three planets: one of each rotational, two of each translational mode, Hz."""
    found = natural_modes(assemble(example("lin_parker_planetary_scene.toml"))).frequency
    expected = np.sort([*ROTATIONAL, *np.repeat(TRANSLATIONAL, 2)])
    assert found[-expected.size :] == pytest.approx(expected, rel=2e-6, abs=0.005)
    assert np.all(found[: -expected.size] < 1e-2)


@pytest.mark.parametrize(
    ("frequency", "rms"), [(0.5, 0.011759), (0.85, 0.181301), (1.0, 0.133083), (1.6, 0.057716)]
)
def test_the_oscillator_with_backlash_has_the_converged_response(frequency: float, rms: float) -> None:
    """Over W = 1 and more, and below the jumps, both branches are one; rms in half backlashes of 50 um."""
    text = tomllib.loads((EXAMPLES / "backlash_oscillator_scene.toml").read_text("utf-8"))
    shift = (frequency - 1.0) * text["drives"][0]["speed_rpm"][0]
    error = text["meshes"][0]["stiffness"]["transmission_error_um"]["amplitude"]
    error[0] = 50.0 * 0.05 * frequency / math.hypot(frequency, 0.1)
    text["drives"][0]["speed_rpm"][0] += shift
    text["speed_torques"][0]["speed_rpm"] = [s + shift for s in text["speed_torques"][0]["speed_rpm"]]
    text["outputs"]["sample_rate_hz"] *= frequency
    run = simulate(dynamic_scene(validated(SceneInput, text), {}))
    excited = error[0] * 1e-6 * np.cos(1e4 * frequency * run.time)
    deflection = (run.dynamic_transmission_error[0] - excited) / 50e-6
    assert np.std(deflection[-20 * 64 - 1 : -1]) == pytest.approx(rms, rel=1e-3)
