"""The address is the state: menu, reload, back, forward and another browser show what it names."""

import re
from typing import Any

import pytest
from page_visit import (
    CASE,
    answered,
    choose_case,
    computed,
    control,
    moved,
    opened,
    other_browser,
    shows_the_same,
    tab,
)
from playwright.sync_api import Page, Route, expect
from running_service import until

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.schemas import Case, validated

LONG = CASE | {"accuracy": {"level": "fine", "model": "3d", "positions": 512}}
NOWHERE = "11111111-1111-4111-8111-111111111111"
EDITED = "Edited since: pinion tip relief 0 → 7 µm"


def type_relief(page: Page) -> None:
    control(page, "#f-pair-pinion-tip_relief_um").fill("7")
    expect(page.locator("#results-design")).to_contain_text(EDITED)


@pytest.mark.law
def test_a_reload_shows_what_was_typed_and_moved(visit):
    page = visit.page
    type_relief(page)
    control(page, "#live-wheel-tip_relief_um").press("End")
    control(page, "#study-Tolerances-samples").fill("77")
    page.reload()
    expect(page.locator("#live-wheel-tip_relief_um-exact")).to_have_value("20")
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("7")
    expect(page.locator("#study-Tolerances-samples")).to_have_value("77")
    expect(page.locator("#results-design")).to_contain_text(EDITED)
    assert visit.complaints == []


@pytest.mark.law
def test_flanks_and_torque_that_were_moved_are_sent_with_the_address(visit, browser):
    page, sliders = visit.page, ("#live-wheel-tip_relief_um", "#live-torque_n_m")
    for slider in sliders:
        moved(page, slider, "End")
    expect(page).to_have_url(re.compile("live="))
    page.wait_for_timeout(600)  # ms: the address is written when the hand rests
    with other_browser(browser, page.url) as sent:
        answered(sent)
        for slider in sliders:
            assert (
                sent.locator(f"{slider}-exact").input_value() == page.locator(f"{slider}-exact").input_value()
            )


def test_the_client_has_the_case_and_the_result_that_an_address_shows(visit, address, analyzed):
    page = visit.page
    with LineOfActionClient(address) as client:
        assert client.case_at(page.url) == validated(Case, CASE)
        type_relief(page)
        page.wait_for_url(re.compile("case="))
        relieved = CASE["pair"] | {"pinion": CASE["pair"]["pinion"] | {"tip_relief_um": 7}}
        assert client.case_at(page.url) == validated(Case, CASE | {"pair": relieved})
        page.locator("#variants").get_by_role("button", name="Another variant").press("Enter")
        page.wait_for_url(re.compile("on=b"))
        control(page, "#f-pair-pinion-tip_relief_um").fill("8")
        expect(page.locator("#results-design")).to_contain_text("→ 8 µm")
        page.wait_for_url(lambda url: client.case_at(url).pair.pinion.tip_relief_um == 8.0)
        assert client.result_at(page.url) == analyzed


def test_a_reload_shows_what_was_typed_if_the_browser_loses_its_entry(visit):
    page = visit.page
    type_relief(page)
    page.wait_for_timeout(500)  # nothing is to be kept any more
    page.evaluate("history.replaceState(null, '')")
    page.reload()
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("7")
    expect(page.locator("#results-design")).to_contain_text(EDITED)


def test_a_result_says_of_which_design_it_is_and_leads_back(visit):
    page = visit.page
    assert page.locator(".design-note").count() == 0
    type_relief(page)
    note = page.locator("#results-design")
    note.get_by_role("button", name="Back to that design").press("Enter")
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("")
    assert page.locator(".design-note").count() == 0
    page.go_back()
    expect(note).to_contain_text(EDITED)


def test_a_job_under_way_goes_on_after_a_reload_and_is_left_by_the_way_back(browser, address):
    page = opened(browser, address).page
    with LineOfActionClient(address) as client:
        job = client.submit("frontier", {"case": LONG})
        page.goto(f"{address}/#frontier={job.id}")
        tab(page, "Errors and cost")
        card = page.locator(".study").filter(has=page.get_by_role("heading", name="Accuracy frontier"))
        expect(card.get_by_role("button", name="Run the accuracy study")).to_be_disabled()
        page.reload()
        tab(page, "Errors and cost")
        expect(card.locator("progress")).to_be_visible()
        page.go_back()
        expect(card.locator(".job")).to_have_count(0)
        page.go_forward()
        card.get_by_role("button", name="Cancel frontier").press("Enter")
        expect(card.get_by_role("alert")).to_contain_text("Cancelled")
        until(lambda: client.status(job.id).status == "dismissed")
    page.close()


def test_an_analysis_survives_a_reload_in_mid_job(browser, address, analyzed, tmp_path):
    page = opened(browser, address).page
    choose_case(page, tmp_path)
    page.route(re.compile(r"/v1/jobs/[^?]"), lambda _: None)  # no end is heard of until the page is reloaded
    page.locator("#analyze").press("Enter")
    page.wait_for_url(re.compile("#analyze="))
    page.unroute_all(behavior="ignoreErrors")
    page.reload()
    answered(page)
    assert analyzed in page.url and "analyze=" not in page.url
    expect(page.locator("#f-pair-pinion-teeth")).to_have_value("20")
    page.go_back()
    expect(page.locator("#results-none")).to_be_visible()
    expect(page.locator("#live-figures")).to_be_empty()
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
def test_an_unknown_address_is_said_on_the_first_screen(browser, address, name, said):
    page = opened(browser, f"{address}/#{name}", width=400).page
    notice = page.locator("#notice")
    expect(notice).to_contain_text(said)
    box = notice.bounding_box()
    assert box is not None and box["y"] >= 0.0 and box["y"] + box["height"] < 900.0
    expect(notice).to_contain_text("The fields of the gear pair are left empty.")
    expect(page.locator("#f-pair-normal_module_mm")).to_have_value("")
    page.route("**/execution", lambda _: None)  # the first example is not computed
    notice.get_by_role("link", name="Begin anew").press("Enter")
    expect(notice).to_be_empty()
    page.close()


@pytest.mark.nightly
def test_a_study_whose_answer_is_lost_is_asked_again(visit, address, analyzed):
    page = visit.page
    computed(address, "scatter", case=CASE, tolerance_class=8, samples=50)
    lost: list[Route] = []

    def lose(route):
        """Let the service have the request once and nobody have its answer."""
        lost.append(route)
        route.fetch()
        route.abort()

    page.route("**/v1/processes/scatter/execution", lose, times=1)
    control(page, "#study-Tolerances-tolerance_class").fill("8")
    control(page, "#study-Tolerances-samples").fill("50")
    tab(page, "Tolerance")
    page.get_by_role("button", name="Draw pairs").press("Enter")
    expect(page.locator("[data-figure=scatter] .plot")).to_have_attribute("data-drawn", "yes")
    assert len(lost) == 1
    assert page.locator("#panels [role=alert]").count() == 0
    page.reload()
    tab(page, "Tolerance")
    expect(page.locator("[data-figure=scatter] .plot")).to_have_attribute("data-drawn", "yes")


def entered(address: str, process: str, **inputs: Any) -> str:
    """Submit a job and wait for its end; returns its identifier."""
    with LineOfActionClient(address) as client:
        job = client.submit(process, inputs)
        until(lambda: client.status(job.id).status in ("successful", "failed"))
        return job.id


def test_the_address_of_an_analysis_shows_its_design_and_its_result(browser, address, analyzed, tmp_path):
    job = entered(address, "analyze", case=CASE)
    sender = opened(browser, address).page
    choose_case(sender, tmp_path)
    sender.locator("#analyze").press("Enter")
    expect(sender).to_have_url(re.compile(f"#database={analyzed}(&name=case)?$"))
    answered(sender)
    for name in (f"analyze={job}", f"job={job}", sender.url.partition("#")[2]):
        with other_browser(browser, f"{address}/#{name}") as page:
            expect(page).to_have_url(re.compile(f"#database={analyzed}(&name=case)?$"))
            answered(page)
            shows_the_same(page, sender)
            assert page.locator(".design-note").count() == 0
    sender.close()


def test_the_design_of_a_job_under_way_stands_before_its_result(browser, address):
    with LineOfActionClient(address) as client:
        job = client.submit("analyze", {"case": LONG})
        with other_browser(browser, f"{address}/#analyze={job.id}") as page:
            expect(page.locator("#analyze-job .job")).to_be_visible()
            expect(page.locator("#f-pair-normal_module_mm")).to_have_value("1")
            expect(page.locator("#f-accuracy-level")).to_have_value("fine")
            expect(page.locator("#example-note")).to_have_text("The pair of this address.")
            page.get_by_role("button", name="Cancel analyze", exact=True).press("Enter")
            expect(page.locator("#notice")).to_contain_text("analyze: The job was cancelled.")
            expect(page.locator("#f-pair-normal_module_mm")).to_have_value("1")


def test_a_study_is_sent_with_the_design_as_edited_and_what_was_typed_for_it(visit, browser):
    page = visit.page
    control(page, "#f-pair-pinion-tip_relief_um").fill("7")
    control(page, "#f-pair-pinion-tip_relief_length_mm").fill("0.3")
    control(page, "#study-Flank-pressure-torque_n_m").fill("0.8")
    tab(page, "Flank")
    page.get_by_role("button", name="Compute flank pressure").press("Enter")
    expect(page.locator("[data-figure=contact_pattern] .plot")).to_have_attribute("data-drawn", "yes")
    expect(page.locator("#results-design")).to_contain_text(EDITED)
    with other_browser(browser, page.url) as other:
        tab(other, "Flank")
        expect(other.locator("[data-figure=contact_pattern] .plot")).to_have_attribute("data-drawn", "yes")
        expect(other.locator("#results-design")).to_contain_text(EDITED)
        answered(other)
        shows_the_same(other, page)
        assert other.locator("#panels .design-note").count() == 0
    assert visit.complaints == []


@pytest.mark.nightly
def test_a_run_up_is_sent_with_its_result_and_what_was_typed_for_it(visit, browser):
    page = visit.page
    control(page, "#study-Run-up-duration_s").fill("0.05")
    control(page, "#study-Run-up-torque_n_m").fill("0.9")
    tab(page, "Orders")
    page.get_by_role("button", name="Simulate the run-up").press("Enter")
    drawn = "#dynamics-body [data-figure=dynamic_error] .plot"
    expect(page.locator(drawn)).to_have_attribute("data-drawn", "yes")
    with other_browser(browser, page.url) as other:
        tab(other, "Orders")
        expect(other.locator(drawn)).to_have_attribute("data-drawn", "yes")
        shows_the_same(other, page)
        assert other.locator(".design-note").count() == 0
    job = page.url.partition("simulate=")[2]
    with other_browser(browser, f"{page.url.partition('#')[0]}#simulate={job}") as other:
        tab(other, "Jobs")
        expect(other.locator(drawn.replace("dynamics-body", "jobs-result"))).to_have_attribute(
            "data-drawn", "yes"
        )
        expect(other.locator("#f-pair-normal_module_mm")).to_have_value("1")
        expect(other.locator("#scene-text")).to_have_value(re.compile("duration_s = 0.05"))


def test_a_scene_is_sent_with_its_text_and_its_speeds(visit, browser):
    page = visit.page
    tab(page, "Sound")
    page.get_by_role("button", name="Write the scene of the pair").press("Enter")
    expect(page.locator("#scene-text")).to_have_value(re.compile("database_hash"))
    page.get_by_label("Compute", exact=True).select_option("modes")
    page.locator("#scene-body").get_by_label("to, rpm", exact=True).fill("2000")
    page.locator("#scene-body").get_by_label("number", exact=True).fill("4")
    page.get_by_role("button", name="Compute the scene").press("Enter")
    drawn = "#scene-body [data-figure=modal_campbell] .plot"
    expect(page.locator(drawn)).to_have_attribute("data-drawn", "yes")
    with other_browser(browser, page.url) as other:
        tab(other, "Sound")
        expect(other.locator(drawn)).to_have_attribute("data-drawn", "yes")
        shows_the_same(other, page)


def test_a_job_of_the_list_takes_the_page_with_its_design(visit, browser, address):
    page = visit.page
    load = {"torque_n_m": [0.9, 1.1]}
    entered(address, "flank", case=CASE | {"load": load})
    page.reload()
    expect(page.locator("#live-ripple .plot")).to_have_attribute("data-drawn", "yes")  # with its sliders
    tab(page, "Jobs")
    page.get_by_role("button", name=re.compile("^Open flank")).first.press("Enter")
    expect(page.locator("#jobs-result .plot").first).to_have_attribute("data-drawn", "yes")
    expect(page.locator("#f-load-torque_n_m")).to_have_value("0.9, 1.1")
    assert page.locator(".design-note").count() == 0
    with other_browser(browser, page.url) as other:
        tab(other, "Jobs")
        expect(other.locator("#jobs-result .plot").first).to_have_attribute("data-drawn", "yes")
        shows_the_same(other, page)
    page.go_back()
    expect(page.locator("#f-load-torque_n_m")).to_have_value("0.5, 1")
    tab(page, "Ripple")
    expect(page.locator("#live-ripple .plot")).to_have_attribute("data-drawn", "yes")


def test_a_job_that_failed_says_so_beside_its_design(browser, address):
    with LineOfActionClient(address) as client:
        job = client.with_terms(max_cost_s=0.1).submit("frontier", {"case": LONG}).id
        until(lambda: client.status(job).status == "failed")
        message = client.status(job).message
    with other_browser(browser, f"{address}/#frontier={job}") as page:
        expect(page.locator("#notice li")).to_have_text(f"frontier: {message}")
        expect(page.locator("#f-pair-normal_module_mm")).to_have_value("1")


def test_openings_file_no_job(browser, address):
    with LineOfActionClient(address) as client:
        before = [job.id for job in client.jobs(process="analyze")]
        for _ in range(2):
            with other_browser(browser, address) as page:
                expect(page.locator("#live-ripple .plot")).to_have_attribute("data-drawn", "yes")
        assert [job.id for job in client.jobs(process="analyze")] == before


def test_the_same_design_analyzed_again_is_the_same_job(visit):
    page = visit.page

    def job():
        with page.expect_response("**/v1/processes/analyze/execution") as answer:
            page.locator("#analyze").press("Enter")
        expect(page.locator("#analyze")).to_be_enabled()
        return str(answer.value.json()["jobID"])

    assert job() == job()
