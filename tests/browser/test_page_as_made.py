"""Gears as made on the page: stated, measured or drawn, undone, analyzed, with their orders by name."""

import copy
import json
import re

import pytest
from page_visit import CASE, Visit, answered, choose_case, control, opened, tab
from playwright.sync_api import Page, expect

SHEET = "tooth,flank,trace,deviation_um\n" + "".join(
    f"{tooth},right,pitch,{3 * (-1) ** tooth}\n" for tooth in range(1, 21)
)


@pytest.fixture
def page(browser, address, tmp_path):
    visit: Visit = opened(browser, address)
    choose_case(visit.page, tmp_path)
    tab(visit.page, "Teeth as made")
    yield visit.page
    assert visit.complaints == []
    visit.page.close()


def field(page: Page, name: str) -> str:
    return page.locator(f"#f-pair-pinion-{name}").input_value()


def test_a_sheet_goes_into_the_fields_and_is_undone(page, tmp_path):
    sheet = tmp_path / "gear.csv"
    sheet.write_text(SHEET, encoding="utf-8")
    control(page, "#made-file").set_input_files(sheet)
    expect(page.locator("#example-note")).to_have_text("The pinion as measured, gear.csv")
    expect(page.locator("#f-pair-pinion-pitch_deviation_um")).to_have_value(re.compile("^-3, 0, -3"))
    expect(page.locator("#f-pair-wheel-pitch_deviation_um")).to_have_value("")
    expect(page.locator("#undo")).to_be_enabled()
    page.locator("#undo").click()
    expect(page.locator("#f-pair-pinion-pitch_deviation_um")).to_have_value("")


def test_a_line_that_is_none_is_said_by_its_number(page, tmp_path):
    sheet = tmp_path / "gear.csv"
    sheet.write_text(SHEET + "21,right,pitch,0\n", encoding="utf-8")
    control(page, "#made-file").set_input_files(sheet)
    expect(page.locator("#form-errors")).to_contain_text("line 22")


def test_drawn_gears_are_in_the_fields_and_the_result_is_theirs(page):
    page.get_by_role("button", name="Draw both gears").press("Enter")
    expect(page.locator("#example-note")).to_have_text(
        "Both gears drawn within class 6 of ISO 1328-1, draw 1"
    )
    expect(page.locator("#f-pair-pinion-tooth_flanks")).to_have_value(re.compile("^1, .*; 20, "))
    expect(page.locator("#f-pair-wheel-run_out-eccentricity_um")).not_to_have_value("")
    page.locator("#analyze").press("Enter")
    expect(page).to_have_url(re.compile("database="))
    answered(page)
    expect(page.locator("#results-design")).to_be_empty()


def test_orders_of_run_out_and_waves_have_names(page, tmp_path):
    case = copy.deepcopy(CASE)
    case["pair"]["pinion"] = case["pair"]["pinion"] | {
        "run_out": {"eccentricity_um": 5.0},
        "waves": [{"order": 7, "amplitude_um": 0.5, "phase_deg": 10.0}],
    }
    file = tmp_path / "made.json"
    file.write_text(json.dumps(case), encoding="utf-8")
    page.locator("#import-file").set_input_files(file)
    expect(page.locator("#f-pair-pinion-waves")).to_have_value("7, 0.5, 10")
    page.locator("#f-pair-pinion-waves").fill("7, 0.5; 13, 0.4")
    page.locator("#analyze").press("Enter")
    expect(page).to_have_url(re.compile("database="))
    answered(page)
    expect(page.locator("[data-figure=live_ste] h3")).to_have_text(
        "Transmission error over 20 base pitches, at 1 N m"
    )
    tab(page, "Orders")
    orders = page.locator("[data-figure=live_harmonics] .plot")
    for name in ("pinion 1 ", "pinion 7 ", "pinion 13 ", "mesh 1 "):
        expect(orders).to_have_attribute("aria-label", re.compile(f"Strongest orders:.*{name}"))
    expect(orders.locator(".bartext").filter(has_text="pinion 7")).to_have_count(1)
    expect(page.locator("#results-design")).to_be_empty()
