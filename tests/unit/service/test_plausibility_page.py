"""The page of plausibility has every check with its limits, as the code has them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from dynamics.plausibility import CHECKS as SCENE_CHECKS
from fe_contact.plausibility import CHECKS as PAIR_CHECKS
from service.convert.plausibility import limit_text

DOCS = Path(__file__).parents[3] / "docs"


@pytest.mark.parametrize(
    "check", [*PAIR_CHECKS.values(), *SCENE_CHECKS.values()], ids=lambda check: check.name
)
def test_every_check_is_on_the_page(check: Any) -> None:
    limits = f"{limit_text(check.low, check.unit)} | {limit_text(check.high, check.unit)}"
    line = f"| `{check.name}` | {check.quantity} | {limits} | {check.source} |"
    assert line in (DOCS / "plausibility.md").read_text(encoding="utf-8").splitlines()


def test_the_page_has_no_check_that_is_gone() -> None:
    lines = (DOCS / "plausibility.md").read_text(encoding="utf-8").splitlines()
    listed = [line.split("`")[1] for line in lines if line.startswith("| `") and line.count("|") == 6]
    assert sorted(listed) == sorted([*PAIR_CHECKS, *SCENE_CHECKS])


def test_the_page_is_linked() -> None:
    assert "(plausibility.md)" in (DOCS / "cli.md").read_text(encoding="utf-8")
