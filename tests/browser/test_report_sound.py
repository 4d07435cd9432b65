"""Sounds of the page and of reports: the cursor is where they are, a click seeks, two play in turn."""

import base64
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest
from page_visit import PATIENCE, found_inaccessible, opened
from playwright.sync_api import Browser, Locator, Page, Route, expect
from running_service import until

from lineofaction.report.comparison.compare import compare, stored_comparison
from lineofaction.report.document import stored_figures, write_page, write_report
from lineofaction.report.run.sound import stored_sound
from lineofaction.report.run.view import RunView

DURATION, TOP = 2.0, 900.0  # s, rpm of the run-up from standstill


@pytest.fixture(scope="module")
def folder(closed_forms, tmp_path_factory):
    made = tmp_path_factory.mktemp("sound")
    run = closed_forms.run_up(duration=DURATION, top_rpm=TOP)
    run.to_netcdf(made / "loud.nc")
    replace(run, bearing_force=0.5 * run.bearing_force).to_netcdf(made / "quiet.nc")
    return made


@pytest.fixture(scope="module")
def order_map(browser, folder):
    write_report(folder / "loud.nc", folder / "report.html")
    yield from figure(browser, folder / "report.html", "#order_map")


@pytest.fixture(scope="module")
def levels(browser, folder):
    write_page(compare([folder / "loud.nc", folder / "quiet.nc"], RunView()), folder / "comparison.html")
    yield from figure(browser, folder / "comparison.html", "#levels")


def figure(browser: Browser, file: Path, name: str) -> Iterator[Locator]:
    """Yield a figure of a page that is drawn and whose sounds are loaded; nothing is complained about."""
    page, complaints = browser.new_page(viewport={"width": 1280, "height": 900}), []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(file.as_uri())
    page.wait_for_selector("html[data-drawn=yes]", timeout=PATIENCE)
    found = page.locator(name)
    found.scroll_into_view_if_needed()
    page.wait_for_function(f"[...document.querySelectorAll('{name} audio')].every((one) => one.readyState)")
    yield found
    assert complaints == []
    page.close()


def speed(of: Locator) -> float:
    value, unit = (of.locator("output").text_content() or "").split()
    assert unit == "rpm"
    return float(value)


def times(of: Locator) -> list[float]:
    found: list[float] = of.locator("audio").evaluate_all("all => all.map((one) => one.currentTime)")
    return found


def clicked(of: Locator, part: float) -> float:
    """Click on a plot at a part of its width, between its curves; return the speed there by its axis."""
    box = of.locator(".nsewdrag").first.bounding_box()
    of.page.mouse.click(box["x"] + part * box["width"], box["y"] + 0.6 * box["height"])
    low, high = of.locator(".plot").evaluate("node => node.layout.xaxis.range")
    return float(low + part * (high - low))


def test_the_sound_lasts_as_long_as_the_run(order_map):
    players = order_map.locator("audio")
    expect(players).to_have_count(1)
    assert players.evaluate("one => one.duration") == pytest.approx(DURATION, abs=1e-3)
    expect(order_map).to_contain_text("no sound pressure")
    expect(order_map).to_contain_text("Full scale: 28 N")


def test_the_cursor_is_at_the_speed_of_the_sound(order_map):
    order_map.locator("audio").evaluate("one => { one.currentTime = 1.2; }")
    expect(order_map.locator("output")).to_have_text("540.0 rpm")  # TOP 1.2 / DURATION
    low, high = order_map.locator(".plot").evaluate("node => node.layout.xaxis.range")
    area, cursor = (order_map.locator(name).first.bounding_box() for name in (".nsewdrag", ".cursor"))
    expected = area["x"] + (540.0 - low) / (high - low) * area["width"]
    assert cursor["x"] + 1.0 == pytest.approx(expected, abs=1.5)
    assert cursor["height"] == pytest.approx(area["height"], abs=1.0)


def test_a_click_on_the_map_seeks(order_map):
    there = clicked(order_map, 0.75)
    order_map.page.wait_for_function("document.querySelector('#order_map audio').currentTime > 1.3")
    assert speed(order_map) == pytest.approx(there, rel=2e-3)
    assert times(order_map)[0] == pytest.approx(DURATION * there / TOP, rel=2e-3)


def test_the_player_is_reached_by_the_keyboard(order_map):
    order_map.locator("audio").focus()
    before = times(order_map)[0]
    order_map.page.keyboard.press("Home")
    order_map.page.wait_for_function("document.querySelector('#order_map audio').currentTime < 0.1")
    assert before > 0.1


def test_two_designs_are_heard_in_turn_at_the_same_speed(levels):
    players = levels.locator("audio")
    expect(players).to_have_count(2)
    there = clicked(levels, 0.5)
    levels.page.wait_for_function("document.querySelector('#levels audio').currentTime > 0.5")
    assert times(levels)[1] == 0.0
    levels.get_by_role("radio", name="quiet").check()
    expect(players.nth(0)).to_be_hidden()
    expect(players.nth(1)).to_be_visible()
    assert times(levels)[1] == pytest.approx(DURATION * there / TOP, rel=2e-3)
    levels.get_by_role("radio", name="loud").check()
    expect(players.nth(1)).to_be_hidden()


def test_both_play_at_their_relative_level(levels):
    """Decoded by the browser: the peaks are 1 and one half."""
    page: Page = levels.page
    peaks = page.evaluate(
        """async () => Promise.all([...document.querySelectorAll("#levels audio")].map(async (one) => {
          const bytes = Uint8Array.from(atob(one.src.split(",")[1]), (letter) => letter.charCodeAt(0));
          const sound = await new OfflineAudioContext(1, 1, 24000).decodeAudioData(bytes.buffer);
          return sound.getChannelData(0).reduce((most, value) => Math.max(most, Math.abs(value)), 0);
        }))"""
    )
    assert peaks == pytest.approx([1.0, 0.5], rel=1e-6)


def test_without_scripts_the_sound_can_be_played(browser, folder, order_map):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto((folder / "report.html").as_uri())
    expect(page.locator("#order_map audio[controls]")).to_be_visible()
    context.close()


LOUD, QUIET = "a" * 64, "b" * 64
SHOW = """async ([hash, against]) => {
  const { showReport } = await import("/page/report.js");
  const target = document.querySelector("main").appendChild(document.createElement("div"));
  target.id = "shown";
  const result = { href: `/v1/results/${hash}`, type: "application/x-netcdf", hash, against };
  await showReport(target, result, { signal: new AbortController().signal });
}"""


@dataclass
class Runs:
    """Two runs in files, answered for as the service does."""

    files: dict[str, str]

    def answer(self, route: Route) -> None:
        address = urlsplit(route.request.url)
        key, what = address.path.split("/")[-2:]
        query = {name: values[0] for name, values in parse_qs(address.query).items()}
        other = query.pop("against", None)
        files = [self.files[one] for one in (key, other) if one]
        if what == "sound":
            wav = stored_sound({"kind": "run", "files": files, "view": query})["wav"]
            route.fulfill(body=base64.b64decode(wav), content_type="audio/wav")
        else:
            route.fulfill(
                json=stored_comparison({"files": files}) if other else stored_figures({"file": files[0]})
            )


@pytest.fixture(scope="module")
def runs(closed_forms, tmp_path_factory):
    folder: Path = tmp_path_factory.mktemp("runs")
    run = closed_forms.run_up()
    run.to_netcdf(folder / "loud.nc")
    replace(run, bearing_force=0.5 * run.bearing_force).to_netcdf(folder / "quiet.nc")
    return Runs({LOUD: str(folder / "loud.nc"), QUIET: str(folder / "quiet.nc")})


@pytest.fixture
def heard(browser, address, runs):
    found = opened(browser, address)
    found.page.route("**/v1/results/*/figures*", runs.answer)
    found.page.route("**/v1/results/*/sound*", runs.answer)
    yield found
    found.page.close()


def test_a_run_is_heard_under_its_order_map(heard):
    page = heard.page
    page.evaluate(SHOW, [LOUD])
    order_map = page.locator("#shown [data-figure=order_map]")
    expect(order_map.locator("audio")).to_have_count(0)
    order_map.get_by_role("button", name="Listen to: Order map").press("Enter")
    player = order_map.locator("audio")
    expect(player).to_be_focused()
    until(lambda: player.evaluate("one => one.readyState") > 0)
    assert player.evaluate("one => one.duration") == pytest.approx(2.0, abs=1e-3)
    player.evaluate("one => { one.currentTime = 1.0; }")
    expect(order_map.locator("output").first).to_have_text("450.0 rpm")
    area, cursor = (order_map.locator(name).first.bounding_box() for name in (".nsewdrag", ".cursor"))
    assert area and cursor
    assert area["x"] < cursor["x"] < area["x"] + area["width"]
    assert cursor["height"] == pytest.approx(area["height"], abs=1.0)
    assert not found_inaccessible(page)
    assert heard.complaints == []


def test_two_runs_are_heard_in_turn(heard):
    page = heard.page
    page.evaluate(SHOW, [LOUD, QUIET])
    levels = page.locator("#shown [data-figure=levels]")
    levels.get_by_role("button", name="Listen to: Overall level").press("Enter")
    expect(levels.locator("audio")).to_have_count(2)
    levels.locator("audio").first.evaluate("one => { one.currentTime = 1.0; }")
    levels.get_by_role("radio", name="second").check()
    expect(levels.locator("audio").first).to_be_hidden()
    assert levels.locator("audio").nth(1).evaluate("one => one.currentTime") == pytest.approx(1.0, abs=1e-3)
    sounds = [url for url in heard.requests if "/sound?" in url]
    assert sorted((LOUD in url.split("?")[0], QUIET in url.split("?")[1]) for url in sounds) == [
        (False, False),
        (True, True),
    ]
    assert heard.complaints == []
