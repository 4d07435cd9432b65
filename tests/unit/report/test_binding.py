"""Reports of the pairs of a unit as one: nothing of any is left out, what is common stands once."""

from collections import Counter
from dataclasses import replace

import pytest

from lineofaction.gearbox.schemas.report import ReportInput
from lineofaction.report.binding import bound
from lineofaction.report.document import page_of, read_inputs, write_page
from lineofaction.report.drawing.page import Part
from lineofaction.report.title_block import titled

PARTS = ("first stage", "second stage")


@pytest.fixture
def pages(database, tmp_path):
    pages = {}
    for part, torque in zip(PARTS, (1.0, 3.0), strict=True):
        scaled = replace(database, torque=torque * database.torque, force=torque * database.force)
        scaled.to_netcdf(tmp_path / f"{part}.nc")
        pages[part] = page_of(read_inputs([tmp_path / f"{part}.nc"]))
    return pages


def test_every_panel_and_every_row_of_each_pair_is_there_and_has_its_name(pages):
    whole = bound(pages)
    for part, page in pages.items():
        for section in page.sections:
            (own,) = (other for other in whole.sections if other.title == section.title)
            rows = {row[-1] for table in (*own.tables, *own.folded) for row in table.rows}
            assert {row[-1] for table in (*section.tables, *section.folded) for row in table.rows} <= rows
            for figure in section.figures:
                (drawn,) = (other for other in own.figures if other.key == figure.key)
                named = [panel for panel in drawn.content if panel.title.startswith(part)]
                assert [panel.lines for panel in named] == [panel.lines for panel in figure.content]
                assert figure.alternative in drawn.alternative


def test_what_both_say_stands_once(pages):
    whole = bound(pages)
    titles = Counter((section.title, section.part) for section in whole.sections)
    assert set(titles.values()) == {1}
    assert len([section for section in whole.sections if section.part is Part.EFFECTS]) == 1
    for section in whole.sections:
        for figure in section.figures:
            sentences = Counter(figure.caption.split(". "))
            assert max(sentences.values()) == 1, figure.key
    heads = [figure.title for section in whole.sections for figure in section.figures]
    assert not [head for head in heads if head.endswith((",", " at", " of"))]
    keys = Counter(figure.key for section in whole.sections for figure in section.figures)
    assert set(keys.values()) == {1}


def test_a_requirement_is_met_or_not_by_each_pair(pages):
    page = titled(bound(pages), ReportInput(requirements=("mean STE at most 1000 µm",)))
    assert page.block is not None and page.alarms == bound(pages).alarms
    assert [part for part, words in zip(PARTS, page.block.verdicts, strict=True) if part in words] == [*PARTS]
    assert all(words.startswith("Met: mean STE") for words in page.block.verdicts)


def test_one_report_alone_stays_as_it_is(pages):
    (page, _) = pages.values()
    assert bound({"": page}) is page
    assert bound({"first stage": page}) is page


def test_the_bound_page_is_written_with_the_plot_library_once(pages, tmp_path):
    write_page(bound(pages), tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text("utf-8")
    assert text.count('id="library"') == 1
    assert all(f"second stage: {words}" in text for words in ("transverse section", "peak to peak"))


def test_what_each_pair_was_made_from_is_kept(pages):
    records = bound(pages).records
    assert records.keys() == {f"{part}.nc" for part in PARTS} and all(records.values())
