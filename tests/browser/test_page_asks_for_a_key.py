"""A service with access keys: its page asks once and goes on, its description is tried with the key."""

import page_visit
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from service.access.key_file import KeyFile


@pytest.fixture
def served(tmp_path):
    file = tmp_path / "keys.json"
    secret = KeyFile(file).add("reader")
    with page_visit.served(tmp_path, LOA_KEYS_FILE=str(file)) as address:
        yield address, secret


def test_it_asks_until_the_key_is_right_and_keeps_it_for_the_tab(browser, served):
    address, secret = served
    page = browser.new_page(viewport={"width": 1000, "height": 800})
    page.set_default_timeout(page_visit.PATIENCE)
    page.goto(f"{address}/#rail")
    dialog = page.get_by_role("dialog", name="Access key")
    expect(dialog).to_contain_text("asks for an access key")
    expect(dialog).to_have_count(1)
    assert Axe().run(page, options={"rules": {"region": {"enabled": False}}}).violations_count == 0
    page.keyboard.type("loa_wrong")
    page.keyboard.press("Enter")
    expect(dialog).to_contain_text("unknown")
    page.keyboard.type(secret)
    page.keyboard.press("Enter")
    page.wait_for_selector("html[data-ready=yes]")
    page.reload()
    page.wait_for_selector("html[data-ready=yes]")
    assert dialog.count() == 0, "kept for the tab"
    assert secret not in page.url


def test_the_description_is_shown_and_tried_with_the_key(browser, tmp_path):
    file = tmp_path / "keys.json"
    secret = KeyFile(file).add("reader")
    complaints: list[str] = []
    asked: list[str] = []
    with page_visit.served(tmp_path, LOA_KEYS_FILE=str(file)) as address:
        page = browser.new_page()
        page.set_default_timeout(page_visit.PATIENCE)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on(
            "console", lambda message: complaints.append(message.text) if "Policy" in message.text else None
        )
        page.on("request", lambda request: asked.append(request.url))
        page.goto(f"{address}/docs")
        page.get_by_role("dialog", name="Access key").get_by_role("textbox").fill(secret)
        page.keyboard.press("Enter")
        page.locator("#operations-service-conformance").click()
        page.get_by_role("button", name="Try it out").click()
        page.get_by_role("button", name="Execute").click()
        expect(page.locator(".live-responses-table")).to_contain_text(
            "ogcapi-processes-1", timeout=page_visit.PATIENCE
        )
        assert page.locator(".opblock-summary").count() > 30
    assert f"{address}/v1/conformance" in asked
    assert [url for url in asked if not url.startswith((address, "data:", "blob:"))] == []
    assert [text for text in complaints if "401" not in text] == []
