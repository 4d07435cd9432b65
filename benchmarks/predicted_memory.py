"""Predicted against measured peak memory of runs, one process each, since peaks never fall."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from statistics import median

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

_CODE = """
import math
from pathlib import Path
from fe_contact import Gear, GearPair, analyze

def pair(first, second, module, modules, helix=0.0, bore=0.5):
    def gear(teeth, angle):
        return Gear(teeth=teeth, normal_module=module, face_width=modules * module,
                    bore_diameter=bore * teeth * module, helix_angle=angle)
    distance = 0.5 * (first + second) * module / math.cos(helix)
    return GearPair(gear(first, helix), gear(second, -helix), distance)

gears = pair{sizes}
rated = 60.0 * gears.face_width * gears.pinion.normal_module * 1e6
forces = [rated * (k + 1) / {loads} for k in range({loads})]
receipt = analyze(gears, normal_forces=forces, cache=Path({cache!r}), **{options}).metadata.receipt
measured = {{"predicted": receipt["prediction"]["memory_bytes"], "peak": receipt["peak_memory_bytes"]}}
"""
_SKEWS = {"positions": 64, "misalignments": [-20e-6, -10e-6, 0.0, 10e-6, 20e-6]}
_DISTANCES = {"positions": 64, "center_distance_changes": [0.0, 1e-4, 2e-4, 3e-4, 4e-4]}
CASES: tuple[tuple[str, tuple[float, ...], int, dict[str, object]], ...] = (
    ("2-D", (18, 25, 2e-3, 5.0), 2, {"level": "draft"}),
    ("2-D", (27, 90, 2e-3, 12.0), 2, {"level": "standard"}),
    ("2-D", (40, 110, 2e-3, 10.0, 0.0, 0.6), 2, {"model": "plane_strain", "level": "fine"}),
    ("2-D", (22, 47, 3e-3, 10.0, 0.0, 0.6), 2, {"level": "fine"}),
    ("2-D", (20, 40, 2.5e-3, 12.0), 12, {"model": "plane_strain", **_DISTANCES}),
    ("3-D", (19, 24, 2e-3, 4.0), 2, {"model": "3d", "level": "draft"}),
    ("3-D", (32, 33, 2e-3, 6.0, 0.15), 2, {"level": "draft"}),
    ("3-D", (39, 40, 2.5e-3, 12.0, 0.2), 12, {"level": "draft", **_SKEWS}),
    ("3-D", (20, 29, 2e-3, 6.0, 0.35), 2, {"tolerance": 0.01}),
    ("3-D", (21, 28, 3e-3, 6.0), 2, {"model": "3d", "level": "standard"}),
    ("3-D", (24, 24, 3e-3, 6.0, 0.2), 2, {"level": "standard"}),
    ("3-D", (26, 40, 3e-3, 10.0, 0.3), 2, {"level": "standard"}),
    ("3-D", (20, 29, 2e-3, 4.0, 0.3), 2, {"level": "fine"}),
    ("3-D", (30, 50, 2e-3, 8.0), 2, {"model": "3d", "level": "fine"}),
)
"""Kind, teeth, module, face width in modules, helix angle and bore, loads, options: solid bodies."""


def figures() -> list[Figure]:
    """Return how far predictions are off, with compliances computed and with those of a run before."""
    found = [run for case in CASES for run in _runs(*case)]
    subject = f"predicted peak memory, {len(found)} runs"
    ratios = [max(predicted / peak, peak / predicted) for _, predicted, peak in found]
    beyond = 100.0 * sum(ratio > 1.5 for ratio in ratios) / len(ratios)
    rows = [
        Figure(subject, "off by more than a factor 1.5", beyond, "% of runs", 20.0),
        Figure(subject, "worst factor", max(ratios), "x", 3.0),
        Figure(subject, "median of predicted over measured", median(p / m for _, p, m in found), "x"),
    ]
    for kind in dict.fromkeys(kind for kind, _, _ in found):
        part = [ratio for (name, _, _), ratio in zip(found, ratios, strict=True) if name == kind]
        rows.append(Figure(subject, f"median factor, {kind} ({len(part)} runs)", median(part), "x"))
        rows.append(Figure(subject, f"worst factor, {kind}", max(part), "x", 3.0))
    return rows


def _runs(
    kind: str, sizes: tuple[float, ...], loads: int, options: dict[str, object]
) -> Iterator[tuple[str, float, float]]:
    """Yield kind, predicted and measured bytes of a run, and of one that finds its compliances."""
    with tempfile.TemporaryDirectory() as cache:
        code = _CODE.format(sizes=sizes, loads=loads, cache=cache, options=options)
        for name in (kind, f"{kind} cached"):
            run = measure(code)
            yield name, run["predicted"], run["peak"]
