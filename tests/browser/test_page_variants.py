"""Variants of a design on the page: side by side, each a copy, all in one address."""

import base64
import json
import math
import re
from typing import Any

import httpx2
import pytest
from page_visit import CASE, GEAR, computed, control, found_inaccessible, moved
from playwright.sync_api import Page, expect
from running_service import until

RELIEVED = GEAR | {"tip_relief_um": 8.0, "tip_relief_length_mm": 0.4}


@pytest.fixture(scope="module")
def relieved(address):
    """Hash of the table of the small pair with tip relief."""
    positions = CASE["accuracy"] | {"positions": 192}  # of which 16 miss 5 % of its ripple
    return computed(address, case=CASE | {"pair": CASE["pair"] | {"pinion": RELIEVED}, "accuracy": positions})


DATA = "node => Object.fromEntries((node.data ?? []).map(({name, y}) => [name, [...y]]))"


def curves(page: Page) -> dict[str, list[float]]:
    node = control(page, "[data-figure=live_ste] .plot")
    found: list[tuple[str, list[float]]] = node.evaluate(
        "node => (node.data ?? []).map(({name, y}) => [name, [...y]])"
    )
    return dict(found)


@pytest.mark.law
def test_a_variant_begins_as_a_copy_and_moves_by_itself(visit, analyzed):
    page = visit.page
    page.get_by_role("button", name="Another variant").press("Enter")
    expect(page.get_by_role("button", name="Variant B")).to_have_attribute("aria-pressed", "true")
    expect(page).to_have_url(re.compile(f"#database={analyzed}&a={analyzed}&on=b$"))
    until(lambda: len(curves(page)) == 3)
    until(lambda: curves(page)["A"] == curves(page)["B"] == curves(page)["as analyzed"])  # as it rests
    same = curves(page)
    moved(page, "#live-pinion-tip_relief_um", "End")
    page.wait_for_timeout(500)  # drawn in a moment
    found = curves(page)
    assert found["A"] == same["A"] != found["B"]
    page.get_by_role("button", name="Variant A").press("Enter")
    expect(page.locator("#live-pinion-tip_relief_um")).to_have_value("0")
    until(lambda: curves(page).get("B") == found["B"])  # with its moved flanks
    assert visit.complaints == []


def test_two_results_and_an_edit_stand_side_by_side_in_another_browser(visit, browser, analyzed, relieved):
    page = visit.page
    origin = page.url.partition("#")[0]
    page.goto(f"{origin}#database={relieved}&a={analyzed}&on=b")
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("8")
    until(lambda: len(curves(page)) == 3)
    found = curves(page)
    assert found["A"] != found["B"]
    page.get_by_role("button", name="Variant A").press("Enter")
    expect(page).to_have_url(re.compile(f"#database={analyzed}&b={relieved}"))
    expect(page.locator("#f-pair-pinion-tip_relief_um")).to_have_value("")
    control(page, "#f-pair-wheel-tip_relief_um").fill("5")
    expect(page).to_have_url(re.compile("case="))
    page.get_by_role("button", name="Variant B").press("Enter")
    expect(page.locator("#f-pair-wheel-tip_relief_um")).to_have_value("")
    context = browser.new_context()
    other = context.new_page()
    other.goto(page.url)
    other.wait_for_selector("html[data-ready=yes]")
    expect(other.locator("#f-pair-pinion-tip_relief_um")).to_have_value("8")
    other.get_by_role("button", name="Variant A").press("Enter")
    expect(other.locator("#f-pair-wheel-tip_relief_um")).to_have_value("5")
    other.go_back()
    expect(other.locator("#f-pair-pinion-tip_relief_um")).to_have_value("8")
    context.close()
    assert visit.complaints == []


def packed(case: dict[str, Any]) -> str:
    """Return the word of the address for a design as typed."""
    return base64.urlsafe_b64encode(json.dumps(case).encode()).decode().rstrip("=")


def with_pinion(**changes: Any) -> dict[str, Any]:
    return CASE | {"pair": CASE["pair"] | {"pinion": GEAR | changes}}


def at_rest(address: str, key: str) -> dict[str, Any]:
    body = {"torque_n_m": [1.0], "flanks": True}
    answer = httpx2.post(f"{address}/v1/databases/{key}/ste", json=body, timeout=60.0).json()
    curve: dict[str, Any] = answer["curves"][0]
    return curve


def table(page: Page) -> dict[str, list[str]]:
    """Return the rows of the dock's table of variants, by their names."""
    rows = page.locator("#compared tr").evaluate_all(
        "rows => rows.map((row) => [...row.children].map((cell) => cell.textContent))"
    )
    return {name: [text.replace("\xa0", " ") for text in cells] for name, *cells in rows}


def go(page: Page, fragment: str) -> None:
    page.goto(f"{page.url.partition('#')[0]}#{fragment}")


@pytest.mark.law
def test_a_typed_design_is_answered_on_the_gears_of_a_result(visit, address, analyzed, relieved):
    page = visit.page
    go(page, f"database={analyzed}&a={packed(with_pinion(tip_relief_um=8.0, tip_relief_length_mm=0.4))}&on=b")
    until(lambda: len(curves(page)) == 3)
    typed, exact = at_rest(address, analyzed), at_rest(address, relieved)
    assert typed["peak_to_peak_um"] != exact["peak_to_peak_um"], "the relief acts"
    until(lambda: "±" in table(page).get("peak to peak, µm", [""])[0])
    assert table(page)["figure"] == ["A", "B"]
    ripples = [float(text.split()[0]) for text in table(page)["peak to peak, µm"]]
    assert ripples == pytest.approx([exact["peak_to_peak_um"], typed["peak_to_peak_um"]], rel=3e-3)
    expect(page.locator("#unanswered")).to_be_empty()
    page.get_by_role("button", name="Variant A").press("Enter")
    expect(control(page, "#live-pinion-tip_relief_um")).to_have_value("8")
    expect(page).to_have_url(re.compile(f"database={analyzed}"))
    shown = pytest.approx(ripples[0], rel=5e-3)
    until(lambda: first_of(table(page).get("peak to peak, µm", [""])[0]) == shown)
    assert visit.complaints == []


def first_of(text: str) -> float:
    """The number that a text begins with, as many digits as it has; NaN where it is none (yet)."""
    found = re.match(r"[\d.]+", text)
    return float(found[0]) if found else float("nan")


@pytest.mark.law
def test_a_typed_design_of_other_gears_says_what_it_needs_and_is_analyzed_beside(visit, analyzed):
    page = visit.page
    other = packed(with_pinion(face_width_mm=3.5))
    go(page, f"database={analyzed}&b={other}&c={packed(with_pinion(tip_relief_um=5.0))}&on=a")
    line = page.get_by_role("group", name="Variant B")
    expect(line).to_contain_text("B: not analyzed, and no result here has its gears.")
    assert found_inaccessible(page, "#dock") == {}
    line.get_by_role("button", name="Analyze B").press("Enter")
    until(lambda: "B" in curves(page))
    expect(line).to_have_count(0)
    expect(page).to_have_url(re.compile(f"database={analyzed}.*&b=[0-9a-f-]{{36}}"))
    expect(page.get_by_role("button", name="Variant A")).to_have_attribute("aria-pressed", "true")
    until(lambda: table(page).get("figure") == ["A", "B"])
    expect(page.locator("#compared p")).to_contain_text(re.compile("^C: .*relief"))
    page.reload()
    until(lambda: "B" in curves(page))
    page.get_by_role("button", name="Variant B").press("Enter")
    expect(page.locator("#f-pair-pinion-face_width_mm")).to_have_value("3.5")
    assert visit.complaints == []


def test_three_variants_stand_beside_each_other_with_the_complaint(visit, address, analyzed, relieved):
    page = visit.page
    heard = with_pinion() | {"complaint": {"frequency_hz": 1000.0, "speed_rpm": 1500.0, "torque_n_m": 1.0}}
    words = {"a": relieved, "b": packed(with_pinion(tip_relief_um=4.0, tip_relief_length_mm=0.4))}
    others = "&".join(f"{name}={word}" for name, word in words.items())
    go(page, f"database={analyzed}&case={packed(heard)}&{others}&on=c")
    until(lambda: "…" not in str(table(page).get("peak to peak, µm", "…")) and "B" in curves(page))
    rows = table(page)
    assert rows["figure"] == ["A", "B", "C"]
    level, first, change = (
        rows[name]
        for name in (
            "complaint, harmonic 2 at 1 N m, dB re 1 µm",
            "first harmonic, µm",
            "first harmonic, dB from A",
        )
    )
    assert all(re.fullmatch(r"−?[\d.]+ ± [\d.]+|below −?[\d.]+ \(its error\)", text) for text in level)
    assert first[0].startswith(f"{at_rest(address, relieved)['harmonics_um'][0]:.3g}"[:4])
    tones = [first_of(text) for text in first]
    assert change[0] == "" and min(abs(20.0 * math.log10(tone / tones[0])) for tone in tones[1:]) > 0.2
    for text, tone in zip(change[1:], tones[1:], strict=True):
        level, _, band = text.partition(" ± ")
        assert len(level.partition(".")[2]) == len(band.partition(".")[2]), "as the error leaves"
        assert float(level.replace("−", "-")) == pytest.approx(20.0 * math.log10(tone / tones[0]), abs=0.2)
    box = page.locator("#compared").bounding_box()
    assert box is not None and box["width"] <= 320, "it fits the dock"
    assert visit.complaints == []
