"""The start of a relief on the page: as on the drawing, by one switch at its field."""

import json

import pytest
from page_visit import CASE, GEAR, answered, choose_case, computed, control, opened, shown
from playwright.sync_api import Page, expect

from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.schemas import Case, validated

FIELD = "#f-pair-pinion-{}"
SWITCH = "Tip relief, pinion: stated by"
WAYS = {
    "mm ⌀": "tip_relief_start_diameter_mm",
    "° roll": "tip_relief_start_roll_angle_deg",
    "mm roll": "tip_relief_start_roll_length_mm",
    "mm": "tip_relief_length_mm",
}


def length_of(**facts: float) -> float:
    """Return the length of the relief on the flank that a gear states, m."""
    pinion = GEAR | {"tip_relief_um": 8.0} | facts
    pair = gear_pair(validated(Case, CASE | {"pair": CASE["pair"] | {"pinion": pinion}}))
    return pair.pinion.modification.tip_relief_length


def turn(page: Page, way: str) -> str:
    """Turn the switch; return what its field has then."""
    control(page, f"select[aria-label='{SWITCH}']").select_option(way)
    field = page.locator(FIELD.format(WAYS[way]))
    expect(field).to_be_visible()
    expect(field).not_to_have_value("")
    for other in set(WAYS.values()) - {WAYS[way]}:
        expect(page.locator(FIELD.format(other))).to_be_hidden()
        expect(page.locator(FIELD.format(other))).to_have_value("")
    return field.input_value()


def test_the_switch_leaves_the_flank_as_it_is(browser, address, tmp_path):
    seen = opened(browser, address)
    page = seen.page
    choose_case(page, tmp_path)
    control(page, FIELD.format("tip_relief_um")).fill("8")
    control(page, FIELD.format("tip_relief_length_mm")).fill("0.4")
    for way, field in WAYS.items():
        assert length_of(**{field: float(turn(page, way))}) == pytest.approx(0.4e-3, rel=1e-7)
    assert turn(page, "mm ⌀") == "21.2"
    assert turn(page, "mm") == "0.4"
    page.wait_for_selector("#plan dl")
    expect(page.locator("#form-errors")).to_be_hidden()
    assert seen.complaints == []
    page.close()


def test_a_start_that_is_refused_says_so_in_its_unit(browser, address, tmp_path):
    page = opened(browser, address).page
    choose_case(page, tmp_path)
    control(page, FIELD.format("tip_relief_um")).fill("8")
    control(page, f"select[aria-label='{SWITCH}']").select_option("mm ⌀")
    control(page, FIELD.format("tip_relief_start_diameter_mm")).fill("23")
    expect(page.locator("#form-errors")).to_contain_text("to below the tip diameter 22")
    page.close()


def test_a_file_with_a_start_is_opened_analyzed_and_slid(browser, address, tmp_path):
    pinion = GEAR | {"tip_relief_um": 8.0, "tip_relief_start_diameter_mm": 21.2}
    case = CASE | {"pair": CASE["pair"] | {"pinion": pinion}}
    seen = shown(browser, address, computed(address, case=case))
    page = seen.page
    answered(page)
    slider = control(page, "#live-pinion-tip_relief_length_mm-exact")
    expect(slider).to_have_value("0.4")
    file = tmp_path / "drawing.json"
    file.write_text(json.dumps(case), encoding="utf-8")
    page.locator("#import-file").set_input_files(file)
    expect(page.locator(FIELD.format("tip_relief_start_diameter_mm"))).to_have_value("21.2")
    expect(page.locator(FIELD.format("tip_relief_length_mm"))).to_be_hidden()
    control(page, "#live-pinion-tip_relief_length_mm-exact").fill("0.5")
    page.get_by_role("button", name="Take these flanks").press("Enter")
    expect(page.locator(FIELD.format("tip_relief_start_diameter_mm"))).to_have_value("21")
    expect(page.locator(FIELD.format("tip_relief_length_mm"))).to_have_value("")
    assert seen.complaints == []
    page.close()
