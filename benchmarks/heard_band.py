"""A run at 24 000 rpm on elastic shafts in the audio band, and against one that resolves ten orders."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from dynamics.loads import TimeLaw
from dynamics.results import RunResult
from dynamics.scene import Scene
from dynamics.simulation import simulate
from dynamics.types import FloatArray
from lineofaction.cli.scene_tables import tabled_scene
from lineofaction.gearbox.subjects import scene_of

EXAMPLE = Path(__file__).parents[1] / "examples" / "flexible_shafts_scene.toml"
SPEED = 24_000.0 * math.pi / 30.0
TEETH = 20
SECONDS, COMPARED = 0.1, 0.02
WIDE = 1e6
"""Wide band, Hz; it leaves ten orders whole."""


def figures() -> list[Figure]:
    """Return the time of the run, that of the wide one, and how far audible orders differ."""
    given, folder = scene_of(EXAMPLE)
    scene = tabled_scene(given, folder, None, lambda _stage, _fraction: None).scene
    drives = tuple(replace(drive, speed=TimeLaw.constant(SPEED)) for drive in scene.drives)
    fast = replace(scene, drives=drives, duration=SECONDS)
    short = replace(fast, duration=COMPARED)
    wide = replace(short, outputs=replace(short.outputs, band=WIDE))
    for warm in (fast, wide):
        simulate(replace(warm, duration=0.1 * COMPARED))
    seconds, _ = _timed(fast)
    narrow_seconds, narrow = _timed(short)
    wide_seconds, resolved = _timed(wide)
    subject = f"24 000 rpm of {TEETH} teeth on two elastic shafts"
    return [
        Figure(subject, f"{SECONDS:g} s, default", seconds, "CPU s", 3.0),
        Figure(subject, f"{COMPARED:g} s, ten orders over audio band", wide_seconds / narrow_seconds, "-"),
        Figure(subject, "orders below 20 kHz, largest difference", _difference(narrow, resolved), "dB", 0.1),
    ]


def _timed(scene: Scene) -> tuple[float, RunResult]:
    """Return the CPU time of a run, and the run."""
    began = time.process_time()
    run = simulate(scene)
    return time.process_time() - began, run


def _difference(narrow: RunResult, wide: RunResult) -> float:
    """Return the largest change of levels of bearing forces and transmission error, orders 1 and 2, dB."""
    levels = []
    for run in (narrow, wide):
        force = np.sqrt(np.sum(_orders(run, run.bearing_force[:, :3]) ** 2, axis=(0, 1)))
        levels.append(20.0 * np.log10([force, _orders(run, run.dynamic_transmission_error)[0]]))
    return float(np.max(np.abs(levels[0] - levels[1])))


def _orders(run: RunResult, series: FloatArray) -> FloatArray:
    """Return the amplitudes (..., 2) of orders 1 and 2 in the second half of a run, Blackman's window."""
    inside = (run.time > 0.4 * COMPARED) & (run.time < 0.97 * COMPARED)
    moment, weight = run.time[inside], np.blackman(np.count_nonzero(inside))
    omega = SPEED * TEETH * np.array([1.0, 2.0])
    wave = np.exp(-1j * omega[:, None] * moment) * (weight / np.sum(weight))
    return np.asarray(2.0 * np.abs(series[..., inside] @ wave.T))
