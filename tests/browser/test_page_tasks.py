"""Four tasks of a new user in the browser alone, action by action as the documentation has them."""

import re

import pytest
from page_visit import Visit, answered, answers, found_inaccessible, opened, to_print
from playwright.sync_api import Locator, Page, expect
from repository import ROOT
from running_service import until

UNIT = ROOT / "examples" / "two_stage_gearbox.rexs"
TASKS = (ROOT / "docs" / "how-to" / "in-the-browser.md").read_text(encoding="utf-8").split("\n## ")
MAX = 15
PAIR = {
    "normal_module_mm": "2", "center_distance_mm": "45", "pinion-teeth": "21", "wheel-teeth": "24",
    "pinion-face_width_mm": "10", "wheel-face_width_mm": "10", "pinion-bore_diameter_mm": "20",
    "wheel-bore_diameter_mm": "22",
}  # fmt: skip


class Hand:
    """What a user does with the page; showing a part of the rail goes with what is done there."""

    def __init__(self, seen: Visit) -> None:
        self.page = seen.page
        self.actions = 0

    def show(self, title: str) -> None:
        self.page.get_by_role("tab", name=title, exact=True).click()

    def on(self, name: str | Locator) -> Locator:
        self.actions += 1
        return self.page.locator(name) if isinstance(name, str) else name

    def press(self, name: str) -> None:
        self.on(self.page.get_by_role("button", name=name)).first.click()

    def analyze(self) -> None:
        before = answers(self.page)
        self.on("#analyze").click()
        expect(self.page).to_have_url(re.compile("database="))
        until(lambda: answers(self.page) > before)

    def move(self, slider: str) -> None:
        self.show("Flanks, live")
        before = answers(self.page)
        self.on(slider).press("End")
        until(lambda: answers(self.page) > before)

    def did(self, task: str) -> None:
        """See that a task took the actions of the documentation, and few."""
        (text,) = (part for part in TASKS if part.startswith(f"{task}\n"))
        *_, last = re.findall(r"^(\d+)\. ", text, re.MULTILINE)  # an earlier task may be its beginning
        assert self.actions == int(last) < MAX


@pytest.fixture
def seen(browser, address):
    visit = opened(browser, f"{address}/#")
    yield visit
    assert visit.complaints == []
    visit.page.close()


def type_pair(hand: Hand) -> None:
    hand.on("#example").select_option("empty")
    for field, text in PAIR.items():
        hand.on(f"#f-pair-{field}").fill(text)
    hand.show("Loads")
    hand.on("#f-load-torque_n_m").fill("20, 80")


def tone(page: Page) -> float:
    """Return the amplitude of the first harmonic in the dock, in um."""
    row = page.locator("#live-figures > div").filter(has_text="first harmonic")
    return float(row.locator("dd").inner_text().split()[0])


def dragged(hand: Hand, slider: str, steps: list[str]) -> dict[str, float]:
    """Move a slider along, which is one action; returns the first harmonic at each step."""
    exact = hand.on(f"{slider}-exact")
    found = {}
    for step in steps:
        before = answers(hand.page)
        exact.fill(step)
        until(lambda before=before: answers(hand.page) > before)
        expect(hand.page.locator("#live-figures")).not_to_contain_text("…")  # at rest: with its error
        found[step] = tone(hand.page)
    return found


@pytest.mark.nightly
def test_an_own_pair_is_typed_analyzed_relieved_and_sent(seen, browser):
    page, hand = seen.page, Hand(seen)
    type_pair(hand)
    hand.analyze()
    expect(page.locator("#live-figures")).to_contain_text(re.compile("peak to peak.*±"))
    hand.show("Flanks, live")
    expect(page.locator("#live-torque_n_m-exact")).to_have_value("80")
    relief = "#live-pinion-tip_relief_um"
    along = dragged(hand, relief, ["0", "5", "10", "15", "20"])
    minimum = min(along, key=lambda step: along[step])
    page.locator(f"{relief}-exact").fill(minimum)  # where the hand lets go
    until(lambda: tone(page) == along[minimum])
    assert along[minimum] < along["0"] and minimum != "20", "the least lies within the slider"
    (cost,) = dragged(hand, "#live-torque_n_m", ["20"]).values()
    expect(page.locator("#live-figures")).to_contain_text(
        re.compile(r"first harmonic.*[+−][\d.]+ ± [\d.]+ dB")
    )
    assert cost > 0.0
    hand.on("#name").fill("own pair")
    hand.did("My own pair")
    expect(page).to_have_url(re.compile("live=.*name=own%20pair|name=own%20pair.*live="))
    other = opened(browser, page.url).page
    answered(other)
    for control, value in ((relief, minimum), ("#live-torque_n_m", "20")):
        expect(other.locator(f"{control}-exact")).to_have_value(value)
    other.close()


@pytest.mark.nightly
def test_an_own_pair_with_a_run_out_shows_a_revolution_and_its_sidebands(seen):
    page, hand = seen.page, Hand(seen)
    type_pair(hand)
    hand.show("Teeth as made")
    hand.on("#f-pair-pinion-run_out-eccentricity_um").fill("10")
    expect(page.locator("#plan")).to_contain_text("of one processor")
    hand.analyze()
    title = page.locator("[data-figure=live_ste] h3")
    expect(title).to_have_text("Transmission error over 21 base pitches, at 80 N m")
    expect(page.locator("#results-design")).to_be_empty()
    hand.on(page.get_by_role("tab", name="Orders", exact=True)).click()
    orders = page.locator("[data-figure=live_harmonics] .plot")
    expect(orders).to_have_attribute(
        "aria-label", re.compile(r"pinion 1 \d.*mesh 1 \d.*mesh \d [-+] pinion 1")
    )
    names = orders.locator(".bartext").filter(has_text="mesh 1 ± pinion 1")
    expect(names).to_have_count(1)
    hand.did("My own pair as it is made")


@pytest.mark.nightly
def test_an_own_unit_is_opened_and_its_flanks_are_misaligned(seen):
    page, hand = seen.page, Hand(seen)
    hand.on("#import-file").set_input_files(UNIT)
    expect(page.locator("#f-pair-pinion-teeth")).to_have_value("20")
    hand.on("#bar-frequency_hz").fill("933")
    hand.on("#bar-speed_rpm").fill("2800")
    makes = "cylindrical_stage 21 at 933.3 Hz: harmonic 1, off by +0.036 %"
    expect(page.locator("#unit-heard")).to_contain_text(makes)
    hand.on(page.locator("#unit [data-part]").nth(2)).click()
    assert not found_inaccessible(page, "#unit")
    hand.press("Open scene")
    hand.on("#scene-process").select_option("deflect")
    hand.press("Compute the scene")
    causes = page.locator("#scene-body table").filter(has_text="misalignment over the face by cause")
    expect(causes).to_contain_text("cylindrical_stage 21")
    hand.on(page.locator("#unit details").filter(has_text="Meshes").get_by_role("button").first).click()
    hand.show("Accuracy")
    hand.on("#f-accuracy-tolerance").fill("")
    hand.on("#f-accuracy-level").select_option("draft")
    hand.analyze()
    hand.on(page.get_by_role("tab", name="Flank", exact=True)).click()
    expect(page.locator("[data-figure=live_pressure] .plot")).to_have_attribute("data-drawn", "yes")
    hand.move("#live-misalignment_um")
    expect(page.locator("#live-figures")).to_contain_text("K_Hbeta")
    hand.did("My own unit")


def on_the_grid(page: Page) -> None:
    """See that flanks are in steps of the drawing: 0.5 um and 0.1 mm, as the example states them."""
    for name, step in (("tip_relief_um", 0.5), ("tip_relief_length_mm", 0.1)):
        for gear in ("pinion", "wheel"):
            count = float(page.locator(f"#f-pair-{gear}-{name}").input_value()) / step
            assert count == pytest.approx(round(count), abs=1e-9), (gear, name)


@pytest.mark.nightly
def test_a_search_brings_three_decibels_that_are_heard(seen):
    page, hand = seen.page, Hand(seen)
    for field, text in {"frequency_hz": "1533", "speed_rpm": "4000", "torque_n_m": "120"}.items():
        hand.on(f"#bar-{field}").fill(text)  # 23 teeth: harmonic 1
    hand.analyze()
    hand.press("Another variant")
    expect(page.locator("#cost-optimize")).to_have_text(re.compile(r"Takes about \d+ CPU s.*designs at"))
    hand.press("Search better flanks")
    lead = page.locator("#ripple .lead").filter(has_text="harmonic 1, at 120 N m")
    expect(lead).to_have_text(re.compile(r"falls by (at least [\d.]+|[\d.]+ ± [\d.]+) dB"))
    hand.press("Take the optimum into the case")
    on_the_grid(page)
    hand.analyze()
    rows = page.locator("#compared tr")
    tone = rows.filter(has_text="first harmonic, dB from A").locator("td").nth(1)
    expect(tone).to_have_text(re.compile("−"))
    change = (
        tone.inner_text().removeprefix("below ").replace("−", "-").split(" ± ")
    )  # with its error, or a bound
    assert sum(map(float, change)) < -3.0
    heard = rows.filter(has_text="the same, dB from A").locator("td").nth(1)
    expect(heard).to_have_text(re.compile(r"−[\d.]+(\s±\s[\d.]+)?$"))
    hand.on("#band-on").check()
    words = page.locator(".made-band output")
    expect(words).to_contain_text(
        re.compile(r"A: nine of ten pairs within class 6.*B: nine|B: nine.*A: nine")
    )
    hand.on(page.get_by_role("tab", name="Sound", exact=True)).click()
    for letter in "AB":
        hand.press(f"Play {letter}")
    hand.show("Errors and cost")
    printed = to_print(page, lambda: hand.press("Report to print"))
    assert 1 < len(printed.pages) <= 12 and sum(printed.pictures) > 2
    hand.did("What brings 3 dB?")
