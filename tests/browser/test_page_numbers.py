"""No two numbers of the page contradict each other or the service, whatever a user does with it."""

import os
import random
from collections.abc import Callable

import pytest
from page_numbers import contradictions, printed
from page_visit import CASE, GEAR, OVER_FACE, computed, shown
from playwright.sync_api import Page, expect
from running_service import until

SESSIONS = int(os.environ.get("LOA_PAGE_SESSIONS", "3"))
"""Sessions of each kind, by seeds from 0; scripts/nightly takes 200 in all."""
ACTIONS = 6
STILL = """() => !document.querySelector("#dock [aria-busy=true]")
  && !document.querySelector("#dock").textContent.includes("…")"""
TYPE = """(node, value) => {
  node.value = value;
  node.dispatchEvent(new Event("input", { bubbles: true }));
}"""
EVERYWHERE = """(node) => {
  const same = [...document.querySelectorAll("[data-subject]")].filter(({ dataset }) => (
    dataset.subject === node.dataset.subject));
  for (const { dataset } of same) dataset.value = String(1.001 * dataset.value);
}"""
SLIDERS = ("torque_n_m", "pinion-tip_relief_um", "wheel-tip_relief_um", "pinion-tip_relief_length_mm")
ACROSS = ("misalignment_um", "pinion-helix_crowning_um")


def rests(page: Page) -> None:
    """Wait until every answer is there with its error, and the page asks for no more."""
    quiet = 0

    def settled():
        nonlocal quiet
        page.wait_for_timeout(120)
        before = page.locator("#live-figures").get_attribute("data-answers")
        page.wait_for_timeout(120)
        same = before == page.locator("#live-figures").get_attribute("data-answers")
        quiet = quiet + 1 if same and page.evaluate(STILL) else 0
        return quiet >= 2

    until(settled)


class Session:
    """A user who does by chance what can be done with an analyzed pair."""

    def __init__(self, page: Page, seed: int, *, over_face: bool) -> None:
        self.page = page
        self.chance = random.Random(seed)
        self.sliders = (*SLIDERS, *ACROSS) if over_face else SLIDERS
        self.did: list[str] = []

    def act(self) -> None:
        actions: tuple[Callable[[], str], ...] = (
            self.slide, self.slide, self.slide, self.complain, self.vary, self.choose, self.undo, self.look,
            self.reload,
        )  # fmt: skip
        self.did.append(self.chance.choice(actions)())
        rests(self.page)

    def slide(self) -> str:
        name = self.chance.choice(self.sliders)
        exact = self.page.locator(f"#live-{name}-exact")
        low, high = (float(exact.get_attribute(end) or 0.0) for end in ("min", "max"))
        low = max(low, 0.05 * high)
        value = f"{self.chance.uniform(low, 0.5 * (low + high)):.3g}"
        exact.evaluate(TYPE, value)
        return f"{name} {value}"

    def complain(self) -> str:
        harmonic, torque = self.chance.randint(1, 3), self.chance.choice(["", "0.5", "0.7", "1"])
        frequency = f"{500 * harmonic * self.chance.uniform(0.97, 1.03):.4g}"
        for field, text in (("frequency_hz", frequency), ("speed_rpm", "1500"), ("torque_n_m", torque)):
            self.page.locator(f"#bar-{field}").fill(text)
        return f"complaint {frequency} Hz at {torque or 'no'} N m"

    def vary(self) -> str:
        more = self.page.get_by_role("button", name="Another variant")
        if more.count():
            more.press("Enter")
        return "+"

    def choose(self) -> str:
        others = self.page.locator("#variants [aria-pressed=false]")
        if others.count():
            others.nth(self.chance.randrange(others.count())).press("Enter")
        return "another variant"

    def undo(self) -> str:
        name = self.chance.choice(["Undo", "Redo"])
        button = self.page.get_by_role("button", name=name, exact=True)
        if button.is_enabled():
            button.press("Enter")
        return name

    def look(self) -> str:
        name = self.chance.choice(["Ripple", "Flank", "Load", "Orders", "Errors and cost", "Jobs"])
        self.page.locator("#tabs").get_by_role("tab", name=name, exact=True).press("Enter")
        return name

    def reload(self) -> str:
        self.page.wait_for_timeout(300)
        self.page.reload()
        self.page.wait_for_selector("html[data-ready=yes]")
        self.page.wait_for_selector("#live-figures[data-answers]", state="attached")
        return "reload"


def run(page: Page, address: str, seed: int, *, over_face: bool) -> None:
    session = Session(page, seed, over_face=over_face)
    rests(page)
    assert contradictions(page, address) == []
    for _ in range(ACTIONS):
        session.act()
        found = contradictions(page, address)
        assert not found, "\n".join([f"after {', '.join(session.did)} ({page.url})", *found])


@pytest.mark.law
@pytest.mark.parametrize("seed", range(SESSIONS))
def test_a_pair_in_the_plane_has_one_number_of_each_subject(browser, address, analyzed, seed):
    visit = shown(browser, address, analyzed)
    run(visit.page, address, seed, over_face=False)
    assert visit.complaints == []
    visit.page.close()


@pytest.fixture(scope="module")
def on_polymer(address):
    polymer = {"youngs_modulus_gpa": 2.8, "poissons_ratio": 0.35}  # POM
    pair = CASE["pair"] | {"wheel": GEAR | {"material": polymer}}
    return computed(address, case=CASE | {"pair": pair})


@pytest.mark.law
@pytest.mark.parametrize("seed", range(SESSIONS))
def test_a_wheel_of_polymer_has_one_number_of_each_subject(browser, address, on_polymer, seed):
    visit = shown(browser, address, on_polymer)
    run(visit.page, address, 2000 + seed, over_face=False)
    assert visit.complaints == []
    visit.page.close()


@pytest.fixture(scope="module")
def over_face(address):
    return computed(address, case=OVER_FACE)


@pytest.mark.law
@pytest.mark.parametrize("seed", range(SESSIONS))
def test_a_pair_over_its_face_has_one_number_of_each_subject(browser, address, over_face, seed):
    visit = shown(browser, address, over_face)
    run(visit.page, address, 1000 + seed, over_face=True)
    visit.page.close()


@pytest.mark.law
def test_the_reader_of_numbers_finds_each_kind_of_contradiction(visit, address):
    page = visit.page
    rests(page)
    assert contradictions(page, address) == [] and len(printed(page)) > 20
    kinds = {
        "differ": "node => { node.dataset.value = String(2 * node.dataset.value); }",
        "digits": "node => { node.firstChild.data = `${node.dataset.value} µm`; }",
        "bare": "node => { delete node.dataset.subject; }",
        "answer": EVERYWHERE,
    }
    for kind, change in kinds.items():
        page.reload()
        page.wait_for_selector("#live-figures[data-answers]", state="attached")
        rests(page)
        page.locator("#live-figures dd").first.evaluate(change)
        found = contradictions(page, address)
        assert kind in {text.partition(":")[0] for text in found}, (kind, found)


@pytest.mark.law
def test_every_view_begins_at_the_torque_of_the_complaint_and_names_it(visit):
    page = visit.page
    point, torque = page.locator("#operating-point"), page.locator("#live-torque_n_m-exact")
    expect(point).to_have_text("at 1 N m")
    for name, text in (("frequency_hz", "500"), ("speed_rpm", "1500"), ("torque_n_m", "0.7")):
        page.locator(f"#bar-{name}").fill(text)
    expect(point).to_have_text("at 0.7 N m, 1500 rpm")
    expect(torque).to_have_value("0.7")
    for figure in ("live_ste", "live_harmonics", "live_load_share", "live_pressure"):
        expect(page.locator(f"[data-figure={figure}] h3")).to_contain_text(", at 0.7 N m, 1500 rpm")
    page.reload()
    expect(point).to_have_text("at 0.7 N m, 1500 rpm")
    point.press("Enter")
    expect(torque).to_be_focused()
    torque.fill("0.9")
    page.locator("#bar-torque_n_m").fill("0.6")
    expect(point).to_have_text("at 0.9 N m, 1500 rpm")  # who moved the slider keeps it there
