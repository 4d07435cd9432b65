"""The page of the service in a real browser: from a case to live flanks by keyboard, nothing foreign."""

import json
import re
import tomllib
from pathlib import Path

import pytest
from page_visit import (
    CASE,
    GEAR,
    PATIENCE,
    answered,
    answers,
    choose_case,
    computed,
    control,
    found_inaccessible,
    opened,
    tab,
    unfold,
)
from playwright.sync_api import Page, expect
from running_service import until

from bounds import DEPTHS, Direction, Kind
from fe_contact.flank.modification import FlankModification
from lineofaction.gearbox.schemas.declared import figures

TABS = ("Flank", "Load", "Orders", "Sound", "Tolerance", "Errors and cost", "Jobs")
FIGURES = (
    "ste",
    "ripple",
    "load_sharing",
    "mesh_stiffness",
    "ste_spectrum",
    "live_ste",
    "live_harmonics",
    "live_load_share",
    "live_pressure",
)


def tab_to(page: Page, target: str, maximum: int = 120) -> None:
    for _ in range(maximum):
        page.keyboard.press("Tab")
        if page.evaluate("selector => document.activeElement?.matches(selector)", target):
            return
    raise AssertionError(f"{target} is not reached by {maximum} tabs")


@pytest.fixture(scope="module")
def visit(browser, address, tmp_path_factory):
    """Walk the main path with the keyboard alone, but for the dialog that opens a file."""
    seen = opened(browser, address, "light", 1400)
    page = seen.page
    choose_case(page, tmp_path_factory.mktemp("case"))
    page.wait_for_selector("#plan dl")
    page.keyboard.press("Tab")
    tab_to(page, "#analyze")
    page.keyboard.press("Enter")
    answered(page)
    return seen


def peak_to_peak(page: Page) -> str:
    return page.locator("#live-figures dd").first.text_content() or ""


@pytest.mark.parametrize("key", FIGURES)
def test_every_plot_is_drawn_and_has_words(visit, key):
    node = control(visit.page, f"[data-figure='{key}'] .plot")
    expect(node).to_have_attribute("data-drawn", "yes", timeout=PATIENCE)
    assert node.locator(".scatterlayer .trace path.js-line, .barlayer .point path").count() >= (
        1 if key == "live_pressure" else 2  # of the flank as it is now
    )
    assert len(node.get_attribute("aria-label") or "") > 20


def test_a_slider_redraws_the_curve_by_arrow_keys(visit):
    page = visit.page
    before, count = peak_to_peak(page), answers(page)
    control(page, "#live-pinion-tip_relief_um").focus()
    for _ in range(8):
        page.keyboard.press("ArrowRight")
    until(lambda: answers(page) > count)
    expect(page.locator("#live-figures dd").first).not_to_have_text(before)
    now = control(page, "[data-figure=live_ste]").locator(".scatterlayer .trace path.js-line")
    until(lambda: now.nth(0).get_attribute("d") != now.nth(1).get_attribute("d"))  # drawn in a moment
    page.get_by_role("button", name="As analyzed").press("Enter")
    expect(page.locator("#live-figures dd").first).to_have_text(before)


def test_flanks_go_from_the_sliders_into_the_case(visit):
    page = visit.page
    control(page, "#live-wheel-tip_relief_um").focus()
    page.keyboard.press("End")
    maximum = page.locator("#live-wheel-tip_relief_um").input_value()
    page.get_by_role("button", name="Take these flanks").press("Enter")
    expect(page.locator("#f-pair-wheel-tip_relief_um")).to_have_value(maximum)
    assert float(page.locator("#f-pair-wheel-tip_relief_length_mm").input_value()) > 0.0


def test_in_the_plane_nothing_across_the_face_is_offered(visit):
    assert visit.page.locator("#live-misalignment_um").is_disabled()
    assert visit.page.locator("#live-pinion-helix_crowning_um").is_disabled()


def test_every_depth_and_length_has_a_slider_and_acts_along_what_it_is_declared_to(visit):
    page = visit.page
    depths, lengths = figures(FlankModification, *DEPTHS), figures(FlankModification, Kind.LENGTH)
    sliders = page.locator("#sliders input[type=range]")
    expect(sliders).to_have_count(2 + 2 * len(depths) + 2 * len(lengths))
    for depth in depths + lengths:
        for gear in ("pinion", "wheel"):
            slider = page.locator(f"#live-{gear}-{depth.field}")
            assert slider.is_disabled() == (Direction.FACE in depth.what.along), depth.field
            signed = float(slider.get_attribute("min") or "nan") < 0.0
            assert signed == (depth.what.kind is Kind.DEVIATION), depth.field


def test_a_folded_slider_redraws_the_curve_and_takes_the_length_that_its_relief_needs(visit):
    page = visit.page
    before, count = peak_to_peak(page), answers(page)
    control(page, "#live-pinion-root_relief_um").press("End")
    until(lambda: answers(page) > count)
    expect(page.locator("#live-figures dd").first).not_to_have_text(before)
    page.get_by_role("button", name="Take these flanks").press("Enter")
    assert float(page.locator("#f-pair-pinion-root_relief_length_mm").input_value()) > 0.0


@pytest.mark.law
def test_a_fault_is_said_at_its_field_and_the_list_leads_there(browser, address, visit, tmp_path):
    page = opened(browser, address, "light", 1400).page  # a refusal is an error on a console
    choose_case(page, tmp_path)
    bore = page.locator("#f-pair-pinion-bore_diameter_mm")
    bore.fill("19")
    expect(bore).to_have_attribute("aria-invalid", "true")
    told = page.locator(f"#{bore.get_attribute('aria-describedby')}")
    expect(told).to_contain_text("must be")
    link = page.locator("#form-errors a")
    expect(link).to_have_text("pair.pinion.bore_diameter_mm")
    link.press("Enter")
    expect(bore).to_be_focused()
    choose_case(page, tmp_path)
    expect(bore).to_have_attribute("aria-invalid", "false")
    page.close()


def test_the_case_is_saved_as_toml_that_reads_back(visit, tmp_path):
    choose_case(visit.page, tmp_path)
    with visit.page.expect_download() as given:
        visit.page.locator("#export-toml").press("Enter")
    written = tomllib.loads(Path(given.value.path()).read_text(encoding="utf-8"))
    assert written["pair"]["pinion"]["teeth"] == 20
    assert written["load"]["torque_n_m"] == [0.5, 1.0]


@pytest.mark.parametrize(
    ("tool", "begin"), [("PNG", b"\x89PNG"), ("CSV", b'"0.5 N m, x"'), ("JSON", b'{"data"')]
)
def test_a_plot_is_saved(visit, tool, begin):
    control(visit.page, "[data-figure=ste]")
    with visit.page.expect_download() as given:
        visit.page.get_by_role("button", name=f"{tool} of: Static transmission error over").press("Enter")
    content = Path(given.value.path()).read_bytes()
    assert content.startswith(begin)
    assert tool != "CSV" or content.count("STE less its mean, µm".encode()) == 2  # no column of a band's edge


def test_the_result_is_saved_as_netcdf(visit):
    tab(visit.page, "Errors and cost")
    with visit.page.expect_download() as given:
        visit.page.get_by_role("button", name="netCDF").first.press("Enter")
    assert Path(given.value.path()).read_bytes()[1:4] == b"HDF"


def test_plots_follow_the_width_of_the_window(visit):
    widths = "node => [node.clientWidth, node.querySelector('.main-svg')?.clientWidth]"
    plot = visit.page.locator("#live-ripple .plot")
    seen = []
    tab(visit.page, "Ripple")
    for width in (400, 1400):
        visit.page.set_viewport_size({"width": width, "height": 900})
        until(lambda: len(set(plot.evaluate(widths))) == 1)
        seen.append(plot.evaluate(widths)[0])
    assert seen[0] < 400 < seen[1]


def test_both_gears_are_drawn_and_roll(visit):
    page = visit.page
    gears = page.locator("#mesh-drawing g > g")
    expect(gears).to_have_count(2)
    before = [gear.get_attribute("transform") for gear in gears.all()]
    page.locator("#roll").focus()
    page.keyboard.press("End")
    turned = [gear.get_attribute("transform") for gear in gears.all()]
    angles = [[float(re.findall(r"-?[\d.]+", text or "")[0]) for text in both] for both in (before, turned)]
    # one base pitch: one tooth of either gear, in opposite senses (an angle of a drawing runs clockwise)
    assert [b - a for a, b in zip(*angles, strict=True)] == pytest.approx([-18.0, 18.0], abs=1e-3)


@pytest.mark.law
@pytest.mark.parametrize(
    ("scheme", "width"), [("light", 1400), pytest.param("dark", 400, marks=pytest.mark.nightly)]
)
def test_the_page_is_accessible(browser, address, visit, scheme, width):
    page = visit.page
    page.emulate_media(color_scheme=scheme)
    page.set_viewport_size({"width": width, "height": 900})
    unfold(page)
    assert not (told := found_inaccessible(page)), json.dumps(told, indent=1)
    for title in TABS:
        tab(page, title)
        assert not (told := found_inaccessible(page, "#panels")), json.dumps(told, indent=1)
    until(lambda: page.evaluate("document.documentElement.scrollWidth") <= width)


def test_nothing_is_complained_about(visit):
    assert [line for line in visit.console if line.startswith("error")] == []


def test_nothing_is_fetched_from_elsewhere(visit, address):
    foreign = [url for url in visit.requests if not url.startswith((address, "data:", "blob:"))]
    assert foreign == []


@pytest.mark.law
def test_a_script_from_elsewhere_does_not_run(browser, address, visit):
    page = opened(browser, address, "light", 1400).page
    page.evaluate(
        "() => { const s = document.createElement('script'); s.textContent = 'window.intruder = 1';"
        " document.head.append(s); }"
    )
    assert page.evaluate("window.intruder") is None
    page.close()


def test_what_is_implausible_is_said_with_the_plan_and_with_the_results(browser, address):
    pair = CASE["pair"] | {"pinion": GEAR | {"face_width_mm": 1000.0}}  # of module 1
    page = opened(browser, f"{address}/#database={computed(address, case=CASE | {'pair': pair})}").page
    expect(page.locator("#plan > .alarm + .headline")).to_be_visible()
    for part in ("#plan", "#results-alarms"):
        expect(page.locator(f"{part} > .alarm")).to_contain_text(
            "Warning: pair.pinion.face_width_mm = 1000 mm"
        )
    page.close()
