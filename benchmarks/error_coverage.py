"""Do the stated errors cover the finest solution? Drawn pairs on the meshes draft and standard."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np

from benchmarks.assessed import Assessed, coverage_figures, coverage_table, error_cell
from benchmarks.drawn_pairs import assessed_pairs, in_plane
from benchmarks.figures import Figure
from benchmarks.marked_section import MEASURED, replace_section
from benchmarks.pair_cases import PairCase
from benchmarks.stored_runs import finest_run, table_run
from fe_contact.ste.curve_errors import METHOD

PAGE = MEASURED / "accuracy.md"
SECTION = "finest"
SUBJECT = "stated errors against the finest solution"
LEVELS = ("draft", "standard")
SHARED = (METHOD,)
"""Sources of error that the finest solution shares; they are not assessed."""
_COVERAGE = 95.0


def figures() -> list[Figure]:
    """Return the coverage."""
    return coverage_figures(assessed(), SUBJECT, _COVERAGE)


@cache
def assessed() -> tuple[Assessed, ...]:
    """Hold every pair at every level against its finest solution; runs are stored."""
    return tuple(assess(case, level) for case in assessed_pairs() for level in LEVELS)


@cache
def in_full() -> tuple[Assessed, ...]:
    """Return the same tables with all that they state, the shared sources included."""
    return tuple(assess(case, level, ()) for case in assessed_pairs() for level in LEVELS)


def assess(case: PairCase, level: str, without: tuple[str, ...] = SHARED) -> Assessed:
    """Hold one table against the finest solution of its pair, some of its sources left out."""
    run = table_run(case, level=level)
    true = np.abs(run.value - finest_run(case))
    return Assessed(case.name, _kind(case, level), run.value, run.stated(*without), true)


def _kind(case: PairCase, level: str) -> str:
    """Name model and mesh."""
    if in_plane(case):
        return f"corrected plane, {level}"
    return f"{'helical' if case.pair.base_helix_angle else 'spur over the face'}, {level}"


def markdown(found: Sequence[Assessed], whole: Sequence[Assessed]) -> str:
    """Return the section of accuracy.md; `whole` are the tables with all that they state."""
    groups = {"all, with `method`": list(whole), "all": list(found)}
    groups |= {kind: [one for one in found if one.level == kind] for kind in sorted({o.level for o in found})}
    return coverage_table(groups) + "\n" + _worst(found)


def _worst(found: Sequence[Assessed]) -> str:
    """Every table at the loads where its errors are covered least."""
    lines = [
        "| pair | level | mean: off, % (stated) | peak-to-peak | harmonic 1 |",
        "|---|---|---:|---:|---:|",
    ]
    for one in found:
        cells = [error_cell(one, q, int(np.argmin(one.ratio[q]))) for q in range(3)]
        lines.append(f"| {one.name} | {one.level.rpartition(' ')[2]} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def publish(found: Sequence[Assessed], machine: Mapping[str, str]) -> None:
    """Write the section of the page between its marks; see `markdown`."""
    versions = ", ".join(f"{name} {machine[name]}" for name in ("lineofaction", "numpy", "scipy"))
    replace_section(PAGE, SECTION, f"{markdown(found, in_full())}\nMeasured with {versions}.\n")
