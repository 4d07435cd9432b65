"""Do the stated errors hold? Tables of many pairs against the finest rung."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from benchmarks.finest_rung import FACE_POSITIONS, PLANE_FACTOR, PLANE_POSITIONS, SLICES
from benchmarks.held_out_cases import held_out_face_cases, held_out_plane_cases
from benchmarks.honesty_cases import HonestyCase, face_cases, plane_cases
from benchmarks.marked_section import replace_section
from benchmarks.measured_rungs import RungOf, measured, needs_face, truth
from fe_contact.types import FloatArray

PAGE = Path(__file__).parents[1] / "docs" / "accuracy.md"
SECTION = "honesty"
QUANTITIES = ("mean", "peak-to-peak", "first harmonic")
SUBJECT = "error estimates against the finest rung"
_SHARE, _MEDIAN = 90.0, 3.0


@dataclass(frozen=True)
class Judged:
    """One case on one rung: value, stated and true error (3 quantities, loads) in m; `flanks` by name."""

    case: str
    level: str
    value: FloatArray
    stated: FloatArray
    true: FloatArray
    flanks: str = ""

    @property
    def held_out(self) -> bool:
        """Whether no constant was set on the pair."""
        return self.case in {case.name for case in (*held_out_plane_cases(), *held_out_face_cases())}

    @property
    def in_plane(self) -> bool:
        """Whether the plane stands in for three dimensions."""
        return self.level.startswith("corrected")

    @property
    def ratio(self) -> FloatArray:
        """Stated over true errors (3, loads); true errors below 1e-5 of the value count as that."""
        return np.asarray(self.stated / np.maximum(self.true, 1e-5 * self.value))


def figures() -> list[Figure]:
    """Return the counts."""
    return counts(judged())


@cache
def judged() -> tuple[Judged, ...]:
    """Judge all cases; what is measured already is not measured again."""
    return tuple(study([*plane_cases(), *face_cases(), *held_out_plane_cases(), *held_out_face_cases()]))


def study(cases: Sequence[HonestyCase]) -> list[Judged]:
    """Hold every case on each of its rungs against the finest one of its model."""
    return [found for case in cases for found in _judged(case)]


def _judged(case: HonestyCase) -> Iterator[Judged]:
    """Hold a case against the finest rung."""
    exact = truth(case)
    for rung in judged_rungs(case):
        found = measured(case, rung)
        yield Judged(case.name, rung.name, found.value, found.stated, np.abs(found.value - exact))


def judged_rungs(case: HonestyCase) -> list[RungOf]:
    """Return the rungs of a case whose estimates are judged."""
    if needs_face(case):
        return [RungOf("3d", "draft"), RungOf("3d", "standard"), RungOf("3d", "standard", 23)]
    return [RungOf("corrected", "draft"), RungOf("corrected", "standard")]


def counts(found: Sequence[Judged], subject: str = SUBJECT, kind: str = "pair x level") -> list[Figure]:
    """Return how often the stated errors hold, and how much larger than the true ones they are."""
    ratio = np.concatenate([one.ratio for one in found], axis=1)
    rows = [Figure(subject, f"cases ({kind})", float(len(found)), "-")]
    for name, values in zip(QUANTITIES, ratio, strict=True):
        missed = 100.0 * float(np.mean(values < 1.0))
        rows += [
            Figure(subject, f"{name}: true error beyond the estimate", missed, "%", 100.0 - _SHARE),
            Figure(subject, f"{name}: median over-estimate", float(np.median(values)), "times", _MEDIAN),
        ]
    return rows


def markdown(found: Sequence[Judged]) -> str:
    """Return the section of docs/accuracy.md."""
    pairs, points = len({one.case for one in found}), sum(one.value.shape[1] for one in found)
    flat = sum(one.in_plane for one in found)
    rest = len(found) - flat
    head = (
        f"{pairs} pairs on two or three rungs each: {len(found)} cases ({flat} in the plane, {rest} in three "
        f"dimensions), {points} loads in all, against the finest rung that could be afforded:\n"
        f"in the plane elements {PLANE_FACTOR:g} times as fine as those of the level fine and "
        f"{PLANE_POSITIONS} positions, in three dimensions the mesh of the level fine, {SLICES} slices\n"
        f"and {FACE_POSITIONS} positions. That rung has an error of its own, in three dimensions a third of "
        "that of standard: true errors are that uncertain.\nAll constants of the estimates were set on the "
        "pairs that are not marked; those marked * were held out.\n\n"
    )
    return head + table_of_counts(found) + "\n" + _table_of_cases(found)


def table_of_counts(found: Sequence[Judged]) -> str:
    """Coverage and over-estimate by quantity: all, those held out, and by rung."""
    lines = [
        "| | loads | " + " | ".join(f"{name}: held | median over-estimate" for name in QUANTITIES) + " |",
        "|---|---:|" + "---:|" * (2 * len(QUANTITIES)),
    ]
    groups = {"all": list(found), "held out of every fit": [one for one in found if one.held_out]}
    for name, flat in (("plane", True), ("three dimensions", False)):
        groups[f"{name}, held out"] = [one for one in found if one.held_out and one.in_plane is flat]
    groups |= {
        rung: [one for one in found if one.level == rung] for rung in dict.fromkeys(o.level for o in found)
    }
    for name, group in groups.items():
        if group:
            ratio = np.concatenate([one.ratio for one in group], axis=1)
            cells = [f"{100 * np.mean(row >= 1):.0f} % | {np.median(row):.2g}" for row in ratio]
            lines.append(f"| {name} | {ratio.shape[1]} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + f"\n\nTargets: held in {_SHARE:g} %, median over-estimate {_MEDIAN:g}.\n"


def _table_of_cases(found: Sequence[Judged]) -> str:
    """Worst load of every case: stated and true error in % of the value."""
    lines = [
        "Each case at the load at which its estimate covers least, stated / true error in % of the value:",
        "",
        "| case | rung | " + " | ".join(QUANTITIES) + " |",
        "|---|---|---:|---:|---:|",
    ]
    for one in found:
        cells = []
        for q in range(len(QUANTITIES)):
            k = int(np.argmin(one.ratio[q]))
            stated, true = (100.0 * errors[q, k] / one.value[q, k] for errors in (one.stated, one.true))
            text = f"{stated:.2g} / {true:.2g}"
            cells.append(text if one.ratio[q, k] >= 1.0 else f"**{text}**")
        name = f"{one.case}*" if one.held_out else one.case
        lines.append(f"| {name} | {one.level} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def publish(found: Sequence[Judged], machine: dict[str, str]) -> None:
    """Write the section of the page between its marks."""
    versions = ", ".join(f"{name} {machine[name]}" for name in ("lineofaction", "numpy", "scipy"))
    replace_section(PAGE, SECTION, f"{markdown(found)}\nMeasured with {versions}.\n")
