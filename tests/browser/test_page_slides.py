"""A gear or bearing of the unit in the picture, moved along its shaft by keys and by the pointer."""

import re

import numpy as np
import pytest
from page_picture import CANVAS, different, picture, stopped
from page_visit import opened, refused
from playwright.sync_api import Page, expect
from repository import EXAMPLES

UNIT = EXAMPLES / "two_stage" / "two_stage.rexs"


@pytest.fixture
def visit(drawing_browser, address):
    seen = opened(drawing_browser, f"{address}/#tab=sound")
    seen.page.locator("#import-file").set_input_files(UNIT)
    expect(seen.page.locator("#view [role=status]")).to_contain_text("click a mesh")
    seen.page.locator(CANVAS).scroll_into_view_if_needed()
    stopped(seen.page)
    yield seen
    assert seen.complaints == []
    seen.page.close()


def select(page: Page, part: str) -> None:
    page.get_by_role("button", name=part, exact=True).press("Enter")
    expect(page.locator("#view [role=status]")).to_contain_text(f"Drag {part} along its shaft")


def stands(page: Page, part: str, place: str) -> None:
    """Wait until tree, table and text have a part at a place."""
    expect(page.locator("#unit [role=status]")).to_contain_text(re.compile(f"{part}: .*, at {place} mm"))
    cell = page.locator("#scene-tables").get_by_label(f"Position, mm, {part}", exact=True)
    expect(cell).to_have_value(str(float(place)).removesuffix(".0"))
    expect(page.locator("#scene-text")).to_have_value(
        re.compile(rf'name = "{part}"(\n.+)*\nposition_mm = {float(place)}\n')
    )


@pytest.mark.law
def test_arrow_keys_move_what_is_selected_in_picture_tree_table_and_text(visit):
    page, canvas = visit.page, visit.page.locator(CANVAS)
    select(page, "wheel 1")
    canvas.press("ArrowUp")
    before = picture(page)
    canvas.press("ArrowRight")
    stands(page, "wheel 1", "51.00")
    canvas.press("Shift+ArrowLeft")
    stands(page, "wheel 1", "41.00")
    assert different(before, picture(page)) > 0.002
    page.wait_for_timeout(500)  # ms: an edit that rests is a step
    page.locator("#undo").press("Enter")
    for _ in range(2):  # on a slow machine each key is a step
        if "50.00" not in page.locator("#unit [role=status]").inner_text():
            page.locator("#undo").press("Enter")
            page.wait_for_timeout(500)
    stands(page, "wheel 1", "50.00")
    assert different(before, picture(page)) < 0.002, "seen from where it was seen"
    page.locator(CANVAS).press("ArrowRight")
    stands(page, "wheel 1", "51.00")
    with refused(page, "simulate") as sent:
        page.get_by_role("button", name="Compute the scene").press("Enter")
        expect(page.locator("#scene-body [role=alert]")).to_contain_text("Not now")
    assert [gear["position_mm"] for gear in sent[0]["scene"]["gears"]] == [50.0, 51.0, 108.0, 108.0]
    page.reload()
    stands(page, "wheel 1", "51.00")


@pytest.mark.law
def test_what_is_typed_while_a_move_comes_to_rest_is_kept_with_it(visit):
    page = visit.page
    select(page, "wheel 1")
    place = re.search(r"at (\S+) mm", page.locator("#unit [role=status]").inner_text())
    page.locator(CANVAS).press("ArrowLeft")
    stands(page, "wheel 1", f"{float(place[1]) - 1.0:.2f}")
    page.locator(CANVAS).press("ArrowRight")
    duration = page.locator("#scene-tables").get_by_label("Duration, s, Run", exact=True)
    duration.fill("0.25")
    page.wait_for_timeout(700)  # ms: longer than a move takes to rest
    page.keyboard.press("Tab")
    expect(page.locator("#scene-text")).to_have_value(re.compile("duration_s = 0.25"), timeout=30_000)
    stands(page, "wheel 1", f"{float(place[1]):.2f}")
    expect(duration).to_have_value("0.25")


@pytest.mark.law
def test_undo_brings_back_whole_the_scene_whose_place_a_move_takes(visit):
    page = visit.page
    text, under = page.locator("#scene-text"), page.get_by_text("A deflection takes the load cases")
    page.locator("#import-file").set_input_files(EXAMPLES / "two_stage_gearbox.rexs")
    expect(page.locator("#unit")).to_contain_text("two_stage_gearbox.rexs")
    page.get_by_role("button", name="Open scene", exact=True).press("Enter")
    expect(text).to_have_value(re.compile("concept_bearing 31"))
    duration = page.locator("#scene-tables").get_by_label("Duration, s, Run", exact=True)
    duration.fill("0.25")
    duration.press("Tab")
    expect(text).to_have_value(re.compile("duration_s = 0.25"))
    known, cases = text.input_value(), under.inner_text()
    page.locator("#import-file").set_input_files(UNIT)
    select(page, "wheel 1")
    page.locator(CANVAS).press("ArrowRight")
    stands(page, "wheel 1", "51.00")
    page.wait_for_timeout(500)  # ms: an edit that rests is a step
    for place in ("51.00", "50.00"):
        expect(page.locator("#unit [role=status]")).to_contain_text(f"at {place} mm")
        page.locator("#undo").press("Enter")
    expect(text).to_have_value(known)
    expect(duration).to_have_value("0.25")
    assert under.inner_text() == cases
    page.locator("#redo").press("Enter")
    stands(page, "wheel 1", "50.00")


@pytest.mark.law
def test_the_picture_moves_a_part_to_an_end_of_its_shaft_and_tables_refuse_more(visit):
    page, fact = visit.page, visit.page.locator("#unit [role=status]")
    select(page, "wheel 1")
    for _ in range(6):
        page.locator(CANVAS).press("Shift+ArrowLeft")
    stands(page, "wheel 1", "0")
    cell = page.locator("#scene-tables").get_by_label("Position, mm, wheel 1", exact=True)
    cell.fill("-1")
    cell.press("Tab")
    bound = 'must be on the shaft "intermediate", from 0 to 170 mm from its left end'
    expect(fact).to_contain_text(f"gears[1].position_mm {bound}")
    expect(page.locator("#scene-body")).to_contain_text(bound)
    cell.fill("1")
    cell.press("Tab")
    expect(fact).not_to_contain_text("must be")


def drag(page: Page, start: np.ndarray, way: tuple[float, float]) -> None:
    box = page.locator(CANVAS).bounding_box()
    x, y = box["x"] + start[0], box["y"] + start[1]
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + way[0], y + way[1], steps=3)
    page.mouse.up()


def marked(page: Page) -> np.ndarray:
    """Return the places (n, 2) of what is marked in the picture, CSS pixels."""
    shown = picture(page).astype(int)
    rows, columns = np.nonzero((shown[..., 0] > 90) & (shown[..., 2] < 25))
    return np.stack([columns, rows], axis=1)


@pytest.mark.law
def test_the_pointer_drags_what_is_selected_and_turns_the_picture_beside_it(visit):
    page = visit.page
    select(page, "output, far side")
    places = marked(page)
    before = np.mean(places, axis=0)
    fact = page.locator("#unit [role=status]")
    known, way = fact.inner_text(), np.array([-30.0, 0.0])
    drag(page, places[len(places) // 2], (-30.0, 0.0))
    expect(fact).not_to_have_text(known)
    moved = np.mean(marked(page), axis=0) - before
    assert moved @ moved == pytest.approx(way @ moved, rel=0.2)  # as far along its shaft as the pointer
    assert way @ moved > 20.0
    place = re.search(r"at (\S+) mm", fact.inner_text())
    stands(page, "output, far side", place[1])
    known, beside = fact.inner_text(), np.array([20.0, 200.0])
    seen = picture(page)
    drag(page, beside, (40.0, 0.0))
    assert fact.inner_text() == known
    assert different(seen, picture(page)) > 0.01, "the camera turned"
    page.keyboard.down("Shift")
    drag(page, beside, (15.0, 0.0))
    page.keyboard.up("Shift")
    expect(fact).not_to_have_text(known)
    place = re.search(r"at (\S+) mm", fact.inner_text())
    stands(page, "output, far side", place[1])  # the tables are written anew when the drag rests
    length = page.locator("#scene-shafts-2-length_mm")
    was = length.input_value()
    length.fill("-3")
    length.press("Tab")
    expect(fact).to_contain_text("shafts[2].length_mm must be above 0")
    page.locator(CANVAS).press("ArrowLeft")
    expect(page.locator("#scene-tables")).to_be_visible()
    length.fill(was)
    length.press("Tab")
    expect(fact).not_to_contain_text("must be")
