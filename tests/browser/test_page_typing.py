"""A pair typed field after field: the page waits, says what is missing, and rewrites nothing."""

import re
import tomllib
from contextlib import suppress

import pytest
from page_visit import control, found_inaccessible, opened, refused
from playwright.sync_api import Error, Page, Route, expect
from running_service import until

PAIR = {
    "pair-normal_module_mm": "2.5",
    "pair-center_distance_mm": "56.25",
    "pair-pinion-teeth": "21",
    "pair-wheel-teeth": "24",
    "pair-pinion-face_width_mm": "18",
    "pair-wheel-face_width_mm": "17,5",
    "pair-pinion-bore_diameter_mm": "20",
    "pair-wheel-bore_diameter_mm": "22",
    "load-torque_n_m": "10, 40",
}
TYPED_SLOWLY = 30  # milliseconds between keys; a field is left for the service to answer
EDGES = """() => {
  const [fields, rail] = ["#fields", "#rail"].map((name) => document.querySelector(name));
  return fields.getBoundingClientRect().top + rail.scrollTop;
}"""

GIVEN_UP = """async () => {
  const { post } = await import("/page/api.js");
  const own = window.fetch;
  const cut = { start: (body) => body.error(new DOMException("", "AbortError")) };
  window.fetch = async () => new Response(new ReadableStream(cut));
  const said = await post("/v1/drafts/plan", {}).catch((fault) => [fault.constructor.name, fault.status]);
  window.fetch = own;
  return said;
}"""
"""What a request is that ends while its answer is read."""


@pytest.fixture
def visit(browser, address):
    seen = opened(browser, address)
    yield seen
    seen.page.close()


def typed(page: Page, key: str, text: str) -> None:
    """Type into a field as a person does, and see that it holds what was typed while the service answers."""
    field = control(page, f"#f-{key}")
    field.focus()
    page.keyboard.press("ControlOrMeta+a")
    with page.expect_response("**/v1/drafts/outline"):
        page.keyboard.type(text, delay=TYPED_SLOWLY)
    assert page.evaluate("document.activeElement.id") == f"f-{key}"
    expect(field).to_have_value(text)


@pytest.mark.parametrize("begin", ["empty", pytest.param("helical_automotive", marks=pytest.mark.nightly)])
def test_a_pair_typed_in_reading_order_is_the_pair_that_is_planned(visit, begin):
    page = visit.page
    page.locator("#example").select_option(begin)
    shared = {} if begin == "empty" else {"pair-helix_angle_deg": "0"}
    top = page.evaluate(EDGES)
    for key, text in ({"pair-normal_module_mm": ""} | shared | PAIR).items():
        if text:
            typed(page, key, text)
        assert page.evaluate(EDGES) == top, "what is refused meanwhile moves no field"
        assert page.locator("#form-errors li").count() <= 3, "no wall of errors"
    if begin == "helical_automotive":
        for gear in ("pinion", "wheel"):
            typed(page, f"pair-{gear}-profile_shift_coefficient", "0")
    expect(page.locator("#plan dl")).to_be_visible()
    expect(page.locator("#form-errors")).to_be_hidden()
    expect(page.locator("#drawing-state")).to_be_empty()
    for key, text in PAIR.items():
        expect(page.locator(f"#f-{key}")).to_have_value(text)
    assert "wheel with 24" in page.locator("#mesh-words").inner_text()
    assert visit.complaints == []


def test_what_is_missing_is_listed_with_the_plan_and_no_field_is_blamed(visit):
    page = visit.page
    page.locator("#example").select_option("empty")
    missing = page.locator("#form-errors")
    expect(missing).to_contain_text("Still to fill in: normal module, center distance, pinion teeth")
    expect(page.locator("#drawing-state")).to_have_text("(not yet the pair as typed)")
    assert page.locator("[aria-invalid=true]").count() == 0
    assert found_inaccessible(page) == {}
    missing.get_by_role("link", name="wheel teeth").press("Enter")
    assert page.evaluate("document.activeElement.id") == "f-pair-wheel-teeth"
    assert page.get_by_label(re.compile("^(Young|Poisson)'s ")).count() >= 2


def test_a_field_that_is_being_typed_into_is_not_blamed_before_it_is_finished(visit):
    page = visit.page
    typed(page, "pair-pinion-teeth", "2")
    teeth = page.locator("#f-pair-pinion-teeth")
    expect(page.locator("#form-errors li")).to_contain_text("pair.pinion.teeth must be")
    assert teeth.get_attribute("aria-invalid") != "true"
    page.keyboard.type("0")
    expect(page.locator("#form-errors")).to_be_hidden()
    assert teeth.get_attribute("aria-invalid") != "true"
    expect(teeth).to_have_value("20")


def test_an_example_says_which_settings_it_replaces(visit):
    page = visit.page
    control(page, "#f-accuracy-model").select_option("3d")
    control(page, "#f-accuracy-tolerance").fill("0.005")
    page.locator("#example").select_option("internal_gear")
    said = page.locator("#example-replaced")
    expect(said).to_contain_text("tolerance 0.005 → not set")
    expect(said).to_contain_text("model 3d → plane strain")
    expect(page.locator(".replaced #f-accuracy-model")).to_have_value("plane_strain")
    page.go_back()
    expect(page.locator("#f-accuracy-model")).to_have_value("3d")
    expect(page.locator("#f-accuracy-tolerance")).to_have_value("0.005")
    page.locator("#example").select_option("palermo_spur_20_20")
    expect(page.locator("#f-accuracy-model")).to_have_value("plane_strain")


def test_a_helix_with_a_model_of_the_plane_is_told_what_it_is(visit):
    page = visit.page
    page.locator("#example").select_option("palermo_spur_20_20")
    typed(page, "pair-helix_angle_deg", "15")
    told = page.locator("#form-errors")
    expect(told).to_contain_text(re.compile("helical.*“plane strain”.*spur pair"))
    told.get_by_role("button", name="Set the model to 3d").press("Enter")
    expect(page.locator("#f-accuracy-model")).to_have_value("3d")
    expect(told).not_to_contain_text("spur pair")


def test_an_edit_gives_up_the_plan_that_the_edit_before_asked_for(visit):
    """The service refuses a question (409) when a later one takes its place: nobody is to hear of it."""
    page, waiting = visit.page, []

    def as_a_busy_service(route):
        if not waiting:
            waiting.append(route)
            return
        problem = {"type": "urn:lineofaction:problem:superseded", "title": "superseded", "status": 409}
        with suppress(Error):  # given up by the page
            waiting[0].fulfill(status=409, json=problem)
        route.continue_()

    expect(page.locator("#plan dl")).to_be_visible()
    page.route("**/v1/drafts/plan", as_a_busy_service)
    for width in ("21", "22"):
        with page.expect_request("**/v1/drafts/plan"):
            control(page, "#f-pair-pinion-face_width_mm").fill(width)
    with page.expect_response("**/v1/drafts/plan"):
        control(page, "#f-pair-pinion-face_width_mm").fill("23")
    expect(page.locator("#plan dl")).to_be_visible()
    assert [line for line in visit.console if line.startswith("error")] == []


def test_a_request_given_up_while_its_answer_is_read_is_no_answer(visit):
    assert visit.page.evaluate(GIVEN_UP) == ["Problem", 0]


OPENED = """[pair]
normal_module_mm = 2.5
center_distance_mm = 56.25
[pair.pinion]
teeth = 21
face_width_mm = 18.0
bore_diameter_mm = 20.0
[pair.wheel]
teeth = 24
face_width_mm = 17.5
bore_diameter_mm = 22.0
[load]
torque_n_m = [10, 40]
[complaint]
frequency_hz = 400.0
speed_rpm = 1142.0
[report]
title = "Pump drive, as ordered"
requirements = ["peak-to-peak STE at most 6 µm", "largest pressure at most 1000 MPa"]
"""


@pytest.mark.law
def test_an_opened_case_keeps_its_complaint_and_its_title_block(visit):
    page = visit.page
    page.locator("#import-file").set_input_files(
        {"name": "own.toml", "mimeType": "application/toml", "buffer": OPENED.encode()}
    )
    expect(control(page, "#f-complaint-frequency_hz")).to_have_value("400")
    expect(control(page, "#f-report-title")).to_have_value("Pump drive, as ordered")
    with page.expect_download() as saved:
        page.locator("#export-toml").click()
    text = saved.value.path().read_text("utf-8")
    kept, given = tomllib.loads(text), tomllib.loads(OPENED)
    assert (kept["complaint"], kept["report"]) == (given["complaint"], given["report"])
    assert visit.complaints == []


@pytest.mark.law
def test_jobs_wait_for_a_file_that_is_read_and_are_given_up_with_it(visit):
    """The pair that the file replaces was analyzed."""
    page, waiting = visit.page, list[Route]()
    page.route("**/v1/cases/from-toml", lambda route: waiting.append(route))  # noqa: PLW0108 (no builtin)
    own = {"name": "own.toml", "mimeType": "application/toml", "buffer": OPENED.encode()}
    search = page.get_by_role("button", name="Search better flanks").first
    unread = {"title": "No case", "status": 422, "detail": "It is none."}
    buttons = {"analyze": page.locator("#analyze"), "optimize": search}
    for process, button in buttons.items():
        with refused(page, process) as sent:
            for refusal in (None, unread):
                waiting.clear()
                page.locator("#import-file").set_input_files(own)
                until(lambda: page.wait_for_timeout(20) or waiting)
                button.press("Enter")
                expect(button).to_be_disabled()
                expect(page.get_by_text("Waits for the file that is read.")).to_have_count(1)
                assert len(sent) == (refusal is not None)
                if refusal:
                    waiting[0].fulfill(status=422, json=refusal)
                else:
                    waiting[0].continue_()
                expect(button).to_be_enabled()
                expect(page.get_by_text("Waits for the file that is read.")).to_have_count(0)
            (job,) = sent
            assert job["case"]["report"] == tomllib.loads(OPENED)["report"]
            control(page, "#f-report-title").fill("")
            button.press("Enter")
            until(lambda sent=sent: page.wait_for_timeout(20) or len(sent) == 2)
            assert "title" not in sent[1]["case"]["report"], "nothing is waited for any more"


def test_a_backlash_of_rounding_is_none(visit):
    page = visit.page

    def rounded(route):
        answer = route.fetch().json()
        answer["figures"]["circumferential_backlash_um"] = 7e-4
        route.fulfill(json=answer)

    page.route("**/drafts/outline", rounded)
    control(page, "#f-pair-pinion-face_width_mm").fill("4.5")
    expect(page.locator("#pair-figures")).to_contain_text("backlash, circumferential0 µm")
    page.unroute("**/drafts/outline")
