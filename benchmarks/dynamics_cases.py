"""Runs of gear stages whose cost `benchmarks.dynamics_cost` measures, each in a process of its own."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.stages import stages
from dynamics.loads import TimeLaw
from dynamics.meshes.gear_mesh import CoastFlank
from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.technique import PlainTable
from dynamics.scene import Outputs, Scene
from dynamics.simulation import simulate
from fe_contact.ste import SteDatabase

RUN_UP = TimeLaw((0.0, 5.0), (0.0, 100.0))
CONSTANT = TimeLaw.constant(50.0)
REPEATS = 5


def run_up(path: str) -> dict[str, float]:
    """Two stages with 24 freedoms from rest to 955 rpm in 5 s: plain, with error estimates, and audited."""
    scene = stages(_table(path), 2, 5.0, RUN_UP)
    plain = replace(scene, outputs=Outputs(energy_audit=False))
    simulate(scene)
    (audited, run), (alone, _) = _cheapest(scene, 3), _cheapest(plain, 3)
    minimal, _ = _cheapest(replace(scene, outputs=Outputs(energy_audit=False, receipt="minimal")), 3)
    assert run.bearing_force.shape[0] == 8
    return {"audited": audited, "alone": alone, "minimal": minimal, "energy": run.energy.relative}


def by_duration(path: str, durations: Sequence[float]) -> dict[str, list[float]]:
    """CPU seconds and steps of one stage at constant speed, over the duration."""
    table = _table(path)
    return _costs([stages(table, 1, seconds, CONSTANT) for seconds in durations])


def by_meshes(path: str, counts: Sequence[int]) -> dict[str, list[float]]:
    """CPU seconds and steps of one second of several stages at constant speed, over their number."""
    table = _table(path)
    return _costs([stages(table, count, 1.0, CONSTANT) for count in counts])


def switched_off(path: str) -> dict[str, dict[str, float]]:
    """CPU seconds of a stage that could have an effect but has it off, and of one that could not."""
    table = _table(path)
    scene = stages(table, 1, 1.0, CONSTANT)
    axes = {
        "dynamic_misalignment": "off",
        "moving_application_point": "off",
        "dynamic_center_distance": "off",
    }
    able = {
        "backlash": (_with_mesh(scene, coast=CoastFlank(50e-6)), {"backlash": "off"}),
        "friction": (_with_mesh(scene, friction=0.05, table=_with_axes(table)), {"friction": "off", **axes}),
        "operating points on a table's axes": (_with_mesh(scene, table=_with_axes(table)), axes),
    }
    found = {}
    for name, (given, choice) in able.items():
        off = replace(given, effects={**given.effects, **choice})
        cost, same = _paired(off, scene)
        found[name] = {"off": cost[0], "absent": cost[1], "same": same}
    return found


def _table(path: str) -> MeshTable:
    """Return the mesh-force table of a database."""
    return SteDatabase.from_netcdf(path).force_table()


def _with_mesh(scene: Scene, **changes: Any) -> Scene:
    """Change the first mesh."""
    return replace(scene, meshes=(replace(scene.meshes[0], **changes), *scene.meshes[1:]))


def _with_axes(table: MeshTable) -> PlainTable:
    """Return the table at three misalignments and center distances, the same at all, with levers."""
    knots = np.array([-1e-5, 0.0, 1e-5])
    shape = (3, 3, *np.shape(table.deflection)[2:])
    names = ("deflection", "deflection_slope", "stiffness", "stiffness_slope")
    fields = {name: np.broadcast_to(getattr(table, name), shape).copy() for name in names}
    levers = dict.fromkeys(("load_arm", "sliding_share", "sliding_lever"), np.full(shape, 1e-3))
    return PlainTable(table.position, table.level, knots, knots, **fields, period=table.period, **levers)


def _cheapest(scene: Scene, repeats: int) -> tuple[float, Any]:
    """Return the least CPU seconds of several runs, and a run."""
    times = []
    for _ in range(repeats):
        began = time.process_time()
        run = simulate(scene)
        times.append(time.process_time() - began)
    return min(times), run


def _costs(scenes: Sequence[Scene]) -> dict[str, list[float]]:
    """Return CPU seconds and accepted steps of each."""
    simulate(replace(scenes[0], duration=1e-3))
    runs = [_cheapest(scene, 3) for scene in scenes]
    return {
        "seconds": [seconds for seconds, _ in runs],
        "steps": [float(run.statistics.accepted) for _, run in runs],
    }


def _paired(one: Scene, other: Scene) -> tuple[list[float], float]:
    """Return the least CPU seconds of both, run in turns, and whether their forces agree to the last bit."""
    best, runs = [np.inf, np.inf], [simulate(one), simulate(other)]
    for _ in range(REPEATS):
        for which, scene in enumerate((one, other)):
            seconds, runs[which] = _cheapest(scene, 1)
            best[which] = min(best[which], seconds)
    return best, float(np.array_equal(runs[0].mesh_force, runs[1].mesh_force))
