"""Compiled code of runs, made while a run still waits for its tables."""

from __future__ import annotations

from dataclasses import replace

from dynamics.loads import TimeLaw
from dynamics.meshes.stiffness_table import straight_table
from dynamics.scene import pair_scene
from dynamics.shafts import GearBody, Inertia
from dynamics.simulation.to_file import run_scene


def compile_ahead() -> None:
    """Compile, or read where they are kept, the loops that all runs take, by a short run of two gears.

    Laws of other elements (rolling bearings, housings) are compiled by the scenes that have them.
    """
    driver = GearBody("driver", "input", 0.1, 20, 0.0376, 0.02, inertia=Inertia(1.0, 1e-3, 1e-3))
    scene = pair_scene(
        straight_table(3e8),
        (driver, replace(driver, name="driven", shaft="output")),
        center_distance=0.08,
        speed=TimeLaw.constant(10.0),
        resisting_torque=TimeLaw.constant(10.0),
        duration=0.01,
    )
    run_scene(scene)
