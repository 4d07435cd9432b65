"""The report in a real browser: every plot drawn, nothing fetched, nothing complained about."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from service.report import palette
from service.report.facts import facts
from service.report.figure import Axis, Figure, Line, Panel, Reference, Surface, Table
from service.report.image import png
from service.report.page import Headline, Section, html
from service.report.page import Page as Report


@dataclass
class Visit:
    """An opened page and what it did."""

    page: Page
    console: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


def curves() -> Figure:
    x = np.linspace(0.0, 2.0, 101)
    lines = tuple(
        Line(f"{10 * k} N m", x, k * (1 + 0.2 * np.sin(6.28 * x)), palette.ordered(k, 5)) for k in range(5)
    )
    panel = Panel(Axis("position, base pitches"), Axis("STE, µm"), lines, (Reference("handover", 0.5),))
    table = Table("Numbers", ("load", "mean"), (("10 N m", "0.680"),))
    return Figure("ste", "Static transmission error", "Caption.", "Curves.", (panel, panel), table)


def surface() -> Figure:
    x, y = np.linspace(0, 2, 41), np.linspace(100, 1000, 6)
    axes = (Axis("position"), Axis("normal force, N"), Axis("STE, µm"))
    solid = Surface(x, y, np.outer(y, 1 + 0.2 * np.sin(6.28 * x)), axes)
    return Figure("database", "The STE database", "Caption.", "A surface.", solid)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    figures = (curves(), surface())
    table = facts("Case", {"center_distance_mm": 80.0})
    section = Section("Static", figures=figures, tables=(table,))
    page = Report("Report", "A pair.", (Headline("mean", "6.2 µm"),), (section,))
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(html(page, {f.key: png(f) for f in figures}), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def visit(browser: Browser, report: Path) -> Visit:
    seen = Visit(browser.new_page(viewport={"width": 1280, "height": 900}))
    seen.page.on("console", lambda message: seen.console.append(f"{message.type}: {message.text}"))
    seen.page.on("pageerror", lambda error: seen.console.append(f"error: {error}"))
    seen.page.on("request", lambda request: seen.requests.append(request.url))
    seen.page.goto(report.as_uri())
    seen.page.wait_for_selector("html[data-drawn=yes]", timeout=60_000)
    return seen


def test_every_curve_is_drawn(visit: Visit) -> None:
    drawn = visit.page.locator("#ste .plot .scatterlayer .trace path.js-line")
    assert drawn.count() == 10
    for index in range(10):
        box = drawn.nth(index).bounding_box()
        assert box is not None
        assert box["width"] > 300


def test_the_surface_is_drawn_or_stands_as_an_image(visit: Visit) -> None:
    canvas = visit.page.locator("#database .plot canvas").first
    still = visit.page.locator("#database .still")
    assert canvas.is_visible() != still.is_visible()


def test_the_still_images_load(visit: Visit) -> None:
    widths = visit.page.eval_on_selector_all("img.still", "nodes => nodes.map(n => n.naturalWidth)")
    assert widths == [1350, 1350]


def test_nothing_is_complained_about(visit: Visit) -> None:
    assert [line for line in visit.console if line.startswith("error")] == []


def test_nothing_is_fetched_but_the_page(visit: Visit, report: Path) -> None:
    foreign = [url for url in visit.requests if not url.startswith(("data:", "blob:"))]
    assert foreign == [report.as_uri()]


def test_the_page_does_not_scroll_sideways_on_a_phone(browser: Browser, report: Path) -> None:
    page = browser.new_page(viewport={"width": 390, "height": 800})
    page.goto(report.as_uri())
    page.wait_for_selector("html[data-drawn=yes]", timeout=60_000)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.close()


def test_the_numbers_open_by_keyboard(visit: Visit) -> None:
    summary = visit.page.locator("#ste summary")
    table = visit.page.locator("#ste table")
    assert not table.is_visible()
    summary.focus()
    visit.page.keyboard.press("Enter")
    assert table.is_visible()


def test_print_shows_the_images(visit: Visit) -> None:
    visit.page.emulate_media(media="print")
    assert visit.page.locator("#ste .still").is_visible()
    assert not visit.page.locator("#ste .plot").is_visible()
    visit.page.emulate_media(media="screen")
