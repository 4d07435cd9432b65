"""Parts of a time step: the parts of one in compiled loops, and whole runs, for `benchmarks.step_cost`."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.assemble import assemble
from dynamics.forces.elements import evaluate
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.explicit_step import accelerate
from dynamics.integrators.instant_powers import write_powers
from dynamics.integrators.march import march_on, start_march
from dynamics.integrators.stage_parts import set_motion
from dynamics.integrators.state_sink import MemorySink
from dynamics.integrators.workspace import Count, Workspace
from dynamics.kernels.compiled import compiled
from dynamics.motion.motion import add_motion
from dynamics.scene import Scene
from dynamics.simulation import simulate
from fe_contact import analyze
from lineofaction.gearbox.convert.case import analysis_options, gear_pair, table_axes
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.subjects import case_of_mesh, scene_of

EXAMPLES = Path(__file__).parents[1] / "examples"
LOOPS, REPEATS = 1000, 30
FEW = 100.0
"""Samples per second whose cost is lost in that of the steps."""
Part = Callable[[SystemArrays, Workspace, float, int], None]


@compiled
def _motion(system: SystemArrays, work: Workspace, start: float, times: int) -> None:
    for k in range(times):
        set_motion(system, work, start + k * 1e-9, work.local.position)


@compiled
def _coordinates(system: SystemArrays, work: Workspace, start: float, times: int) -> None:
    for _ in range(times):
        add_motion(system, work.q, work.v, work.free_position, work.local.coordinate, work.local.rate)


@compiled
def _laws(system: SystemArrays, work: Workspace, start: float, times: int) -> None:
    for _ in range(times):
        for e in range(system.elements.law.size):
            evaluate(system.elements, work.local, e)


@compiled
def _evaluation(system: SystemArrays, work: Workspace, start: float, times: int) -> None:
    for k in range(times):
        accelerate(system, work, start + k * 1e-9, 1)


@compiled
def _powers(system: SystemArrays, work: Workspace, start: float, times: int) -> None:
    for k in range(times):
        write_powers(system, work, 1, start + k * 1e-9)


PARTS: dict[str, Part] = {
    "motion of the laws and phases": _motion,
    "local coordinates": _coordinates,
    "force laws": _laws,
    "one evaluation": _evaluation,
    "powers at a stage": _powers,
}


def example(stem: str) -> Scene:
    """Return the scene of an example on the tables of its cases."""
    scene, folder = scene_of(EXAMPLES / f"{stem}.toml")
    tables = {}
    for index, mesh in enumerate(scene.meshes):
        case = case_of_mesh(mesh, f"meshes[{index}]", folder)
        assert case is not None
        options = replace(analysis_options(case), receipt="minimal")
        tables[mesh.name] = analyze(gear_pair(case), table_axes(case), options)
    return dynamic_scene(scene, tables)


def measured(stem: str, whole: float, part: float) -> dict[str, Any]:
    """Return ns per part, us per step by method over `part` s, CPU s of runs over `whole` s."""
    scene = example(stem)
    short = replace(scene, duration=part)
    found: dict[str, Any] = {"parts": _parts(short)}
    for method in ("implicit", "explicit"):
        found[method], found[f"{method} alone"] = _per_step(short, method)
    full = replace(scene, duration=whole)
    bare = replace(full, outputs=replace(full.outputs, energy_audit=False, receipt="minimal"))
    for _ in range(2):
        simulate(full)
        simulate(bare)
    costs = [(_cpu(lambda: simulate(full)), _cpu(lambda: simulate(bare))) for _ in range(3)]
    return found | {"default": min(cost[0] for cost in costs), "bare": min(cost[1] for cost in costs)}


def _parts(scene: Scene) -> dict[str, float]:
    """Least ns of each part, in the state at the end of the run."""
    system = assemble(scene)
    march = start_march(system, static_equilibrium(system), scene.integration)
    march_on(march, MemorySink(march.samples, march.widths))
    arrays, work = march.compiled[:2]
    end = float(march.work.time[0])
    found = {}
    for name, part in PARTS.items():
        part(arrays, work, end, 1)
        costs = [_cpu(lambda part=part: part(arrays, work, end, LOOPS)) for _ in range(REPEATS)]  # type: ignore[misc]
        found[name] = 1e9 * min(costs) / LOOPS
    return found


def _per_step(scene: Scene, method: str) -> tuple[float, float]:
    """Least CPU us per step tried, without audit: with its samples, and with next to none."""
    plain = replace(scene, outputs=replace(scene.outputs, energy_audit=False))
    system = assemble(plain)
    bare = replace(system, sampling=replace(system.sampling.points(), rate=FEW, inner_rate=FEW))
    start, integration = static_equilibrium(system), replace(plain.integration, method=method)
    count = integrate(system, start, integration).count
    costs = [
        [_cpu(lambda sampled=sampled: integrate(sampled, start, integration)) for sampled in (system, bare)]  # type: ignore[misc]
        for _ in range(5)
    ]
    steps = float(count[Count.ACCEPTED] + count[Count.REJECTED])
    with_samples, alone = (1e6 * min(cost) / steps for cost in zip(*costs, strict=True))
    return with_samples, alone


def _cpu(call: Callable[[], object]) -> float:
    """Return the CPU seconds of a call."""
    began = time.process_time()
    call()
    return time.process_time() - began
