"""The resolver of platforms, without the network: its requirements, its verdicts."""

import subprocess
from pathlib import Path

import pytest
import resolver

GMSH = """error: No solution found when resolving dependencies
  cause: Because gmsh>=4.13.0 has no wheels with a matching platform tag (e.g., `manylinux_2_28_aarch64`)
      and you require gmsh>=4.13, we can conclude that your requirements are unsatisfiable.
"""
PYMETIS = "  cause: Because pymetis>=2023.1 has no usable wheels and you require pymetis>=2023.1, we can"


def answered(monkeypatch: pytest.MonkeyPatch, errors: dict[str, str]) -> list[str]:
    """Let uv fail on platforms with a text; return what it is asked for."""
    asked: list[str] = []

    def run(command, **options):
        platform = command[command.index("--python-platform") + 1]
        asked.append(f"{platform} {command[-1]} {options['input']}")
        error = errors.get(platform, "") if "gmsh" in options["input"] else ""
        return subprocess.CompletedProcess(command, bool(error), "", error)

    monkeypatch.setattr("subprocess.run", run)
    return asked


def test_the_package_without_wheels_is_named(monkeypatch):
    answered(monkeypatch, {"a": GMSH, "b": PYMETIS, "c": "no network"})
    assert resolver.lacking_wheels(["gmsh"], "a", "3.12") == "gmsh"
    assert resolver.lacking_wheels(["gmsh"], "b", "3.12") == "pymetis"
    assert resolver.lacking_wheels(["numpy"], "a", "3.12") == ""
    with pytest.raises(RuntimeError, match="no network"):
        resolver.lacking_wheels(["gmsh"], "c", "3.12")


def test_what_is_stated_passes_and_anything_else_does_not(monkeypatch, capsys):
    arm = resolver.PLATFORMS["Linux ARM"]
    asked = answered(monkeypatch, {arm: GMSH})
    assert resolver.main() == 0
    assert any("3.11" in question and "fastapi" in question and "numba" in question for question in asked)
    answered(monkeypatch, {})
    assert resolver.main() == 1  # ARM has wheels: the page is out of date
    answered(monkeypatch, {arm: GMSH, resolver.PLATFORMS["Windows"]: PYMETIS})
    assert resolver.main() == 1
    assert "Windows analysis no wheels of pymetis <- NOT AS STATED" in capsys.readouterr().out


def test_the_host_table_names_what_has_no_wheels():
    page = (Path(resolver.ROOT) / "docs" / "architecture.md").read_text("utf-8")
    for (system, _), package in resolver.WITHOUT_WHEELS.items():
        (row,) = [
            line for line in page.splitlines() if line.startswith(f"| {system.replace('ARM', 'on ARM')}")
        ]
        assert package in row
