"""One version, after the newest release while changes wait for the next; manifests: tests/unit/scripts."""

import re
import tomllib
from importlib.metadata import version

import pytest
from packaging.version import Version
from repository import ROOT

from service.schemas.answer_examples import ANSWERS
from service.version import solver_version

PROJECT: str = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["version"]


def changes(text: str) -> tuple[bool, Version]:
    """Return whether changes are not released, and the newest release."""
    unreleased, newest, _ = re.split(r"^## (\d\S*).*$", text, maxsplit=1, flags=re.MULTILINE)
    return "\n- " in unreleased, Version(newest)


def agrees(stated: Version, waiting: bool, newest: Version) -> bool:
    """Whether a version is that of the release after the newest, or of the newest where nothing waits."""
    if not waiting:
        return stated == newest
    return stated.is_devrelease and Version(stated.base_version) > newest


def test_the_version_is_that_of_the_next_release_or_of_this_one():
    waiting, newest = changes((ROOT / "CHANGELOG.md").read_text("utf-8"))
    assert agrees(Version(PROJECT), waiting, newest), f"{PROJECT} after {newest}"


@pytest.mark.parametrize(
    ("stated", "waiting", "good"),
    [("0.2.0", False, True), ("0.2.0", True, False), ("0.3.0.dev1", True, True), ("0.3.0", True, False),
     ("0.2.0.dev1", True, False), ("0.3.0", False, False)],
)  # fmt: skip
def test_a_version_that_stands_still_is_found(stated, waiting, good):
    text = "## Unreleased\n\n" + "- **A change**\n" * waiting + "\n## 0.2.0 - 2026-11-22\n\n- an older one\n"
    assert agrees(Version(stated), *changes(text)) is good


def test_program_and_examples_say_the_installed_version():
    """After `scripts/environment`, which installs anew where pyproject.toml changed."""
    assert ANSWERS["/v1"]["version"] == solver_version() == version("lineofaction") == PROJECT
