"""Sounds on the page: fetched on request with its policy in force, with a cursor on the plot."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from urllib.parse import parse_qs, urlsplit

import pytest
from page_visit import Visit, found_inaccessible, opened
from playwright.sync_api import Browser, Route, expect
from running_service import until

from lineofaction.report.comparison.compare import stored_comparison
from lineofaction.report.document import stored_figures
from lineofaction.report.run.sound import stored_sound

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
def runs(closed_forms: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Runs:
    folder: Path = tmp_path_factory.mktemp("runs")
    run = closed_forms.run_up()
    run.to_netcdf(folder / "loud.nc")
    replace(run, bearing_force=0.5 * run.bearing_force).to_netcdf(folder / "quiet.nc")
    return Runs({LOUD: str(folder / "loud.nc"), QUIET: str(folder / "quiet.nc")})


@pytest.fixture
def visit(browser: Browser, address: str, runs: Runs) -> Iterator[Visit]:
    found = opened(browser, address)
    found.page.route("**/v1/results/*/figures*", runs.answer)
    found.page.route("**/v1/results/*/sound*", runs.answer)
    yield found
    found.page.close()


def test_a_run_is_heard_under_its_order_map(visit: Visit) -> None:
    page = visit.page
    page.evaluate(SHOW, [LOUD])
    order_map = page.locator("#shown [data-figure=order_map]")
    expect(order_map.locator("audio")).to_have_count(0)
    order_map.get_by_role("button", name="Listen to: Order map").press("Enter")
    player = order_map.locator("audio")
    expect(player).to_be_focused()
    until(lambda: player.evaluate("one => one.readyState") > 0)
    assert player.evaluate("one => one.duration") == pytest.approx(2.0, abs=1e-3)
    player.evaluate("one => { one.currentTime = 1.0; }")
    expect(order_map.locator("output")).to_have_text("450.0 rpm")
    area, cursor = (order_map.locator(name).first.bounding_box() for name in (".nsewdrag", ".cursor"))
    assert area and cursor
    assert area["x"] < cursor["x"] < area["x"] + area["width"]
    assert cursor["height"] == pytest.approx(area["height"], abs=1.0)
    assert not found_inaccessible(page)
    assert visit.complaints == []


def test_two_runs_are_heard_in_turn(visit: Visit) -> None:
    page = visit.page
    page.evaluate(SHOW, [LOUD, QUIET])
    levels = page.locator("#shown [data-figure=levels]")
    levels.get_by_role("button", name="Listen to: Overall level").press("Enter")
    expect(levels.locator("audio")).to_have_count(2)
    levels.locator("audio").first.evaluate("one => { one.currentTime = 1.0; }")
    levels.get_by_role("radio", name="second").check()
    expect(levels.locator("audio").first).to_be_hidden()
    assert levels.locator("audio").nth(1).evaluate("one => one.currentTime") == pytest.approx(1.0, abs=1e-3)
    sounds = [url for url in visit.requests if "/sound?" in url]
    assert sorted((LOUD in url.split("?")[0], QUIET in url.split("?")[1]) for url in sounds) == [
        (False, False),
        (True, True),
    ]
    assert visit.complaints == []
