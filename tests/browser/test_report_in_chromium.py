"""The report in a real browser: every plot drawn, nothing fetched, nothing complained about."""

import re
from dataclasses import dataclass, field

import pytest
from page_visit import PATIENCE
from playwright.sync_api import Page, expect

from lineofaction.gearbox.problems import BadInput
from lineofaction.report.document import write_report

# curves of every figure; all panels together
CURVES = {
    "ste": 12,  # the ripple with the edges of its bands, and the Harris map
    "ripple": 35,
    "load_sharing": 9,
    "mesh_stiffness": 3,
    "dynamic_error": 6,
    "signal": 2,
    "spectrum": 1,
    "levels": 6,
    "order_map": 0,
    "campbell": 8,
    "octave_bands": 2,
    "dynamic_factor": 3,
}
PANELS = {
    "ste": 2,
    "ripple": 3,
    "ste_spectrum": 1,
    "ste_waterfall": 1,
    "load_sharing": 3,
    "mesh_stiffness": 1,
    "dynamic_error": 3,
    "signal": 2,
    "spectrum": 1,
    "levels": 1,
    "order_map": 1,
    "campbell": 1,
    "octave_bands": 1,
    "dynamic_factor": 1,
}


@dataclass
class Visit:
    """An opened page and what it did."""

    page: Page
    console: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@pytest.fixture(scope="module")
def report(closed_forms, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    closed_forms.closed_form().to_netcdf(folder / "ste.nc")
    closed_forms.run_up().to_netcdf(folder / "run.nc")
    closed_forms.closed_form_flanks().to_netcdf(folder / "flanks.nc")
    files = [folder / name for name in ("ste.nc", "flanks.nc", "run.nc")]
    return write_report(files, folder / "report.html")[0]


@pytest.fixture(scope="module")
def visit(browser, report):
    seen = Visit(browser.new_page(viewport={"width": 1280, "height": 900}))
    seen.page.on("console", lambda message: seen.console.append(f"{message.type}: {message.text}"))
    seen.page.on("pageerror", lambda error: seen.console.append(f"error: {error}"))
    seen.page.on("request", lambda request: seen.requests.append(request.url))
    seen.page.goto(report.as_uri())
    seen.page.wait_for_selector("html[data-drawn=yes]", timeout=PATIENCE)
    return seen


@pytest.mark.parametrize("key", CURVES)
def test_every_curve_is_drawn(visit, key):
    drawn = visit.page.locator(f"#{key} .plot .scatterlayer .trace path.js-line")
    expect(drawn).to_have_count(CURVES[key])
    boxes = [drawn.nth(index).bounding_box() for index in range(CURVES[key])]
    assert all(box is not None and box["width"] > 100 for box in boxes)


@pytest.mark.parametrize("key", PANELS)
def test_every_panel_has_both_axes_named_once(visit, key):
    named = visit.page.eval_on_selector_all(
        f"#{key} .plot text", "nodes => nodes.map(n => [n.getAttribute('class') || '', n.textContent])"
    )
    vertical = [text for name, text in named if re.fullmatch(r"y\d*title", name) and text]
    assert len(vertical) == PANELS[key]
    assert all("," in text or "share" in text or "order" in text for text in vertical)  # quantity and unit
    assert any(text for name, text in named if re.fullmatch(r"x\d*title", name))


def test_no_text_of_a_plot_lies_on_another(visit):
    for key in CURVES:
        texts = visit.page.locator(f"#{key} .plot").locator("[class*=title], .annotation-text, .legendtext")
        found = [
            (t.text_content(), t.bounding_box()) for t in texts.all() if (t.text_content() or "").strip()
        ]
        boxes = {(text, round(box["x"]), round(box["y"])): box for text, box in found if box and box["width"]}
        names = list(boxes)
        for index, one in enumerate(names):
            for other in names[index + 1 :]:
                assert not overlap(boxes[one], boxes[other]), (key, one, other)


def test_no_label_at_a_curve_is_cut_off(visit):
    """Labels stand to the right of their curves, in whatever font the reader's machine has."""
    cut: list[str] = visit.page.evaluate(
        """() => [...document.querySelectorAll(".js-plotly-plot")].flatMap((plot) => {
          const right = plot.getBoundingClientRect().right;
          return [...plot.querySelectorAll(".annotation-text")]
            .filter((label) => label.getBoundingClientRect().right > right + 0.5)
            .map((label) => label.textContent);
        })"""
    )
    assert cut == []


def overlap(one: dict[str, float], other: dict[str, float]) -> bool:
    """Whether two boxes share more than a pixel in both directions."""
    across = min(one["x"] + one["width"], other["x"] + other["width"]) - max(one["x"], other["x"])
    along = min(one["y"] + one["height"], other["y"] + other["height"]) - max(one["y"], other["y"])
    return across > 1 and along > 1


def test_the_still_images_load(visit):
    widths = visit.page.eval_on_selector_all("img.still", "nodes => nodes.map(n => n.naturalWidth)")
    assert widths == [1350] * visit.page.locator("figure").count()
    assert len(widths) >= len(PANELS)


def test_nothing_is_complained_about(visit):
    assert [line for line in visit.console if line.startswith("error")] == []


def test_nothing_is_fetched_but_the_page(visit, report):
    foreign = [url for url in visit.requests if not url.startswith(("data:", "blob:"))]
    assert foreign == [report.as_uri()]


@pytest.mark.law
def test_the_page_does_not_scroll_sideways_on_a_phone(browser, report):
    page = browser.new_page(viewport={"width": 390, "height": 800})
    page.goto(report.as_uri())
    page.wait_for_selector("html[data-drawn=yes]", timeout=PATIENCE)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.close()


@pytest.mark.parametrize("width", [390, pytest.param(700, marks=pytest.mark.nightly), 1280])
def test_the_bar_of_buttons_hides_nothing(browser, report, width):
    """Neither a legend nor the words above a plot; it is reached from the plot without a gap."""
    page = browser.new_page(viewport={"width": width, "height": 800})
    page.goto(report.as_uri())
    page.wait_for_selector("html[data-drawn=yes]", timeout=PATIENCE)
    bars, plots, words = (
        page.eval_on_selector_all(chosen, "nodes => nodes.map(n => n.getBoundingClientRect().toJSON())")
        for chosen in (
            ".plot:has(.legend) .modebar",
            ".plot:has(.legend) .svg-container",
            "h2, h3, p, figcaption, summary, .legendtext",
        )
    )
    page.close()
    assert len(bars) == len(plots) > 3
    for bar, plot in zip(bars, plots, strict=True):
        assert not any(overlap(bar, box) for box in words)
        assert abs(bar["bottom"] - plot["top"]) < 4


def test_the_numbers_open_by_keyboard(visit):
    summary = visit.page.locator("#ste summary")
    table = visit.page.locator("#ste table")
    expect(table).to_be_hidden()
    summary.focus()
    visit.page.keyboard.press("Enter")
    expect(table).to_be_visible()


def test_print_shows_pictures_with_one_title_and_what_was_opened(visit):
    page = visit.page
    page.locator("#ste details").evaluate("node => { node.open = true; }")
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    expect(page.locator("#ste .still")).to_be_visible()
    expect(page.locator("#ste .plot")).to_be_hidden()
    expect(page.locator("#ste h3")).to_be_hidden()  # the picture has it
    expect(page.locator("#ste table")).to_be_visible()
    expect(page.locator("#ripple table").first).to_be_hidden()
    unprinted = page.locator("section.unprinted h2").all_text_contents()
    assert "Case" in unprinted and any(title.startswith("Receipt") for title in unprinted)
    assert not any(section.is_visible() for section in page.locator("section.unprinted").all())
    page.emulate_media(media="screen")
    expect(page.locator("#ste h3")).to_be_visible()


@pytest.fixture(scope="module")
def printed(browser, report, tmp_path_factory):
    del browser  # skips where there is none
    folder = tmp_path_factory.mktemp("printed")
    files = [report.with_name(name) for name in ("ste.nc", "flanks.nc", "run.nc")]
    return write_report(files, folder / "report.pdf")[0].read_bytes()


def test_a_pdf_has_few_pages_of_a4_and_no_empty_one(printed):
    boxes = re.findall(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", printed)
    assert printed.startswith(b"%PDF-")
    assert len(printed) < 3_000_000
    assert 3 <= len(boxes) <= 15  # of three results, 22 plots
    for width, height in boxes:
        assert float(width) / 72.0 * 25.4 == pytest.approx(210.0, abs=0.5)
        assert float(height) / 72.0 * 25.4 == pytest.approx(297.0, abs=0.5)


@pytest.mark.parametrize(
    ("browser_of_caller", "bound"),
    [("/bin/false", "must be a page that false prints: CalledProcessError"), ("", "no browser is installed")],
)
def test_a_pdf_without_a_browser_is_refused_and_leaves_nothing(
    browser_of_caller, bound, report, tmp_path, monkeypatch
):
    monkeypatch.setenv("CHROMIUM", browser_of_caller)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BadInput, match=bound):
        write_report(report.with_name("ste.nc"), tmp_path / "page.pdf")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.law
def test_without_scripts_images_take_the_place_of_figures(browser, report):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(report.as_uri())
    expect(page.locator("#ste .still")).to_be_visible()
    expect(page.locator("h1")).to_have_text("Gear pair 20/20")
    context.close()
