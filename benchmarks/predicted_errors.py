"""Does the plan predict the stated errors of a run? Errors of mean and peak-to-peak in um and per cent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from benchmarks.drawn_pairs import assessed_pairs, fresh_pairs, in_plane
from benchmarks.figures import Figure
from benchmarks.marked_section import MEASURED, replace_section
from benchmarks.pair_cases import PairCase
from benchmarks.stored_runs import StoredRun, table_run
from benchmarks.tolerance_kept import ALLOWED
from fe_contact.allowed_error import RELATIVE

PAGE, SECTION = MEASURED / "accuracy.md", "predicted errors"
SUBJECT = "predicted over stated errors"
FACTOR = 3.0
_WITHIN = 90.0
RUNS: Mapping[str, Mapping[str, object]] = {
    "draft": {"level": "draft"},
    "standard": {"level": "standard"},
    "tolerance": {"tolerance": ALLOWED.relative},
}


@dataclass(frozen=True)
class Predicted:
    """Predicted over stated errors of a run by quantity: "relative", "mean" and "peak-to-peak" in um."""

    name: str
    kind: str
    ratios: Mapping[str, float]


def figures() -> list[Figure]:
    """Return how often predictions are within the factor."""
    rows = [Figure(SUBJECT, "runs", float(len(assessed())), "-")]
    for quantity, ratios in _by_quantity(assessed()).items():
        beyond = 100.0 * float(np.mean([not within(ratio) for ratio in ratios]))
        rows.append(
            Figure(SUBJECT, f"{quantity}: not within a factor {FACTOR:g}", beyond, "%", 100.0 - _WITHIN)
        )
    return rows


@cache
def assessed() -> tuple[Predicted, ...]:
    """Compare the runs of all drawn pairs; they are stored."""
    cases = (*assessed_pairs(), *fresh_pairs())
    return tuple(
        compare(case, name, table_run(case, **accuracy)) for case in cases for name, accuracy in RUNS.items()
    )


def compare(case: PairCase, name: str, run: StoredRun) -> Predicted:
    """Compare the stated errors of a run with the predicted ones, at the worst load."""
    predicted, stated = run.receipt["prediction"]["error"], run.stated()[:2]
    scale = (ALLOWED if name == "tolerance" else RELATIVE).scale(run.value[:2])
    ratios = {"relative": predicted["total"] / float(np.max(stated / scale))}
    if predicted["mean_m"] is not None:
        in_m = zip(
            ("mean", "peak-to-peak"), (predicted["mean_m"], predicted["peak_to_peak_m"]), stated, strict=True
        )
        ratios |= {quantity: value / float(errors.max()) for quantity, value, errors in in_m}
    return Predicted(case.name, f"{'plane' if in_plane(case) else 'over the face'}, {name}", ratios)


def within(ratio: float) -> bool:
    """Whether a prediction is within the factor."""
    return 1.0 / FACTOR <= ratio <= FACTOR


def markdown(found: Sequence[Predicted]) -> str:
    """Return the section of accuracy.md."""
    kinds = ["all", *dict.fromkeys(one.kind for one in found)]
    lines = ["| runs | number | relative | mean, um | peak-to-peak, um |", "|---|---:|---:|---:|---:|"]
    for kind in kinds:
        group = [one for one in found if kind in ("all", one.kind)]
        ratios = _by_quantity(group)
        cells = [_cell(ratios.get(quantity, [])) for quantity in ("relative", "mean", "peak-to-peak")]
        lines.append(f"| {kind} | {len(group)} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _cell(ratios: Sequence[float]) -> str:
    """Return how many ratios are within the factor, and their range."""
    if not ratios:
        return "-"
    return f"{sum(map(within, ratios))} of {len(ratios)}, {min(ratios):.2g} to {max(ratios):.2g}"


def _by_quantity(found: Sequence[Predicted]) -> dict[str, list[float]]:
    """Return the ratios by quantity."""
    ratios: dict[str, list[float]] = {}
    for one in found:
        for quantity, ratio in one.ratios.items():
            ratios.setdefault(quantity, []).append(ratio)
    return ratios


def publish(found: Sequence[Predicted]) -> None:
    """Write the section of the page between its marks."""
    replace_section(PAGE, SECTION, markdown(found))
