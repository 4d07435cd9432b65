"""What a notebook shows of a result, and of jobs that are waited for."""

from __future__ import annotations

import io
import json
from typing import Any
from xml.etree import ElementTree as Xml

import pytest
from rich.console import Console
from small_table import small_table
from stored_jobs import state

from service.client import JobState, Report, progress_bars
from service.report.as_json import stored_figures


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return the report on a table as it arrives."""
    file = tmp_path_factory.mktemp("table") / "table.nc"
    small_table().to_netcdf(file)
    found: dict[str, Any] = json.loads(json.dumps(stored_figures({"file": str(file)})))
    return found


def test_a_report_shows_its_figures_a_picture_and_its_tables(answer: dict[str, Any]) -> None:
    page = Xml.fromstring(f"<div>{Report.model_validate(answer)._repr_html_()}</div>")  # well-formed
    text = "".join(page.itertext())
    for headline in answer["headlines"]:
        assert headline["value"] in text
    (drawing,) = page.iter("svg")
    curves = [line.attrib["points"].split() for line in drawing]
    drawn = [t for t in answer["sections"][0]["figures"][0]["plot"]["data"] if t.get("yaxis", "y") == "y"]
    assert 1 <= len(curves) <= len(drawn) and all(len(points) > 100 for points in curves)
    heights = [float(point.split(",")[1]) for points in curves for point in points]
    assert min(heights) == pytest.approx(10.0) and max(heights) == pytest.approx(210.0)  # they fill it
    shown = {each.findtext("summary") for each in page.iter("details")}
    filled = [s["title"] for s in answer["sections"] if any(t["rows"] for t in s["tables"] + s["folded"])]
    assert shown == set(filled) and "Accuracy of the table" in shown


def test_a_report_says_what_it_is_told_and_runs_nothing(answer: dict[str, Any]) -> None:
    nasty = answer | {"title": "<script>alert(1)</script>", "alarms": ["a < b"]}
    html = Report.model_validate(nasty)._repr_html_()
    assert "<script" not in html and "&lt;script&gt;" in html and "a &lt; b" in html


def test_a_bar_follows_every_job() -> None:
    console = Console(file=io.StringIO(), force_terminal=True, width=120)
    with progress_bars(console) as watch:
        for progress in (10, 60, 100):
            for job in ("one", "two"):
                watch(JobState.from_json(state(job, "running") | {"progress": progress}))
    drawn = console.file.getvalue()  # type: ignore[attr-defined]
    assert drawn.count("100%") >= 2 and "analyze mesh" in drawn
