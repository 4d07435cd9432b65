"""The tables of verbs and processes on their pages are those of the program."""

import pytest
import service_pages
from described_api import DESCRIPTION
from repository import ROOT

from lineofaction.gearbox.studies.scatter import Inputs


@pytest.mark.parametrize(("name", "tables"), [("cli", ["verbs"]), ("service", ["processes"])])
def test_the_tables_are_current(name, tables):
    text = (ROOT / "docs" / f"{name}.md").read_text("utf-8")
    assert [found[2] for found in service_pages.TABLE.finditer(text)] == tables
    assert service_pages.page(text, DESCRIPTION) == text, (
        f"write them anew: python scripts/service_pages.py docs/{name}.md"
    )


def test_a_verb_links_to_its_section_and_a_default_is_one_value():
    verbs = service_pages.verbs("\n## `loa ste`\n")
    assert (
        "| [`loa ste`](#loa-ste) | Print one STE curve of a database. |" in verbs
        and "| `loa keys add` |" in verbs
    )
    assert "loa modes" not in verbs, "studies have a table of their own, in docs/studies.md"
    samples = Inputs.model_fields["samples"].default
    assert f"`samples` ({samples})" in service_pages.processes(DESCRIPTION)
    assert service_pages.default({"default": []}) == service_pages.default({}) == ""
    assert service_pages.default({"default": True}) == " (true)"
