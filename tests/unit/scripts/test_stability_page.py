"""The page of the hard scenes holds each scene, and the random pairs that were run."""

import json
from pathlib import Path
from typing import Any

import stability_page

SCENE: dict[str, Any] = {
    "name": "zero_load",
    "family": "contact",
    "hard_because": "0/0",
    "criterion": "tends to the gap",
    "passed": True,
    "failure": "",
    "figures": {"STE left": 1e-15},
    "bounds": {"STE left": "<= 1e-12"},
    "seconds": 2.0,
    "cpu_seconds": 1.5,
}
FIGURES = {
    "points": 5,
    "most iterations": 7.0,
    "largest residual": 1e-15,
    "CPU time, s": 1.0,
    "predicted CPU time, s": 2.0,
}


def _made(folder: Path) -> str:
    (folder / "scenes.json").write_text(json.dumps({"scenes": [SCENE]}))
    page = folder / "page.md"
    stability_page.main(folder, page)
    return page.read_text()


def test_a_scene_is_an_entry_with_its_figures_and_bounds(tmp_path):
    page = _made(tmp_path)
    assert "- **`zero_load`** (1.5 CPU s). 0/0 *Criterion:* tends to the gap *Figures:* STE left" in page
    assert max(map(len, page.splitlines())) <= stability_page.LINE
    assert "Random pairs" not in page


def test_sweeps_in_the_folder_are_counted(tmp_path):
    (tmp_path / "sweep-plane.jsonl").write_text(json.dumps({"end": "table", "figures": FIGURES}) + "\n")
    page = _made(tmp_path)
    assert page.startswith("# Stability\n")
    assert "| in the plane | 1 | 1 | 0 | 0 | 5 | 7 |" in page
