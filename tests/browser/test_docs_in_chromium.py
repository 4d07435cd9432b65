"""The description of the API in a browser: of a service with keys, without anything from elsewhere."""

from __future__ import annotations

from pathlib import Path

import page_visit
from playwright.sync_api import Browser, expect

from service.access.keyring import KeyFile


def test_the_description_is_shown_and_tried_with_the_key(browser: Browser, tmp_path: Path) -> None:
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
