"""A gear unit is a subject of the page: its tabs, its dock, its answer in the bar, results at their parts."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from page_visit import opened
from playwright.sync_api import Browser, Page, Route, expect
from running_service import until

UNIT = Path(__file__).parents[2] / "examples" / "two_stage_gearbox.rexs"
JOB, KEY = "33333333-3333-4333-8333-333333333333", "d" * 64
FIRST, SECOND = "cylindrical_stage 21", "cylindrical_stage 22"
WORST = {FIRST: (1.6961, 1.1436), SECOND: (-10.798, 1.5202)}
DEFLECTED = [
    {"name": name, "largest_misalignment_um": tilt, "largest_k_h_beta": factor, "largest_in": "load case 2"}
    for name, (tilt, factor) in WORST.items()
]
RESULT = {"meshes": DEFLECTED, "load_cases": [{"name": f"load case {k}"} for k in (1, 2, 3)]}
STATUS = {"jobID": JOB, "processID": "deflect", "status": "successful", "progress": 100}


def deflect_at_no_cost(page: Page) -> list[dict[str, Any]]:
    """Answer deflections without computing any; returns the inputs that are sent."""
    sent: list[dict[str, Any]] = []

    def enter(route: Route) -> None:
        sent.append(route.request.post_data_json["inputs"])
        route.fulfill(status=201, json=STATUS)

    def inputs(route: Route) -> None:
        route.fulfill(json={"processID": "deflect", "inputs": sent[0]})

    reference = {"deflection": {"href": f"/v1/results/{KEY}", "type": "application/x-netcdf", "hash": KEY}}
    report = {"title": "Deflection", "lead": "", "headlines": [], "alarms": [], "sections": []}
    page.route("**/v1/processes/deflect/execution", enter)
    page.route(f"**/v1/jobs/{JOB}", lambda route: route.fulfill(json=STATUS))
    page.route(f"**/v1/jobs/{JOB}/inputs", inputs)
    page.route(f"**/v1/jobs/{JOB}/results?*", lambda route: route.fulfill(json=reference))
    page.route(f"**/v1/results/{KEY}", lambda route: route.fulfill(json=RESULT))
    page.route(f"**/v1/results/{KEY}/figures", lambda route: route.fulfill(json=report))
    page.route(f"**/v1/results/{KEY}/motion*", lambda route: route.fulfill(json={"groups": []}))
    return sent


@pytest.mark.law
def test_a_deflection_is_seen_at_its_parts_by_one_click(browser: Browser, address: str) -> None:
    visit = opened(browser, address, width=1440)
    page = visit.page
    sent = deflect_at_no_cost(page)
    expect(page.locator("#tabs [role=tab]").first).to_have_text("Ripple")
    page.locator("#import-file").set_input_files(UNIT)
    tabs = page.locator("#tabs [role=tab]:visible")
    expect(tabs).to_have_text(["Deflection", "Modes", "Response", "Noise", "Steady", "Sound", "Jobs"])
    expect(page.locator("#results-none")).to_be_hidden()
    expect(page.locator("#unit-dock")).to_contain_text(f"{FIRST} not deflected yet{SECOND} not deflected yet")
    expect(page.locator("#unit-dock")).to_contain_text(f"The pair of {FIRST}")
    expect(page.locator("#deflection")).to_contain_text(
        re.compile("of one processor and .* MiB for the tables of 2 meshes")
    )
    page.locator("#deflection").get_by_role("button", name="Deflect the gearbox").click()
    table = page.locator("#deflection table").first
    expect(table).to_contain_text(f"{SECOND}−10.8 µm1.52load case 2")
    box = table.bounding_box()
    assert box is not None and box["y"] + box["height"] < 900.0, "nothing is scrolled"
    assert [len(inputs["load_cases"]) for inputs in sent] == [3]
    for place in ("#unit .parts", "#unit-dock"):
        expect(page.locator(place)).to_contain_text("−10.8 µm")
        expect(page.locator(place)).to_contain_text("K_Hbeta 1.14")
    page.reload()
    expect(page.locator("#unit .parts")).to_contain_text("−10.8 µm")
    assert visit.complaints == []
    page.close()


@pytest.mark.law
def test_the_complaint_of_a_unit_is_answered_in_the_bar_and_follows_to_its_meshes(
    browser: Browser, address: str
) -> None:
    visit = opened(browser, address, width=1440)
    page = visit.page
    page.locator("#import-file").set_input_files(UNIT)
    expect(page.locator("#f-pair-pinion-teeth")).to_have_value("20")
    for name, text in (("frequency_hz", "933"), ("speed_rpm", "2800"), ("torque_n_m", "60")):
        page.locator(f"#bar-{name}").fill(text)
    words = page.locator("#complaint output")
    answer = f"order 19.99 of shaft 3, harmonic 1 of {FIRST} (+0.036 %), or 3 of {SECOND}"
    expect(words).to_have_text(answer)
    page.locator("#unit button", has_text=SECOND).press("Enter")
    expect(page.locator("#tabs [role=tab]:visible").first).to_have_text("Ripple")
    expect(page.locator("#unit-dock")).to_be_hidden()
    values = {"frequency_hz": "933", "speed_rpm": "933.333", "torque_n_m": "180"}  # a third of the speed
    for name, text in values.items():
        expect(page.locator(f"#bar-{name}")).to_have_value(text)
    expect(words).to_have_text(answer)
    page.locator("#unit [data-part]").first.press("Enter")
    expect(page.locator("#unit-dock")).to_contain_text(f"The pair of {SECOND}")
    page.locator("#unit button", has_text=FIRST).press("Enter")
    until(lambda: page.locator("#bar-speed_rpm").input_value() == "2800")
    page.close()
