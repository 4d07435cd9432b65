"""What a notebook shows of a result, and of jobs that are waited for."""

from __future__ import annotations

import io
import json
from itertools import pairwise
from typing import Any
from xml.etree import ElementTree as Xml

import pytest
from rich.console import Console
from small_table import small_table
from stored_jobs import state

from lineofaction.client import JobState, Report, progress_bars
from lineofaction.client.report import BOTTOM, TOP, Axis
from lineofaction.report.document.as_json import stored_figures


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
    curves = [line.attrib["points"].split() for line in drawing.iter("polyline")]
    figures = {figure["title"]: figure for section in answer["sections"] for figure in section["figures"]}
    shown_one = figures[page.findtext(".//figcaption") or ""]
    assert "scaleanchor" not in shown_one["plot"]["layout"]["xaxis"]  # no drawing, which it would distort
    drawn = [t for t in shown_one["plot"]["data"] if t.get("yaxis", "y") == "y"]
    assert 1 <= len(curves) <= len(drawn) and all(len(points) > 100 for points in curves)
    heights = [float(point.split(",")[1]) for points in curves for point in points]
    assert min(heights) == pytest.approx(TOP) and max(heights) == pytest.approx(BOTTOM)  # they fill it
    words = {text.text for text in drawing.iter("text")}
    layout = shown_one["plot"]["layout"]
    assert layout["yaxis"]["title"]["text"] in words
    assert {layout[name]["title"]["text"] for name in layout if name.startswith("xaxis")} & words
    assert {trace["name"] for trace in drawn if trace.get("name")} <= words
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
                facts = {"progress": progress, "remaining_s": 100.0 - progress, "title": f"[{job}]"}
                watch(JobState.from_json(state(job, "running") | facts))
    drawn = console.file.getvalue()  # type: ignore[attr-defined]
    last = drawn[drawn.rindex("1. analyze [one]: mesh") :]
    assert last.count("100 %") == 2 and "2. analyze [two]: mesh" in last and last.count("0 s left") == 2


def test_many_jobs_do_not_fill_the_screen() -> None:
    console = Console(file=io.StringIO(), force_terminal=True, width=120, height=25)
    with progress_bars(console) as watch:
        for number in range(40):
            watch(JobState.from_json(state(f"j{number}", "running")))
            watch(JobState.from_json(state(f"j{number}", "failed" if number == 39 else "successful")))
    drawn = console.file.getvalue()  # type: ignore[attr-defined]
    last = drawn[drawn.rindex("38. analyze: done") :]
    assert "39. analyze: done" in last and "40. analyze: failed" in last and "37. " not in last


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(None, ""), (0.0, "0 s left"), (99.4, "99 s left"), (100.0, "2 min left"), (7200.0, "2.0 h left")],
)
def test_a_state_is_told_in_a_line(seconds: float | None, said: str) -> None:
    running = JobState.from_json(state("j", "running") | {"remaining_s": seconds})
    assert str(running) == ", ".join(filter(None, ("analyze: mesh", "10 %", said)))
    assert str(JobState.from_json(state("j", "successful") | {"remaining_s": seconds})) == "analyze: done"
    assert str(JobState.from_json(state("j", "accepted"))) == "analyze: waits"
    assert str(JobState.from_json(state("j", "dismissed"))) == "analyze: dismissed"


@pytest.mark.parametrize(
    ("low", "high"), [(0.0, 1.0), (-3.2, 2.7), (418.0, 652.0), (1e-9, 7e-9), (-1e6, 3.0)]
)
def test_ticks_are_round_few_and_within(low: float, high: float) -> None:
    ticks = Axis(low, high, 0.0, 100.0).ticks()
    steps = [after - before for before, after in pairwise(ticks)]
    assert 2 <= len(ticks) <= 6 and low - 1e-9 * (high - low) <= ticks[0] <= ticks[-1] <= high * (1 + 1e-9)
    assert f"{steps[0]:.0e}"[0] in "125" and steps == pytest.approx([steps[0]] * len(steps))
    assert Axis(3.0, 3.0, 0.0, 100.0).ticks() == [3.0]
