"""Jobs on the page: listed, reopened, cancelled; and a service that goes away and comes back."""

import json
import re

import pytest
from page_visit import CASE, answers, choose_case, control, found_inaccessible, opened, tab
from playwright.sync_api import expect
from running_service import until
from stored_jobs import state

from lineofaction.client import JobState, LineOfActionClient

LONG = CASE | {"accuracy": {"level": "fine", "model": "3d", "positions": 512}}


STATES = """async (jobs) => {
  const { stateOf } = await import("/page/job.js");
  return jobs.map((job) => stateOf(job));
}"""


def test_page_and_terminal_say_behind_how_many_a_job_waits(scripts):
    jobs = [state("a", "accepted") | {"ahead": ahead} for ahead in (0, 1, 2)]
    behind = ("", " behind 1 job", " behind 2 jobs")
    assert scripts.evaluate(STATES, jobs) == [f"waits for its turn{words}" for words in behind]
    assert [JobState.from_json(job).activity for job in jobs] == [f"waits{words}" for words in behind]


@pytest.mark.law
def test_a_job_is_cancelled_from_the_list(visit, address):
    page = visit.page
    tab(page, "Jobs")
    with LineOfActionClient(address) as client:
        job = client.submit("frontier", {"case": LONG})
        page.reload()
        tab(page, "Jobs")
        row = page.get_by_role("listitem").filter(
            has=page.get_by_role("button", name=re.compile("Cancel frontier"))
        )
        row.get_by_role("button", name=re.compile("^Cancel")).press("Enter")
        until(lambda: client.status(job.id).status == "dismissed")
    first = page.locator("#jobs-rows li").first
    expect(first).to_contain_text("cancelled")
    assert first.get_by_role("button", name=re.compile("^(Cancel|Open|Compare)")).count() == 0


def test_the_jobs_of_a_batch_are_shown_beneath_it(visit, address):
    page = visit.page
    tab(page, "Jobs")
    loads = [{"torque_n_m": [torque]} for torque in (0.5, 0.75)]
    with LineOfActionClient(address) as client:
        batch = client.with_terms(title="Two loads").analyze.batch([CASE | {"load": load} for load in loads])
        batch.wait()
    page.reload()
    tab(page, "Jobs")
    row = page.get_by_role("listitem").filter(has_text="Two loads")
    expect(row).to_contain_text("analyze, 2 jobs")
    assert row.get_by_role("button", name=re.compile("^(Open|Compare)")).count() == 0
    row.get_by_role("button", name=re.compile("^Show jobs")).press("Enter")
    inner = page.locator("#jobs-rows .inner")
    expect(inner).to_have_count(2)
    expect(inner.nth(1)).to_contain_text("torque 0.5 → 0.75 N m")
    assert not (told := found_inaccessible(page, "#jobs")), json.dumps(told, indent=1)
    inner.nth(1).get_by_role("button", name=re.compile("^Open analyze")).press("Enter")
    expect(page).to_have_url(re.compile("#database="))
    tab(page, "Jobs")
    row.get_by_role("button", name=re.compile("^Hide jobs")).press("Enter")
    expect(inner).to_have_count(0)
    assert visit.complaints == []


def test_a_result_opens_again_in_another_window(visit, browser, address):
    page = visit.page
    tab(page, "Jobs")
    tab(page, "Orders")
    page.get_by_role("button", name="Find the modes").press("Enter")
    expect(page.locator("[data-figure=modal_campbell] .plot")).to_have_attribute("data-drawn", "yes")
    expect(page.locator("#jobs-rows li").first).to_contain_text("scene of 1 mesh")
    later = opened(browser, address).page
    tab(later, "Jobs")
    later.get_by_role("button", name=re.compile("^Open modes")).first.press("Enter")
    again = later.locator("#jobs-result [data-figure=modal_campbell] .plot")
    expect(again).to_have_attribute("data-drawn", "yes")
    expect(later.locator("#jobs-result")).to_be_focused()
    assert not (told := found_inaccessible(later, "#jobs")), json.dumps(told, indent=1)
    later.close()


def test_a_job_is_renamed_and_found_by_title_and_tag(visit, address):
    page = visit.page
    tab(page, "Jobs")
    with LineOfActionClient(address) as client:
        job = client.with_terms(tags=["EV-3"]).submit("analyze", {"case": CASE})
        client.submit("analyze", {"case": CASE | {"load": {"torque_n_m": [0.6]}}})
        page.reload()
        tab(page, "Jobs")
        rows = page.locator("#jobs-rows li")
        row = rows.filter(has_text="#ev-3")
        page.once("dialog", lambda dialog: dialog.accept("Tip relief"))
        row.get_by_role("button", name=re.compile("^Rename analyze")).press("Enter")
        expect(row).to_contain_text("Tip relief")
        expect(row).to_contain_text("20/20, module 1 mm, up to 1 N m")
        assert client.status(job.id).title == "Tip relief"
    page.get_by_label("Find by words").fill("RELIEF #ev-3")
    page.get_by_label("Find by words").press("Enter")
    expect(rows).to_have_count(1)
    expect(rows).to_contain_text("Tip relief")
    page.get_by_label("Find by words").fill("#no-such-tag")
    page.get_by_label("Find by words").press("Enter")
    expect(page.locator("#jobs-none")).to_have_text("No such jobs.")
    assert not (told := found_inaccessible(page, "#jobs")), json.dumps(told, indent=1)
    assert visit.complaints == []


def test_a_job_tells_what_sets_it_apart(visit, address):
    page = visit.page
    tab(page, "Jobs")
    with LineOfActionClient(address) as client:
        for torques in ([0.5, 1.0], [0.5]):
            client.submit("analyze", {"case": CASE | {"load": {"torque_n_m": torques}}})
    page.reload()
    expect(page.locator("#jobs-rows li").first).to_contain_text("torque 0.5, 1 → 0.5 N m")


def test_a_job_under_way_outlasts_a_service_that_is_away(visit, address, tmp_path):
    page = visit.page
    tab(page, "Jobs")
    with LineOfActionClient(address) as client:
        busy = client.submit("frontier", {"case": LONG})  # the one worker: the job waits
    choose_case(page, tmp_path)
    control(page, "#f-load-torque_n_m").fill("0.7, 1.3")
    page.wait_for_selector("#plan dl")
    page.locator("#analyze").press("Enter")
    page.wait_for_selector("#analyze-job .job")
    page.context.set_offline(True)
    expect(page.locator("#away")).to_contain_text("does not answer")
    expect(page.locator("#analyze-job [role=status]")).to_contain_text("asked for again")
    assert not (told := found_inaccessible(page)), json.dumps(told, indent=1)
    count = answers(page)
    control(page, "#live-pinion-tip_relief_um").press("End")
    page.context.set_offline(False)
    with LineOfActionClient(address) as client:
        client.dismiss(busy.id)
    expect(page.locator("#away")).to_be_empty()
    until(lambda: answers(page) > count)
    expect(page.locator("#live-torque_n_m")).to_have_attribute("max", "2.6")
    assert page.locator("[role=alert]:visible").count() == 0
    assert visit.complaints == []
