"""The page of plausibility has every check with its limits, as the code has them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from bounds import engineering
from dynamics.plausibility import CHECKS as SCENE_CHECKS
from fe_contact.plausibility import CHECKS as PAIR_CHECKS
from lineofaction.gearbox.units import DEGREE, GPA, MM, UM

DOCS = Path(__file__).parents[3] / "docs"
PAGE = (DOCS / "plausibility.md").read_text(encoding="utf-8")


def limits(check: Any) -> str:
    low, high = limit_text(check.low, check.unit), limit_text(check.high, check.unit)
    if low and high:
        return f"{low} to {high} ({check.source})."
    if not low + high:
        return f"{check.source[0].upper()}{check.source[1:]}."
    return f"{f'At least {low}' if low else f'At most {high}'} ({check.source})."


@pytest.mark.parametrize(
    "check", [*PAIR_CHECKS.values(), *SCENE_CHECKS.values()], ids=lambda check: check.name
)
def test_every_check_is_on_the_page(check: Any) -> None:
    assert f"`{check.name}`: {check.quantity} : {limits(check)}" in " ".join(PAGE.split())


def test_the_page_has_no_check_that_is_gone() -> None:
    listed = re.findall(r"^`(\w+)`: ", PAGE, re.MULTILINE)
    assert sorted(listed) == sorted([*PAIR_CHECKS, *SCENE_CHECKS])


def test_the_page_is_linked() -> None:
    assert "(plausibility.md)" in (DOCS / "cli.md").read_text(encoding="utf-8")


def limit_text(limit: float | None, unit: str) -> str:
    """Return a limit of a check as people read it; empty for none."""
    if limit is None:
        return ""
    small, soft = limit < 1e-3, limit < 1e9
    scales = {
        "m": (UM, "um") if small else (MM, "mm"),
        "Pa": (1e6, "MPa") if soft else (GPA, "GPa"),
        "rad": (DEGREE, "deg"),
        "1": (1.0, ""),
    }
    scale, name = scales.get(unit, (1.0, unit))
    return f"{engineering(limit / scale, 3)} {name}".strip()
