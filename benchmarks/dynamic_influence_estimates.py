"""Are influences of dynamic effects estimated well? Every effect of many scenes toggled in time."""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.assessed_influence import (
    FACTOR,
    FLOOR,
    SHARE,
    AssessedEffect,
    InfluenceStudy,
    by_effect,
    per_cent_right,
    within_factor,
)
from benchmarks.dynamic_influence_cases import example_scenes, influence_scenes
from benchmarks.figures import Figure
from benchmarks.influence_estimates import PAGE
from benchmarks.marked_section import replace_section
from dynamics.ablation import EffectAblation, RunFigures, ablate
from dynamics.influence import decide_effects
from dynamics.influence.level_change import BearingForces, decibels
from dynamics.scene import Scene
from dynamics.types import FloatArray

SECTION = "dynamic influence estimates"
TOLERANCES = (0.01, 0.05, 0.2)
STUDY = InfluenceStudy(
    "influence estimates of dynamic effects against ablation",
    "scene and effect",
    "any quantity",
    ("mean DTE", "peak-to-peak DTE", "bearing forces"),
    TOLERANCES,
)
"""Means and peak-to-peak values are those of the mesh, and bearing forces (mesh orders 1 to 5 together, over
the largest in the scene) those of the bearing, of the largest measured change."""


LEVEL_FLOOR, LEVEL_SHARE = 0.1, 90.0
"""dB below which both changes of a level count as nothing, and the share that has to be right, %."""


@dataclass(frozen=True)
class AssessedLevel(AssessedEffect):
    """The same, and the change of the level of what the scene is computed for, dB: stated and computed."""

    quantity: str = ""
    decibels: tuple[float, float] = (0.0, 0.0)

    @property
    def level_right(self) -> bool:
        """Whether both agree within a factor 2 and in sign."""
        return within_factor(*self.decibels, LEVEL_FLOOR)

    @property
    def decided_by(self) -> float:
        """Largest measured change of what "auto" decides by: where sound is computed, of its amplitude."""
        if self.quantity == BearingForces().name:
            return super().decided_by
        return float(abs(10.0 ** (self.decibels[1] / 20.0) - 1.0))

    @property
    def level_cell(self) -> str:
        """Column of a row: stated / computed, bold where it is not right."""
        text = " / ".join(f"{value:+.2g}" for value in self.decibels)
        return text if self.level_right else f"**{text}**"


def figures() -> list[Figure]:
    """Return how often the estimates are right."""
    found = assessed()
    wrong = [100.0 * (1.0 - right) for right in (_levels_right(found), _levels_right(_seen(found)))]
    words = f"levels beyond a factor {FACTOR:g}"
    return [
        *STUDY.counts(found),
        Figure(STUDY.subject, words, wrong[0], "%", 100.0 - LEVEL_SHARE),
        Figure(
            STUDY.subject, f"{words}, of changes above {LEVEL_FLOOR:g} dB", wrong[1], "%", 100.0 - LEVEL_SHARE
        ),
    ]


def _seen(found: Sequence[AssessedLevel]) -> list[AssessedLevel]:
    return [one for one in found if max(map(abs, one.decibels)) >= LEVEL_FLOOR]


def _levels_right(found: Sequence[AssessedLevel]) -> float:
    """Return the share of levels within a factor 2."""
    return float(np.mean([one.level_right for one in found])) if found else 1.0


@cache
def assessed() -> tuple[AssessedLevel, ...]:
    """Toggle all effects of all scenes, once: some five CPU minutes."""
    with tempfile.TemporaryDirectory() as folder:
        return tuple(study({**influence_scenes(Path(folder)), **example_scenes()}))


def study(scenes: Mapping[str, Scene]) -> list[AssessedLevel]:
    """Toggle every effect of every scene."""
    found = []
    for name, scene in scenes.items():
        sys.stderr.write(f"  {name}\n")
        requested = {tolerance: replace(scene, tolerance=tolerance) for tolerance in TOLERANCES}
        left = {tolerance: set(decide_effects(one).neglected) for tolerance, one in requested.items()}
        for entry in ablate(scene).effects:
            off_at = tuple(tolerance for tolerance in TOLERANCES if entry.name in left[tolerance])
            found.append(assess(name, entry, off_at))
    return found


def assess(name: str, entry: EffectAblation, off_at: tuple[float, ...] = ()) -> AssessedLevel:
    """Compare the estimate of one effect with its ablation; what was not estimated counts as nothing."""
    whole, without, estimate = entry.with_effect, entry.without_effect, entry.estimate
    measured = [
        entry.mean_change / whole.mean,
        entry.peak_to_peak_change / whole.peak_to_peak,
        (_bearings(without) - _bearings(whole)) / max(float(np.max(_bearings(whole), initial=0.0)), 1e-300),
    ]
    estimated = [np.zeros(values.size) for values in measured]
    if estimate is not None:
        estimated = [
            estimate.mean / whole.mean,
            estimate.peak_to_peak / whole.peak_to_peak,
            estimate.bearing_force / max(float(np.max(_bearings(whole), initial=0.0)), 1e-300),
        ]
    pairs = [_largest(e, m) for e, m in zip(estimated, measured, strict=True)]
    own = tuple(e for e, _ in pairs), tuple(m for _, m in pairs), off_at
    stated = entry.level if estimate is None else estimate.level
    levels = stated.decibels, _level_at(entry, stated.order)
    return AssessedLevel(name, entry.name, *own, stated.quantity, levels)


def _level_at(entry: EffectAblation, order: float) -> float:
    """Return the measured change at an order, dB: of two alike changes the estimate may name the other."""
    whole, without = (figures.lines for figures in (entry.with_effect, entry.without_effect))
    if order not in whole or order not in without:
        return entry.level_change.decibels
    return decibels(math.sqrt(whole[order]), math.sqrt(without[order]))


def _largest(estimated: FloatArray, measured: FloatArray) -> tuple[float, float]:
    """Return both changes where the measured one is largest; 0 of a scene without bearings."""
    if not measured.size:
        return 0.0, 0.0
    k = int(np.argmax(np.abs(measured)))
    return float(estimated[k]), float(measured[k])


def _bearings(run: RunFigures) -> FloatArray:
    """Mesh orders 1 to 5 together of every bearing, N."""
    return np.asarray(np.sqrt(np.sum(run.bearing_orders**2, axis=1)))


def markdown(found: Sequence[AssessedLevel]) -> str:
    """Return the section of influence.md."""
    scenes = list(dict.fromkeys(one.where for one in found))
    head = (
        f"{len(found)} ablations in time: {len(scenes)} scenes, every effect that can be switched in them.\n"
        f"**{per_cent_right(found):.0f} %** have mean, peak-to-peak and bearing forces right "
        f"within a factor {FACTOR:g} and in sign (target {SHARE:g} %);\n"
        f"changes below {100 * FLOOR:g} % count as zero.\n\n"
    )
    visible, quantities = _seen(found), {one.where: one.quantity for one in found}
    sounding = sum(name == "sound power" for name in quantities.values())
    head += (
        f"**{100.0 * _levels_right(found):.0f} %** have the level of what the scene is computed for right\n"
        f"within a factor {FACTOR:g} and in sign (target {LEVEL_SHARE:g} %), "
        f"{100.0 * _levels_right(visible):.0f} % of the {len(visible)} that change it by "
        f"{LEVEL_FLOOR:g} dB:\n"
        f"sound power in {sounding} scenes, all bearing forces in {len(quantities) - sounding}.\n\n"
    )
    head += "\n".join(f"- {figure.what}: {figure.value:.2g} %" for figure in STUDY.by_quantity(found))
    return f"{head}\n\n{_table_of_effects(found)}\n{_table_of_scenes(found)}"


def _table_of_effects(found: Sequence[AssessedLevel]) -> str:
    """Return the table of how often the estimates of every effect are right."""
    lines = [
        "| effect | ablations | "
        + " | ".join(f"{name}: right" for name in (*STUDY.quantities, "level"))
        + " |",
        "|---|---:|" + "---:|" * (1 + len(STUDY.quantities)),
    ]
    for effect, group in by_effect(found).items():
        cells = [f"{per_cent_right(group, k):.0f} %" for k in range(len(STUDY.quantities))]
        cells.append(f"{100.0 * _levels_right(group):.0f} %")
        lines.append(f"| {effect} | {len(group)} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _table_of_scenes(found: Sequence[AssessedLevel]) -> str:
    """Every ablation that changes something: estimated / measured change in %."""
    lines = [
        "Change without the effect, estimated / measured in % of the value with it (bearing forces: "
        "of the largest),\nof the level in dB. **Bold** is beyond a factor 2; "
        "ablations without a change of 1 % are omitted.",
        "",
        "| scene | effect | " + " | ".join((*STUDY.quantities, "level, dB")) + " |",
        "|---|---|" + "---:|" * (1 + len(STUDY.quantities)),
    ]
    for one in found:
        if max(map(abs, (*one.estimated, *one.measured))) >= FLOOR:
            lines.append(f"| {one.where} | {one.effect} | {one.cells} | {one.level_cell} |")
    return "\n".join(lines) + "\n"


def publish(found: Sequence[AssessedLevel], machine: dict[str, str]) -> None:
    """Write the section of the page between its marks."""
    versions = ", ".join(f"{name} {machine[name]}" for name in ("lineofaction", "numpy", "scipy"))
    replace_section(PAGE, SECTION, f"{markdown(found)}\nMeasured with {versions}.\n")
