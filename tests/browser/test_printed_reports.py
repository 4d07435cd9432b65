"""Reports on paper, page by page: what a reader sees once, whole, and with its head."""

import json
import re
import warnings
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from page_visit import opened, tab, to_print
from printed_pages import Printed, plain
from small_inputs import small_inputs

from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas.report import ReportInput
from lineofaction.report.binding import bound
from lineofaction.report.document import page_of, read_inputs, write_page
from lineofaction.report.drawing.figure import Table
from lineofaction.report.drawing.image import panel_sheet
from lineofaction.report.drawing.page import Page, Part, Section
from lineofaction.report.presentation import presentation_of
from lineofaction.report.title_block import titled

BLOCK = ReportInput(
    project="EV reducer",
    author="A. Smith",
    number="23-067",
    revision="A",
    requirements=["95 % of all pairs below at most 0.7 µm", "mean STE at most 10 µm"],
)


def of_study(name: str) -> Page:
    """Return the report of a study's small question."""
    study, inputs = STUDIES[name], small_inputs(name)
    subject = inputs.pop("scene" if "scene" in inputs else "case")
    with warnings.catch_warnings(action="ignore"):
        result: Any = study.function(subject, inputs)
    return presentation_of(study).page(result)


def of_pair(closed_forms: ModuleType, folder: Path) -> Page:
    """Return the report of a table with the load on its flanks."""
    closed_forms.closed_form().to_netcdf(folder / "ste.nc")
    closed_forms.closed_form_flanks().to_netcdf(folder / "flanks.nc")
    return page_of(read_inputs([folder / "ste.nc", folder / "flanks.nc"]))


def of_unit(closed_forms: ModuleType, folder: Path) -> Page:
    """Return the report of two pairs with their flanks and of the unit that they are in."""
    pairs = {part: of_pair(closed_forms, folder) for part in ("first stage", "second stage")}
    return bound({"": of_study("deflect")} | pairs)


def of_long_table() -> Page:
    """Return a report of a table over pages, whose rows have four lines."""
    words = "a sentence that goes on in its cell, where a page may end; " * 5
    rows = tuple((f"row {index}", words, f"{index}") for index in range(70))
    table = Table("What each row says", ("row", "what it says", "number"), rows)
    return Page("A long table", "Rows of four lines.", (), (Section("Rows", "All.", tables=(table,)),))


WIDTH, MARGIN = 210.0, 15.5
"""Of the paper and beside what is printed on it, mm."""
ROWS = 40
"""Of a table that has room on one page."""


@dataclass(frozen=True)
class Report:
    """A page and what was printed of it."""

    page: Page
    printed: Printed


@pytest.fixture(
    scope="module",
    params=[
        "pair",
        "unit",
        "optimize",
        "scatter",
        "change",
        pytest.param("noise", marks=pytest.mark.nightly),
        "table",
    ],
)
def report(request, browser, closed_forms, tmp_path_factory):
    del browser  # skips where there is none
    folder, name = tmp_path_factory.mktemp("printed"), request.param
    if name == "pair":
        page = of_pair(closed_forms, folder)
    elif name == "unit":
        page = of_unit(closed_forms, folder)
    else:
        page = of_long_table() if name == "table" else of_study(name)
    page = titled(page, BLOCK)
    write_page(page, folder / "report.pdf")
    return Report(page, Printed((folder / "report.pdf").read_bytes()))


def test_a_report_has_few_pages_and_is_small_enough_to_send(report):
    assert len(report.printed.pages) <= 12
    assert report.printed.size < 3_000_000


def test_each_page_has_its_number_the_title_and_the_drawing_and_none_is_empty(report):
    pages = report.printed.pages
    for number, text in enumerate(pages, start=1):
        margins = f"{report.page.title} 23-067 A page {number} of {len(pages)} lineofaction"
        assert text.startswith(margins)
        assert text != margins or report.printed.pictures[number - 1]


def test_no_title_stands_twice(report):
    titles = report.printed.titles()
    assert report.page.title in titles
    assert [title for title, times in Counter(titles).items() if times > 1] == []


def test_what_the_page_shows_is_printed(report):
    titles = set(report.printed.titles())
    shown = [section for section in report.page.sections if section.part is not Part.RECEIPT]
    figures = {figure.title for section in shown for figure in section.figures}
    assert figures <= titles
    assert {table.caption for section in shown for table in section.tables} <= titles


def test_what_is_said_of_the_results_is_printed(report):
    page, printed = report.page, report.printed
    assert page.block is not None and (page.block.verdicts or page.alarms)
    said = [*page.alarms, *page.block.verdicts, *(value for _, value in page.block.rows)]
    said += [words for one in page.headlines for words in (one.name, one.value, one.remark)]
    figures = [figure for section in page.sections for figure in section.figures]
    said += [words for figure in figures for words in (figure.alternative, figure.caption)]
    whole = printed.words(printed.document).replace(" ", "")  # a line may end within a word
    assert [words for words in said if plain(words).replace(" ", "") not in whole] == []


def test_a_picture_is_on_one_page_with_its_words(report):
    figures = [each for each in report.printed.document.all("Figure") if list(each.all("Caption"))]
    assert len(figures) == sum(len(section.figures) for section in report.page.sections)
    assert [report.printed.words(figure) for figure in figures if len(figure.pages) > 1] == []


def test_a_heading_is_on_the_page_of_what_it_heads(report):
    parted = []
    for section in report.printed.document.all("NonStruct"):
        head, *rest = section.children or [section]
        if head.kind == "H2" and rest:
            first = next(rest[0].all("TR", "P", "Caption"), rest[0])
            parted += [report.printed.words(head)] * (not head.pages & first.pages)
    for table in report.printed.document.all("Table"):
        caption, row = (next(table.all(kind), None) for kind in ("Caption", "TR"))
        if caption is not None and row is not None:
            parted += [report.printed.words(caption)] * (not caption.pages <= row.pages)
    assert parted == []


def test_nothing_is_beyond_the_margins(report):
    for number, corners in report.printed.corners.items():
        across = np.array(corners)[:, 0]
        assert across.min() > MARGIN and across.max() < WIDTH - MARGIN, number


def test_a_table_of_few_rows_is_on_one_page(report):
    short = [each for each in report.printed.document.all("Table") if len(list(each.all("TR"))) <= ROWS]
    assert [report.printed.words(table) for table in short if len(table.pages) > 1] == []


def test_the_file_in_a_report_says_how_its_results_were_made(report):
    if report.page.records:
        held = json.loads(report.printed.attachments["receipts.json"])
        assert held == json.loads(json.dumps(report.page.records))
        assert all(record for record in held.values())
    else:
        assert report.printed.attachments == {}


def test_no_row_of_a_table_is_cut_by_the_end_of_a_page(report):
    tables = list(report.printed.document.all("Table"))
    assert tables or not any(section.tables for section in report.page.sections)
    rows = [row for table in tables for row in [*table.all("TR")][1:]]
    assert [report.printed.words(row) for row in rows if len(row.pages) > 1] == []


def test_the_head_of_a_table_stands_on_each_of_its_pages(report):
    for table in report.printed.document.all("Table"):
        head, *rows = table.all("TR")
        assert head.pages == {page for row in rows for page in row.pages} or not rows


def test_orders_have_whole_ticks_in_every_picture(report):
    panels = [
        panel
        for section in report.page.sections
        for figure in section.figures
        for panel in figure.content
        if re.fullmatch(r"(mesh )?order", panel.x.label)
    ]
    for panel in panels:
        sheet = panel_sheet((panel,))
        sheet.draw_without_rendering()
        ticks = sheet.axes[0].get_xticks()
        assert np.array_equal(ticks, np.round(ticks)), panel.x.label


def test_a_report_is_saved_to_print(browser, address, analyzed):
    """One file: a browser prints it without the service, and nothing in it runs."""
    page = opened(browser, f"{address}/#database={analyzed}").page
    tab(page, "Errors and cost")
    printed = to_print(page, page.get_by_role("button", name="Report to print").first.click)
    assert 1 < len(printed.pages) <= 12 and sum(printed.pictures) > 2
    assert "20/20" in printed.words(printed.document)
    page.close()


def test_a_picture_with_its_title_has_no_second_one_on_the_screen(browser, closed_forms, tmp_path):
    write_page(of_pair(closed_forms, tmp_path), tmp_path / "still.html", still_only=True)
    page = browser.new_page()
    page.goto((tmp_path / "still.html").as_uri())
    figures = page.locator("figure:has(.still)")
    assert figures.count() > 2 and figures.locator("h3:visible").count() == 0
    assert page.locator(".still:visible").count() == figures.count()
    page.close()
