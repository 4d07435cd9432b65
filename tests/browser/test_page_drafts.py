"""A pair typed digit by digit, with slips: its faults stand at their fields and are no errors of the page."""

import pytest
from page_visit import Visit, answered, control, opened, shown
from playwright.sync_api import expect

SLIPS = {
    "pair-normal_module_mm": "1.8",
    "pair-helix_angle_deg": "99",
    "pair-center_distance_mm": "8x",
    "pair-pinion-teeth": "23",
    "pair-pinion-face_width_mm": "-2",
    "pair-pinion-bore_diameter_mm": "220",
}
"""Typed first; all but the module and the teeth are impossible."""
DRAWN = "#node-teeth-as-made button"
"""What draws both gears within a class."""
TUTORIAL = {
    "pair-helix_angle_deg": "22",
    "pair-center_distance_mm": "87.5",
    "pair-pinion-teeth": "23",
    "pair-wheel-teeth": "67",
    "pair-pinion-face_width_mm": "28",
    "pair-wheel-face_width_mm": "26",
    "pair-pinion-bore_diameter_mm": "22",
    "pair-wheel-bore_diameter_mm": "60",
    "pair-pinion-thickness_allowance_um": "50",
    "pair-wheel-thickness_allowance_um": "50",
    "load-torque_n_m": "60, 120, 200",
}
"""The pair of the first tutorial (docs/tutorials/helical-ev-pair.md)."""


@pytest.fixture
def refused(browser, address):
    """Open the page; gives what it does and what the service refuses it."""
    seen, answers = opened(browser, address), []

    def note(response):
        if response.status >= 400:
            answers.append(f"{response.status} {response.url}")

    seen.page.on("response", note)
    yield seen, answers
    seen.page.close()


def typed_digit_by_digit(seen: Visit, key: str, text: str) -> None:
    """Type into a field, waiting after every digit until the service has answered what stands there."""
    page = seen.page
    field = control(page, f"#f-{key}")
    field.focus()
    if field.input_value():
        page.keyboard.press("ControlOrMeta+a")
    for character in text:
        with page.expect_response(lambda response: "outline" in response.url):
            page.keyboard.type(character)
    expect(field).to_have_value(text)


@pytest.mark.law
def test_a_pair_typed_with_slips_logs_no_error(refused):
    seen, answers = refused
    page = seen.page
    page.locator("#example").select_option("empty")
    for key, text in SLIPS.items():
        typed_digit_by_digit(seen, key, text)
    page.locator("#name").focus()
    for key in ("helix_angle_deg", "center_distance_mm", "pinion-face_width_mm"):
        field = page.locator(f"#f-pair-{key}")
        expect(field).to_have_attribute("aria-invalid", "true")
        expect(page.locator(f"#f-pair-{key}-fault")).to_contain_text("must be")
    for press, question in (("#export-toml", "to-toml"), (DRAWN, "as-made")):
        with page.expect_response(lambda response, question=question: f"drafts/{question}" in response.url):
            control(page, press).click()
        expect(page.locator("#form-errors")).to_be_visible()
    for key, text in TUTORIAL.items():
        typed_digit_by_digit(seen, key, text)
    expect(page.locator("#plan dl")).to_be_visible()
    expect(page.locator("#form-errors")).to_be_hidden()
    assert page.locator("[aria-invalid=true]").count() == 0
    assert answers == []
    assert [line for line in seen.console if line.startswith("error")] == []


def test_a_slider_typed_beyond_its_range_says_so_and_logs_no_error(browser, address, analyzed):
    seen = shown(browser, address, analyzed)
    page = seen.page
    exact = control(page, "#live-torque_n_m-exact")
    exact.fill("900")
    expect(page.locator("#live-errors")).to_contain_text("torque_n_m")
    exact.fill("0.75")
    expect(page.locator("#live-errors")).to_be_hidden()
    answered(page)
    assert [line for line in seen.console if line.startswith("error")] == []
    page.close()
