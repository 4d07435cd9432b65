"""Chromium for the browser tests: the system's own, with everything that calls home switched off."""

import importlib.util
import os
import shutil
from pathlib import Path

import pytest
from condensed_once import find_condensed
from page_visit import PATIENCE, bare, computed, served, shown
from playwright.sync_api import expect, sync_playwright

CLOSED_FORMS = Path(__file__).parents[1] / "unit" / "report" / "conftest.py"

FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--no-first-run", "--disable-3d-apis",
)  # fmt: skip
DRAWING = (
    "--headless", "--no-sandbox", "--disable-background-networking", "--disable-sync", "--no-first-run",
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
)  # fmt: skip
NAMES = ("chromium", "chromium-browser", "google-chrome")


def chromium() -> str | None:
    """Return the path of the browser: CHROMIUM, or the first one installed."""
    return os.environ.get("CHROMIUM") or next((path for name in NAMES if (path := shutil.which(name))), None)


@pytest.fixture(scope="session")
def playwright():
    expect.set_options(timeout=PATIENCE)  # of a busy machine; what is there is seen at once
    with sync_playwright() as started:
        yield started


@pytest.fixture(scope="session")
def browser_path():
    path = chromium()
    if path is None:
        pytest.skip("no Chromium on this machine: apt-get install chromium, or name one in CHROMIUM")
    return path


@pytest.fixture(scope="session")
def browser(playwright, browser_path):
    started = playwright.chromium.launch(executable_path=browser_path, args=FLAGS)
    yield started
    started.close()


@pytest.fixture(scope="module")
def drawing_browser(playwright, browser_path):
    """The browser of the other tests, with WebGL by software."""
    started = playwright.chromium.launch(executable_path=browser_path, args=DRAWING)
    yield started
    started.close()


@pytest.fixture(scope="module", autouse=True)
def _closed(browser):
    yield
    for context in browser.contexts:
        context.close()


@pytest.fixture(scope="session")
def address(tmp_path_factory, condensed_bodies):
    home = tmp_path_factory.mktemp("service")
    find_condensed(condensed_bodies, home / "lineofaction")
    with served(home) as found:
        yield found


@pytest.fixture(scope="session")
def analyzed(address):
    """Hash of the small case's table in that service."""
    return computed(address)


@pytest.fixture
def visit(browser, address, analyzed):
    seen = shown(browser, address, analyzed)
    yield seen
    seen.page.close()


@pytest.fixture(scope="module")
def scripts(browser, address):
    """Return a page whose scripts are asked, without what they draw and ask in the whole one."""
    page = bare(browser, address)
    yield page
    page.close()


@pytest.fixture(scope="session")
def closed_forms():
    """Return the small database and run that the report's other tests use."""
    spec = importlib.util.spec_from_file_location("closed_forms", CLOSED_FORMS)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
