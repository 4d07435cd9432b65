"""A document says what it is about and whether it suffices, is small, and holds its receipts."""

import json
import re
import tomllib
import zlib
from collections.abc import Sequence
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from command_line import loa
from PIL import Image
from spur_case import spur_case

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import about
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.report import ReportInput
from lineofaction.report import document
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.attaching import attached
from lineofaction.report.drawing.figure import (
    Axis,
    Bars,
    Figure,
    Line,
    Panel,
    counts,
    half_figures,
    panel_rows,
)
from lineofaction.report.drawing.image import panel_sheet, png, still
from lineofaction.report.drawing.interactive import plotly_figure
from lineofaction.report.drawing.page import Headline, Page, Section, html
from lineofaction.report.ste.over_torque import ripple_over_torque
from lineofaction.report.title_block import about_of, titled

RESULTS = (
    Headline("mean STE at 120 N m", "16.65 µm", "± 0.088 µm"),
    Headline("peak-to-peak STE at 120 N m", "0.436 µm", "± 0.020 µm; gears of this width +2 %"),
    Headline("largest pressure at 120 N m", "1366 MPa", "no error is stated for it"),
    Headline("95 % of all pairs below", "0.643 µm", "0.612 to 0.700 with 95 % confidence"),
    Headline("99 % of all pairs below", "0.671 µm", "0.643 to none with 95 % confidence"),
)
PAGE = Page("Gear pair 23/67", "A pair.", RESULTS, ())
ABOUT = {"title": "First stage", "project": "EV", "number": "25-061", "revision": "B", "author": "A. Smith"}


def verdicts(*requirements: str) -> tuple[str, ...]:
    block = titled(PAGE, ReportInput(requirements=list(requirements))).block
    return block.verdicts


@pytest.mark.law
@pytest.mark.parametrize(
    ("requirement", "verdict"),
    [
        ("peak-to-peak STE at most 0.5 µm", "Met: "),
        ("peak-to-peak STE at most 0.457 µm", "Met: "),
        ("peak-to-peak STE at most 0.44 µm", "Open within the error: "),
        ("peak-to-peak STE at most 0.43 µm", "Open within the error: "),
        ("peak-to-peak STE at most 0.4 µm", "Not met: "),
        ("Largest pressure at 120 N m at most 1366 MPa", "Open, no error is stated: "),
        ("largest pressure at least 1400 MPa", "Not met: "),
        ("95 % of all pairs below at most 0.72 µm", "Met: "),
        ("95 % of all pairs below at most 0.65 µm", "Open within the error: "),
        ("95 % of all pairs below at most 0.6 µm", "Not met: "),
        ("99 % of all pairs below at most 2 µm", "Open within the error: "),
        ("99 % of all pairs below at most 0.6 µm", "Not met: "),
    ],
)
def test_a_limit_is_met_only_by_more_than_the_error(requirement, verdict):
    (said,) = verdicts(requirement)
    assert said.startswith(verdict)


def test_a_verdict_is_one_sentence_with_value_error_and_limit():
    (said,) = verdicts("peak-to-peak STE at most 0.5 µm")
    assert said == "Met: peak-to-peak STE at 120 N m is 0.436 ± 0.020 µm; required is at most 0.5 µm."


@pytest.mark.law
def test_every_document_names_date_program_hash_author_and_main_result():
    page = titled(replace(PAGE, records={"ste.nc": {"content_hash": "3f2a"}}), None)
    rows = dict(page.block.rows)
    assert set(rows) == {"date", "made with", "hash of the report"}
    assert page.block.verdicts == ("Mean STE at 120 N m is 16.65 ± 0.088 µm; no requirement is stated.",)
    other = titled(replace(PAGE, records={"ste.nc": {"content_hash": "3f2b"}}), None).block
    assert other is not None and dict(other.rows)["hash of the report"] != rows["hash of the report"]


def test_a_requirement_of_nothing_shown_is_an_alarm():
    """Also of one that is named by the end of its name alone, or in another unit."""
    stated = ["sound power at most 80 dB(A)", "mean STE at most 1 mm", "STE at 120 N m at most 1 µm"]
    page = titled(PAGE, ReportInput(requirements=stated))
    assert [text.rpartition(": ")[2] for text in page.alarms] == stated


def test_the_title_block_stands_on_the_first_page_and_its_number_on_all():
    text = html(titled(PAGE, ReportInput(**ABOUT)), {}, still=True)
    for name, value in {"project": "EV", "drawing": "25-061", "revision": "B", "author": "A. Smith"}.items():
        assert f"<dt>{name}</dt><dd>{value}</dd>" in text
    assert "<h1>First stage</h1>" in text
    assert '@top-right { content: "25-061 B"; }' in text
    assert 'content: "page " counter(page) " of " counter(pages)' in text


def test_what_a_limit_is_must_be_said():
    with pytest.raises(ValueError, match="FIGURE at most NUMBER UNIT"):
        ReportInput(requirements=["quiet"])


def test_a_title_block_changes_no_result():
    table = tomllib.loads(spur_case(torques=[10.0]))
    titled_case, plain = (Case.model_validate(content) for content in (table | {"report": ABOUT}, table))
    assert titled_case.report is not None and titled_case.report.project == "EV"
    assert titled_case.model_dump_json() == plain.model_dump_json()


def test_a_folder_has_one_title_block(tmp_path):
    for name in ("one", "two"):
        (tmp_path / f"{name}.toml").write_text(f'[report]\nauthor = "{name}"\n')
    with pytest.raises(BadInput, match="a folder of one"):
        about(tmp_path)
    (tmp_path / "report.toml").write_text('[report]\nauthor = "third"\n')
    file = about(tmp_path)
    assert file is not None and about_of(file).author == "third"
    (tmp_path / "none.toml").write_text("a = 1\n")
    with pytest.raises(BadInput, match="a table"):
        about_of(tmp_path / "none.toml")


def test_a_report_without_interaction_is_small_and_says_its_verdict(tmp_path, database):
    database.to_netcdf(tmp_path / "ste.nc")
    (tmp_path / "report.toml").write_text('[report]\nrequirements = ["peak-to-peak STE at most 90 µm"]\n')
    done = loa("report", tmp_path, "--still")
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines()[-2].startswith("Met: peak-to-peak STE")
    page = tmp_path / "report.html"
    assert page.stat().st_size < 600_000
    text = page.read_text("utf-8")
    assert "Plotly" not in text and 'class="plot"' not in text
    assert len(re.findall(r'<img class="still"', text)) == len(re.findall("<figure", text)) > 5


def figure(*panels: Panel) -> Figure:
    return Figure("key", "Title", "", "", panels)


def curve(label: str = "") -> Panel:
    x = np.linspace(0.0, 2.5, 9)
    line = Line("curve", x, x, palette.BLUE, label=label)
    return Panel(Axis("position"), Axis("STE, µm"), (line,))


def drawing(height: float) -> Panel:
    line = Line("outline", np.array([0.0, 1.0]), np.array([0.0, height]), palette.BLUE)
    return Panel(Axis("mm"), Axis("mm"), (line,), equal=True)


@pytest.mark.law
def test_narrow_panels_stand_side_by_side():
    wide, short = curve("120 N m: mean 5.59 µm"), curve("120 N m")
    assert panel_rows((curve(), short, curve()), 2) == [[0, 1], [2]]
    assert panel_rows((curve(), wide, curve(), curve()), 2) == [[0], [1], [2, 3]]
    assert panel_rows((drawing(1.3), drawing(1.3)), 2) == [[0, 1]]
    assert panel_rows((drawing(0.3), curve()), 2) == [[0], [1]]
    assert panel_rows((curve(), curve()), 1) == [[0], [1]]
    left, right = panel_sheet((curve(), curve()), 2).axes
    assert left.get_position().x1 < right.get_position().x0


def test_small_figures_share_the_width_of_a_page():
    """Alone: of one panel; of two panels beside such a figure; never with long labels or three panels."""
    panels = {
        "one": [curve()],
        "two": [curve()] * 2,
        "three": [curve()] * 3,
        "long": [curve("12.5 N m: mean 9 µm")],
    }
    named = {name: replace(figure(*drawn), key=name) for name, drawn in panels.items()}
    last = replace(named["one"], key="last")
    assert half_figures([*named.values(), last]) == {"one", "two", "last"}
    assert half_figures([named["two"], named["three"]]) == set()
    single, double = (Image.open(BytesIO(png(named[name], half=True))) for name in ("one", "two"))
    assert single.width == double.width == Image.open(BytesIO(png(named["one"]))).width // 2
    assert double.height > single.height


def test_a_still_picture_has_the_size_of_its_sheet_in_a_third_of_the_bytes():
    whole = png(figure(curve(), curve()), across=2)
    small = still(whole)
    assert Image.open(BytesIO(small)).size == Image.open(BytesIO(whole)).size
    assert len(small) < 0.45 * len(whole)


def test_a_page_and_its_images_draw_a_column_of_panels_once(monkeypatch, tmp_path):
    column, row = figure(drawing(0.3), curve()), replace(figure(curve(), curve()), key="row")
    calls: list[tuple[str, int]] = []

    def counted(drawn, across=1, *, half=False):
        calls.append((drawn.key, across))
        return png(drawn, across)

    monkeypatch.setattr(document, "png", counted)
    section = Section("Figures", "Two.", (column, row))
    document.write_page(replace(PAGE, sections=(section,)), tmp_path / "page.html", tmp_path)
    assert calls == [(column.key, 2), ("row", 2), ("row", 1)]
    for drawn in (column, row):
        assert (tmp_path / f"{drawn.key}.png").read_bytes() == png(drawn)


@pytest.mark.law
def test_bars_are_one_artist_within_the_limits_of_single_ones():
    order = np.arange(1.0, 2001.0)
    top = np.where(order % 7 == 0, np.nan, 2.0 + np.cos(order))
    bars = Bars("lines", order, top, 0.5, 0.8, palette.BLUE)
    (axes,) = panel_sheet((Panel(Axis("mesh order"), Axis("µm"), (), bars=(bars,)),)).axes
    assert len(axes.patches) == 0 and len(axes.collections) == 1
    assert np.allclose(axes.dataLim.extents, (0.6, 0.5, 2000.4, np.nanmax(top)))
    assert axes.get_ylim()[0] == 0.5 and axes.get_ylim()[1] > np.nanmax(top)  # they stand on the axis


@pytest.mark.law
def test_orders_have_whole_ticks():
    order = np.arange(1.0, 21.0)
    bars = Bars("lines", order, order, 0.0, 0.8, palette.BLUE)
    spectrum = Panel(Axis("mesh order"), Axis("µm"), (), bars=(bars,))
    assert counts(spectrum, "x") and not counts(spectrum, "y") and not counts(curve(), "x")
    assert plotly_figure(figure(spectrum))["layout"]["xaxis"]["dtick"] == 2
    empty = Panel(Axis("mesh order"), Axis("µm"))
    assert plotly_figure(figure(empty))["layout"]["xaxis"]["dtick"] == 1
    sheet = panel_sheet((spectrum,))
    sheet.draw_without_rendering()
    ticks = sheet.axes[0].get_xticks()
    assert np.array_equal(ticks, np.round(ticks))


@pytest.mark.law
def test_the_first_harmonics_are_told_apart_by_eye(database):
    colors = {line.name: line.color for line in ripple_over_torque(database).content[1].lines}
    assert all(
        max(part) > 80 for part in assert_apart([colors[f"{k}"] for k in range(1, 9)])
    )  # none is near black


def assert_apart(colors: Sequence[str]) -> list[list[int]]:
    """Return the parts of colors that are told apart by eye, on the screen and in a picture of few colors."""
    parts = [[int(color[at : at + 2], 16) for at in (1, 3, 5)] for color in colors]
    assert min(np.abs(np.subtract(a, b)).sum() for i, a in enumerate(parts) for b in parts[:i]) > 60
    at = np.arange(float(len(colors)))
    bars = tuple(Bars(f"{k}", at[k : k + 1], np.ones(1), 0.0, 0.8, color) for k, color in enumerate(colors))
    drawn = Image.open(BytesIO(still(png(figure(Panel(Axis("x"), Axis("y"), bars=bars)))))).convert("RGB")
    held = np.unique(np.asarray(drawn).reshape(-1, 3), axis=0).astype(int)
    assert all(np.abs(held - part).sum(axis=1).min() < 16 for part in parts)
    return parts


@pytest.mark.law
def test_pairs_of_teeth_and_categories_are_told_apart_by_eye():
    assert_apart([palette.category(k) for k in range(6)])
    assert_apart([palette.tooth_pair(k) for k in range(6)])


SIMPLE = (
    b"%PDF-1.4\n1 0 obj\n<</Type /Catalog\n/Pages 2 0 R>>\nendobj\n2 0 obj\n<</Type /Pages\n/Count 0>>\n"
    b"endobj\nxref\n0 3\n0000000000 65535 f \n0000000009 00000 n \n0000000058 00000 n \n"
    b"trailer\n<</Size 3\n/Root 1 0 R>>\nstartxref\n101\n%%EOF\n"
)


@pytest.mark.law
def test_a_file_in_a_pdf_is_found_by_its_table_and_comes_back_as_it_was():
    content = json.dumps({"case": "µm"}).encode()
    whole = attached(SIMPLE, "receipts.json", content)
    assert whole.startswith(SIMPLE)
    start = int(whole[whole.rindex(b"startxref") :].split()[1])
    table = whole[start:]
    assert table.startswith(b"xref\n") and b"/Prev 101" in table
    for number, offset in re.findall(rb"(\d+) 1\n(\d{10}) 00000 n \n", table):
        assert whole[int(offset) :].startswith(number + b" 0 obj\n")
    stream = whole[whole.index(b"/EmbeddedFile\n") :].partition(b"stream\n")[2].partition(b"\nendstream")[0]
    assert zlib.decompress(stream) == content
    with pytest.raises(ValueError, match="names already"):
        attached(whole, "again.json", content)


def test_a_page_that_is_no_document_has_no_title_block():
    assert "drawing</dt>" not in html(replace(PAGE, lead=""), {}, still=True)
