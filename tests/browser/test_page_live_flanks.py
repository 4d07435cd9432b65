"""Pressure over the flank, load over the face and K_Hbeta follow the sliders."""

from __future__ import annotations

import json

import pytest
from page_visit import OVER_FACE, Visit, computed, found_inaccessible, moved, shown, unfold
from playwright.sync_api import Browser, Page, expect

PLOTS = ("live_pressure", "live_face_load")


@pytest.fixture(scope="module")
def visit(browser: Browser, address: str) -> Visit:
    """Show the small pair in three dimensions."""
    return shown(browser, address, computed(address, case=OVER_FACE))


def figure(page: Page, name: str) -> float:
    node = page.locator("#live-figures > div").filter(has=page.locator("dt", has_text=name)).locator("dd")
    return float((node.text_content() or "nan").split()[0])


def test_a_misaligned_pair_is_pressed_harder_and_carries_less_evenly(visit: Visit) -> None:
    page = visit.page
    for key in PLOTS:
        expect(page.locator(f"[data-figure={key}] .plot")).to_have_attribute("data-drawn", "yes")
    pressure, factor = figure(page, "largest pressure"), figure(page, "K_Hbeta")
    before = page.locator("#live-figures").text_content() or ""
    assert 1.0 <= factor < 1.2
    moved(page, "#live-misalignment_um", "End")
    assert figure(page, "largest pressure") > 1.2 * pressure
    assert figure(page, "K_Hbeta") > 1.5 * factor
    load = page.locator("[data-figure=live_face_load]")
    assert load.locator(".scatterlayer .trace").count() == 3, "as analyzed, now, now at the worst position"
    said = load.locator(".plot").get_attribute("aria-label") or ""
    assert f"K_Hbeta {figure(page, 'K_Hbeta'):g}" in said
    page.get_by_role("button", name="As analyzed").press("Enter")
    expect(page.locator("#live-figures")).to_have_text(before)


def test_in_the_plane_there_is_a_pressure_along_the_profile_and_no_face(
    browser: Browser, address: str, analyzed: str
) -> None:
    page = shown(browser, address, analyzed).page
    before = figure(page, "largest pressure")
    expect(page.locator("[data-figure=live_face_load]")).to_be_hidden()
    expect(page.locator("#live-figures")).not_to_contain_text("K_Hbeta")
    moved(page, "#live-torque_n_m", "End")
    assert figure(page, "largest pressure") > 1.1 * before
    page.close()


def test_the_length_of_a_relief_acts_where_there_is_a_relief(
    browser: Browser, address: str, analyzed: str
) -> None:
    page = shown(browser, address, analyzed).page
    plain = page.locator("#live-figures").text_content()
    moved(page, "#live-pinion-tip_relief_length_mm", "End")
    expect(page.locator("#live-figures")).to_have_text(plain or "")
    moved(page, "#live-pinion-tip_relief_um", "End")
    before = figure(page, "peak to peak")
    moved(page, "#live-pinion-tip_relief_length_mm", "Home")
    assert abs(figure(page, "peak to peak") / before - 1.0) > 0.05
    page.get_by_role("button", name="Take these flanks").press("Enter")
    expect(page.locator("#f-pair-pinion-tip_relief_length_mm")).to_have_value("0.01")
    page.close()


def test_they_are_accessible_and_nothing_is_complained_about(visit: Visit) -> None:
    unfold(visit.page)
    assert not (told := found_inaccessible(visit.page)), json.dumps(told, indent=1)
    assert visit.complaints == []
