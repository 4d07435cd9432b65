"""Is what effects are worth estimated well? Every effect of many pairs switched over by finite elements."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from benchmarks.honesty_cases import HonestyCase
from benchmarks.worth_cases import worth_cases
from fe_contact.analysis import check_request
from fe_contact.analysis.ablation import EffectAblation, ablate
from fe_contact.analysis.model_choice import decide
from fe_contact.effects import FaceLoadDistribution, FiniteWidth

PAGE = Path(__file__).parents[1] / "docs" / "effects" / "worth.md"
MARKS = ("<!-- figures: written by scripts/bench --publish -->", "<!-- end of figures -->")
SUBJECT = "worth estimates of effects against ablation"
FLOOR = 0.01
"""Relative change below which both count as nothing: the usual tolerance, and the error of a draft."""
FACTOR, SHARE = 2.0, 80.0
QUANTITIES = ("mean", "peak-to-peak")
TOLERANCES = (0.01, 0.05)
"""At which the decisions of "auto" are judged."""


@dataclass(frozen=True)
class JudgedWorth:
    """One effect of one case at one load: relative changes by leaving it out, estimated and measured.

    `off_at` are the tolerances at which "auto" leaves it off.
    """

    case: str
    effect: str
    load: float
    estimated: tuple[float, float]
    measured: tuple[float, float]
    off_at: tuple[float, ...] = ()

    @property
    def right(self) -> tuple[bool, bool]:
        """Whether mean and peak-to-peak are within a factor two."""
        return within_factor(self.estimated[0], self.measured[0]), within_factor(
            self.estimated[1], self.measured[1]
        )


def within_factor(estimated: float, measured: float, floor: float = FLOOR) -> bool:
    """Whether two changes agree in sign and within a factor two, or are both nothing."""
    if max(abs(estimated), abs(measured)) < floor:
        return True
    return estimated * measured > 0.0 and 1.0 / FACTOR <= abs(estimated / measured) <= FACTOR


def figures() -> list[Figure]:
    """Return how often the estimates are right."""
    return counts(judged())


@cache
def judged() -> tuple[JudgedWorth, ...]:
    """Switch all effects of all cases over, once: about five CPU minutes."""
    with tempfile.TemporaryDirectory() as folder:
        return tuple(study(worth_cases(), Path(folder)))


def study(cases: Sequence[HonestyCase], folder: Path) -> list[JudgedWorth]:
    """Switch every effect of every case over."""
    found = []
    for case in cases:
        sys.stderr.write(f"  {case.name}\n")
        made = ablate(case.pair, normal_forces=case.forces, level="draft", cache=folder, **case.options)
        asked = {"normal_forces": case.forces, **case.options}
        wishes = {tol: check_request(case.pair, tolerance=tol, **asked) for tol in TOLERANCES}
        decided = {tol: decide(wish, folder).checked.decided for tol, wish in wishes.items()}
        for entry in made.effects:
            off_at = tuple(tol for tol in TOLERANCES if left_off(decided[tol], entry.name))
            found += _judged(case, entry, off_at)
    return found


def left_off(decided: Mapping[str, str], name: str) -> bool:
    """Whether an effect is off; three dimensions hold the finite width by themselves."""
    held = name == FiniteWidth.name and decided[FaceLoadDistribution.name] == "on"
    return decided[name] == "off" and not held


def _judged(case: HonestyCase, entry: EffectAblation, off_at: tuple[float, ...]) -> list[JudgedWorth]:
    """One effect at every load."""
    if entry.estimate is None:
        return []
    whole = entry.with_effect
    measured = (entry.mean_change / whole.mean, entry.peak_to_peak_change / whole.peak_to_peak)
    estimated = (entry.estimate.mean / whole.mean, entry.estimate.peak_to_peak / whole.peak_to_peak)
    return [
        JudgedWorth(
            case.name,
            entry.name,
            load,
            (float(estimated[0][k]), float(estimated[1][k])),
            (float(measured[0][k]), float(measured[1][k])),
            off_at,
        )
        for k, load in enumerate(case.loads)
    ]


def counts(found: Sequence[JudgedWorth]) -> list[Figure]:
    """Return how often the estimates are right."""
    wrong = 100.0 * float(np.mean([not all(one.right) for one in found]))
    rows = [
        Figure(SUBJECT, "ablations (case, effect and load)", float(len(found)), "-"),
        Figure(SUBJECT, "mean or peak-to-peak beyond a factor 2", wrong, "%", 100.0 - SHARE),
    ]
    for k, name in enumerate(QUANTITIES):
        seen = [one for one in found if max(abs(one.estimated[k]), abs(one.measured[k])) >= FLOOR]
        wrong = 100.0 * float(np.mean([not one.right[k] for one in seen]))
        what = f"{name}: beyond a factor 2, of the {len(seen)} changes above {100 * FLOOR:g} %"
        rows.append(Figure(SUBJECT, what, wrong, "%", 100.0 - SHARE))
    return rows + [_left_off(found, tolerance) for tolerance in TOLERANCES]


def _left_off(found: Sequence[JudgedWorth], tolerance: float) -> Figure:
    """Return the largest change of mean or peak-to-peak by an effect that "auto" leaves off."""
    off = [one for one in found if tolerance in one.off_at]
    worst = max((abs(change) for one in off for change in one.measured), default=0.0)
    what = f"largest change by what auto leaves off at {100 * tolerance:g} % ({len(off)} ablations)"
    return Figure(SUBJECT, what, 100.0 * worst, "%", 100.0 * tolerance)


def markdown(found: Sequence[JudgedWorth]) -> str:
    """Return the section of docs/effects/worth.md."""
    cases = list(dict.fromkeys(one.case for one in found))
    right = 100.0 * float(np.mean([all(one.right) for one in found]))
    head = (
        f"## Measured\n\n{len(found)} ablations: {len(cases)} pairs, every effect that they hold, two loads "
        f"(0.3 and 1 of the rated one), finite elements of the level draft.\n"
        f"**{right:.0f} %** have mean and peak-to-peak right within a factor {FACTOR:g} and in sign (target "
        f"{SHARE:g} %); changes below {100 * FLOOR:g} % count as nothing.\n\n"
    )
    seen = [one for one in counts(found) if "beyond a factor 2, of" in one.what]
    head += "".join(f"{figure.what[0].upper()}{figure.what[1:]}: {figure.value:.2g} %.\n" for figure in seen)
    left = [_left_off(found, tolerance) for tolerance in TOLERANCES]
    head += "".join(f"{figure.what[0].upper()}{figure.what[1:]}: {figure.value:.2g} %.\n" for figure in left)
    head += "\n"
    return head + _table_of_effects(found) + "\n" + _table_of_cases(found)


def _table_of_effects(found: Sequence[JudgedWorth]) -> str:
    """How often the estimates of every effect are right, and the spread of the ratio where it can be seen."""
    lines = [
        "| effect | ablations | mean: right | median estimated / measured | peak-to-peak: right | median |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for effect in dict.fromkeys(one.effect for one in found):
        group = [one for one in found if one.effect == effect]
        cells = []
        for k in range(2):
            share = 100.0 * float(np.mean([one.right[k] for one in group]))
            seen = [one.estimated[k] / one.measured[k] for one in group if abs(one.measured[k]) >= FLOOR]
            cells.append(f"{share:.0f} % | {f'{np.median(seen):.2f}' if seen else ''}")
        lines.append(f"| {effect} | {len(group)} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _table_of_cases(found: Sequence[JudgedWorth]) -> str:
    """Every ablation at the full load: estimated / measured change in % of the value with the effect."""
    lines = [
        "What leaving an effect out changes at the rated load, estimated / measured in % of the value.",
        "**Bold** is beyond a factor 2.",
        "",
        "| case | effect | mean | peak-to-peak |",
        "|---|---|---:|---:|",
    ]
    largest = max(one.load for one in found)
    for one in found:
        if one.load == largest:
            cells = []
            for k in range(2):
                text = f"{100.0 * one.estimated[k]:+.2g} / {100.0 * one.measured[k]:+.2g}"
                cells.append(text if one.right[k] else f"**{text}**")
            lines.append(f"| {one.case} | {one.effect} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def publish(found: Sequence[JudgedWorth], machine: dict[str, str]) -> None:
    """Write the section of the page between its marks."""
    page = PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition(MARKS[0])
    _, _, after = rest.partition(MARKS[1])
    versions = ", ".join(f"{name} {machine[name]}" for name in ("lineofaction", "numpy", "scipy"))
    section = f"{MARKS[0]}\n{markdown(found)}\nMeasured with {versions}.\n{MARKS[1]}"
    PAGE.write_text(before + section + after, encoding="utf-8")
