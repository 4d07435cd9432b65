"""The page stands alone, says what figures and metadata say, in one order, and no content can break it."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise

import numpy as np
import pytest

from fe_contact import Gear, GearPair
from lineofaction.gearbox.units import boundary_ledger
from lineofaction.report.document import Inputs, headlines_of, page_of, read_inputs
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table
from lineofaction.report.drawing.page import Headline, Page, Part, Section, html, is_number
from lineofaction.report.drawing.tables import records, settings_table, side_by_side
from lineofaction.report.pair import data_sheet_section, pair_of, pair_remarks
from lineofaction.report.ste.headlines import static_headlines
from lineofaction.report.ste.page import case_tables, contact_effects, static_alarms, static_making

PNG = b"\x89PNG\r\n\x1a\n"
HOSTILE = '</script><script src="http://example.org/x.js"></script>'


class Outline(HTMLParser):
    """Collect elements, with their attributes, as a browser would meet them."""

    def __init__(self) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))


def figure(key: str = "ste", title: str = "STE") -> Figure:
    x = np.array([0.0, 1.0, 2.0])
    panel = Panel(Axis("position"), Axis("µm"), (Line(title, x, x, palette.BLUE),))
    table = Table("Numbers", ("load", "mean"), (("10 N m", "0.680"),))
    return Figure(key, title, "How to read it.", "A straight line.", (panel,), table)


def page(title: str = "Report", **changes: object) -> Page:
    section = Section("Static", "Text.", (figure(),), (settings_table("Case", {"center_distance_mm": 80.0}),))
    given = {"headlines": (Headline("mean STE", "6.245 µm", "± 0.02"),), "sections": (section,)} | changes
    return Page(title, "A pair.", **given)


def outline(text: str) -> list[tuple[str, dict[str, str | None]]]:
    parser = Outline()
    parser.feed(text)
    return parser.elements


def test_nothing_is_loaded_from_elsewhere():
    text = html(page(), {"ste": PNG})
    for tag, attributes in outline(text):
        for name in ("src", "href", "data", "srcset", "poster", "action"):
            value = attributes.get(name) or ""
            assert not re.match(r"(https?:)?//", value), (tag, value)
    style = re.findall(r"<style>(.*?)</style>", text, re.DOTALL)
    assert style
    assert not any("url(" in sheet or "@import" in sheet for sheet in style)


def test_the_drawing_library_is_in_the_page():
    assert "Plotly" in html(page(), {"ste": PNG})[:2_000_000]
    assert 1_000_000 < len(html(page(), {"ste": PNG})) < 2_500_000  # the library as gzip, once


def test_text_is_escaped_and_data_cannot_close_its_script():
    hostile = figure(title=HOSTILE)
    alarmed = page(HOSTILE, sections=(Section(HOSTILE, HOSTILE, (hostile,)),), alarms=(HOSTILE,))
    elements = outline(html(alarmed, {"ste": PNG}))
    assert not [a for tag, a in elements if tag == "script" and "src" in a]
    assert len([tag for tag, _ in elements if tag == "script"]) == 3  # library, data, drawing


def test_the_embedded_data_is_json():
    text = html(page(), {"ste": PNG})
    data = re.search(r'<script type="application/json" id="ste-data">(.*?)</script>', text, re.DOTALL)
    assert data
    assert json.loads(data.group(1))["data"][0]["x"] == [0.0, 1.0, 2.0]


def test_every_plot_has_words_a_still_image_and_its_numbers():
    elements = outline(html(page(), {"ste": PNG}))
    plot = next(a for _, a in elements if a.get("class") == "plot")
    image = next(a for tag, a in elements if tag == "img")
    assert "A straight line." in (plot["aria-label"] or "")
    assert plot["aria-label"] == image["alt"]
    assert (image["src"] or "").startswith("data:image/png;base64,")
    assert [tag for tag, _ in elements].count("table") == 2


def test_headings_descend_one_level_at_a_time():
    levels = [int(tag[1]) for tag, _ in outline(html(page(), {"ste": PNG})) if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(b - a <= 1 for a, b in pairwise(levels))


def test_the_contents_lead_to_every_section():
    sections = (Section("One"), Section("Two"))
    elements = outline(html(page(sections=sections), {}))
    targets = {a["id"] for _, a in elements if "id" in a}
    links = [(a["href"] or "")[1:] for tag, a in elements if tag == "a"]
    assert len(links) == 3
    assert set(links) <= targets


def test_settings_become_rows_with_units():
    table = settings_table(
        "Case", {"pair": {"normal_module_mm": 4.0, "pinion": {"teeth": 20}}, "none": None, "on": True}
    )
    assert table.rows == (("pair · normal module, mm", "4"), ("pair · pinion · teeth", "20"), ("on", "yes"))


def test_records_keep_every_field():
    table = records("Ledger", [{"name": "a", "on": True}, {"name": "b", "worth": "2 %"}])
    assert table.head == ("name", "on", "worth")
    assert table.rows == (("a", "yes", "none"), ("b", "none", "2 %"))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1330.0, "1330"),
        (7850.0, "7850"),
        (0.349066, "0.349066"),
        (2.1e11, "2.1e+11"),
        ([10.0, 0.5], "10, 0.5"),
    ],
)
def test_no_digit_is_lost(value, text):
    assert settings_table("Case", {"load": value}).rows == (("load", text),)


def test_both_gears_stand_beside_each_other():
    table = side_by_side("Gears", {"pinion": {"teeth": 20}, "wheel": {"teeth": 40, "rim_mm": 5.0}})
    assert table.head == ("quantity", "pinion", "wheel")
    assert table.rows == (("teeth", "20", "40"), ("rim, mm", "", "5"))


def test_the_case_is_told_in_full(database):
    gears, rest = case_tables(database.metadata.case)
    assert ("teeth", "20", "20") in gears.rows
    assert ("center distance, mm", "80") in rest.rows
    assert ("load · torque, N m", "10, 100, 400") in rest.rows


def test_the_ledger_says_what_is_simulated_and_why(database):
    section = contact_effects(boundary_ledger(database.metadata.effect_ledger))
    (table,), (trifles, decisions) = section.tables, section.folded
    assert section.text.endswith("estimated change without each, at 400 N m, misalignment 0 µm.")
    assert table.head == ("effect", "in", "simulated", "without it", "because")
    assert decisions.head == ("effect", "cost", "decision", "price of the choice", "checked")
    words = "mean +0.2 µm (+2 %), peak-to-peak -0.05 µm (-5 %)"
    assert table.rows == (("corner contact", "contact", "yes", words, "tips touch"),)
    assert [row[0] for row in decisions.rows] == ["corner_contact", "misalignment"]
    assert trifles.caption == "1 effect below 0.1 %"
    assert [row[0] for row in trifles.rows] == ["misalignment"]


def test_a_ledger_without_estimates_says_so():
    section = contact_effects([{"name": "misalignment", "on": False, "reason": "aligned"}])
    assert section.text == ""
    assert section.tables[0].rows == (("misalignment", "contact", "no", "not estimated", "aligned"),)


def test_an_edge_is_named_apart_from_the_largest_pressure(database):
    edges = np.zeros(database.max_pressure.shape)
    assert "edge" not in static_headlines(replace(database, edge_pressure=edges))[2].remark
    edges[3] = 1.072e9
    pressed = static_headlines(replace(database, edge_pressure=edges))[2]
    assert pressed.value == static_headlines(database)[2].value == "700.0 MPa"
    assert pressed.remark.endswith("1072 MPa at the edges, indicative: the true one is singular")


def test_headlines_are_those_of_the_load_asked_for(database):
    names = [headline.name for headline in static_headlines(database, force=10_000.0)]
    assert names == ["mean STE at 400 N m", "peak-to-peak STE at 400 N m", "largest pressure at 400 N m"]
    mean = static_headlines(database)[0]
    assert (mean.name, mean.value, mean.remark) == ("mean STE at 100 N m", "5.978 µm", "± 0.012 µm")


@pytest.mark.law
def test_one_load_has_one_largest_pressure(database):
    at = "at 100 N m"
    flank = Page("", "", (Headline(f"largest flank pressure {at}", "702 MPa", "± 9 MPa"),), ())
    bound = {line.name: line.value for line in headlines_of(Inputs(database, pages={"flank": flank}))}
    assert f"largest pressure {at}" not in bound and bound[f"largest flank pressure {at}"] == "702 MPa"
    other = replace(flank, headlines=(replace(flank.headlines[0], name="largest flank pressure at 7 N m"),))
    names = [line.name for line in headlines_of(Inputs(database, pages={"flank": other}))]
    assert f"largest pressure {at}" in names  # of another load


def test_failed_points_are_said_loudly(database, damaged):
    assert static_alarms(database) == ()
    (alarm,) = static_alarms(damaged)
    assert "1 of 256 points FAILED" in alarm


def test_the_receipt_is_in_the_page(database):
    tables = [t for section in static_making(database) for t in (*section.tables, *section.folded)]
    stages = next(t for t in tables if t.caption == "Time by stage")
    assert stages.rows == (("mesh", "1.00", "1.10"),)
    made = next(t for t in tables if t.caption == "Made with")
    assert ("numpy", "2.0") in made.rows


@pytest.mark.parametrize("text", ["12", "-0.5", "1.0e-12", "6.2 ± 0.1", "10 N m", ""])
def test_numbers_are_known(text):
    assert is_number(text)


@pytest.mark.parametrize("text", ["none", "832, 0 failed", "10, 20", "corner_contact", "2 % of the mean"])
def test_words_are_no_numbers(text):
    assert not is_number(text)


def test_results_stand_before_effects_accuracy_input_and_receipts(database, run, flanks, tmp_path):
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


def test_effects_of_contact_and_run_stand_in_one_table(database, run):
    (section,) = [s for s in page_of(Inputs(database, run)).sections if s.part is Part.EFFECTS]
    (table,) = section.tables
    assert [row[:2] for row in table.rows] == [("corner contact", "contact"), ("lateral", "input")]
    captions = [folded.caption for folded in section.folded]
    assert captions[0] == "1 effect below 0.1 %" and captions[-1] == "Not in the model"


def test_the_data_sheet_begins_with_what_speaks_against_the_pair(database):
    pair = pair_of(database)
    messages = [remark["message"] for remark in pair_remarks(pair)]
    assert any("no backlash" in message for message in messages)
    assert data_sheet_section(pair).text == " ".join(f"Warning: {message}" for message in messages)
    gear = Gear(
        teeth=40, normal_module=2e-3, face_width=20e-3, bore_diameter=30e-3, thickness_allowance=50e-6
    )
    assert data_sheet_section(GearPair(gear, gear)).text.startswith("No warnings")


def test_a_table_without_its_pair_says_what_is_left_out(database):
    bare = replace(database, metadata=replace(database.metadata, case={}))
    sections = {section.title: section for section in page_of(Inputs(bare)).sections}
    assert "not split" in sections["Mesh stiffness and deflection"].text
    assert [f.key for f in sections["Mesh stiffness and deflection"].figures] == ["mesh_stiffness"]
