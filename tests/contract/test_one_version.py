"""One version, which moves with every entry among the changes; manifests: tests/unit/scripts."""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest
from packaging.version import Version

from service.schemas.examples import ANSWERS
from service.version import solver_version

ROOT = Path(__file__).resolve().parents[2]
PROJECT: str = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]


def changes(text: str) -> tuple[int, Version]:
    unreleased, newest, _ = re.split(r"^## (\d\S*).*$", text, maxsplit=1, flags=re.MULTILINE)
    return len(re.findall(r"^- ", unreleased, re.MULTILINE)), Version(newest)


def agrees(stated: Version, count: int, newest: Version) -> bool:
    """Whether a version is that of a tree with so many changes after a release."""
    if count == 0:
        return stated == newest
    return stated.dev == count and Version(stated.base_version) > newest


def test_the_version_counts_what_is_not_released() -> None:
    count, newest = changes((ROOT / "CHANGELOG.md").read_text("utf-8"))
    wanted = f"the development version after {newest} with {count} changes: BASE.dev{count}"
    assert agrees(Version(PROJECT), count, newest), f"{PROJECT} is not {wanted}"


@pytest.mark.parametrize(
    ("stated", "count", "good"),
    [("0.2.0", 0, True), ("0.2.0", 1, False), ("0.3.0.dev1", 1, True), ("0.3.0.dev1", 2, False),
     ("0.2.0.dev1", 1, False), ("0.3.0", 0, False)],
)  # fmt: skip
def test_a_version_that_stands_still_is_found(stated: str, count: int, good: bool) -> None:
    text = "## Unreleased\n\n" + "- **A change**\n" * count + "\n## 0.2.0 - 2026-11-22\n\n- an older one\n"
    assert agrees(Version(stated), *changes(text)) is good


def test_program_and_examples_say_the_installed_version() -> None:
    """After `scripts/environment`, which installs anew where pyproject.toml changed."""
    assert ANSWERS["/v1"]["version"] == solver_version() == version("lineofaction") == PROJECT
