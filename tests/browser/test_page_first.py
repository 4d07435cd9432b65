"""A page without an address shows its first example at once, and weighs little: bytes, listeners, memory."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from page_visit import CASE, answers, computed, control, found_inaccessible, opened, tab, unfold
from playwright.sync_api import CDPSession, Page, expect


@pytest.mark.law
def test_the_first_example_stands_there_with_its_errors_when_the_page_opens(browser, address):
    visit = opened(browser, f"{address}/#")
    page = visit.page
    expect(page.locator("#live-ripple .plot")).to_have_attribute("data-drawn", "yes")
    expect(page.locator("#dock-words")).to_have_text(re.compile(r"Gear pair 23/67: [^.].*[^.]\.$"))
    edges = r"largest pressure\d+ MPa on the flank; error not estimatedat the edges\d+ MPa indicative"
    expect(page.locator("#live-figures")).to_contain_text(re.compile(f"peak to peak.*±.*{edges}"))
    measured = re.findall(r"([\d.]+) µm ± ([\d.]+)", page.locator("#live-figures").inner_text())
    decimals = [[len(text.partition(".")[2]) for text in pair] for pair in measured]
    assert len(decimals) == 3 and all(value == error for value, error in decimals), "as the error leaves"
    assert page.evaluate(BEYOND) == [], "on the first screen, which does not scroll"
    assert [url for url in visit.requests if "/execution" in url] == [], "no job"
    assert page.locator(".design-note").count() == 0
    expect(page.locator("#live-ripple figcaption")).to_contain_text(
        "Gray, after Analyze: the pair as analyzed"
    )
    expect(page.locator(".made-band")).to_be_hidden()
    assert not (told := found_inaccessible(page)), json.dumps(told, indent=1)
    assert [line for line in visit.console if line.startswith("error")] == [], "nothing was refused either"
    control(page, "#f-pair-pinion-tip_relief_um").fill("12")
    expect(page.locator("#results-design")).to_contain_text("pinion tip relief 8 → 12 µm")
    expect(page).to_have_url(re.compile("#case="))
    tab(page, "Flank")
    expect(page.locator("[data-figure=live_pressure] .plot")).to_have_attribute("data-drawn", "yes")
    page.close()


@pytest.mark.law
def test_no_figure_of_a_result_stands_under_the_title_of_another(browser, address, analyzed):
    page = opened(browser, f"{address}/#").page
    figures = page.locator("#live-figures")
    expect(figures).to_contain_text("peak to peak")
    before = figures.locator("dd").first.inner_text()

    def hold(route):
        assert route.request.method == "POST"

    page.route("**/ste", hold)
    with page.expect_request("**/ste"):
        page.evaluate(f"location.hash = 'database={analyzed}'")
    expect(page.locator("#dock-words")).to_contain_text("Gear pair 20/20")
    expect(figures).not_to_contain_text(before)
    expect(figures).to_contain_text("mean STE")
    page.unroute("**/ste", hold)  # lets go what was held
    expect(figures).to_contain_text("first harmonic")
    expect(page.locator("#live-ripple figcaption")).to_contain_text(
        "Gray: the pair as analyzed, at the same torque"
    )
    page.close()


@pytest.mark.law
def test_a_design_that_is_opened_leaves_the_result_of_another_behind(browser, address):
    page = opened(browser, f"{address}/#").page
    figures, note = page.locator("#live-figures"), page.locator(".design-note")
    expect(figures).to_contain_text("peak to peak")
    control(page, "#f-pair-pinion-tip_relief_um").fill("12")
    expect(note).to_contain_text("Edited since")
    expect(figures).to_contain_text("peak to peak")
    for open_another in (
        lambda: page.locator("#example").select_option("empty"),
        lambda: page.locator("#import-file").set_input_files(UNIT),
    ):
        open_another()
        expect(figures).to_be_empty()
        expect(note).to_have_count(0)
        expect(page.locator("#results-none")).to_be_visible()
        page.go_back()
        expect(figures).to_contain_text("peak to peak")
    page.close()


UNIT = Path(__file__).parents[2] / "examples" / "two_stage_gearbox.rexs"
STATIC = Path(__file__).parents[2] / "service" / "page" / "static"
BEYOND = """() => ["#live-figures", "#analyze", "#thing", "#live-ripple .plot"].filter((name) => {
  const { right, bottom } = document.querySelector(name).getBoundingClientRect();
  const { scrollHeight, scrollWidth } = document.documentElement;
  return right > innerWidth || bottom > innerHeight || scrollHeight > innerHeight || scrollWidth > innerWidth;
})"""
"""Parts of the first screen that end beyond it."""
OUTSIDE = """() => [...document.querySelectorAll(":is(#results-body, .report) .plot")].flatMap((plot) => {
  const { right } = plot.getBoundingClientRect();
  const beyond = (label) => label.getBoundingClientRect().right > right + 1;
  return [...plot.querySelectorAll(".annotation-text")].filter(beyond).map((label) => label.textContent);
})"""


def test_a_phone_has_slider_and_curve_together_and_labels_within_plots(visit):
    page = visit.page
    page.set_viewport_size({"width": 400, "height": 660})
    curve, slider = (page.locator(name).bounding_box() for name in ("#live-ripple .plot", "#quick .slider"))
    assert curve is not None and slider is not None
    assert curve["height"] > 140.0
    for title in page.locator("#tabs [role=tab]:visible").all_inner_texts():
        tab(page, title)
        assert page.evaluate("document.documentElement.scrollHeight") <= 660, title
    tab(page, "Ripple")
    assert curve["y"] + curve["height"] <= slider["y"] <= 660.0 - slider["height"]
    page.set_viewport_size({"width": 400, "height": 900})
    expect(page.locator("#results-body[aria-busy=false]")).to_have_count(1)
    unfold(page)
    for title, minimum in {"Ripple": 4, "Orders": 4}.items():
        tab(page, title)
        figures = page.locator("[role=tabpanel]:not([hidden]) .report .plot")
        for plot in figures.all():
            expect(plot).to_have_attribute("data-drawn", "yes")
        assert page.locator(".report .annotation-text").count() > minimum
    assert page.evaluate(OUTSIDE) == []
    page.close()


def test_a_section_of_the_page_computes_nothing(browser, address):
    page = opened(browser, f"{address}/#rail").page
    page.wait_for_selector("#plan dl")
    expect(page.locator("#live-figures")).to_be_empty()
    assert page.url.endswith("#rail")
    page.close()


def test_the_examples_begin_with_an_ev_pair_and_an_industrial_spur_pair(browser, address):
    page = opened(browser, address).page
    names = page.locator("#example option:not([hidden])").evaluate_all("all => all.map(one => one.value)")
    assert names[:2] == ["helical_ev_23_67", "industrial_spur_21_59"]
    expect(page.locator("#f-pair-helix_angle_deg")).to_have_value("22")
    page.close()


FIRST_SCREEN = 900_000  # bytes
ROUNDS = 6
ONE_PLOT = 20  # listeners: code that the browser has compiled may hold the last plot it saw, once
GROWTH = 300_000  # bytes a result: code that the browser compiles meanwhile; a result that is held has 1.3 MB


@pytest.fixture(scope="module")
def other(address):
    return computed(address, case=CASE | {"load": {"torque_n_m": [0.4, 0.8]}})


@pytest.mark.law
def test_the_first_screen_is_light_and_has_no_plots_and_no_description_of_the_service(browser, address):
    page = browser.new_page()
    session = page.context.new_cdp_session(page)
    session.send("Network.enable")
    received: list[float] = []
    paths: list[str] = []
    session.on("Network.loadingFinished", lambda event: received.append(event["encodedDataLength"]))
    page.on("request", lambda request: paths.append(request.url.removeprefix(address)))
    page.goto(address)
    page.wait_for_selector("#plan dl")
    page.wait_for_selector("#live-ripple [data-drawn=yes]")
    page.wait_for_load_state("networkidle")
    assert len(received) > 20
    assert sum(received) < FIRST_SCREEN
    assert not {"/openapi.json", "/page/plotly.min.js"} & set(paths)
    page.close()


def visited(page: Page, key: str) -> None:
    """Go to a result within the page and wait until it is drawn, live flanks included."""
    before = answers(page)
    page.evaluate("key => { location.hash = `database=${key}`; }", key)
    page.wait_for_function(
        "before => Number(document.querySelector('#live-figures').dataset.answers) > before", arg=before
    )
    expect(page.locator("#results-body[aria-busy=false]")).to_have_count(1)


def weight(session: CDPSession) -> tuple[float, float]:
    """Return the listeners and the bytes in use after all garbage is gone."""
    for _ in range(3):
        session.send("HeapProfiler.collectGarbage")
    metrics: list[dict[str, Any]] = session.send("Performance.getMetrics")["metrics"]
    found = {metric["name"]: metric["value"] for metric in metrics}
    return found["JSEventListeners"], found["JSHeapUsedSize"]


@pytest.mark.nightly
def test_many_results_add_no_listeners_and_little_memory(browser, address, analyzed, other):
    page = opened(browser, address).page
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")
    for key in (analyzed, other) * 2:  # what is made once is made
        visited(page, key)
    listeners, used = weight(session)
    for _ in range(ROUNDS // 2):
        visited(page, analyzed)
        visited(page, other)
    later = weight(session)
    assert later[0] - listeners < ONE_PLOT
    assert later[1] - used < ROUNDS * GROWTH
    page.close()
