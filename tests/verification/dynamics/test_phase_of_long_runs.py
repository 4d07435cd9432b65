"""Phase of integrated runs against exact arithmetic: no step adds a rounding to the position.

The benchmark `long_phase` runs the same for 1e7 steps; what is done in a step knows nothing of how many there
were, so that errors may grow with the angle turned only, and that is exact for huge counts by itself.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, with_mesh

from dynamics.assembly.assemble import assemble
from dynamics.joints import FreeRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.scene import Integration, Outputs, Scene
from dynamics.simulation import simulate

PI = Fraction(3141592653589793238462643383279502884197, 10**39)
STEP, TEETH, START = 1e-5, 20, 50.0


def imposed(steps: int, method: str = "implicit") -> Scene:
    """Torsion alone, the drive at 955 rpm, `steps` fixed steps."""
    duration = steps * STEP
    scene = gear_pair_scene(spring_table(4e8), duration=duration, speed=TimeLaw.constant(955.0 * RPM))
    kept = {"anti_alias": False, "bearing_forces": False, "energy_audit": False, "receipt": "minimal"}
    outputs = Outputs(10.0 / duration, **kept)
    scene = replace(scene, bushings=(), effects={}, outputs=outputs)
    return with_mesh(replace(scene, integration=Integration(method, fixed_step=STEP)), damping_ratio=0.1)


def accelerating(steps: int, method: str = "implicit") -> Scene:
    """A train without a drive: a motor of 1.25 and a brake of 0.25 of what makes 1 rad/s2."""
    scene = replace(
        imposed(steps, method), drives=(), free_rotations=(FreeRotation("train", "input", START),)
    )
    inertia = float(assemble(replace(scene, loads=_loads(1.0))).arrays.total_inertia[0, 0])
    return replace(scene, loads=_loads(inertia))


def _loads(inertia: float) -> tuple[LoadTorque, ...]:
    """Motor and brake."""
    return (
        LoadTorque("motor", "input", TimeLaw.constant(-1.25 * inertia)),
        LoadTorque("brake", "output", TimeLaw.constant(0.25 * inertia)),
    )


def phase_error(scene: Scene) -> float:
    """Position at the last output sample less the exact one, base pitches."""
    run = simulate(scene)
    time = Fraction(float(run.time[-1]))
    if scene.drives:
        angle = Fraction(955.0 * RPM) * time
    else:
        torque = sum(-Fraction(load.torque.value[0]) for load in scene.loads)
        inertia = Fraction(float(assemble(scene).arrays.total_inertia[0, 0]))
        angle = Fraction(START) * time + torque / inertia * time**2 / 2
    turned = Fraction(float(run.position[0, -1])) - Fraction(float(run.position[0, 0]))
    error = turned - angle * TEETH / (2 * PI)
    return float(error - round(error))


STEPS = 100_000


@pytest.mark.parametrize("method", ["implicit", "explicit"])
@pytest.mark.parametrize("make", [imposed, accelerating], ids=["imposed", "accelerating"])
def test_the_phase_is_exact_after_many_steps(make, method, record_figure):
    error = abs(phase_error(make(STEPS, method)))
    name = f"phase after {STEPS:g} steps, {make.__name__}, {method}"
    record_figure(name, error, "below 1e-9", "base pitches", "own target")
    assert error < 2e-13 * (STEPS / 1e5) ** 2  # 5e-12 after 1e7 steps, with the angle
