"""A page without an address computes its first example: there is a result with nothing to press."""

from __future__ import annotations

import json
import re

import pytest
from page_visit import found_inaccessible, opened
from playwright.sync_api import Browser, expect

from lineofaction.client import LineOfActionClient


@pytest.mark.law
def test_the_first_example_is_computed_when_the_page_opens(browser: Browser, address: str) -> None:
    visit = opened(browser, f"{address}/#")
    page = visit.page
    expect(page.locator("#glance-words")).to_contain_text(re.compile("is computed now|Result, as analyzed"))
    expect(page.locator("#glance-plot")).to_have_attribute("data-drawn", "yes")
    expect(page.locator("#glance-words")).to_contain_text("Result, as analyzed: Gear pair 23/67")
    expect(page.locator("#glance-figures")).to_contain_text("peak-to-peak")
    expect(page.locator("#glance-figures")).to_contain_text("largest pressure")
    box = page.locator("#glance-plot").bounding_box()
    assert box is not None and box["y"] + box["height"] < 900.0, "on the first screen"
    expect(page).to_have_url(re.compile("#database=[0-9a-f]{64}$"))
    assert page.locator(".design-note").count() == 0
    assert not (told := found_inaccessible(page)), json.dumps(told, indent=1)
    assert visit.complaints == []
    with LineOfActionClient(address) as client:
        key = page.url.partition("=")[2]
        before = client.fetch(key).metadata.content_hash
    page.close()
    again = opened(browser, f"{address}/#").page
    expect(again).to_have_url(re.compile(f"#database={before}$"))
    again.close()


OUTSIDE = """() => [...document.querySelectorAll("#results-body .plot")].flatMap((plot) => {
  const { right } = plot.getBoundingClientRect();
  const beyond = (label) => label.getBoundingClientRect().right > right + 1;
  return [...plot.querySelectorAll(".annotation-text")].filter(beyond).map((label) => label.textContent);
})"""


def test_labels_at_lines_stay_within_plots_on_a_narrow_screen(browser: Browser, address: str) -> None:
    page = opened(browser, f"{address}/#", width=400).page
    expect(page.locator("#results-body[aria-busy=false]")).to_have_count(1)
    assert page.locator("#results-body .annotation-text").count() > 20
    assert page.evaluate(OUTSIDE) == []
    page.close()


def test_a_section_of_the_page_computes_nothing(browser: Browser, address: str) -> None:
    page = opened(browser, f"{address}/#terms").page
    page.wait_for_selector("#plan dl")
    expect(page.locator("#glance")).to_be_hidden()
    assert page.url.endswith("#terms")
    page.close()


def test_the_examples_begin_with_an_ev_pair_and_an_industrial_spur_pair(
    browser: Browser, address: str
) -> None:
    page = opened(browser, address).page
    names = page.locator("#example option:not([hidden])").evaluate_all("all => all.map(one => one.value)")
    assert names[:2] == ["helical_ev_23_67", "industrial_spur_21_59"]
    expect(page.locator("#f-pair-helix_angle_deg")).to_have_value("22")
    page.close()
