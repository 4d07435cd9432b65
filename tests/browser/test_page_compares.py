"""Live flanks follow the sliders; two results on one pair of axes, of variants."""

import csv
import json
import re
from pathlib import Path

import pytest
from page_visit import (
    CASE,
    OVER_FACE,
    answers,
    computed,
    control,
    found_inaccessible,
    moved,
    opened,
    shown,
    tab,
    unfold,
)
from playwright.sync_api import Page, expect
from running_service import until

IN_THE_PLANE = "20/20, module 1 mm, up to 1 N m"
"""The small case in the list of jobs, which has those of other tests too."""
ORDINATE = ", STE less mean, µm"


@pytest.fixture(scope="module")
def other(address):
    """Hash of another pair's table, in three dimensions."""
    return computed(address, case=OVER_FACE)


def curves(page: Page, folder: Path) -> dict[str, list[float]]:
    with page.expect_download() as given:
        control(page, "[data-figure=live_ste] [data-tool=CSV]").press("Enter")
    given.value.save_as(folder / "live.csv")
    head, *rows = csv.reader((folder / "live.csv").read_text(encoding="utf-8").splitlines())
    return {
        name.removesuffix(ORDINATE): [float(row[k]) for row in rows if row[k]]
        for k, name in enumerate(head)
        if name.endswith(ORDINATE)
    }


def mean_of_first(page: Page) -> float:
    """Return the mean of variant A in the table of variants, um."""
    row = page.locator("#compared tr").filter(has_text="mean, µm")
    return float(row.locator("td").first.inner_text().split()[0])


def change(page: Page) -> str:
    return page.locator("#live-figures dd small").first.text_content() or ""


@pytest.mark.nightly
def test_another_pair_is_compared_at_the_torque_that_is_looked_at(browser, address, analyzed, other):
    visit = opened(browser, f"{address}/#database={other}&a={analyzed}&on=b")
    page = visit.page
    until(lambda: answers(page) > 0)
    expect(page.locator("#f-pair-wheel-teeth")).to_have_value("24")
    one = mean_of_first(page)
    moved(page, "#live-torque_n_m", "End")
    two = mean_of_first(page)
    assert 1.6 < two / one < 2.0, "twice the torque: the other variant follows"
    unfold(page)
    assert not (told := found_inaccessible(page)), json.dumps(told, indent=1)
    assert visit.complaints == []


@pytest.mark.nightly
def test_in_three_dimensions_misalignment_and_crowning_act(browser, address, other):
    visit = shown(browser, address, other)
    page = visit.page
    before = page.locator("#live-figures dd").first.text_content()
    moved(page, "#live-misalignment_um", "End")
    expect(page.locator("#live-figures dd").first).not_to_have_text(before or "")
    moved(page, "#live-pinion-helix_crowning_um", "End")
    expect(page.locator("#live-pinion-helix_crowning_um")).to_have_attribute("aria-valuetext", "30 µm")
    tab(page, "Flanks, live")
    count = answers(page)
    page.get_by_role("button", name="As analyzed").press("Enter")
    until(lambda: answers(page) > count)
    expect(page.locator("#live-figures dd").first).to_have_text(before or "")
    tab(page, "Flank")
    page.get_by_role("button", name="Compute flank pressure").press("Enter")
    pattern = page.locator("[data-figure=contact_pattern] .plot")
    expect(pattern).to_have_attribute("data-drawn", "yes")
    maps = pattern.locator(".contourlayer .contour")
    expect(maps, "a map over roll length and face for each gear").to_have_count(2)
    assert visit.complaints == []


@pytest.mark.nightly
def test_one_button_computes_in_three_dimensions(browser, address, analyzed):
    visit = opened(browser, f"{address}/#database={analyzed}")
    page = visit.page
    tab(page, "Flanks, live")
    page.get_by_role("button", name="Analyze in three dimensions").press("Enter")
    expect(page.locator("#live-misalignment_um")).to_be_enabled()
    expect(page.locator("#f-accuracy-model")).to_have_value("3d")
    assert analyzed not in page.url
    assert visit.complaints == []


def test_two_analyses_of_the_list_are_compared_with_their_errors(visit, other):
    page = visit.page
    page.reload()
    tab(page, "Jobs")
    buttons = page.get_by_role("button", name=re.compile("^Compare analyze"))
    rows = page.get_by_role("listitem").filter(has=buttons)
    over_face, others = rows.filter(has_text="20/24"), rows.filter(has_text=IN_THE_PLANE)
    over_face.first.get_by_role("button", name=re.compile("^Compare")).press("Enter")
    expect(page.locator("#jobs-line")).to_contain_text("Choose another analyze job")
    others.first.get_by_role("button", name=re.compile("^Compare")).press("Enter")
    shown = page.locator("#jobs-result")
    expect(shown).to_contain_text("first and second compared")
    expect(shown).to_contain_text("Fields that differ")
    expect(shown.locator("[data-figure=ripples] .plot")).to_have_attribute("data-drawn", "yes")
    assert not (told := found_inaccessible(page, "#jobs")), json.dumps(told, indent=1)
    assert visit.complaints == []


def test_results_without_a_load_in_common_are_not_compared_and_it_says_why(visit, address):
    computed(address, case=CASE | {"load": {"torque_n_m": [3.0, 4.0]}})
    page = visit.page
    page.reload()
    tab(page, "Jobs")
    rows = page.get_by_role("listitem")
    for text in ("up to 4 N m", IN_THE_PLANE):
        row = rows.filter(has=page.get_by_role("button", name=re.compile("^Compare analyze")), has_text=text)
        row.first.get_by_role("button", name=re.compile("^Compare")).press("Enter")
    expect(page.locator("#jobs-line")).to_contain_text("Compute both for the same torques")
    expect(page.locator("#jobs-result")).to_have_attribute("aria-busy", "false")


PLOTS = ("live_pressure", "live_face_load")


@pytest.fixture(scope="module")
def over_face(browser, address):
    return shown(browser, address, computed(address, case=OVER_FACE))


def figure(page: Page, name: str) -> float:
    node = (
        page.locator("#live-figures > div")
        .filter(has=page.locator("dt", has_text=re.compile(f"^{name}$")))
        .locator("dd")
    )
    return float((node.text_content() or "nan").split()[0])


def test_a_misaligned_pair_is_pressed_harder_and_carries_less_evenly(over_face):
    page = over_face.page
    for key in PLOTS:
        expect(control(page, f"[data-figure={key}] .plot")).to_have_attribute("data-drawn", "yes")
    pressure, factor = figure(page, "largest pressure"), figure(page, "K_Hbeta")
    before = page.locator("#live-figures").text_content() or ""
    assert 1.0 <= factor < 1.2
    moved(page, "#live-misalignment_um", "End")
    assert figure(page, "largest pressure") > 1.2 * pressure
    assert figure(page, "K_Hbeta") > 1.5 * factor
    load = page.locator("[data-figure=live_face_load]")
    expect(load.locator(".scatterlayer .trace")).to_have_count(3)
    said = load.locator(".plot").get_attribute("aria-label") or ""
    assert f"K_Hbeta {figure(page, 'K_Hbeta'):g}" in said
    page.get_by_role("button", name="As analyzed").press("Enter")
    expect(page.locator("#live-figures")).to_have_text(before)


def test_in_the_plane_there_is_a_pressure_along_the_profile_and_no_face(browser, address, analyzed):
    page = shown(browser, address, analyzed).page
    before = figure(page, "largest pressure")
    expect(page.locator("[data-figure=live_face_load]")).to_be_hidden()
    expect(page.locator("#live-figures")).not_to_contain_text("K_Hbeta")
    moved(page, "#live-torque_n_m", "End")
    assert figure(page, "largest pressure") > 1.1 * before
    page.close()


def test_the_length_of_a_relief_acts_where_there_is_a_relief(browser, address, analyzed):
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


def test_they_are_accessible_and_nothing_is_complained_about(over_face):
    unfold(over_face.page)
    assert not (told := found_inaccessible(over_face.page)), json.dumps(told, indent=1)
    assert over_face.complaints == []
