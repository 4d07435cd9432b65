"""Cost of the derivatives of a curve over the curve alone, and their distance from central differences."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from fe_contact import FlankModification, Gear, GearPair, analyze
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.stored_bodies import condensed_pair
from fe_contact.microgeometry.curve_derivatives import curve_derivatives
from fe_contact.microgeometry.variables import modified
from fe_contact.types import FloatArray

SUBJECT = "derivatives of a helical curve of 64 by 12 figures of the flanks"
TORQUES = np.array([50.0])
FLANKS = (
    "tip_relief",
    "tip_relief_length",
    "profile_crowning",
    "profile_slope",
    "helix_crowning",
    "helix_slope",
)
NAMES = tuple(f"{gear}.{name}" for gear in ("pinion", "wheel") for name in FLANKS)
TURNS = 9
STEP = 1e-9
MAX = 1.5
"""Largest CPU time of the derivatives over that of the curve alone."""


def figures() -> list[Figure]:
    """Measure by turns in one process."""
    with tempfile.TemporaryDirectory() as folder:
        bodies = condensed(Path(folder))
    pair = bodies.checked.request.pair
    curve_derivatives(bodies, pair, TORQUES, NAMES)  # compiles and assembles
    alone, more = [], []
    for _ in range(TURNS):
        alone.append(seconds(lambda: bodies.solve(pair, TORQUES)))
        more.append(seconds(lambda: curve_derivatives(bodies, pair, TORQUES, NAMES)))
    found = curve_derivatives(bodies, pair, TORQUES, NAMES).by
    off = [difference(bodies, name, by) for name, by in zip(NAMES, found, strict=True)]
    return [
        Figure(SUBJECT, "curve and derivatives over the curve alone", min(more) / min(alone), "times", MAX),
        Figure(SUBJECT, "curve alone", 1e3 * min(alone), "ms", None),
        Figure(SUBJECT, "off central differences, median of the worst", max(off), "of the largest", None),
    ]


def condensed(folder: Path) -> CondensedPair:
    """Return the bodies of a relieved and crowned pair on draft meshes."""
    flank = FlankModification(
        tip_relief=15e-6, tip_relief_length=0.8e-3, profile_crowning=2e-6, helix_crowning=6e-6
    )
    gears = (
        Gear(
            teeth=teeth,
            normal_module=1.8e-3,
            face_width=30e-3,
            bore_diameter=20e-3,
            helix_angle=math.radians(angle),
            modification=flank,
        )
        for teeth, angle in ((23, 22.0), (67, -22.0))
    )
    pair = GearPair(*gears)
    table = analyze(pair, torques=TORQUES, level="draft", receipt="minimal", cache=folder)
    found = condensed_pair(pair, table, {}, folder)
    if found is None:
        raise RuntimeError("the compliance that was just computed is not in its cache")
    return found


def seconds(work: Callable[[], object]) -> float:
    """CPU seconds of a call."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def difference(bodies: CondensedPair, name: str, by: FloatArray) -> float:
    """Return the median difference from central differences over positions, over the largest derivative."""
    pair = bodies.checked.request.pair
    gear, _, quantity = name.partition(".")
    value = getattr(getattr(pair, gear).modification, quantity)
    ends = [modified(pair, {name: value + way * STEP}) for way in (1.0, -1.0)]
    one, other = (bodies.solve(end, TORQUES).solution.deflection for end in ends)
    return float(np.median(np.abs((one - other) / (2.0 * STEP) - by)) / np.abs(by).max())
