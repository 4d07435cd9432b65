"""What order both integrators keep at fixed steps across kinks: of tables at knots, of forces at lift-off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, square_wave_table

from dynamics.loads import TimeLaw
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate

STEPS = 2.0 ** -(np.arange(12) / 4)  # three octaves; where in a step a kink lies is chance, so many of them


def torsional(table, torque, rpm):
    """One rotation, damped."""
    outputs = Outputs(5e3, energy_audit=False, anti_alias=False)
    pair = gear_pair_scene(
        table, torque=torque, speed=TimeLaw.constant(rpm * RPM), duration=0.01, outputs=outputs
    )
    return replace(pair, bushings=(), effects={})


# name: scene, largest step in s, order that theory gives a kink of that kind
CASES = {
    "knots, a kink in the second derivative": (
        torsional(spring_table(4e8, 2e-6, positions=4), 100.0, 4000.0),
        8e-6,
        3.0,
    ),
    "lift-off, a kink in the force": (torsional(square_wave_table(256), 20.0, 12000.0), 4e-6, 2.0),
}


@pytest.mark.parametrize("method", ["implicit", "explicit"])
@pytest.mark.parametrize("name", CASES)
def test_kinks_cost_as_much_order_as_theory_says(name, method, record_figure):
    """Slope of log error over log step; a step in which a kink lies has an error of its own order."""
    scene, largest, theory = CASES[name]

    def run(step, method=method):
        integration = Integration(method, tolerance=1e-14, fixed_step=float(step))
        return simulate(replace(scene, integration=integration))

    fine = run(largest / 256, "explicit")
    assert bool(np.any(fine.mesh_force == 0.0)) is (theory == 2.0)
    exact = fine.dynamic_transmission_error
    errors = [
        np.sqrt(np.mean((run(step).dynamic_transmission_error - exact) ** 2)) for step in largest * STEPS
    ]
    order = np.polyfit(np.log(STEPS), np.log(errors), 1)[0]
    record_figure(f"order of the {method} method, {name}", order, f"about {theory:g}", "1", "theory")
    assert abs(order - theory) < 0.5
