"""The page without a mouse, zoomed, and with less motion."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from page_visit import Visit, answers, shown
from playwright.sync_api import Browser, Page
from running_service import until

FOCUS = """() => {
  const node = document.activeElement;
  const drawn = node.classList.contains('hidden-file') ? node.nextElementSibling : node; // a label
  const style = getComputedStyle(drawn), box = drawn.getBoundingClientRect();
  const own = node.id || node.textContent.trim().slice(0, 30) || node.tagName;
  const ring = style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) >= 2;
  return {own, ring, inside: box.bottom > 0 && box.top < innerHeight, body: node === document.body};
}"""


@pytest.fixture(scope="module")
def visit(browser: Browser, address: str, analyzed: str) -> Iterator[Visit]:
    seen = shown(browser, address, analyzed)
    seen.page.emulate_media(reduced_motion="reduce")  # a page that still glides is nowhere yet
    yield seen
    seen.page.close()


def stops(page: Page, most: int) -> list[dict[str, object]]:
    found = []
    for _ in range(most):
        page.keyboard.press("Tab")
        found.append(page.evaluate(FOCUS))
    return found


def test_the_first_stop_skips_to_the_gear_pair(browser: Browser, address: str) -> None:
    page = browser.new_page()
    page.route("**/execution", lambda _: None)  # the first example is not computed
    page.goto(address)
    page.wait_for_selector("html[data-ready=yes]")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    assert page.locator(".skip").bounding_box()["x"] >= 0  # type: ignore[index]
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "pair"
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "example"
    page.close()


@pytest.mark.law
def test_every_stop_is_seen_and_the_order_is_that_of_the_page(visit: Visit) -> None:
    page = visit.page
    page.evaluate("document.querySelector('#pair').focus()")
    first = stops(page, 2)
    assert first[1]["own"] == "import-file"
    assert first[1]["ring"]
    page.evaluate("document.querySelector('#run').focus()")
    found = stops(page, 120)
    assert not [stop for stop in found if not stop["body"] and not (stop["ring"] and stop["inside"])]
    names = [str(stop["own"]) for stop in found]
    places = [names.index(name) for name in ("analyze", "live-torque_n_m", "keep")]
    assert places == sorted(places)
    assert "forget" not in names, "what is hidden is no stop"


def test_a_slider_says_its_value_with_the_unit(visit: Visit) -> None:
    slider = visit.page.locator("#live-wheel-tip_relief_um")
    assert slider.get_attribute("aria-valuetext") == "0 µm"
    count = answers(visit.page)
    slider.press("ArrowRight")
    until(lambda: answers(visit.page) > count)
    value = slider.input_value()
    assert float(value) > 0.0
    assert slider.get_attribute("aria-valuetext") == f"{value} µm"


@pytest.mark.parametrize(("motion", "behavior"), [("reduce", "auto"), ("no-preference", "smooth")])
def test_nothing_glides_where_less_motion_is_asked_for(visit: Visit, motion: str, behavior: str) -> None:
    visit.page.emulate_media(reduced_motion=motion)  # type: ignore[arg-type]
    assert visit.page.evaluate("document.getAnimations().length") == 0
    style = "getComputedStyle(document.documentElement).scrollBehavior"
    assert visit.page.evaluate(style) == behavior
    visit.page.emulate_media(reduced_motion="reduce")


@pytest.mark.parametrize("width", [700, 320])  # 200 % of 1400 pixels; what WCAG 1.4.10 asks for
def test_zoomed_in_nothing_is_cut_off_or_covered(visit: Visit, width: int) -> None:
    page = visit.page
    page.set_viewport_size({"width": width, "height": 450})
    until(lambda: page.evaluate("document.documentElement.scrollWidth") <= width)  # plots follow in a moment
    sliders, plots = (page.locator(name).bounding_box() for name in ("#sliders", "#live-plots"))
    assert sliders is not None and plots is not None
    assert sliders["y"] + sliders["height"] <= plots["y"], "one column"
    page.evaluate("document.querySelector('#dynamics').focus()")
    stop = stops(page, 1)[0]
    bar = page.locator(".top").bounding_box()
    box = page.evaluate("document.activeElement.getBoundingClientRect().top")
    assert stop["inside"] and bar is not None and box >= max(bar["y"] + bar["height"], 0.0)
