"""The jobs of a service as a gallery: ripple and figures of each, no design twice, no table fetched."""

import json
import math
import re
from typing import Any

import pytest
from page_visit import CASE, Visit, found_inaccessible, opened, served, tab
from playwright.sync_api import expect

from bounds.error_digits import error_text, to_error
from lineofaction.client import LineOfActionClient

OWN = CASE | {"accuracy": {k: v for k, v in CASE["accuracy"].items() if k != "receipt"}}
"""With errors."""
OTHER = OWN | {"load": {"torque_n_m": [0.5]}}
RELIEVED = CASE["pair"]["pinion"] | {"tip_relief_um": 3.0, "tip_relief_length_mm": 0.4}
LONGER = OWN | {"pair": CASE["pair"] | {"pinion": RELIEVED}}


@pytest.fixture(scope="module")
def gallery(tmp_path_factory):
    """Give the address of a service with three designs, the first one computed twice, and its table."""
    home = tmp_path_factory.mktemp("gallery")
    with served(home) as address, LineOfActionClient(address) as client:
        for title, case in (("first", OWN), ("light", OTHER), ("relieved", LONGER), ("again", OWN)):
            key = client.wait(client.with_terms(title=title).submit("analyze", {"case": case}).id).key
        yield address, client.fetch(key)


@pytest.fixture
def seen(browser, gallery):
    found = opened(browser, gallery[0])
    tab(found.page, "Jobs")
    expect(found.page.locator("#jobs-rows li")).to_have_count(3)
    yield found
    found.page.close()


@pytest.mark.law
def test_a_card_has_the_ripple_and_the_figures_of_its_table(seen, gallery):
    card = seen.page.locator("#jobs-rows li").first
    table = gallery[1]
    curve = table.curve(torque=float(table.torque[1]))
    ripple, tone = curve.peak_to_peak, curve.harmonics[0].value
    value, error = 1e6 * ripple.value, 1e6 * ripple.error
    expect(card).to_contain_text(f"{to_error(value, error)} µm")
    expect(card).to_contain_text(f"± {error_text(value, error)}")
    level = f"{20.0 * math.log10(1e6 * tone):.1f}".replace("-", "−")
    expect(card).to_contain_text(re.compile(rf"{re.escape(level)} dB ± [\d.]+ re 1 µm"))
    expect(card).to_contain_text(re.compile(r"CPU time[\d.]+ s"))
    drawn = card.locator("polyline").get_attribute("points")
    heights = [float(point.partition(",")[2]) for point in drawn.split()]
    assert len(heights) == 49
    assert heights[:25] == pytest.approx(heights[24:], abs=0.2), "a pitch is as the next one"
    assert max(heights) - min(heights) > 25.0
    assert not [url for url in seen.requests if "/v1/results/" in url or url.endswith("/results")]


LABELLED = """async (differences) => {
  const { label } = await import("/page/job_label.js");
  return label({ title: "", subject: "", processID: "flank", tags: [], differences })[1]?.textContent;
}"""
CALLED = """() => [...document.querySelectorAll("#case-form :is(input, select)[name]")].map(
  (control) => [control.name, control.labels[0]?.textContent ?? control.ariaLabel])"""


def labelled(seen: Visit, *first: dict[str, Any]) -> str:
    said: str = seen.page.evaluate(LABELLED, {"since": "x", "first": list(first), "number": len(first)})
    return said


def test_differences_that_read_alike_are_counted_only(seen):
    alike = {"field": "scene.housings[0].step_file", "before": "text of 9 bytes", "value": "text of 9 bytes"}
    other = {"field": "case.load.torque_n_m", "before": [80], "value": [20, 80]}
    assert labelled(seen, alike, other) == "torque 80 → 20, 80 N m; 1 more"
    assert labelled(seen, alike) == "1 more"


@pytest.mark.law
def test_a_card_calls_a_field_as_the_form_does(seen):
    fields = seen.page.evaluate(CALLED)
    assert len(fields) > 100
    for name, text in fields:
        words, *more = text.split(", ")
        gear = f"{more.pop()} " if more[-1:] in (["pinion"], ["wheel"]) else ""
        said = f"{gear}{words[0].lower()}{words[1:]} 1 → 1.9 {''.join(more)}".strip()
        assert labelled(seen, {"field": f"case.{name}", "before": 1, "value": 1.9}) == said
    module = {"field": "case.pair.normal_module_mm", "before": 1, "value": None}
    assert labelled(seen, module) == "normal module 1 mm → not set"
    shaft = {"field": "scene.shafts[0].length_mm", "before": None, "value": 90}
    assert labelled(seen, shaft) == "shafts 1 length not set → 90 mm"


def test_a_design_that_was_computed_twice_is_shown_once(seen, gallery):
    titles = seen.page.locator("#jobs-rows h3")
    expect(titles).to_have_text(["again", "relieved", "light"])
    seen.page.get_by_label("Find by words").fill("first")
    seen.page.get_by_label("Find by words").press("Enter")
    expect(titles).to_have_text(["first"])
    with LineOfActionClient(gallery[0]) as client:
        assert len(list(client.jobs())) == 4, "all are there for programs"


@pytest.mark.parametrize(("scheme", "width"), [("light", 1400), ("dark", 400)])
def test_the_gallery_is_for_everybody(browser, gallery, scheme, width):
    found = opened(browser, gallery[0], scheme, width)
    page = found.page
    tab(page, "Jobs")
    cards = page.locator("#jobs-rows li")
    expect(cards).to_have_count(3)
    assert not (rules := found_inaccessible(page, "#jobs")), json.dumps(rules, indent=1)
    wide = page.evaluate("() => document.documentElement.scrollWidth - innerWidth")
    inner = page.evaluate(
        "() => { const p = document.querySelector('#jobs'); return p.scrollWidth - p.clientWidth; }"
    )
    assert wide <= 0 and inner <= 0
    cards.nth(1).get_by_role("button", name=re.compile("^Open analyze of relieved")).focus()
    page.keyboard.press("Tab")
    expect(cards.nth(1).get_by_role("button", name=re.compile("^Compare"))).to_be_focused()
    page.keyboard.press("Shift+Tab")
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile("#database="))
    assert found.complaints == []
    page.close()
