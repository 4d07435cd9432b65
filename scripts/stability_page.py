"""Write the page of stability: the outcomes of the hard scenes, and the counts of the random pairs.

Usage: stability_page.py FOLDER PAGE; FOLDER holds scenes.json and, where `scripts/sweep` has run,
sweep-KIND.jsonl.
"""

from __future__ import annotations

import json
import sys
import textwrap
from collections import Counter
from itertools import groupby
from pathlib import Path
from typing import Any

Json = dict[str, Any]

COMMON = ("failed points", "largest residual", "most iterations", "two solvers apart")
"""Figures of every contact scene: not shown, since the text names their bounds."""
SWEEPS = {"plane": "in the plane", "face": "in three dimensions"}
SWEEP_HEAD = (
    "| random pairs | cases | sound tables | refused | anything else | points solved | most iterations "
    "| largest residual | CPU time over predicted |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|"
)
LINE = 120
"""Longest line of a page."""
HEAD = """# Stability

Cases that are known to break solvers. `loa hardcases` runs the same scenes. A scene passes by its figures:
each has a bound from physics. All contact scenes also ask for no failed point, residuals below 1e-9, at most
40 iterations, and the deflection of the interior-point solver to 1e-8. Scenes in the time domain ask both
integrators to agree to their tolerances and to balance energy to 0.1 % of what was turned over.

## Scenes
"""


def scenes_part(scenes: list[Json]) -> str:
    """Return how many passed, and a list per family."""
    parts = [_summary(scenes)]
    for family, group in groupby(scenes, key=lambda scene: str(scene["family"])):
        rows = "\n".join(_entry(scene) for scene in group)
        parts.append(f"### {family.capitalize()}\n\n{rows}\n")
    return "\n".join(parts)


def sweeps_part(folder: Path) -> str:
    """Return the outcomes of the cases of every sweep, and the names in refusals."""
    rows, named = [], []
    for kind, title in SWEEPS.items():
        file = folder / f"sweep-{kind}.jsonl"
        if file.exists():
            records = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
            rows.append(_sweep_row(title, records))
            named.append(f"{title}: {_refused(records)}.")
    return f"{SWEEP_HEAD}\n" + "\n".join(rows) + "\n\nRefused, by what was named: " + " ".join(named) + "\n"


def _sweep_row(title: str, records: list[Json]) -> str:
    """Write the counts and the worst figures of one sweep."""
    ends = Counter(str(record["end"]) for record in records)
    tables = [record["figures"] for record in records if record["end"] == "table"]
    hardest = max(tables, key=lambda figures: float(figures["most iterations"]))
    late = max(f["CPU time, s"] / (f["predicted CPU time, s"] + 1.0) for f in tables)
    cells = (
        title,
        len(records),
        ends["table"],
        ends["refusal"],
        len(records) - ends["table"] - ends["refusal"],
        f"{sum(int(figures['points']) for figures in tables)}",
        f"{hardest['most iterations']:.0f}",
        f"{max(figures['largest residual'] for figures in tables):.1e}",
        f"{late:.1f}",
    )
    return f"| {' | '.join(map(str, cells))} |"


def _refused(records: list[Json]) -> str:
    """Count the refusals by the standard term or the field they name."""
    texts = (str(record["failure"]) for record in records if record["end"] == "refusal")
    terms = Counter(text.split(" = ")[0].split(": ")[1] for text in texts)
    return ", ".join(f"{term} {count}" for term, count in terms.most_common())


def _summary(scenes: list[Json]) -> str:
    """Say how many passed, and in what time."""
    passed = sum(scene["passed"] for scene in scenes)
    slowest = max(scenes, key=lambda scene: float(scene["cpu_seconds"]))
    total = sum(float(scene["cpu_seconds"]) for scene in scenes)
    return (
        f"{passed} of {len(scenes)} scenes passed, in {total:.0f} s of CPU time in all; "
        f"`{slowest['name']}` takes most, {slowest['cpu_seconds']:.1f} s.\n"
    )


def _entry(scene: Json) -> str:
    """Write one scene as an entry of a list."""
    figures = "; ".join(
        f"{name} {_number(value)}" + (f" ({scene['bounds'][name]})" if name in scene["bounds"] else "")
        for name, value in scene["figures"].items()
        if not name.startswith(COMMON)
    )
    verdict = "" if scene["passed"] else f"**FAILED**: {scene['failure']}; "
    return entry(
        scene["name"],
        scene["hard_because"],
        scene["criterion"],
        verdict + figures,
        f"{scene['cpu_seconds']:.1f}",
    )


def entry(name: str, hard_because: str, criterion: str, figures: str, cpu_seconds: str) -> str:
    """Write an entry of a list in lines of at most `LINE` characters."""
    facts = (
        f"- **`{name}`** ({cpu_seconds} CPU s). {hard_because} *Criterion:* {criterion} *Figures:* {figures}"
    )
    return textwrap.fill(facts, LINE, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def _number(value: float | None) -> str:
    """Write a figure."""
    return "no number" if value is None else f"{value:.3g}"


def main(folder: Path, page: Path) -> None:
    """Write the page; sweeps that are not in the folder have no part."""
    scenes = json.loads((folder / "scenes.json").read_text(encoding="utf-8"))["scenes"]
    text = f"{HEAD}\n{scenes_part(scenes)}"
    if any((folder / f"sweep-{kind}.jsonl").exists() for kind in SWEEPS):
        text += f"\n## Random pairs\n\n{sweeps_part(folder)}"
    page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
