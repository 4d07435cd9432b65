"""A scene in its tables: a cell and the TOML follow each other, faults stand at cells, rows are copied."""

import tomllib
from typing import Any

import pytest
from page_visit import found_inaccessible, refused, shown, tab
from playwright.sync_api import Locator, Page, expect
from running_service import until


@pytest.fixture
def visit(browser, address, analyzed):
    seen = shown(browser, address, analyzed)
    tab(seen.page, "Sound")
    seen.page.get_by_role("button", name="Write the scene of the pair").press("Enter")
    expect(cell(seen.page, "Length, mm, input")).to_have_value("200")
    yield seen
    assert [line for line in seen.console if line.startswith("error")] == []
    seen.page.close()


def cell(page: Page, label: str) -> Locator:
    return page.locator("#scene-tables").get_by_label(label, exact=True)


def typed(page: Page, label: str, value: str) -> None:
    cell(page, label).fill(value)
    cell(page, label).press("Tab")


def scene_in(page: Page) -> dict[str, Any]:
    return tomllib.loads(page.locator("#scene-text").input_value())


def test_a_cell_changes_the_text_and_the_text_the_cell(visit):
    page = visit.page
    typed(page, "Position, mm, pinion", "97.5")
    cell(page, "Shaft, input left").select_option("output")
    until(lambda: scene_in(page)["bushings"][0]["shaft"] == "output")
    assert scene_in(page)["gears"][0]["position_mm"] == 97.5
    tab(page, "TOML")
    text = page.get_by_label("Scene, TOML")
    text.fill(text.input_value().replace("position_mm = 97.5", "position_mm = 88.0"))
    text.press("Tab")
    tab(page, "Table")
    expect(cell(page, "Position, mm, pinion")).to_have_value("88")


def test_a_fault_stands_at_its_cell_until_it_is_mended(visit):
    page = visit.page
    expect(page.locator("#scene-text")).not_to_have_value("")
    before = page.locator("#scene-text").input_value()
    typed(page, "Length, mm, output", "-3")
    length = cell(page, "Length, mm, output")
    expect(length).to_have_attribute("aria-invalid", "true")
    expect(page.locator("#scene-shafts-1-length_mm-fault")).to_contain_text("must be above 0")
    expect(page.locator("#scene-text")).to_have_js_property("readOnly", True)
    assert page.locator("#scene-text").input_value() == before
    page.get_by_role("button", name="shafts[1].length_mm").press("Enter")
    expect(length).to_be_focused()
    page.get_by_role("button", name="Compute the scene").press("Enter")
    expect(page.locator("#scene-body [role=alert]")).to_contain_text("shafts[1].length_mm must be above 0")
    typed(page, "Length, mm, output", "220")
    expect(page.locator("#scene-tables [aria-invalid=true]")).to_have_count(0)
    until(lambda: scene_in(page)["shafts"][1]["length_mm"] == 220.0)
    cell(page, "Driven, mesh").select_option("pinion")
    expect(cell(page, "Driven, mesh")).to_have_attribute("aria-invalid", "true")


def test_a_text_that_is_no_scene_closes_the_tables(visit):
    page = visit.page
    tab(page, "TOML")
    text = page.get_by_label("Scene, TOML")
    good = text.input_value()
    text.fill(good.replace("[run]", "[walk]"))
    text.press("Tab")
    expect(page.locator("#scene-body [role=status]", has_text="The scene has faults")).to_contain_text(
        "walk must"
    )
    expect(page.locator("#scene-tables")).to_have_js_property("inert", True)
    text.fill(good)
    text.press("Tab")
    expect(page.locator("#scene-tables")).to_have_js_property("inert", False)


def test_a_part_is_copied_named_removed_and_undone_by_keyboard(visit):
    page = visit.page
    page.get_by_role("button", name="Copy wheel").press("Enter")
    expect(cell(page, "Name, wheel 2")).to_be_focused()
    page.keyboard.type("idler")
    page.keyboard.press("Tab")
    expect(page.locator("#scene-gears-2-shaft")).to_be_focused()
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    page.keyboard.type("120")
    page.keyboard.press("Tab")
    until(lambda: [gear["name"] for gear in scene_in(page)["gears"]] == ["pinion", "wheel", "idler"])
    until(lambda: scene_in(page)["gears"][2]["position_mm"] == 120.0)
    expect(page.locator("#undo")).to_be_enabled()
    page.wait_for_timeout(500)  # ms: an edit that rests is a step
    page.get_by_role("button", name="Remove idler").press("Enter")
    expect(page.get_by_role("button", name="Remove wheel")).to_be_focused()
    until(lambda: len(scene_in(page)["gears"]) == 2)
    page.wait_for_timeout(500)
    page.locator("#undo").press("Enter")
    expect(cell(page, "Position, mm, idler")).to_have_value("120")
    until(lambda: len(scene_in(page)["gears"]) == 3)


def test_what_names_a_part_follows_its_name(visit):
    page = visit.page
    typed(page, "Name, pinion", "sun")
    expect(cell(page, "Driver, mesh")).to_have_value("sun")
    until(lambda: scene_in(page)["meshes"][0]["driver"] == "sun")
    assert scene_in(page)["meshes"][0]["driven"] == "wheel"


def test_fields_and_parts_of_the_schema_are_added(visit):
    page = visit.page
    page.get_by_label("Further field of shafts", exact=True).select_option("damping_ratio")
    expect(cell(page, "Damping ratio, input")).to_be_focused()
    typed(page, "Damping ratio, output", "0.01")
    page.get_by_label("Add a part", exact=True).select_option("rolling_bearings")
    expect(page.locator("#scene-rolling_bearings-0-name")).to_be_focused()
    until(lambda: scene_in(page).get("rolling_bearings", [{}])[0].get("shaft") == "input")
    assert [shaft.get("damping_ratio") for shaft in scene_in(page)["shafts"]] == [None, 0.01]
    expect(page.locator("#scene-tables td.hint", has_text="fields")).not_to_have_count(0)
    assert scene_in(page)["rolling_bearings"][0]["ball"]["count"] == 8


def test_the_angles_of_gears_of_a_shaft_are_a_field_of_it(visit):
    """One for each gear on the shaft, in degrees."""
    page = visit.page
    page.get_by_role("button", name="Copy wheel").press("Enter")
    until(lambda: len(scene_in(page)["gears"]) == 3)
    page.get_by_label("Further field of shafts", exact=True).select_option("tooth_angles_deg")
    typed(page, "Tooth angles, °, output", "0, 4.5")
    until(lambda: scene_in(page)["shafts"][1].get("tooth_angles_deg") == [0.0, 4.5])
    assert "tooth_angles_deg" not in scene_in(page)["shafts"][0]


def test_what_is_computed_is_what_the_table_shows(visit):
    page = visit.page
    cell(page, "Duration, s, Run").fill("0.25")
    with refused(page, "simulate") as sent:
        page.get_by_role("button", name="Compute the scene").press("Enter")
        expect(page.locator("#scene-body [role=alert]")).to_contain_text("Not now")
    assert sent[0]["scene"]["run"]["duration_s"] == 0.25
    visit.console.clear()  # the browser logs that refusal


def test_the_tables_are_accessible_and_a_phone_shows_them(visit):
    page = visit.page
    assert found_inaccessible(page, "#scene-body") == {}
    page.set_viewport_size({"width": 400, "height": 800})
    expect(cell(page, "Length, mm, input")).to_be_visible()
    for part in ("html", "#sound"):
        across = page.locator(part).evaluate("node => node.scrollWidth - node.clientWidth")
        assert across == 0, part
