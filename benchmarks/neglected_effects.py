"""Cost of neglected effects: runs with effects off against registries that do not know them."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from statistics import median
from unittest import mock

from benchmarks.example_pair import TORQUES
from benchmarks.figures import Figure
from benchmarks.run_up import SCENE
from dynamics.assembly import assemble
from dynamics.effects import EFFECTS as SCENE_EFFECTS
from dynamics.effects import RotorEffect
from dynamics.scene import Scene
from dynamics.simulation import simulate
from fe_contact import Gear, GearPair, analyze
from fe_contact.analysis.request import request
from fe_contact.effects import EFFECTS
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.subjects import scene_of

SUBJECT = "neglected effects against a build without them, CPU time"
GEAR = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
PAIR = GearPair(GEAR, GEAR, center_distance=80e-3)
REPEATS = 15
"""Pairs of runs; the median of the ratios counts."""


def figures() -> list[Figure]:
    """Return the difference in CPU time of a table and of a run, and between runs that are alike."""
    found = [("table, compliance cached", _table), ("run of dynamics", _run)]
    rows = []
    for name, of in found:
        without, alike = of()
        rows.append(Figure(SUBJECT, f"{name}: with effects off over without", without, "%"))
        rows.append(Figure(SUBJECT, f"{name}: scatter, the same run against itself", alike, "%"))
    return rows


def _table() -> tuple[float, float]:
    """Compare tables of a plain spur pair, seven effects off."""
    idle = ("profile_modification", "lead_modification", "misalignment", "pitch_error")
    idle += ("shaft_deflection", "thin_rim", "bore_seat")
    remaining = tuple(effect for effect in EFFECTS if effect.name not in idle)
    with tempfile.TemporaryDirectory() as folder:

        def run() -> None:
            analyze(PAIR, torques=[10.0, 100.0], level="draft", receipt="minimal", cache=Path(folder))

        return _compared(run, [mock.patch.object(request, "EFFECTS", remaining)])


def _run() -> tuple[float, float]:
    """Compare the start of the example run-up, the effects of meshes off."""
    scene = _scene()
    on_rotors = tuple(effect for effect in SCENE_EFFECTS if isinstance(effect, RotorEffect))
    patches = [mock.patch.object(assemble, "EFFECTS", on_rotors)]
    return _compared(lambda: simulate(scene), patches)


def _scene() -> Scene:
    """Return the start of the example scene on a draft of its table."""
    given, _ = scene_of(SCENE)
    table = analyze(PAIR, torques=list(TORQUES), level="draft", receipt="minimal")
    return replace(dynamic_scene(given, {mesh.name: table for mesh in given.meshes}), duration=0.3)


def _compared(run: Callable[[], object], patches: Sequence[mock._patch[object]]) -> tuple[float, float]:
    """Return medians of the relative differences in %: as it is over without, and as it is over itself."""
    run()
    without, alike = [], []
    for _ in range(REPEATS):
        first, second = _seconds(run), _seconds(run)
        with ExitStack() as stack:
            for patch in patches:
                stack.enter_context(patch)
            bare = _seconds(run)
        without.append(100.0 * (second / bare - 1.0))
        alike.append(100.0 * (second / first - 1.0))
    return median(without), median(alike)


def _seconds(run: Callable[[], object]) -> float:
    """CPU seconds of a run."""
    began = time.process_time()
    run()
    return time.process_time() - began
