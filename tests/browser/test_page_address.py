"""The address is the state: menu, reload, back and forward show what it names; an unknown one is said."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from page_visit import CASE, Visit, choose_case, computed, opened, shown
from playwright.sync_api import Browser, Page, Route, expect
from running_service import until

from lineofaction.client import LineOfActionClient

LONG = CASE | {"accuracy": {"level": "fine", "model": "3d", "positions": 512}}
NOWHERE = "11111111-1111-4111-8111-111111111111"
EDITED = "Edited since: pinion tip relief 0 µm → 7 µm"


@pytest.fixture
def visit(browser: Browser, address: str, analyzed: str) -> Iterator[Visit]:
    seen = shown(browser, address, analyzed)
    yield seen
    seen.page.close()


def type_relief(page: Page) -> None:
    """Edit the design of the result that is shown."""
    page.locator("#f-pair-pinion-tip_relief_um").fill("7")
    expect(page.locator("#results-design")).to_contain_text(EDITED)


def test_the_menu_leaves_the_result_in_the_address(visit: Visit, analyzed: str) -> None:
    page = visit.page
    before = page.url
    for link in page.get_by_role("navigation").get_by_role("link").all():
        link.press("Enter")
        section = (link.get_attribute("href") or "")[1:]
        assert page.evaluate("document.activeElement.id") == section
    assert page.url == before
    page.reload()
    expect(page.locator("#results [data-figure=ste] .plot")).to_have_attribute("data-drawn", "yes")


@pytest.mark.law
def test_a_reload_shows_what_was_typed_and_moved(visit: Visit) -> None:
    page = visit.page
    type_relief(page)
    page.locator("#live-wheel-tip_relief_um").press("End")
    page.locator("#study-Tolerances-samples").fill("77")
    page.reload()
    expect(page.locator("#live-wheel-tip_relief_um-exact")).to_have_value("20")
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("7")
    expect(page.locator("#study-Tolerances-samples")).to_have_value("77")
    expect(page.locator("#results-design")).to_contain_text(EDITED)
    assert visit.complaints == []


def test_a_reload_shows_what_was_typed_if_the_browser_loses_its_entry(visit: Visit) -> None:
    page = visit.page
    type_relief(page)
    page.wait_for_timeout(500)  # nothing is to be kept any more
    page.evaluate("history.replaceState(null, '')")
    page.reload()
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("7")
    expect(page.locator("#results-design")).to_contain_text(EDITED)


def test_back_and_forward_show_what_they_showed(visit: Visit, analyzed: str) -> None:
    page = visit.page
    type_relief(page)
    page.locator("#example").select_option("internal_gear")
    expect(page.locator("#f-pair-wheel-teeth")).to_have_value("96")
    expect(page.locator("#results-design")).to_contain_text("pinion teeth 20 → 36")
    page.go_back()
    expect(page.locator("#f-pair-wheel-teeth")).to_have_value("20")
    expect(page.locator("#results-design")).to_contain_text(EDITED)
    page.go_forward()
    expect(page.locator("#f-pair-wheel-teeth")).to_have_value("96")
    assert page.locator("#example").input_value() == "internal_gear"
    assert analyzed in page.url


def test_a_result_says_of_which_design_it_is_and_leads_back(visit: Visit) -> None:
    page = visit.page
    assert page.locator(".design-note").count() == 0
    type_relief(page)
    note = page.locator("#results-design")
    note.get_by_role("button", name="Back to that design").press("Enter")
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("")
    assert page.locator(".design-note").count() == 0
    page.go_back()
    expect(note).to_contain_text(EDITED)


def test_a_job_under_way_goes_on_after_a_reload_and_is_left_by_the_way_back(
    browser: Browser, address: str
) -> None:
    page = opened(browser, address).page
    with LineOfActionClient(address) as client:
        job = client.submit("frontier", {"case": LONG})
        page.goto(f"{address}/#frontier={job.id}")
        card = page.locator(".study").filter(has=page.get_by_role("heading", name="Accuracy frontier"))
        expect(card.get_by_role("button", name="Run the accuracy study")).to_be_disabled()
        page.reload()
        expect(card.locator("progress")).to_be_visible()
        page.go_back()
        expect(card.locator(".job")).to_have_count(0)
        page.go_forward()
        card.get_by_role("button", name="Cancel frontier").press("Enter")
        expect(card.get_by_role("alert")).to_contain_text("Cancelled")
        until(lambda: client.status(job.id).status == "dismissed")
    page.close()


def test_an_analysis_survives_a_reload_in_mid_job(
    browser: Browser, address: str, analyzed: str, tmp_path: Path
) -> None:
    page = opened(browser, address).page
    choose_case(page, tmp_path)
    page.route(re.compile(r"/v1/jobs/[^?]"), lambda _: None)  # no end is heard of until the page is reloaded
    page.locator("#analyze").press("Enter")
    page.wait_for_url(re.compile("#analyze="))
    page.unroute_all(behavior="ignoreErrors")
    page.reload()
    expect(page.locator("#live-body")).to_have_attribute("data-answers", re.compile(r"\d"))
    assert analyzed in page.url and "analyze=" not in page.url
    expect(page.locator("#f-pair-pinion-teeth")).to_have_value("20")
    page.go_back()
    expect(page.locator("#results-none")).to_be_visible()
    expect(page.locator("#live-body")).to_be_hidden()
    page.close()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        (f"database={'0' * 64}", "There is no result"),
        (f"frontier={NOWHERE}", "There is no job"),
        ("database=none", "no such address"),
        ("nothing", "no such address"),
    ],
)
def test_an_unknown_address_is_said_on_the_first_screen(
    browser: Browser, address: str, name: str, said: str
) -> None:
    page = opened(browser, f"{address}/#{name}", width=400).page
    notice = page.locator("#notice")
    expect(notice).to_contain_text(said)
    box = notice.bounding_box()
    assert box is not None and box["y"] >= 0.0 and box["y"] + box["height"] < 900.0
    expect(notice).to_contain_text("The fields of the gear pair are left empty.")
    assert page.locator("#f-pair-normal_module_mm").input_value() == ""
    page.route("**/execution", lambda _: None)  # the first example is not computed
    notice.get_by_role("link", name="Begin anew").press("Enter")
    expect(notice).to_be_empty()
    page.close()


@pytest.mark.nightly
def test_a_study_whose_answer_is_lost_is_asked_again(visit: Visit, address: str, analyzed: str) -> None:
    page = visit.page
    computed(address, "scatter", case=CASE, tolerance_class=8, samples=50)
    lost: list[Route] = []

    def lose(route: Route) -> None:
        """Let the service have the request once and nobody have its answer."""
        lost.append(route)
        route.fetch()
        route.abort()

    page.route("**/v1/processes/scatter/execution", lose, times=1)
    page.locator("#study-Tolerances-tolerance_class").fill("8")
    page.locator("#study-Tolerances-samples").fill("50")
    page.get_by_role("button", name="Draw pairs").press("Enter")
    expect(page.locator("[data-figure=scatter] .plot")).to_have_attribute("data-drawn", "yes")
    assert len(lost) == 1
    assert page.locator("#studies [role=alert]").count() == 0
    page.reload()
    expect(page.locator("[data-figure=scatter] .plot")).to_have_attribute("data-drawn", "yes")
