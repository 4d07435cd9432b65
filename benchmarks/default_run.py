"""Cost of a default run over the bare one: a run-up, the same in a housing, a planetary stage."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from benchmarks.figures import Figure
from benchmarks.housed_run import in_housing
from dynamics.influence import neglected_check
from dynamics.scene import Scene
from dynamics.simulation import simulate
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.gearbox.subjects import scene_of

EXAMPLES = Path(__file__).parents[1] / "examples"
TURNS = 5
LIMIT = {"run-up of 5 s": 1.25, "run-up in a housing of 80 modes": 1.25, "planetary stage of 10 s": 1.15}


def figures() -> list[Figure]:
    """Return the ratios of runs in turn, sizes of effects known by content and new ones."""
    run_up, stage = _scene("palermo_scene.toml"), _scene("planetary_scene.toml")
    subjects = {
        "run-up of 5 s": run_up,
        "run-up in a housing of 80 modes": in_housing(run_up),
        "planetary stage of 10 s": replace(stage, duration=10.0),
    }
    return [figure for name, scene in subjects.items() for figure in _ratios(name, scene)]


def _scene(name: str) -> Scene:
    """Return a scene of the examples with its tables."""
    given, folder = scene_of(EXAMPLES / name)
    return tabled_scene(given, folder, None, lambda _stage, _fraction: None).scene


def _ratios(name: str, scene: Scene) -> list[Figure]:
    """Run a scene by default with new and with known sizes, and bare, in turn."""
    bare = replace(scene, outputs=replace(scene.outputs, receipt="minimal", energy_audit=False))

    def first() -> None:
        neglected_check.forget_sizes()
        simulate(scene)

    runs: dict[str, Callable[[], object]] = {
        "first": first,
        "default": lambda: simulate(scene),
        "bare": lambda: simulate(bare),
    }
    for run in (*runs.values(), *runs.values()):  # compiles, and makes the code of the structure
        run()
    turns = [{label: _seconds(run) for label, run in runs.items()} for _ in range(TURNS)]
    seconds = {label: min(turn[label] for turn in turns) for label in runs}
    return [
        Figure(name, "bare", seconds["bare"], "CPU s"),
        Figure(name, "default over bare", seconds["default"] / seconds["bare"], "-", LIMIT[name]),
        Figure(name, "default over bare, sizes of effects new", seconds["first"] / seconds["bare"], "-"),
    ]


def _seconds(run: Callable[[], object]) -> float:
    """Return the CPU time of a run."""
    began = time.process_time()
    run()
    return time.process_time() - began
