"""The housing of a scene is drawn as the scene is opened: from its file, where it stands, seen through."""

import base64
import re
from typing import Any

import numpy as np
import pytest
from page_picture import CANVAS, different, picture, pixels, stopped, vertices
from page_visit import PATIENCE, opened, opened_scene, shown, tab
from playwright.sync_api import Page, expect

ROUTE = "**/v1/drafts/housing-surface"
BARE = """async ({ scene, surface }) => {
  const { Gearbox } = await import("/page/view_unit.js");
  return Object.assign(new Gearbox(scene, [], () => {}), { given: surface });
}"""
"""A unit without meshes: its shafts, its bearings."""
SHAFT: dict[str, Any] = {"name": "a", "origin_mm": [0.0, 0.0, 0.0], "length_mm": 80.0, "diameter_mm": 12.0}


@pytest.fixture(scope="module")
def visit(drawing_browser, address):
    seen = opened(drawing_browser, address)
    yield seen
    seen.page.close()


def surface_of(place: np.ndarray, facets: np.ndarray) -> dict[str, str]:
    parts = {"place_mm": place.astype("<f4"), "normal": place.astype("<f4"), "facets": facets.astype("<u4")}
    return {name: base64.b64encode(values.tobytes()).decode() for name, values in parts.items()}


@pytest.mark.law
def test_a_housing_is_drawn_where_its_surface_stands(visit):
    place = np.array([[0.0, 0.0, 0.0], [200.0, 0.0, 0.0], [0.0, 90.0, 0.0], [0.0, 0.0, 70.0]])
    facets = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    steps = ["subject.move(null)", "subject.house(subject.given)"]
    values = {"scene": {"shafts": [SHAFT], "gears": []}, "surface": surface_of(place, facets)}
    bare, housed = vertices(visit.page, BARE, steps, **values)
    added = [calls for calls in housed if not any(np.array_equal(calls, known) for known in bare)]
    assert len(added) == 1, "the surface and nothing else"
    np.testing.assert_allclose(added[0], place[facets.ravel()], atol=1e-5)


@pytest.mark.law
def test_a_scene_that_is_opened_shows_its_housing_and_what_is_in_it(
    drawing_browser, address, analyzed, tmp_path
):
    """What is in it shows through: a housing that hid it would leave the picture of the housing alone."""
    seen = shown(drawing_browser, address, analyzed)
    page, words = seen.page, seen.page.locator("#view [role=status]")
    tab(page, "Sound")
    stopped(page)
    pair = picture(page)
    with page.expect_response(ROUTE, timeout=PATIENCE) as answered:
        opened_scene(page, tmp_path)
    assert answered.value.json()["surface"]["facets"]
    expect(words).to_have_text("The unit of the scene, which has no mesh with a pair to draw.")
    housed = picture(page)
    assert different(pair, housed) > 0.05
    bare = drawn_anew(page, 'Object.defineProperty(Gearbox.prototype, "drawnHousing", { get: () => null });')
    body = np.abs(housed - bare).max(axis=-1) > 12
    assert body.mean() > 0.01, "the housing is seen"
    through, behind = housed[body].mean(axis=-1), bare[body].mean(axis=-1)
    assert np.std(behind) > 10.0
    assert np.corrcoef(through, behind)[0, 1] > 0.8, "and what is in it"
    assert seen.complaints == []
    page.close()


def drawn_anew(page: Page, statement: str) -> np.ndarray:
    """Return the picture from where it was seen after a statement about the class of the unit."""
    script = f"""async () => {{ const {{ Gearbox }} = await import("/page/view_unit.js"); {statement} }}"""
    page.evaluate(script)
    page.locator("canvas.view").press("+")
    page.locator("canvas.view").press("-")
    return picture(page)


@pytest.mark.law
def test_a_file_that_is_no_housing_is_said_under_the_picture(drawing_browser, address, analyzed, tmp_path):
    seen = shown(drawing_browser, address, analyzed)
    page, words = seen.page, seen.page.locator("#view [role=status]")
    tab(page, "Sound")
    stopped(page)
    problem = {"detail": "housings[0].step_file: no solid", "faults": []}
    page.route(ROUTE, lambda route: route.fulfill(json=problem))
    opened_scene(page, tmp_path)
    expect(words).to_have_text("housings[0].step_file: no solid")
    page.close()


@pytest.mark.law
def test_a_browser_without_webgl_sees_the_unit_through_its_housing(
    drawing_browser, browser, address, tmp_path
):
    """Its still picture has as much of it, as pale, as the moving picture."""
    shares = []
    for own in (drawing_browser, browser):
        seen = opened(own, f"{address}/#tab=sound")
        page, canvas = seen.page, seen.page.locator(CANVAS)
        with page.expect_response(ROUTE, timeout=PATIENCE):
            opened_scene(page, tmp_path)
        stopped(page)
        expect(page.locator("#view [role=status]")).to_have_text(re.compile("^(The unit of|A still picture)"))
        page.locator("#view [role=status]").evaluate("(node) => { node.style.opacity = '0'; }")
        if own is browser:
            page.locator(f"{CANVAS}[data-drawn]").wait_for()
            shot = pixels(canvas.screenshot())
        else:
            shot = picture(page)
        light = shot.mean(axis=-1)
        shares.append([np.mean((light > 150) & (light < 235)), np.mean(light < 150)])
        assert seen.complaints == []
        page.close()
    moving, still = shares
    assert moving[0] > 0.005
    assert still == pytest.approx(moving, rel=0.25)
