"""One address for what is on screen: six kinds of state, reloaded, gone back to, sent, and in mid-job."""

import re
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from page_visit import PATIENCE, answered, control, moved, other_browser, typed
from playwright.sync_api import BrowserContext, Page, Route, expect
from running_service import until

UNIT = Path(__file__).parents[2] / "examples" / "two_stage_gearbox.rexs"
JOB = "22222222-2222-4222-8222-222222222222"
PRESSED = """() => [...document.querySelectorAll(":is(#variants, #unit:not([hidden])) [aria-pressed=true]")]
  .map((button) => button.textContent)"""

CARRIED = """async () => (await import("/page/packed.js")).unpack(
  new URLSearchParams(location.hash.slice(1)).get("case") ?? "")"""


class Jobs:
    """Analyses that never end, at no cost: what they are submitted with is all that is known of them."""

    def __init__(self) -> None:
        self.inputs: dict[str, Any] = {}

    def enter(self, route: Route) -> None:
        self.inputs = route.request.post_data_json["inputs"]
        route.fulfill(status=201, json=STATUS)

    def watch(self, context: BrowserContext) -> None:
        context.route("**/v1/processes/analyze/execution", self.enter)
        context.route(f"**/v1/jobs/{JOB}", lambda route: route.fulfill(json=STATUS))
        context.route(
            f"**/v1/jobs/{JOB}/inputs",
            lambda route: route.fulfill(json={"processID": "analyze", "inputs": self.inputs}),
        )


STATUS = {"jobID": JOB, "processID": "analyze", "status": "running", "progress": 40}


def seen(page: Page) -> tuple[Any, ...]:
    """Return what is typed, marked and said of the design."""
    return typed(page), page.evaluate(PRESSED), page.title(), page.locator("#roll-value").inner_text()


def same(page: Page, known: tuple[Any, ...]) -> None:
    with suppress(AssertionError):
        until(lambda: seen(page) == known)
    assert seen(page) == known


def carries(page: Page, gear: str, **known: float) -> None:
    """Wait until the address carries the last edit."""
    until(lambda: known.items() <= (page.evaluate(CARRIED) or {"pair": {gear: {}}})["pair"][gear].items())


def type_pair(page: Page, key: str) -> None:
    page.locator("#example").select_option("empty")
    for field, text in {"normal_module_mm": "2.5", "pinion-teeth": "21", "wheel-teeth": "24"}.items():
        control(page, f"#f-pair-{field}").fill(text)
    page.locator("#name").fill("own & typed")
    expect(page).to_have_url(re.compile("own%20%26%20typed"))
    carries(page, "wheel", teeth=24)


def choose_example(page: Page, key: str) -> None:
    page.locator("#example").select_option("internal_gear")
    carries(page, "wheel", teeth=96)


def make_variants(page: Page, key: str) -> None:
    page.evaluate("key => { location.hash = `database=${key}`; }", key)
    answered(page)
    moved(page, "#live-wheel-tip_relief_um", "End")
    page.get_by_role("button", name="Another variant").press("Enter")
    control(page, "#f-pair-pinion-tip_relief_um").fill("7")
    expect(page).to_have_url(re.compile(rf"a={key}\.\w+"))
    carries(page, "pinion", tip_relief_um=7)


def open_unit(page: Page, key: str) -> None:
    page.locator("#import-file").set_input_files(UNIT)
    page.locator("#unit [data-part]").nth(2).press("Enter")
    expect(page).to_have_url(re.compile("unit=.*see="))


def show_result(page: Page, key: str) -> None:
    page.evaluate("key => { location.hash = `database=${key}&tab=load`; }", key)
    answered(page)
    moved(page, "#live-wheel-tip_relief_um", "End")
    page.locator("#roll").press("End")
    expect(page).to_have_url(re.compile("live=.*at=1.00"))


def run_job(page: Page, key: str) -> None:
    choose_example(page, key)
    page.locator("#analyze").press("Enter")
    expect(page).to_have_url(re.compile(f"analyze={JOB}"))


@pytest.fixture(scope="module")
def watched(browser, address):
    jobs = Jobs()
    with other_browser(browser, f"{address}/#rail") as page:
        jobs.watch(page.context)
        page.set_default_timeout(PATIENCE)
        yield page, jobs


NIGHTLY = (choose_example, run_job, show_result)
"""By day these are opened by tests of their own."""


@pytest.mark.law
@pytest.mark.parametrize(
    "begin",
    [
        type_pair,
        make_variants,
        open_unit,
        *(pytest.param(kind, marks=pytest.mark.nightly) for kind in NIGHTLY),
    ],
    ids=lambda f: f.__name__,
)
def test_an_address_shows_the_same_to_everybody_at_any_moment(watched, browser, analyzed, begin):
    page, jobs = watched
    begin(page, analyzed)
    known, url = seen(page), page.url
    if begin is not run_job:
        page.locator("#analyze").press("Enter")
        expect(page).to_have_url(re.compile(f"analyze={JOB}"))
        same(page, known)  # in mid-job
    page.reload()
    page.wait_for_selector("html[data-ready=yes]")
    expect(page.locator("#analyze-job progress")).to_be_visible()
    same(page, known)
    if begin is not run_job:
        page.go_back()
        expect(page.locator("#analyze-job progress")).to_have_count(0)
        assert page.url == url
        same(page, known)
    with other_browser(browser, "about:blank", ready="body") as other:
        jobs.watch(other.context)
        other.goto(url)
        other.wait_for_selector("html[data-ready=yes]")
        same(other, known)
        assert other.url == url


@pytest.mark.law
def test_edits_are_undone_and_done_again(watched, analyzed):
    page, _ = watched
    page.evaluate("key => { location.hash = `database=${key}`; }", analyzed)
    answered(page)
    expect(page.locator("#live-wheel-tip_relief_um")).to_have_value("0")
    relief, slider = page.locator("#f-pair-pinion-tip_relief_um"), page.locator("#live-pinion-tip_relief_um")
    undo, redo = (page.get_by_role("button", name=name, exact=True) for name in ("Undo", "Redo"))
    expect(undo).to_be_disabled()
    moved(page, "#live-pinion-tip_relief_um", "End")
    expect(undo).to_be_enabled()
    control(page, "#f-pair-pinion-tip_relief_um").fill("7")
    expect(page).to_have_url(re.compile("case="))
    page.keyboard.press("Control+z")
    expect(relief, "within a field the browser undoes what is typed").to_have_value("")
    relief.fill("7")
    page.locator("#analyze").focus()
    page.keyboard.press("Control+z")
    expect(relief).to_have_value("")
    expect(slider).to_have_value("20")
    undo.press("Enter")
    expect(slider).to_have_value("0")
    expect(page).not_to_have_url(re.compile("live=|case="))
    for _ in range(2):
        redo.press("Enter")
    expect(relief).to_have_value("7")
    expect(slider).to_have_value("20")
    expect(redo).to_be_disabled()
