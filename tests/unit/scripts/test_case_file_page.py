"""The tables of the case file are those of the declared fields."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

from fe_contact.flank.modification import FlankModification
from service.schemas.declared import figures

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "case-file.md").read_text("utf-8")


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("case_file_page", ROOT / "scripts" / "case_file_page.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_tables_are_current(script: ModuleType) -> None:
    assert script.page(PAGE) == PAGE, "write them anew: python scripts/case_file_page.py docs/case-file.md"


def test_every_declared_dataclass_has_a_table(script: ModuleType) -> None:
    named = [found[2] for found in script.TABLE.finditer(PAGE)]
    assert sorted(named) == sorted(script.BY_NAME)


def test_a_table_says_the_unit_the_bounds_and_the_default(script: ModuleType) -> None:
    table = script.table(figures(FlankModification))
    assert "| `helix_slope_um` | Helix slope over the face width; > 0 " in table
    assert " | -1000 to 1000 | 0 |\n" in table
    assert (
        '| `tip_relief_shape` | Tip relief over its length | `"linear"`, `"parabolic"` | `"linear"` |'
        in table
    )
    assert " | 5 to 85 | 30 |\n" in table
