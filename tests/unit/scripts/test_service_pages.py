"""The tables of verbs, routes and processes on their pages are those of the program."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest
from described_api import DESCRIPTION

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("service_pages", ROOT / "scripts" / "service_pages.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(("name", "tables"), [("cli", ["verbs"]), ("service", ["routes", "processes"])])
def test_the_tables_are_current(script: ModuleType, name: str, tables: list[str]) -> None:
    text = (ROOT / "docs" / f"{name}.md").read_text("utf-8")
    assert [found[2] for found in script.TABLE.finditer(text)] == tables
    assert script.page(text, DESCRIPTION) == text, (
        f"write them anew: python scripts/service_pages.py docs/{name}.md"
    )


def test_a_verb_links_to_its_section_and_a_default_is_one_value(script: ModuleType) -> None:
    verbs = script.verbs("\n## `loa ste`\n")
    assert "| [`loa ste`](#loa-ste) | Print one STE curve" in verbs and "| `loa keys add` |" in verbs
    assert "`samples` (1000)" in script.processes(DESCRIPTION)
    assert script.default({"default": []}) == script.default({}) == ""
    assert script.default({"default": True}) == " (true)"
