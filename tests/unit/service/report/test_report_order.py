"""The sections of a report stand in one order, whatever was read and in whatever order it was named."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from dynamics.results import RunResult
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.geometry import Gear, GearPair
from fe_contact.ste import SteDatabase
from lineofaction.report.document import Inputs, page_of, read_inputs
from lineofaction.report.drawing.page import Part
from lineofaction.report.pair import data_sheet_section, pair_of, pair_remarks


def test_results_stand_before_effects_accuracy_input_and_receipts(
    database: SteDatabase, run: RunResult, flanks: LoadDistribution, tmp_path: Path
) -> None:
    files = [tmp_path / name for name in ("run.nc", "flanks.nc", "table.nc")]
    for result, file in zip((run, flanks, database), files, strict=True):
        result.to_netcdf(file)
    pages = [page_of(read_inputs(order)) for order in (files, files[::-1])]
    titles = [[section.title for section in page.sections] for page in pages]
    assert titles[0] == titles[1]
    assert titles[0][:6] == [
        "Data sheet",
        "Static transmission error",
        "Load sharing",
        "Mesh stiffness and deflection",
        "Flank pressure and load along the face",
        "Flanks",
    ]
    assert titles[0][-8:] == [
        "Effects",
        "Accuracy of the table",
        "Accuracy of the run",
        "Case",
        "Scene",
        "Receipt of the table",
        "Receipt of the flank results",
        "Receipt of the run",
    ]
    parts = [section.part for section in pages[0].sections]
    assert parts == sorted(parts)


def test_effects_of_contact_and_run_stand_in_one_table(database: SteDatabase, run: RunResult) -> None:
    (section,) = [s for s in page_of(Inputs(database, run)).sections if s.part is Part.EFFECTS]
    (table,) = section.tables
    assert [row[:2] for row in table.rows] == [("corner_contact", "contact"), ("lateral", "input")]
    captions = [folded.caption for folded in section.folded]
    assert captions[0] == "1 effect below 0.1 %" and captions[-1] == "Not in the model"


def test_the_data_sheet_begins_with_what_speaks_against_the_pair(database: SteDatabase) -> None:
    pair = pair_of(database)
    assert pair is not None
    messages = [remark["message"] for remark in pair_remarks(pair)]
    assert any("no backlash" in message for message in messages)
    assert data_sheet_section(pair).text == " ".join(f"Warning: {message}" for message in messages)
    gear = Gear(
        teeth=40, normal_module=2e-3, face_width=20e-3, bore_diameter=30e-3, thickness_allowance=50e-6
    )
    assert data_sheet_section(GearPair(gear, gear)).text.startswith("No warnings")


def test_a_table_without_its_pair_says_what_is_left_out(database: SteDatabase) -> None:
    bare = replace(database, metadata=replace(database.metadata, case={}))
    sections = {section.title: section for section in page_of(Inputs(bare)).sections}
    assert "not split" in sections["Mesh stiffness and deflection"].text
    assert [f.key for f in sections["Mesh stiffness and deflection"].figures] == ["mesh_stiffness"]
