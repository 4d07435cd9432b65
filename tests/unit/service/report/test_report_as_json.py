"""The report as JSON: every figure of the page with its words, and a stored ladder drawn as a fresh one."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from fe_contact.analysis.studies.frontier import FidelityResult, Frontier
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.studies.frontier.run import RUN
from lineofaction.report.document import page_json, page_of, read_inputs, stored_figures
from lineofaction.report.effects.frontier import _frontier_page


def rung(name: str, error: float, seconds: float) -> FidelityResult:
    ripple = np.array([1e-6, 2e-6])
    return FidelityResult(
        name, name, seconds, 4.0 * ripple, ripple, 0.01, {"contact": seconds}, 2**28, error, 2.0 * error
    )


LADDER = Frontier(
    (rung("iso6336", 0.2, 0.01), rung("plane_strain", 0.04, 0.3), rung("3d_fine", float("nan"), 60.0)),
    {"corrected": "not asked for"},
    "plane_strain",
    "plane_strain",
    128,
)


def test_a_stored_table_has_the_figures_of_its_report(database: SteDatabase, tmp_path: Path) -> None:
    file = tmp_path / "ste.nc"
    database.to_netcdf(file)
    found = stored_figures({"kind": "database", "file": str(file)})
    page = page_of(read_inputs([file]))
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    drawn = [figure for section in found["sections"] for figure in section["figures"]]
    assert [f["key"] for f in drawn] == [f.key for section in page.sections for f in section.figures]
    assert all(f["alternative"] and f["plot"]["data"] and f["plot"]["layout"] for f in drawn)
    assert [h["value"] for h in found["headlines"]] == [h.value for h in page.headlines]


def test_a_stored_ladder_is_drawn_as_a_fresh_one(tmp_path: Path) -> None:
    file = tmp_path / "frontier.nc"
    RUN.file.write(LADDER, file)
    fresh = page_json(_frontier_page(LADDER))
    assert stored_figures({"kind": "frontier", "file": str(file)}) == fresh
    assert RUN.figures(RUN.file.read(file)) == RUN.figures(LADDER)
