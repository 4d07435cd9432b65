"""Every study of the page in a real browser: run by its button, drawn, saved, accessible; all at night."""

import json
import re
from pathlib import Path

import pytest
from page_visit import PATIENCE, Visit, control, found_inaccessible, shown, unfold
from playwright.sync_api import Locator, Page, expect
from running_service import until

from lineofaction.gearbox.registry import STUDIES as REGISTERED

# title, button, what is typed or chosen by label, figures
STUDIES = {
    "flank": ("Flank pressure", "Compute flank pressure", {}, ["contact_pattern"]),
    "ablate": ("Effects", "Toggle every effect", {}, ["ablation"]),
    "frontier": (
        "Accuracy frontier", "Run the accuracy study",
        {"Up to": "corrected fine"}, ["frontier"],
    ),
    "sensitivity": (
        "Sensitivity", "Study the sensitivity",
        {"Misalignments": "0, 20", "Changes of the center distance": "0, 0.5"}, ["sensitivity"],
    ),
    "root-stress": ("Tooth-root stress", "Compute the root stress", {}, ["root_stress"]),
    "optimize": (
        "Optimize the flanks", "Search better flanks",
        {"Largest tip relief": "10", "Largest number of designs": "30"}, ["harris_map"],
    ),
    "scatter": (
        "Tolerances", "Draw pairs within tolerances", {"Class": "8", "Pairs": "50"}, ["scatter"],
    ),
    "sweep": (
        "Maps", "Map the figures", {"Over": "torque, profile_crowning=0:10:5"}, ["sweep_map", "sweep_curves"],
    ),
    "complaint": (
        "Complaint", "Find what it is", {"Frequency": "2200", "Speed": "3360"}, ["complaint"],
    ),
    "modes": (
        "Modes", "Find the modes", {"Top speed": "2000"}, ["modal_campbell", "modal_energy", "modal_motion"],
    ),
    "simulate": (
        "Run-up", "Simulate the run-up", {"Duration": "0.05"},
        ["dynamic_error", "signal", "spectrum"],
    ),
}  # fmt: skip

FEW = ("flank", "optimize", "modes")
EACH = [pytest.param(name, marks=[pytest.mark.nightly] * (name not in FEW)) for name in STUDIES]


@pytest.fixture(scope="module")
def visit(browser, address, analyzed):
    return shown(browser, address, analyzed)


def card(page: Page, title: str) -> Locator:
    """Return the part of a study, in its tab."""
    part = page.locator(".study").filter(has=page.locator("h3").get_by_text(title, exact=True))
    identifier = part.locator("button").first.evaluate("node => (node.id ||= crypto.randomUUID())")
    control(page, f"[id='{identifier}']")
    return part


def ran(visit: Visit, name: str) -> Locator:
    """Run a study by keyboard, once; returns its part of the page."""
    title, button, wishes, *_ = STUDIES[name]
    part = card(visit.page, title)
    if part.locator(".plot").count():
        return part
    for label, wish in wishes.items():
        control = part.get_by_label(label).first  # "Pairs" before "Pairs analyzed whole"
        if control.evaluate("node => node.tagName") == "SELECT":
            control.select_option(label=wish)
        else:
            control.fill(wish)
    part.get_by_role("button", name=button).press("Enter")
    part.locator(".plot, [role=alert]").first.wait_for(timeout=PATIENCE)
    return part


WORSE = "Warning: expected peak-to-peak rises at"
"""What a search says of loads that it makes worse: this one, of a short search on few positions, does."""


@pytest.mark.law
@pytest.mark.parametrize("name", EACH)
def test_every_plot_of_a_study_is_drawn_and_has_words(visit, name):
    part = ran(visit, name)
    alerts = part.get_by_role("alert").all_text_contents()
    assert [text for text in alerts if not text.startswith(WORSE)] == []
    for key in STUDIES[name][3]:
        node = part.locator(f"[data-figure='{key}'] .plot")
        expect(node).to_have_attribute("data-drawn", "yes", timeout=PATIENCE)
        assert (
            node.locator(".scatterlayer .trace path, .barlayer .trace path, .heatmaplayer image").count() >= 1
        )
        assert len(node.get_attribute("aria-label") or "") > 40
    expect(part.locator(".plot[data-drawn=yes]")).to_have_count(part.locator(".plot").count())


def saved(page: Page, button: Locator) -> bytes:
    """Press a button that saves a file, no faster than the browser lets a page save (10 files a second)."""
    page.wait_for_timeout(150)
    with page.expect_download() as given:
        button.press("Enter")
    return Path(given.value.path()).read_bytes()


@pytest.mark.parametrize("name", EACH)
def test_every_figure_and_every_result_is_saved(visit, name):
    part = ran(visit, name)
    for key in STUDIES[name][3]:
        figure = part.locator(f"[data-figure='{key}']")
        assert saved(visit.page, figure.locator("[data-tool=PNG]")).startswith(b"\x89PNG")
        content = json.loads(saved(visit.page, figure.locator("[data-tool=JSON]")))
        table = saved(visit.page, figure.locator("[data-tool=CSV]")).decode()
        longest = max(len(trace["x"]) for trace in content["data"])
        assert len(table.splitlines()) == longest + 1, key
    files = part.locator(".files")
    whole = json.loads(saved(visit.page, files.get_by_role("button", name="JSON", exact=True)))
    assert whole
    assert saved(visit.page, files.get_by_role("button", name="netCDF"))[1:4] == b"HDF"
    figures = json.loads(saved(visit.page, files.get_by_role("button", name="Figures as JSON")))
    assert [f["key"] for s in figures["sections"] for f in s["figures"]] == STUDIES[name][3]


def test_every_study_of_a_case_has_a_card(visit):
    cards = visit.page.locator("#panels .study")
    studies = [study for study in REGISTERED.values() if "case" in study.takes.subject]
    assert {study.title for study in studies} <= set(cards.locator("> h3").all_text_contents())
    buttons = set(cards.locator("> .row > button").all_text_contents())
    assert {study.action for study in studies} <= buttons
    labels = card(visit.page, "Tooth-root stress").locator("> .row label").all_text_contents()
    fields = REGISTERED["root-stress"].inputs.model_fields.values()
    assert labels == [field.title for field in fields if field.title] != []


def test_the_optimum_goes_into_the_case(visit):
    part = ran(visit, "optimize")
    rows = part.get_by_role("row", name=re.compile("pinion.tip_relief_um"))
    optimum = float(rows.first.get_by_role("cell").nth(1).text_content() or "nan")
    part.get_by_role("button", name="Take the optimum").press("Enter")
    taken = float(visit.page.locator("#f-pair-pinion-tip_relief_um").input_value())
    assert taken == pytest.approx(optimum, rel=1e-3) and 0.0 < taken <= 10.0


def test_a_refused_study_names_the_field_and_only_once(visit):
    part = card(visit.page, "Flank pressure")
    part.get_by_label("Torque").fill("plenty")
    part.get_by_role("button", name="Compute flank pressure").press("Enter")
    told = part.get_by_role("alert")
    expect(told).to_contain_text("torque_n_m must be")
    assert (told.text_content() or "").count("torque_n_m must be") == 1
    assert not (found := found_inaccessible(visit.page)), json.dumps(found, indent=1)


@pytest.mark.parametrize(
    ("names", "scheme", "width"),
    [
        (FEW, "dark", 400),
        pytest.param(STUDIES, "light", 1400, marks=pytest.mark.nightly),
        pytest.param(STUDIES, "dark", 400, marks=pytest.mark.nightly),
    ],
)
def test_the_page_with_studies_is_accessible(visit, names, scheme, width):
    page = visit.page
    for name in names:
        ran(visit, name)
    page.emulate_media(color_scheme=scheme)
    page.set_viewport_size({"width": width, "height": 900})
    unfold(page)
    assert not (told := found_inaccessible(page)), json.dumps(told, indent=1)
    until(lambda: page.evaluate("document.documentElement.scrollWidth") <= width)


def test_nothing_is_complained_about(visit):
    assert visit.complaints == []
