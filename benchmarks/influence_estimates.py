"""Is the influence of effects estimated well? Every effect of many pairs toggled by finite elements."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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
)
from benchmarks.figures import Figure
from benchmarks.influence_cases import influence_cases
from benchmarks.marked_section import MEASURED, replace_section
from benchmarks.pair_cases import PairCase
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request_check import check_request
from fe_contact.analysis.studies.ablation import EffectAblation, ablate
from fe_contact.effects.face_load_distribution import FaceLoadDistribution
from fe_contact.effects.finite_width import FiniteWidth
from fe_contact.effects.influence.estimate import EstimatedInfluence, estimate_influences
from fe_contact.options import Run

PAGE = MEASURED / "influence.md"
SECTION = "influence estimates"
TOLERANCES = (0.01, 0.05)
STUDY = InfluenceStudy(
    "influence estimates of effects against ablation",
    "case, effect and load",
    "mean or peak-to-peak",
    ("mean", "peak-to-peak"),
    TOLERANCES,
)


@dataclass(frozen=True)
class LoadedInfluence(AssessedEffect):
    """An influence at one load, in parts of the rated one."""

    load: float = 1.0


def figures() -> list[Figure]:
    """Return how often the estimates are right."""
    return STUDY.counts(assessed())


@cache
def assessed() -> tuple[LoadedInfluence, ...]:
    """Switch all effects of all cases over, once: about five CPU minutes."""
    with tempfile.TemporaryDirectory() as folder:
        return tuple(study(influence_cases(), Path(folder)))


def study(cases: Sequence[PairCase], folder: Path) -> list[LoadedInfluence]:
    """Switch every effect of every case over."""
    found = []
    for case in cases:
        sys.stderr.write(f"  {case.name}\n")
        made = ablate(case.pair, *case.request(level="draft"), Run(cache=folder))
        checked = check_request(case.pair, *case.request(level="draft"))
        names = [entry.name for entry in made.effects]
        estimates = estimate_influences(checked.request.scene, checked.decision, names)
        wishes = {
            tol: check_request(case.pair, *case.request(tolerance=AllowedError(tol))) for tol in TOLERANCES
        }
        decision = {tol: decide(wish, folder).checked.decision for tol, wish in wishes.items()}
        for entry in made.effects:
            off_at = tuple(tol for tol in TOLERANCES if is_neglected(decision[tol], entry.name))
            found += _assessed(case, entry, estimates[entry.name], off_at)
    return found


def is_neglected(decision: Mapping[str, str], name: str) -> bool:
    """Whether an effect is off; three dimensions hold the finite width by themselves."""
    included = name == FiniteWidth.name and decision[FaceLoadDistribution.name] == "on"
    return decision[name] == "off" and not included


def _assessed(
    case: PairCase, entry: EffectAblation, estimate: EstimatedInfluence | None, off_at: tuple[float, ...]
) -> list[LoadedInfluence]:
    """One effect at every load."""
    if estimate is None:
        return []
    whole = entry.with_effect
    measured = (entry.mean_change / whole.mean, entry.peak_to_peak_change / whole.peak_to_peak)
    estimated = (estimate.mean / whole.mean, estimate.peak_to_peak / whole.peak_to_peak)
    return [
        LoadedInfluence(
            case.name,
            entry.name,
            (float(estimated[0][k]), float(estimated[1][k])),
            (float(measured[0][k]), float(measured[1][k])),
            off_at,
            load,
        )
        for k, load in enumerate(case.loads)
    ]


def markdown(found: Sequence[LoadedInfluence]) -> str:
    """Return the section of influence.md."""
    cases = list(dict.fromkeys(one.where for one in found))
    head = (
        f"{len(found)} ablations: {len(cases)} pairs, every effect that they hold, two loads "
        f"(0.3 and 1 of the rated one), finite elements of the level draft.\n"
        f"**{per_cent_right(found):.0f} %** have mean and peak-to-peak right within a factor {FACTOR:g} and "
        f"in sign (target {SHARE:g} %); changes below {100 * FLOOR:g} % count as zero.\n\n"
    )
    head += "\n".join(f"- {figure.what}: {figure.value:.2g} %" for figure in STUDY.by_quantity(found))
    return f"{head}\n\n{_table_of_effects(found)}\n{_table_of_cases(found)}"


def _table_of_effects(found: Sequence[LoadedInfluence]) -> str:
    """Return the table of how often the estimates of every effect are right, and of their spread."""
    lines = [
        "| effect | ablations | mean: right | median estimated / measured | peak-to-peak: right | median |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for effect, group in by_effect(found).items():
        cells = []
        for k in range(2):
            ratios = [one.estimated[k] / one.measured[k] for one in group if abs(one.measured[k]) >= FLOOR]
            median = f"{np.median(ratios):.2f}" if ratios else ""
            cells.append(f"{per_cent_right(group, k):.0f} % | {median}")
        lines.append(f"| {effect} | {len(group)} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _table_of_cases(found: Sequence[LoadedInfluence]) -> str:
    """Every ablation at the full load: estimated / measured change in % of the value with the effect."""
    lines = [
        "Change without the effect at the rated load, estimated / measured in % of the value.",
        "**Bold** is beyond a factor 2.",
        "",
        "| case | effect | mean | peak-to-peak |",
        "|---|---|---:|---:|",
    ]
    largest = max(one.load for one in found)
    lines += [f"| {one.where} | {one.effect} | {one.cells} |" for one in found if one.load == largest]
    return "\n".join(lines) + "\n"


def publish(found: Sequence[LoadedInfluence], machine: dict[str, str]) -> None:
    """Write the section of the page between its marks."""
    versions = ", ".join(f"{name} {machine[name]}" for name in ("lineofaction", "numpy", "scipy"))
    replace_section(PAGE, SECTION, f"{markdown(found)}\nMeasured with {versions}.\n")
