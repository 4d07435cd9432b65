"""What the page weighs: bytes of the first screen, listeners and memory of many results."""

from __future__ import annotations

from typing import Any

import pytest
from page_visit import CASE, computed, opened
from playwright.sync_api import Browser, CDPSession, Page, expect

FIRST_SCREEN = 600_000  # bytes
ROUNDS = 6
ONE_PLOT = 20  # listeners: code that the browser has compiled may hold the last plot it saw, once
GROWTH = 300_000  # bytes a result: code that the browser compiles meanwhile; a result that is held has 1.3 MB


@pytest.fixture(scope="module")
def other(address: str) -> str:
    """Hash of a second table of the small pair."""
    return computed(address, case=CASE | {"load": {"torque_n_m": [0.4, 0.8]}})


@pytest.mark.law
def test_the_first_screen_is_light_and_has_no_plots_and_no_description_of_the_service(
    browser: Browser, address: str
) -> None:
    page = browser.new_page()
    session = page.context.new_cdp_session(page)
    session.send("Network.enable")
    received: list[float] = []
    paths: list[str] = []
    session.on("Network.loadingFinished", lambda event: received.append(event["encodedDataLength"]))
    page.on("request", lambda request: paths.append(request.url.removeprefix(address)))
    page.goto(f"{address}/#pair")  # where nothing is computed
    page.wait_for_selector("#plan dl")
    page.wait_for_load_state("networkidle")
    assert len(received) > 20
    assert sum(received) < FIRST_SCREEN
    assert not {"/openapi.json", "/page/plotly.min.js"} & set(paths)
    page.close()


def visited(page: Page, key: str) -> None:
    """Go to a result within the page and wait until it is drawn, live flanks included."""
    before = int(page.locator("#live-body").get_attribute("data-answers") or 0)
    page.evaluate("key => { location.hash = `database=${key}`; }", key)
    page.wait_for_function(
        "before => Number(document.querySelector('#live-body').dataset.answers) > before", arg=before
    )
    expect(page.locator("#results [aria-busy=false]")).to_have_count(1)


def weight(session: CDPSession) -> tuple[float, float]:
    """Return the listeners and the bytes in use after all garbage is gone."""
    for _ in range(3):
        session.send("HeapProfiler.collectGarbage")
    metrics: list[dict[str, Any]] = session.send("Performance.getMetrics")["metrics"]
    found = {metric["name"]: metric["value"] for metric in metrics}
    return found["JSEventListeners"], found["JSHeapUsedSize"]


@pytest.mark.nightly
def test_many_results_add_no_listeners_and_little_memory(
    browser: Browser, address: str, analyzed: str, other: str
) -> None:
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
