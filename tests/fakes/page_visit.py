"""What the tests of the page share: a service, its small case, and a page that is watched."""

import copy
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from axe_playwright_python.sync_playwright import Axe
from housing_solid import STIFFNESS, housed_scene, write_block
from playwright.sync_api import Browser, Locator, Page, Route, expect
from printed_pages import Printed
from running_service import PATIENCE_S, until

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.schemas.toml import toml_text

GEAR: dict[str, Any] = {"teeth": 20, "face_width_mm": 4.0, "bore_diameter_mm": 10.0}
CASE: dict[str, Any] = {
    "pair": {"normal_module_mm": 1.0, "center_distance_mm": 20.0, "pinion": GEAR, "wheel": GEAR},
    "load": {"torque_n_m": [0.5, 1.0]},
    "accuracy": {"level": "draft", "model": "plane_strain", "positions": 16, "receipt": "minimal"},
}
OVER_FACE = CASE | {
    "pair": CASE["pair"] | {"center_distance_mm": 22.0, "wheel": GEAR | {"teeth": 24}},
    "accuracy": CASE["accuracy"] | {"model": "3d", "positions": 8},
}
PATIENCE = 1e3 * PATIENCE_S  # milliseconds


@dataclass
class Visit:
    """An opened page and what it did."""

    page: Page
    console: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    @property
    def complaints(self) -> list[str]:
        """What was complained about; not that a request was refused, or a connection cut."""
        return [
            line
            for line in self.console
            if line.startswith("error") and "Failed to load resource" not in line
        ]


@contextmanager
def served(home: Path, **further: str) -> Iterator[str]:
    """Serve on a free port and an empty directory; gives the address."""
    root = str(Path(__file__).parents[2])
    path = os.pathsep.join(part for part in (root, os.environ.get("PYTHONPATH", "")) if part)
    environment = {**os.environ, "PYTHONPATH": path, "XDG_DATA_HOME": str(home), **further}
    command = [sys.executable, "-m", "lineofaction.cli", "serve", "--port", "0"]
    with (
        (home / "log").open("wb") as log,
        subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=log, text=True) as service,
    ):
        assert service.stdout is not None
        try:
            yield service.stdout.readline().split()[-1]
        finally:
            service.terminate()


def opened(browser: Browser, address: str, scheme: str = "light", width: int = 1400) -> Visit:
    """Open the page and note what it does; without a fragment at a section, where nothing is computed."""
    page = _tab(browser, address)
    page.set_viewport_size({"width": width, "height": 900})
    page.emulate_media(color_scheme=scheme)
    page.set_default_timeout(PATIENCE)
    expect.set_options(timeout=PATIENCE)
    seen = Visit(page)
    page.on("console", lambda message: seen.console.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: seen.console.append(f"error: {error}"))
    page.on("request", lambda request: seen.requests.append(request.url))
    page.goto(address if "#" in address else f"{address}/#rail")
    page.wait_for_selector("html[data-ready=yes]")
    return seen


def bare(browser: Browser, address: str) -> Page:
    """Open a file of the page by itself: its modules can be imported, and nothing is drawn or asked."""
    page = _tab(browser, address)
    answer = page.goto(f"{address}/page/style.css")
    assert answer.ok
    return page


def _tab(browser: Browser, address: str) -> Page:
    """Return a tab of the one window, which costs a second less than a window of its own; nothing is stored.

    The window's first tab is blank and stays, so that the window does.
    """
    windows = (one for one in browser.contexts if one.pages and one.pages[0].url == "about:blank")
    window = next(windows, None)
    if window is None:
        window = browser.new_context()
        window.new_page()
    page = window.new_page()
    stored = {"origin": address.partition("/#")[0], "storageTypes": "local_storage"}
    session = window.new_cdp_session(page)
    session.send("Storage.clearDataForOrigin", stored)
    session.detach()
    return page


def choose_case(page: Page, folder: Path) -> None:
    file = folder / "case.json"
    file.write_text(json.dumps(CASE), encoding="utf-8")
    page.locator("#import-file").set_input_files(file)
    expect(page.locator("#example-note")).to_have_text("case.json")
    expect(page.locator("#f-pair-pinion-teeth")).to_have_value("20")
    expect(page.locator("#f-pair-normal_module_mm")).to_have_value("1")


def computed(address: str, process: str = "analyze", **inputs: Any) -> str:
    """Compute something at the service, of the small case by itself; returns the hash of the result."""
    with LineOfActionClient(address) as client:
        return client.wait(client.submit(process, inputs or {"case": CASE}).id, interval=0.05).key


def shown(browser: Browser, address: str, key: str) -> Visit:
    seen = opened(browser, f"{address}/#database={key}")
    answered(seen.page)
    return seen


def answered(page: Page) -> None:
    page.wait_for_selector("#live-figures[data-answers]", state="attached")


def control(page: Page, selector: str) -> Locator:
    """Return a control of a tab or a node of the rail, which is shown for it."""
    page.evaluate(
        "async (selector) => (await import('/page/tabs.js')).reveal(document.querySelector(selector))",
        selector,
    )
    return page.locator(selector)


def tab(page: Page, title: str) -> None:
    """Show a tab of the stage, or a node of the rail."""
    page.get_by_role("tab", name=title, exact=True).click()


def answers(page: Page) -> int:
    return int(page.locator("#live-figures").get_attribute("data-answers") or 0)


def moved(page: Page, slider: str, key: str) -> None:
    count = answers(page)
    control(page, slider).press(key)
    until(lambda: answers(page) > count)


def unfold(page: Page) -> None:
    page.evaluate("() => { for (const folded of document.querySelectorAll('details')) folded.open = true; }")


def found_inaccessible(page: Page, part: str = "html") -> dict[str, list[str]]:
    """Return what axe-core finds to complain about, by rule; a whole page with plots takes it 3 CPU s."""
    found = Axe().run(page, context=part).response["violations"]
    return {rule["id"]: [node["html"][:160] for node in rule["nodes"]] for rule in found}


TYPED = """() => Object.fromEntries(
  [...document.querySelectorAll("#main :is(input, select, textarea)[id]")]
    .filter((control) => !control.matches("[type=file], #jobs-search, #example"))
    .map(({ id, value }) => [id, value]))"""


@contextmanager
def other_browser(browser: Browser, address: str, ready: str = "html[data-ready=yes]") -> Iterator[Page]:
    """Open an address in a browser that has nothing of the others; gives its page when it is ready."""
    context = browser.new_context()
    page = context.new_page()
    page.goto(address)
    page.wait_for_selector(ready)
    yield page
    context.close()


def typed(page: Page) -> dict[str, str]:
    fields: dict[str, str] = page.evaluate(TYPED)
    return fields


def shows_the_same(page: Page, sent: Page) -> None:
    """Wait until all controls of two pages hold the same: what is typed live comes with its first answer."""
    with suppress(AssertionError):
        until(lambda: typed(page) == typed(sent))
    assert typed(page) == typed(sent)


def opened_scene(page: Page, folder: Path, **fields: Any) -> None:
    """Open the scene of two gears in the housing of a block, with its STEP file, as a user does."""
    step, file = write_block(folder / "block.step"), folder / "scene.toml"
    scene = copy.deepcopy(housed_scene(folder, **fields))
    scene["meshes"][0] |= {"database_file": None, "stiffness": STIFFNESS}
    file.write_text(toml_text(scene), encoding="utf-8")
    page.locator("#scene-file").set_input_files([file, step])
    expect(page.get_by_text("With block.step.")).to_be_visible()


@contextmanager
def refused(page: Page, process: str) -> Iterator[list[Any]]:
    """Refuse jobs of a process, since others wait for the worker; yields the inputs that were sent."""
    sent: list[Any] = []

    def refuse(route: Route) -> None:
        sent.append(route.request.post_data_json["inputs"])
        route.fulfill(status=422, json={"title": "Not now", "status": 422})

    address = f"**/processes/{process}/execution"
    page.route(address, refuse)
    yield sent
    page.unroute(address)


def to_print(page: Page, save: Callable[[], None]) -> Printed:
    """Return the report that `save` downloads, as a browser without the service prints it."""
    with page.expect_download() as saved:
        save()
    report = page.context.browser.new_page(java_script_enabled=False)
    report.set_content(saved.value.path().read_text(encoding="utf-8"))
    printed = Printed(report.pdf(prefer_css_page_size=True, tagged=True))
    report.close()
    return printed
