"""A gear unit is a subject of the page: its tabs, its dock, its answer in the bar, results at their parts."""

import math
import os
import random
import re
from pathlib import Path
from typing import Any

import pytest
from page_numbers import printed
from page_visit import opened
from playwright.sync_api import Page, expect
from running_service import until

SESSIONS = int(os.environ.get("LOA_PAGE_SESSIONS", "2"))
"""Sessions by seeds from 0; scripts/nightly takes more."""
RESTED = 900
"""Milliseconds after which an action has been written to the address and to the steps of undo."""
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

    def enter(route):
        sent.append(route.request.post_data_json["inputs"])
        route.fulfill(status=201, json=STATUS)

    def inputs(route):
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
def test_a_deflection_is_seen_at_its_parts_by_one_click(browser, address):
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
def test_the_complaint_of_a_unit_is_answered_in_the_bar_and_follows_to_its_meshes(browser, address):
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


class UnitSession:
    """A user who does by chance what can be done with an opened unit."""

    def __init__(self, page: Page, seed: int) -> None:
        self.page, self.chance = page, random.Random(seed)

    def act(self) -> None:
        self.chance.choice((self.complain, self.see, self.open_mesh, self.undo, self.reload))()
        self.page.wait_for_timeout(RESTED)

    def complain(self) -> None:
        frequency = f"{self.chance.choice((933.3, 311.1, 622.2)) * self.chance.uniform(0.96, 1.04):.4g}"
        for name, text in (("frequency_hz", frequency), ("torque_n_m", self.chance.choice(["", "60"]))):
            self.page.locator(f"#bar-{name}").fill(text)

    def see(self) -> None:
        parts = self.page.locator("#unit [data-part]")
        parts.nth(self.chance.randrange(parts.count())).press("Enter")

    def open_mesh(self) -> None:
        name = self.chance.choice((FIRST, SECOND))
        self.page.locator("#unit button", has_text=name).press("Enter")

    def undo(self) -> None:
        button = self.page.get_by_role("button", name=self.chance.choice(("Undo", "Redo")), exact=True)
        if button.is_enabled():
            button.press("Enter")

    def reload(self) -> None:
        self.page.reload()
        self.page.wait_for_selector("html[data-ready=yes]")
        expect(self.page.locator("#unit .parts")).to_be_visible()


def answer_of_the_train(frequency: float, rpm: float) -> tuple[float, list[tuple[str, int]]]:
    """Return the order of shaft 3 at its speed, and which harmonic each mesh has within 5 %, lowest first."""
    near = []
    for name, teeth in ((FIRST, 20.0), (SECOND, 20.0 / 60.0 * 20.0)):  # a revolution of shaft 3
        multiple = frequency / (rpm / 60.0 * teeth)
        harmonic = max(round(multiple), 1)
        if abs(harmonic / multiple - 1.0) <= 0.05:
            near.append((name, harmonic))
    return 60.0 * frequency / rpm, sorted(near, key=lambda item: item[1])


def of_unit(page: Page) -> list[str]:
    """Return what the page says of a unit that contradicts itself or the teeth on the way."""
    found = [
        f"{number.subject}: {number.text} is not {other.text}"
        for number in printed(page)
        for other in printed(page)
        if number.subject == other.subject and number.value != other.value
    ]
    if page.locator("#results-none").is_visible() and page.locator("#unit-dock").is_visible():
        found.append("nothing analyzed yet, beside the unit")
    frequency, speed = (page.locator(f"#bar-{name}").input_value() for name in ("frequency_hz", "speed_rpm"))
    words = page.locator("#complaint output").inner_text()
    if not frequency or not speed:
        return found
    second = page.locator("#f-pair-wheel-teeth").input_value() == "40"
    order, near = answer_of_the_train(float(frequency), float(speed) * (3.0 if second else 1.0))
    if not near:
        return found if words == "no harmonic of any mesh within 5 %" else [*found, words]
    (name, harmonic), *_ = near
    shaft, own = ("shaft 3", order) if name == FIRST else ("shaft 4", 3.0 * order)
    said = re.fullmatch(r"order (\S+) of (shaft \d), harmonic (\d+) of ([^(]+) \(.*", words)
    if said is None or (said[2], int(said[3]), said[4]) != (shaft, harmonic, name):
        return [*found, f"{words}, of {order} {near}"]
    return found if math.isclose(float(said[1]), own, rel_tol=1e-3) else [*found, f"{words}, of {own}"]


@pytest.mark.law
@pytest.mark.parametrize("seed", range(SESSIONS))
def test_a_unit_has_one_answer_in_bar_tree_and_dock(browser, address, seed):
    visit = opened(browser, address, width=1440)
    page = visit.page
    deflect_at_no_cost(page)
    page.locator("#import-file").set_input_files(UNIT)
    expect(page.locator("#f-pair-pinion-teeth")).to_have_value("20")
    page.locator("#bar-speed_rpm").fill("2800")
    page.locator("#bar-frequency_hz").fill("933")
    if seed % 2:
        page.locator("#deflection").get_by_role("button", name="Deflect the gearbox").click()
        expect(page.locator("#unit-dock")).to_contain_text("−10.8 µm")
    session = UnitSession(page, seed)
    for _ in range(8):
        found = of_unit(page)
        assert not found, "\n".join([*found, page.url])
        session.act()
    assert visit.complaints == []
    page.close()
