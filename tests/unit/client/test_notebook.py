"""What a notebook shows of a result, and of jobs that are waited for."""

import json
from typing import Any
from xml.etree import ElementTree as Xml

import pytest
from small_table import small_table
from stored_jobs import state

from lineofaction.client import JobState, Report
from lineofaction.report.document import stored_figures


@pytest.fixture(scope="module")
def answer(tmp_path_factory):
    file = tmp_path_factory.mktemp("table") / "table.nc"
    small_table().to_netcdf(file)
    found: dict[str, Any] = json.loads(json.dumps(stored_figures({"file": str(file)})))
    return found


def test_a_report_shows_its_figures_and_its_tables(answer):
    page = Xml.fromstring(f"<div>{Report.model_validate(answer)._repr_html_()}</div>")  # well-formed
    text = "".join(page.itertext())
    for headline in answer["headlines"]:
        assert headline["value"] in text
    shown = {each.findtext("summary") for each in page.iter("details")}
    filled = [s["title"] for s in answer["sections"] if any(t["rows"] for t in s["tables"] + s["folded"])]
    assert shown == set(filled) and "Accuracy of the table" in shown


def test_a_report_says_what_it_is_told_and_runs_nothing(answer):
    nasty = answer | {"title": "<script>alert(1)</script>", "alarms": ["a < b"]}
    html = Report.model_validate(nasty)._repr_html_()
    assert "<script" not in html and "&lt;script&gt;" in html and "a &lt; b" in html


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(None, ""), (0.0, "0 s left"), (99.4, "99 s left"), (100.0, "2 min left"), (7200.0, "2.0 h left")],
)
def test_a_state_is_told_in_a_line(seconds, said):
    running = JobState.from_json(state("j", "running") | {"remaining_s": seconds})
    assert str(running) == ", ".join(filter(None, ("analyze: mesh", "10 %", said)))
    assert str(JobState.from_json(state("j", "successful") | {"remaining_s": seconds})) == "analyze: done"
    assert str(JobState.from_json(state("j", "accepted"))) == "analyze: waits"
    assert str(JobState.from_json(state("j", "dismissed"))) == "analyze: dismissed"
