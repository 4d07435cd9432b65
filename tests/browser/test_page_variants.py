"""Variants of a design on the page: side by side, each a copy, all in one address."""

from __future__ import annotations

import re

import pytest
from page_visit import CASE, GEAR, Visit, computed, control, moved
from playwright.sync_api import Browser, Page, expect
from running_service import until

RELIEVED = GEAR | {"tip_relief_um": 8.0, "tip_relief_length_mm": 0.4}


@pytest.fixture(scope="module")
def relieved(address: str) -> str:
    """Hash of the table of the small pair with tip relief."""
    return computed(address, case=CASE | {"pair": CASE["pair"] | {"pinion": RELIEVED}})


DATA = "node => Object.fromEntries((node.data ?? []).map(({name, y}) => [name, [...y]]))"


def curves(page: Page) -> dict[str, list[float]]:
    node = control(page, "[data-figure=live_ste] .plot")
    found: list[tuple[str, list[float]]] = node.evaluate(
        "node => (node.data ?? []).map(({name, y}) => [name, [...y]])"
    )
    return dict(found)


@pytest.mark.law
def test_a_variant_begins_as_a_copy_and_moves_by_itself(visit: Visit, analyzed: str) -> None:
    page = visit.page
    page.get_by_role("button", name="Another variant").press("Enter")
    expect(page.get_by_role("button", name="Variant B")).to_have_attribute("aria-pressed", "true")
    expect(page).to_have_url(re.compile(f"#database={analyzed}&a={analyzed}&on=b$"))
    until(lambda: len(curves(page)) == 3)
    until(lambda: curves(page)["A"] == curves(page)["B"] == curves(page)["as analyzed"])  # as it rests
    same = curves(page)
    moved(page, "#live-pinion-tip_relief_um", "End")
    page.wait_for_timeout(500)  # drawn in a moment
    found = curves(page)
    assert found["A"] == same["A"] != found["B"]
    page.get_by_role("button", name="Variant A").press("Enter")
    expect(page.locator("#live-pinion-tip_relief_um")).to_have_value("0")
    until(lambda: curves(page).get("B") == found["B"])  # with its moved flanks
    assert visit.complaints == []


def test_two_results_and_an_edit_stand_side_by_side_in_another_browser(
    visit: Visit, browser: Browser, analyzed: str, relieved: str
) -> None:
    page = visit.page
    origin = page.url.partition("#")[0]
    page.goto(f"{origin}#database={relieved}&a={analyzed}&on=b")
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("8")
    until(lambda: len(curves(page)) == 3)
    found = curves(page)
    assert found["A"] != found["B"]
    page.get_by_role("button", name="Variant A").press("Enter")
    expect(page).to_have_url(re.compile(f"#database={analyzed}&b={relieved}"))
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("")
    control(page, "#f-pair-wheel-tip_relief_um").fill("5")
    expect(page).to_have_url(re.compile("case="))
    page.get_by_role("button", name="Variant B").press("Enter")
    expect(page.locator("#f-pair-wheel-tip_relief_um")).to_have_value("")
    context = browser.new_context()
    other = context.new_page()
    other.goto(page.url)
    other.wait_for_selector("html[data-ready=yes]")
    expect(other.locator("#f-pair-pinion-tip_relief_um")).to_have_value("8")
    other.get_by_role("button", name="Variant A").press("Enter")
    expect(other.locator("#f-pair-wheel-tip_relief_um")).to_have_value("5")
    other.go_back()
    expect(other.locator("#f-pair-pinion-tip_relief_um")).to_have_value("8")
    context.close()
    assert visit.complaints == []
