"""The pair in three dimensions: drawn, turning, with live pressure, asleep; a drawing without WebGL."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from page_picture import CANVAS, different, frames, has_room, picture, pixels, rest, stopped
from page_visit import PATIENCE, control, found_inaccessible, moved, opened_scene, shown, tab
from playwright.sync_api import Page, expect
from running_service import until

UNIT = Path(__file__).parents[2] / "examples" / "two_stage" / "two_stage.rexs"

MADE = """() => {
  window.made = { contexts: 0, programs: 0 };
  const counted = (of, name, key) => {
    const own = of.prototype[name];
    of.prototype[name] = function (...all) { made[key] += all[0] !== "2d"; return own.apply(this, all); };
  };
  counted(HTMLCanvasElement, "getContext", "contexts");
  counted(WebGL2RenderingContext, "createProgram", "programs");
}"""


@pytest.fixture(scope="module")
def view(drawing_browser, address, analyzed):
    seen = shown(drawing_browser, address, analyzed)
    seen.page.locator(CANVAS).scroll_into_view_if_needed()
    expect(seen.page.locator(f"{CANVAS}[data-pressed]:not([data-pressed='0'])")).to_have_count(1)
    stopped(seen.page)
    return seen


@pytest.mark.parametrize("size", [(1000, 700), (1024, 768), (900, 700)])
def test_a_small_window_has_room_for_the_picture(drawing_browser, address, size):
    page = drawing_browser.new_page(viewport={"width": size[0], "height": size[1]})
    page.goto(address)
    page.wait_for_selector(f"{CANVAS}[data-frames]", state="attached")
    until(lambda: (page.locator(CANVAS).bounding_box() or {"height": 0.0})["height"] > 120.0)
    box = page.locator(CANVAS).bounding_box()
    assert box is not None and box["height"] > 120.0
    page.close()


@pytest.mark.law
def test_the_first_picture_waits_for_nothing_that_is_asked_of_the_form(drawing_browser, address):
    """Its pressure and its figures came with the program; the shaders are those that draw them."""
    page = drawing_browser.new_page()
    page.add_init_script(f"({MADE})()")
    page.route("**/v1/drafts/**", lambda _: None)  # none is answered
    page.goto(address)
    expect(page.locator(f"{CANVAS}[data-pressed]:not([data-pressed='0'])[data-frames]")).to_have_count(1)
    expect(page.locator("#live-figures")).to_contain_text("peak to peak")
    assert page.evaluate("made") == {"contexts": 1, "programs": 2}
    page.locator("#example").select_option("palermo_spur_20_20")
    expect(page.locator(f"{CANVAS}[data-pressed='0']")).to_have_count(1)
    count = frames(page)
    until(lambda: frames(page) > count + 2)
    assert page.evaluate("made.programs") == 2, "flanks without pressure are of steel"
    page.close()


@pytest.mark.law
def test_the_pair_is_drawn_turns_by_keyboard_and_sleeps(view):
    page, canvas = view.page, view.page.locator(CANVAS)
    has_room(page)
    before = picture(page)
    assert len(np.unique(before.reshape(-1, 3), axis=0)) > 50
    canvas.focus()
    for _ in range(4):
        canvas.press("ArrowRight")
    after = picture(page)
    assert different(before, after) > 0.05
    canvas.press("Home")
    assert different(before, picture(page)) < 0.002
    count = frames(page)
    canvas.press(" ")
    until(lambda: frames(page) > count + 2)
    canvas.press(" ")
    assert different(before, picture(page)) > 0.002  # it has rolled on
    stands = page.locator("#roll-value").inner_text()
    assert 0.0 < float(stands) < 1.0
    expect(page).to_have_url(re.compile(rf"\bat={stands}\b"))
    expect(page.locator("#roll")).to_have_value(re.compile(rf"^{float(stands)}$"))
    assert view.complaints == []


@pytest.mark.law
def test_what_is_behind_the_face_of_the_wheel_is_seen_through_it(view):
    """The face is of one shade; through it there are the teeth and the bore of the far side."""
    page, through = view.page, view.page.get_by_label("see through the wheel")
    seen = picture(page)
    through.uncheck()
    opaque = picture(page)
    through.check()
    changed = np.abs(seen - opaque).max(axis=-1) > 12
    shades, counts = np.unique(opaque[changed], axis=0, return_counts=True)
    face = changed & (opaque == shades[counts.argmax()]).all(axis=-1)
    _, counts = np.unique(seen[face], axis=0, return_counts=True)
    assert counts.max() < 0.9 * counts.sum()


SAID = """() => {
  const [view, roll] = [document.querySelector("canvas.view"), document.getElementById("roll")];
  window.said = { times: 0, places: new Set() };
  const own = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");
  Object.defineProperty(roll, "value", { configurable: true, get: () => own.get.call(roll), set: (value) => {
    said.times += 1;
    said.places.add(value);
    own.set.call(roll, value);
  } });
  return Number(view.dataset.frames);
}"""


@pytest.mark.law
def test_the_slider_follows_the_pair_that_rolls_a_few_times_a_second(view):
    """Nothing is requested, what has the focus keeps it, and a hand stops the pair where it is put."""
    page, slider = view.page, view.page.locator("#roll")
    page.locator("#name").focus()
    asked, address = [url for url in view.requests if "/v1/" in url], page.url
    before, begin = page.evaluate(SAID), page.evaluate("performance.now()")
    page.get_by_role("button", name="Roll", exact=True).evaluate("(node) => node.click()")
    until(lambda: page.wait_for_timeout(100) or page.evaluate("said.places.size") > 4)
    passed, times = page.evaluate("[performance.now(), said.times]")
    assert times <= 1 + (passed - begin) / 250.0
    expect(slider).not_to_have_value("0")
    value = float(slider.input_value())
    assert float(page.locator("#roll-value").inner_text()) == pytest.approx(value, abs=0.3)
    assert frames(page) > before
    assert [url for url in view.requests if "/v1/" in url] == asked
    assert page.url == re.sub(r"&at=[\d.]+", "", address), "where it rolls is no place"
    assert page.evaluate("document.activeElement.id") == "name"
    page.evaluate("delete document.getElementById('roll').value")
    slider.fill("0.4")
    expect(page.get_by_role("button", name="Roll", exact=True)).to_be_visible()
    expect(page).to_have_url(re.compile("at=0.40"))
    rest(page)
    expect(slider).to_have_value("0.4")


@pytest.mark.law
def test_a_phone_has_room_beside_variants_and_a_complaint(drawing_browser, address, analyzed):
    page = shown(drawing_browser, address, analyzed).page
    page.get_by_role("button", name="Another variant").press("Enter")
    for name, text in {"frequency_hz": "1000", "speed_rpm": "3000", "torque_n_m": "1"}.items():
        page.locator(f"#bar-{name}").fill(text)
    expect(page.locator("#complaint output")).to_contain_text("harmonic 1")
    has_room(page)
    page.close()


@pytest.mark.law
def test_pressure_follows_a_slider(view):
    page = view.page
    before = picture(page)
    pressed = float(page.locator(CANVAS).get_attribute("data-pressed") or 0)
    moved(page, "#live-torque_n_m", "End")
    until(lambda: float(page.locator(CANVAS).get_attribute("data-pressed") or 0) > 1.1 * pressed)
    assert different(before, picture(page)) > 0.0005


@pytest.mark.law
def test_a_tooth_that_is_clicked_says_its_place_and_its_load(view):
    page = view.page
    box = page.locator(CANVAS).bounding_box()
    said = page.locator("#view [role=status]")
    texts = []
    for part in np.linspace(0.3, 0.8, 12):
        page.mouse.click(box["x"] + part * box["width"], box["y"] + 0.62 * box["height"])
        texts.append(said.inner_text())
    assert any("tooth" in text for text in texts)
    assert found_inaccessible(page, "#view") == {}


@pytest.mark.law
def test_a_unit_turns_when_its_file_opens_and_a_mesh_that_is_clicked_opens_its_pair(view):
    page = view.page
    page.locator("#import-file").set_input_files(UNIT)
    said = page.locator("#view [role=status]")
    expect(said).to_contain_text("click a mesh")
    plain = picture(page)
    assert len(np.unique(plain.reshape(-1, 3), axis=0)) > 50
    part_of_tree = page.get_by_role("button", name="wheel 1", exact=True)
    part_of_tree.press("Enter")
    expect(part_of_tree).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#unit [role=status]")).to_contain_text("wheel 1: gear on intermediate")
    marked = picture(page)
    assert different(plain, marked) > 0.002
    assert np.any((marked[..., 0] > 1.5 * marked[..., 2]) & (marked[..., 0] > 120)), "marked in orange"
    assert found_inaccessible(page, "#unit") == {}
    box = page.locator(CANVAS).bounding_box()
    for part in np.linspace(0.3, 0.7, 12):
        page.mouse.click(box["x"] + part * box["width"], box["y"] + 0.5 * box["height"])
        if "click a mesh" not in said.inner_text():
            break
    expect(page.locator("#f-pair-pinion-teeth")).to_have_value(re.compile("^(25|21)$"))
    page.get_by_role("button", name="second stage, 21/74").press("Enter")
    expect(page.locator("#f-pair-wheel-teeth")).to_have_value("74")
    assert "see=" not in page.url
    assert view.complaints == []


@pytest.mark.law
def test_a_mode_moves_the_unit_and_the_way_back_shows_the_pair(drawing_browser, address, analyzed):
    seen = shown(drawing_browser, address, analyzed)
    page = seen.page
    stopped(page)
    motion, amplitude = page.get_by_label("Motion", exact=True), page.get_by_label("Amplitude", exact=True)
    expect(motion).to_be_hidden()
    control(page, "#study-Modes-top_rpm").fill("2000")
    page.get_by_role("button", name="Find the modes").press("Enter")
    expect(motion).to_be_visible()
    pair = picture(page)
    groups = motion.locator("optgroup").evaluate_all("all => all.map((one) => one.label)")
    assert (groups[:2], groups[-1]) == (["at rest", "at 0 rpm"], "at 2000 rpm")
    name = motion.locator("option").nth(2).inner_text()
    motion.select_option(name)
    said = page.locator("#view [role=status]")
    expect(said).to_have_text(name)
    moved_unit = picture(page)
    assert different(pair, moved_unit) > 0.01
    expect(page).to_have_url(re.compile("modes=.*motion=1"))
    other = page.context.new_page()
    other.goto(page.url)
    expect(other.locator("#view [role=status]")).to_have_text(name)
    expect(other).to_have_url(page.url)
    other.reload()
    expect(other.locator("#view [role=status]")).to_have_text(name)
    other.goto("about:blank")  # a page that stands already takes the motion from its address
    other.goto(page.url.replace("motion=1", "motion=999"))
    expect(other.locator("#view [role=status]")).to_contain_text("Motion 999 of the address: the result has")
    expect(other).not_to_have_url(re.compile("motion="))
    other.close()
    amplitude.focus()
    amplitude.press("Home")
    still = picture(page)
    assert different(still, moved_unit) > 0.005
    page.get_by_role("button", name="Roll", exact=True).press("Enter")
    count = frames(page)
    until(lambda: frames(page) > count + 2)
    page.get_by_role("button", name="Stop", exact=True).press("Enter")
    assert different(still, picture(page)) < 0.001, "only the phase runs"
    assert found_inaccessible(page, "#view") == {}
    motion.select_option("")
    assert different(pair, picture(page)) < 0.002
    expect(page).not_to_have_url(re.compile("motion="))
    assert seen.complaints == []
    page.close()


@pytest.mark.law
def test_the_surface_of_a_housing_moves_in_the_colors_of_its_velocity(
    drawing_browser, address, analyzed, tmp_path
):
    seen = shown(drawing_browser, address, analyzed)
    page = seen.page
    tab(page, "Sound")
    opened_scene(page, tmp_path)
    page.get_by_label("Compute", exact=True).select_option("vibration")
    page.locator("#scene-body").get_by_label("number", exact=True).fill("3")
    page.get_by_role("button", name="Compute the scene").press("Enter")
    motion, refused = page.get_by_label("Motion", exact=True), page.locator("#scene-body [role=alert]")
    page.locator("#view select:visible, #scene-body [role=alert]").first.wait_for(timeout=PATIENCE)
    assert refused.all_text_contents() == []
    stopped(page)
    motion.select_option("0")
    expect(page.get_by_text(re.compile(r"^surface velocity -?\d+ to -?\d+ dB re 50 nm/s$"))).to_be_visible()
    expect(page.locator("#view [role=status]")).to_contain_text("rpm")
    has_room(page)
    colored = picture(page)
    yellow = (colored[..., 0] > 120) & (colored[..., 2] < 0.6 * colored[..., 0])
    assert np.mean(yellow) > 0.002, "where it is loudest"
    amplitude = page.get_by_label("Amplitude", exact=True)
    amplitude.focus()
    amplitude.press("Home")
    assert different(colored, picture(page)) > 0.001
    assert found_inaccessible(page, "#view") == {}
    page.route("**/motion?number=0", lambda route: route.fulfill(json=damaged(route.fetch().json())))
    motion.select_option("")
    motion.select_option("0")
    expect(page.locator("#view [role=status]")).to_contain_text("cannot be drawn")
    assert seen.complaints == []
    page.close()


def damaged(answer: dict[str, Any]) -> dict[str, Any]:
    """Return a motion whose surface has another number of levels than of nodes."""
    surface = answer["motion"]["surface"]
    surface["level_db"] = surface["level_db"][: len(surface["level_db"]) // 8 * 4]
    return answer


def test_a_browser_without_webgl_shows_the_drawing(browser, address, analyzed):
    seen = shown(browser, address, analyzed)
    expect(seen.page.locator("#view")).to_be_hidden()
    expect(seen.page.locator("#mesh-drawing path").first).to_be_visible()
    assert seen.complaints == []
    seen.page.close()


@pytest.mark.law
def test_a_browser_without_webgl_shows_a_still_picture_of_a_unit(view, browser, address, analyzed):
    seen = shown(browser, address, analyzed)
    page, said, canvas = seen.page, seen.page.locator("#view [role=status]"), seen.page.locator(CANVAS)
    page.locator("#import-file").set_input_files(UNIT)
    expect(said).to_contain_text("A still picture of the unit")
    expect(page.locator("#mesh-drawing")).to_be_hidden()
    expect(canvas).to_have_attribute("aria-label", "Gear unit with 3 shafts and 2 meshes")
    view.page.locator("#import-file").set_input_files(UNIT)
    expect(view.page.locator("#view [role=status]")).to_contain_text("click a mesh")
    for own in (said, view.page.locator("#view [role=status]")):
        own.evaluate("(node) => { node.style.visibility = 'hidden'; }")
    plain = still_picture(page)
    shapes = [outlined(plain), outlined(picture(view.page))]
    assert np.mean(shapes[0] ^ shapes[1]) < 0.04, "as the moving picture shows it"
    page.get_by_role("button", name="wheel 1", exact=True).press("Enter")
    until(lambda: different(plain, still_picture(page)) > 0.002)
    view.page.get_by_role("button", name="wheel 1", exact=True).press("Enter")
    expect(view.page.locator("#unit [role=status]")).to_contain_text("wheel 1")
    orange = [np.mean(marked_points(shot)) for shot in (still_picture(page), picture(view.page))]
    assert orange[0] == pytest.approx(orange[1], rel=0.4), "through all that is before it, in both"
    assert found_inaccessible(page, "#view") == {}
    page.get_by_role("button", name="second stage, 21/74").press("Enter")
    expect(page.locator("#view")).to_be_hidden()
    expect(page.locator("#mesh-drawing path").first).to_be_visible()
    assert seen.complaints == []
    page.close()


def marked_points(shot: np.ndarray) -> np.ndarray:
    return (shot[..., 0] > 1.8 * shot[..., 2]) & (shot[..., 0] > 100)


def outlined(shot: np.ndarray) -> np.ndarray:
    """Return where the unit is (100, 100), over the box that holds it."""
    covered = np.abs(shot - shot[-1, shot.shape[1] // 2]).max(axis=-1) > 25
    rows, columns = (np.flatnonzero(covered.any(axis=axis)) for axis in (1, 0))
    at = [np.linspace(ends[0], ends[-1], 100).round().astype(int) for ends in (rows, columns)]
    return covered[np.ix_(*at)]


def still_picture(page: Page) -> np.ndarray:
    page.locator(f"{CANVAS}[data-drawn]").wait_for()
    return pixels(page.locator(CANVAS).screenshot())


def test_nothing_rolls_by_itself_for_who_wants_less_motion(drawing_browser, address, analyzed):
    context = drawing_browser.new_context(reduced_motion="reduce")
    page = context.new_page()
    page.goto(f"{address}/#database={analyzed}")
    page.set_default_timeout(PATIENCE)
    expect(page.get_by_role("button", name="Roll", exact=True)).to_be_visible()
    rest(page)
    context.close()
