"""The contract of studies: one question, one answer in Python, by the verb and over HTTP, to the last bit.

Every study of the registry has a row in tests/fakes/study_rows.py. Each asks a small question once each way;
what all tests here say is said of these answers. What a study refuses is in test_refusals_of_studies.py.
"""

import csv
import io
import json
import re
import signal
import struct
import tomllib
import uuid
from collections.abc import Callable, Mapping
from contextlib import contextmanager
from html import escape, unescape
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from click import Context
from declared_figures import check_declared
from running_service import until
from small_inputs import small_inputs
from study_rows import ROWS, StudyRow
from study_runs import StudyRuns, unmeasured, without_file
from typer.main import get_command
from typer.testing import CliRunner

from lineofaction.cli.commands import app
from lineofaction.gearbox import workbench
from lineofaction.gearbox.registry import STUDIES, figures_model
from lineofaction.gearbox.stages import PacedFraction
from lineofaction.report.document import write_report
from lineofaction.report.drawing import surface_view
from lineofaction.report.drawing.figure import Table
from lineofaction.report.drawing.page import Page
from lineofaction.report.presentation import presentation_of
from model_studies.progress import stage_name
from service.worker.process import default_registry

pytestmark = pytest.mark.chain  # each question is asked once each way, by the first that reads an answer
LOA = get_command(app)
BEFORE = {"compliance", "contact", "housing"}
"""Stages of the tables and housings of a scene, in Python."""


def check_effects_shown(ledger: Mapping[str, Any], printed: str, report: str) -> None:
    assert len(ledger["entries"]) > 3
    for entry in ledger["entries"]:
        name, on = entry["effect"].replace("_", " "), "yes" if entry["on"] else "no"
        assert f'<th scope="row">{name}</th>' in report
        parts = r"<td>[^<]*" + re.escape(escape(entry["part"])) + rf"[^<]*</td><td>{on}</td>"
        assert re.search(parts, report)
        assert f"<td>{escape(entry['reason'])}" in report
        assert name in printed or not (entry["on"] or entry["possible"])
    assert "<td>nothing</td>" in report and "<td>0 µm at" not in report
    for name in ledger["left_out"]:
        assert name.replace("_", " ") in report


@pytest.fixture(scope="module")
def table():
    return workbench.analyze(small_inputs("analyze")["case"])


@pytest.fixture(scope="module", params=ROWS, ids=str)
def runs(request, tmp_path_factory, served):
    row: StudyRow = request.param
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(surface_view, "ACROSS", 90)  # pictures of surfaces are coarse
        yield StudyRuns(row, tmp_path_factory.mktemp(row.registered.package), served)


def verb_writes(runs: StudyRuns) -> None:
    """Skip what the verb of `listen` does not do: it is not made from the row, and writes sounds of runs."""
    if runs.study.name == "listen":
        pytest.skip("loa listen takes runs and writes sounds: tests/api/test_housed_runs_over_http.py")


def test_every_study_has_a_row_for_each_of_its_subjects():
    rows = {(row.study, row.subject) for row in ROWS}
    assert rows == {(s.name, subject) for s in STUDIES.values() for subject in s.takes.subject.split(" or ")}
    csv_rows = {row.study for row in ROWS if row.columns is not None}
    assert csv_rows == {study.name for study in STUDIES.values() if ".csv" in study.endings}


# The same figures each way.


def test_figures_are_in_the_units_of_their_names(runs, table):
    figures, result = runs.python.figures, runs.python.result
    pairs = list(runs.row.witness(figures, result, table))
    assert len(pairs) >= 2
    for told, expected in pairs:
        if isinstance(expected, float | np.ndarray) or np.asarray(expected).dtype.kind == "f":
            np.testing.assert_allclose(told, expected, rtol=1e-9, atol=1e-12)
        else:
            assert told == expected


def test_the_verb_prints_the_figures_of_python_as_json(runs):
    verb_writes(runs)
    printed, figures = runs.printed, without_file(runs.python.figures)
    assert unmeasured(without_file(printed), runs.row.own) == unmeasured(figures, runs.row.own)
    check_declared(runs.study.kind, printed)
    assert isinstance(printed["warnings"], list)


def test_a_job_has_the_figures_of_python(runs):
    told, figures = runs.job.figures, without_file(runs.python.figures)
    assert unmeasured(without_file(told), runs.row.own) == unmeasured(figures, runs.row.own)
    check_declared(runs.study.kind, told)
    assert told["hash"] == runs.job.key
    own = runs.study.run.warnings(runs.python.result) or []
    assert told["warnings"] == [*runs.job.status["warnings"], *own][: len(told["warnings"])]


def test_measured_times_are_there(runs):
    def times(value):
        inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
        for entry in inner:
            yield from times(entry)
        if isinstance(value, dict):
            for name, entry in value.items():
                parts = entry.values() if isinstance(entry, dict) else (entry,)
                if name in ("cpu_seconds", "seconds"):
                    yield from (part for part in parts if isinstance(part, int | float))

    if runs.study.name not in ("sensitivity", "listen"):  # tell none
        assert max(times(runs.python.figures)) > 0.0
        assert max(times(runs.job.figures)) > 0.0


# What the verb writes and prints.


def read_nc(runs: StudyRuns, file: Path, _printed: str) -> None:
    assert file.read_bytes()[1:4] == b"HDF"
    back = without_file(runs.study.run.figures(runs.study.run.file.read(file)))
    expected = without_file(runs.printed)
    assert unmeasured(json.loads(json.dumps(back)), runs.row.own) == unmeasured(expected, runs.row.own)
    page = runs.folder / "page.html"
    write_report(file, page)
    headlines_shown(runs.page, page.read_text("utf-8"))


def read_json(runs: StudyRuns, file: Path, _printed: str) -> None:
    told = json.loads(file.read_text("utf-8"))
    assert told == without_file(runs.printed) | {"warnings": runs.printed["warnings"]}


def read_png(_runs: StudyRuns, file: Path, _printed: str) -> None:
    content = file.read_bytes()
    assert content[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = struct.unpack(">II", content[16:24])
    assert width > 1000 and height > 300


def read_html(runs: StudyRuns, file: Path, printed: str) -> None:
    text = file.read_text("utf-8")
    assert text.startswith("<!DOCTYPE html>")
    headlines_shown(runs.page, text)
    for figure in pictures(runs.page):
        assert f'<figure id="{figure}">' in text
    ledger = runs.printed.get("effect_ledger")
    if isinstance(ledger, dict):
        check_effects_shown(ledger, printed, text)


def read_csv(runs: StudyRuns, file: Path, _printed: str) -> None:
    text = file.read_text("utf-8")
    assert runs.verb("--csv").stdout == text
    rows = list(csv.DictReader(io.StringIO(text)))
    assert runs.row.columns is not None
    columns = runs.row.columns(runs.printed)
    assert set(columns) <= set(rows[0]), list(rows[0])
    for name, expected in columns.items():
        told = [row[name] for row in rows]
        if isinstance(expected[0], str):
            assert told == expected
        else:
            assert list(map(float, told)) == pytest.approx(expected, rel=1e-5, abs=1e-12), name


def read_vtu(_runs: StudyRuns, file: Path, _printed: str) -> None:
    surface = meshio.read(file)
    assert len(surface.points) > 3 and {cells.type for cells in surface.cells} <= {"triangle", "triangle6"}
    fields = [*surface.point_data.values(), *(part for each in surface.cell_data.values() for part in each)]
    assert fields and all(np.isfinite(field).all() for field in fields)


def read_toml(_runs: StudyRuns, file: Path, _printed: str) -> None:
    assert tomllib.loads(file.read_text("utf-8"))


READERS: dict[str, Callable[[StudyRuns, Path, str], None]] = {
    ".nc": read_nc,
    ".json": read_json,
    ".png": read_png,
    ".html": read_html,
    ".csv": read_csv,
    ".vtu": read_vtu,
    ".toml": read_toml,
}


def pictures(page: Page) -> list[str]:
    return [figure.key for section in page.sections for figure in section.figures]


def headlines_shown(page: Page, text: str) -> None:
    """Check that a page has its title and its main results."""
    shown = unescape(text)
    assert page.title in shown
    for headline in page.headlines:
        assert headline.name in shown and headline.value in shown


def test_every_ending_of_the_registry_says_the_same(runs):
    verb_writes(runs)
    for ending in runs.study.endings:
        file, printed = runs.written(ending)
        READERS[ending](runs, file, printed)
        assert str(file) in printed or runs.study.folder


def test_the_terminal_shows_tables_headlines_and_files(runs):
    verb_writes(runs)
    shown = presentation_of(runs.study)
    file, printed = runs.written(".nc")
    lines = printed.strip().splitlines()
    told = " ".join(printed.split())
    for part in shown.text(runs.python.result):
        if isinstance(part, Table) and "cost" not in part.caption.lower():
            assert " ".join(part.caption.split()) in told
            words = {word for head in part.head for word in head.split()}  # a long head wraps in its column
            assert words <= set(told.split())
    said = {part for part in list(shown.text(runs.python.result))[:2] if isinstance(part, str)}
    headlines = [
        one for one in runs.page.headlines if said.isdisjoint((one.value, f"{one.name}: {one.value}"))
    ]
    assert lines[-1].startswith("written to ") and str(file) in lines[-1]
    assert re.match(r"cost [\d.e+]+ CPU s", lines[-2])
    if point := shown.point(runs.python.result):
        assert lines.pop(0) == point
    for headline, line in zip(headlines[:2], lines, strict=False):
        assert line.startswith(f"{headline.name}: {headline.value}")
    for words in runs.row.ends:
        assert any(re.match(words, line) for line in lines[:4]), lines[:4]


def test_strict_ends_by_whether_there_are_warnings(runs, tmp_path):
    """Of the question, and of one whose subject is implausible; files carry what is printed."""
    verb_writes(runs)
    assert runs.printed  # the result that both are told of
    for subject, known in ((runs.subject, runs.printed["warnings"]), (implausible(runs), None)):
        file, output = tmp_path / "subject.json", tmp_path / ("out" if runs.study.folder else "out.json")
        file.write_text(json.dumps(subject), encoding="utf-8")
        done = runs.verb("--strict", "--json", "-o", output, subject=file)
        told = json.loads(done.stdout)["warnings"]
        assert told if known is None else told == known
        assert done.exit_code == (3 if told else 0)
        written = output / f"{runs.study.folder}.json" if runs.study.folder else output
        assert json.loads(written.read_text("utf-8"))["warnings"] == told
    assert f"error: {len(told)} warning" in done.stderr and "under --strict" in done.stderr


def implausible(runs: StudyRuns) -> Any:
    """Return the subject with a tip relief in millimeters, or with what an import left out."""
    if runs.row.subject == "scene":
        return runs.subject | {"left_out": ["shaft 5 (line 143): nothing joins it to the train"]}
    relieved = runs.subject["pair"]["pinion"] | {"tip_relief_um": 0.02, "tip_relief_length_mm": 0.2}
    return runs.subject | {"pair": runs.subject["pair"] | {"pinion": relieved}}


def test_the_help_says_what_every_option_is_and_has_an_example(runs):
    command = LOA.get_command(Context(LOA), runs.study.name)
    text = CliRunner().invoke(app, [runs.study.name, "--help"], terminal_width=400).stdout
    told = "".join(text.split())
    assert f"Example: loa {runs.study.name}" in text
    assert "".join(runs.study.description.split()) in told or runs.study.name == "listen"
    for option in command.params:
        if option.param_type_name == "option":
            assert all(name in text for name in option.opts)
            assert option.help and "".join(option.help.split())[:60] in told, option.name
    if not runs.study.takes.from_file and runs.study.name != "listen":
        for name, field in runs.study.inputs.model_fields.items():
            assert field.description and "".join(field.description.split())[:60] in told, name


# What can go wrong by the verb.


def test_an_interrupted_verb_says_so_and_leaves_no_file(runs, monkeypatch):
    """It reports progress, and Ctrl-C is heeded there; who can end with the best so far writes that."""
    verb_writes(runs)
    own = {name for name, _ in runs.study.stages}
    seen: list[str] = []

    @contextmanager
    def interrupting(_stages):
        def report(stage, _fraction):
            seen.append(stage)
            if stage in own and seen.count(stage) == 1:
                signal.raise_signal(signal.SIGINT)

        yield report

    monkeypatch.setattr("lineofaction.cli.run_study.progress_bar", interrupting)
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    output = runs.folder / ("stopped" if runs.study.folder else "stopped.nc")
    try:
        done = runs.call(runs.inputs, "-o", output)
    finally:
        signal.signal(signal.SIGINT, handler)
    assert own & set(seen)
    assert done.exit_code == 130 and "interrupted" in done.stderr, done.output
    if not runs.study.run.interruptible:
        assert done.stdout == "" and not list(runs.folder.glob("stopped*"))


def test_outputs_that_cannot_be_are_refused_before_the_work(runs, monkeypatch):
    verb_writes(runs)
    monkeypatch.setattr(runs.study.run, "compute", None)  # called: a defect, exit code 5
    for name in ("x.odd", "no/such/x.nc"):
        done = runs.call(runs.inputs, "-o", runs.folder / name)
        assert (done.exit_code, done.stdout) == (2, "")
        (line,) = done.stderr.strip().splitlines()
        assert line.startswith("error: output = ")
        assert name != "x.odd" or all(ending in line for ending in runs.study.endings)
        assert not (runs.folder / name).exists()


def test_another_kind_of_file_is_refused_with_what_it_holds(runs, tmp_path):
    verb_writes(runs)
    if " or " in runs.study.takes.subject:
        return
    other = {"case": "scene", "scene": "case"}[runs.row.subject]
    file = tmp_path / "other.json"
    process = "modes" if other == "scene" else "analyze"
    file.write_text(json.dumps(small_inputs(process)[other]), encoding="utf-8")
    done = runs.call(runs.inputs, subject=file)
    assert (done.exit_code, done.stdout) == (2, "")
    (line,) = done.stderr.strip().splitlines()
    assert f"must be a {runs.row.subject}" in line and f"It holds a {other}" in line


# The job.


def test_a_job_is_served_as_figures_as_its_file_and_as_a_report(runs):
    job, http = runs.job, runs.served.http
    figures = figures_model(runs.study.kind).model_validate_json(json.dumps(job.figures))
    runs.served.has_figures_and_file(runs.study.kind, figures, job.status["jobID"])
    report = http.get(f"/v1/results/{job.key}/figures").json()
    shown = presentation_of(runs.study).page(runs.python.result)
    keys = [figure["key"] for section in report["sections"] for figure in section["figures"]]
    # the page draws the unit itself
    assert keys == [key for key in pictures(shown) if not key.startswith("unit_")]
    if runs.study.name not in (
        "frontier",
        "study",
        "listen",
    ):  # headlines with costs, with a hash
        told = [(line["name"], line["value"]) for line in report["headlines"]]
        assert told == [(line.name, line.value) for line in shown.headlines]


def test_its_process_is_listed_and_described(runs):
    name, http = runs.study.name, runs.served.http
    assert name in [process["id"] for process in http.get("/v1/processes").json()["processes"]]
    inputs = http.get(f"/v1/processes/{name}").json()["inputs"]
    assert set(inputs) == {*runs.study.takes.subject.split(" or "), *runs.study.inputs.model_fields}


def test_progress_goes_through_the_stages_and_never_falls(runs):
    stages = default_registry()[runs.study.name].stages
    declared = [stage.name for stage in stages]
    reported = list(dict.fromkeys(stage_name(stage).partition(",")[0] for stage, _ in runs.python.reported))
    own = [stage for stage in reported if stage in declared and stage not in BEFORE - {"compliance"}]
    assert own and own == sorted(own, key=declared.index)
    assert set(reported) <= {*declared, *BEFORE}
    paced = PacedFraction(stages)
    done = [paced.at(*step, float(at)) for at, step in enumerate(runs.python.reported)]
    known = [part for part in done if part is not None]
    assert known == sorted(known)
    progress = [event["progress"] for event in runs.job.events]
    assert progress == sorted(progress) and progress[-1] == 100
    assert {event["stage"] for event in runs.job.events if event["stage"]} <= set(declared)
    assert runs.job.status["processID"] == runs.study.name


def test_the_same_question_is_one_result_however_it_is_put(runs):
    """Defaults written out, and another order of names; with a key the same request is one job."""
    varied = {name: value for name, value in runs.body.items() if name != runs.row.subject}
    whole = runs.study.inputs.model_validate_json(json.dumps(varied)).model_dump(mode="json")
    again = runs.execute(dict(reversed(({runs.row.subject: runs.subject} | whole).items())))
    assert (again.status_code, again.json()["status"]) == (201, "successful")
    assert again.json()["jobID"] != runs.job.status["jobID"]
    assert runs.served.client.result(again.json()["jobID"]).key == runs.job.key
    name = {"Idempotency-Key": str(uuid.uuid4())}
    first, second = runs.execute(runs.body, **name), runs.execute(runs.body, **name)
    assert first.json()["jobID"] == second.json()["jobID"]
    other = runs.execute({**runs.body, runs.row.subject: changed(runs)}, **name)
    assert (other.status_code, other.json()["errors"][0]["field"]) == (422, "Idempotency-Key")


def changed(runs: StudyRuns) -> Any:
    """Return another subject, whose question nobody has asked."""
    if runs.row.subject == "case":
        relieved = runs.subject["pair"]["pinion"] | {"tip_relief_um": 1.0, "tip_relief_length_mm": 0.2}
        return runs.subject | {"pair": runs.subject["pair"] | {"pinion": relieved}}
    return runs.subject | {"loads": [runs.subject["loads"][0] | {"torque_n_m": [0.75]}]}


def test_a_dismissed_job_has_no_result(runs):
    http = runs.served.http
    entered = runs.execute({**runs.body, runs.row.subject: changed(runs)})
    assert (entered.status_code, entered.json()["status"]) == (201, "accepted"), entered.text
    place = entered.headers["location"]
    assert http.delete(place).json()["status"] == "dismissed"
    gone = http.get(f"{place}/results")
    assert (gone.status_code, gone.headers["content-type"]) == (410, "application/problem+json")
    assert gone.json()["type"].endswith("job-dismissed")
    counts = http.app.state.context.submissions.counts
    until(lambda: not {"accepted", "running"} & set(counts()))
    assert http.get(place).json()["status"] == "dismissed"


def test_the_client_reads_the_result_that_python_has(runs):
    client, result = runs.served.client, runs.python.result
    process = getattr(client, runs.study.package)
    further = {"run": runs.body["run"]} if runs.study.name == "listen" else {}
    if runs.study.takes.from_file:
        job = process.submit(runs.subject, runs.inputs)
    else:
        job = process.submit(runs.subject, **runs.inputs, **further)
    found = job.result()
    assert type(found) is type(result)
    told = json.loads(json.dumps(runs.study.run.figures(found)))
    assert unmeasured(told, runs.row.own) == unmeasured(runs.python.figures, runs.row.own)
    assert job.figures().model_dump(mode="json", by_alias=True, exclude_unset=True) == runs.job.figures
