"""What is drawn is what is typed: a pair needs no load, an old picture is gray, a bar below its error too."""

import pytest
from page_visit import control, opened, shown
from playwright.sync_api import Page, Route, expect
from running_service import until

from lineofaction.gearbox.convert.outline import outline_json
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated
from service.page.example_cases import examples

PAIR = {
    "normal_module_mm": "2.4", "helix_angle_deg": "16", "center_distance_mm": "118.6", "pinion-teeth": "27",
    "wheel-teeth": "68", "pinion-face_width_mm": "20", "wheel-face_width_mm": "20",
    "pinion-bore_diameter_mm": "30", "wheel-bore_diameter_mm": "60",
}  # fmt: skip
BARS = """async (errors) => {
  const { harmonicsFigure } = await import("/page/live_figures.js");
  const curve = { period: 1, harmonics_um: [0.2, 0.01], harmonics_error_um: errors };
  const { data } = harmonicsFigure([{ name: "now", curve, color: "#0072B2" }], 2);
  return [data[0].marker.color, data[0].error_y?.array ?? null];
}"""


def type_pair(page: Page) -> None:
    page.locator("#example").select_option("empty")
    for field, text in PAIR.items():
        control(page, f"#f-pair-{field}").fill(text)


@pytest.mark.law
def test_an_outline_needs_the_fields_of_the_pair_alone(browser, address):
    visit = opened(browser, address)
    page = visit.page
    type_pair(page)
    expect(page.locator("#mesh-words")).to_contain_text("Pinion with 27 teeth and wheel with 68")
    expect(page.locator("#form-errors")).to_contain_text("Still to fill in: torque")
    expect(page.locator("#thing.stale")).to_have_count(0)
    control(page, "#f-pair-wheel-teeth").fill("")
    expect(page.locator("#thing.stale")).to_have_count(1)
    page.close()


@pytest.mark.parametrize("name", [example.name for example in examples()])
def test_an_outline_depends_on_nothing_but_the_pair(name):
    (content,) = (example.content for example in examples() if example.name == name)
    alone = {"pair": content["pair"], "load": {"torque_n_m": [1]}}
    assert outline_json(validated(Case, alone)) == outline_json(validated(Case, content))


@pytest.mark.law
def test_an_address_that_loads_says_so(browser, address, analyzed):
    page = shown(browser, address, analyzed).page
    waiting: list[Route] = []

    def hold(route):
        waiting.append(route)

    page.evaluate("() => { location.hash = 'rail'; }")
    expect(page.locator("#live-figures")).to_be_empty()
    page.route(f"**/v1/results/{analyzed}", hold)
    page.evaluate("key => { location.hash = `database=${key}`; }", analyzed)
    until(lambda: page.wait_for_timeout(20) or waiting)
    expect(page.locator("#dock-words")).to_have_text("The result of this address is being read.")
    expect(page.locator("#results-none")).to_be_hidden()
    for route in waiting:
        route.continue_()
    expect(page.locator("#dock-words")).not_to_contain_text("is being read")
    page.close()


@pytest.mark.law
def test_bars_have_their_errors_and_are_gray_below_them(scripts):
    blue, gray = "#0072B2", "#B4BBC3"
    assert scripts.evaluate(BARS, [0.02, 0.02]) == [[blue, gray], [0.02, 0.02]]
    assert scripts.evaluate(BARS, None) == [[blue, blue], None], "as a slider moves"
