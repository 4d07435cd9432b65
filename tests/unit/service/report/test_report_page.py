"""The page stands alone, says what the figures say, and cannot be broken by its content."""

import json
import re
from html.parser import HTMLParser
from itertools import pairwise

import numpy as np

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table
from lineofaction.report.drawing.page import Headline, Page, Section, html
from lineofaction.report.drawing.tables import facts, records

PNG = b"\x89PNG\r\n\x1a\n"
HOSTILE = '</script><script src="http://example.org/x.js"></script>'


class Outline(HTMLParser):
    """Collect elements, with their attributes, as a browser would meet them."""

    def __init__(self) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))


def figure(key: str = "ste", title: str = "STE") -> Figure:
    x = np.array([0.0, 1.0, 2.0])
    panel = Panel(Axis("position"), Axis("µm"), (Line(title, x, x, palette.BLUE),))
    table = Table("Numbers", ("load", "mean"), (("10 N m", "0.680"),))
    return Figure(key, title, "How to read it.", "A straight line.", (panel,), table)


def page(title: str = "Report", **changes: object) -> Page:
    section = Section("Static", "Text.", (figure(),), (facts("Case", {"center_distance_mm": 80.0}),))
    given = {"headlines": (Headline("mean STE", "6.245 µm", "± 0.02"),), "sections": (section,)} | changes
    return Page(title, "A pair.", **given)  # type: ignore[arg-type]


def outline(text: str) -> list[tuple[str, dict[str, str | None]]]:
    parser = Outline()
    parser.feed(text)
    return parser.elements


def test_nothing_is_loaded_from_elsewhere() -> None:
    text = html(page(), {"ste": PNG})
    for tag, attributes in outline(text):
        for name in ("src", "href", "data", "srcset", "poster", "action"):
            value = attributes.get(name) or ""
            assert not re.match(r"(https?:)?//", value), (tag, value)
    style = re.findall(r"<style>(.*?)</style>", text, re.DOTALL)
    assert style
    assert not any("url(" in sheet or "@import" in sheet for sheet in style)


def test_the_drawing_library_is_in_the_page() -> None:
    assert "Plotly" in html(page(), {"ste": PNG})[:2_000_000]
    assert len(html(page(), {"ste": PNG})) > 2_000_000


def test_text_is_escaped_and_data_cannot_close_its_script() -> None:
    hostile = figure(title=HOSTILE)
    alarmed = page(HOSTILE, sections=(Section(HOSTILE, HOSTILE, (hostile,)),), alarms=(HOSTILE,))
    elements = outline(html(alarmed, {"ste": PNG}))
    assert not [a for tag, a in elements if tag == "script" and "src" in a]
    assert len([tag for tag, _ in elements if tag == "script"]) == 3  # library, data, drawing


def test_the_embedded_data_is_json() -> None:
    text = html(page(), {"ste": PNG})
    data = re.search(r'<script type="application/json" id="ste-data">(.*?)</script>', text, re.DOTALL)
    assert data
    assert json.loads(data.group(1))["data"][0]["x"] == [0.0, 1.0, 2.0]


def test_every_plot_has_words_a_still_image_and_its_numbers() -> None:
    elements = outline(html(page(), {"ste": PNG}))
    plot = next(a for _, a in elements if a.get("class") == "plot")
    image = next(a for tag, a in elements if tag == "img")
    assert "A straight line." in (plot["aria-label"] or "")
    assert plot["aria-label"] == image["alt"]
    assert (image["src"] or "").startswith("data:image/png;base64,")
    assert [tag for tag, _ in elements].count("table") == 2


def test_headings_descend_one_level_at_a_time() -> None:
    levels = [int(tag[1]) for tag, _ in outline(html(page(), {"ste": PNG})) if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(b - a <= 1 for a, b in pairwise(levels))


def test_the_contents_lead_to_every_section() -> None:
    sections = (Section("One"), Section("Two"))
    elements = outline(html(page(sections=sections), {}))
    targets = {a["id"] for _, a in elements if "id" in a}
    links = [(a["href"] or "")[1:] for tag, a in elements if tag == "a"]
    assert len(links) == 3
    assert set(links) <= targets


def test_settings_become_rows_with_units() -> None:
    table = facts(
        "Case", {"pair": {"normal_module_mm": 4.0, "pinion": {"teeth": 20}}, "none": None, "on": True}
    )
    assert table.rows == (("pair · normal module, mm", "4"), ("pair · pinion · teeth", "20"), ("on", "yes"))


def test_records_keep_every_field() -> None:
    table = records("Ledger", [{"name": "a", "on": True}, {"name": "b", "worth": "2 %"}])
    assert table.head == ("name", "on", "worth")
    assert table.rows == (("a", "yes", "none"), ("b", "none", "2 %"))
