"""The ends of the range of numba: read from pyproject.toml, and both tested."""

import subprocess
import tomllib
from pathlib import Path

import numba_ends
import pytest
from packaging.requirements import Requirement
from packaging.version import Version


def project(requirement: str) -> dict[str, dict[str, object]]:
    return {"project": {"optional-dependencies": {"analysis": ["numpy>=2", requirement]}}}


def test_the_ends_are_those_of_the_requirement():
    ends = numba_ends.requirements(project("numba>=0.61,<0.69"))
    assert ends == {"oldest": "numba==0.61", "newest": "numba>=0.61,<0.69"}
    for unbounded in ("numba>=0.61", "numba<0.69", "numba"):
        with pytest.raises(ValueError, match="must have a lowest version"):
            numba_ends.requirements(project(unbounded))


def test_the_newest_end_admits_the_numba_of_the_lock():
    table = tomllib.loads((numba_ends.ROOT / "pyproject.toml").read_text("utf-8"))
    newest = Requirement(numba_ends.requirements(table)["newest"])
    lock = (numba_ends.ROOT / "requirements-dev.lock").read_text("utf-8").splitlines()
    (locked,) = (line.split()[0].partition("==")[2] for line in lock if line.startswith("numba=="))
    assert newest.specifier.contains(locked)
    oldest = numba_ends.requirements(table)["oldest"].partition("==")[2]
    assert Version(oldest).release[:2] < Version(locked).release[:2]  # two versions, not one tested twice


def test_both_ends_are_tested_whichever_fails(monkeypatch, capsys):
    commands: list[list[str]] = []
    table = tomllib.loads((numba_ends.ROOT / "pyproject.toml").read_text("utf-8"))
    oldest = numba_ends.requirements(table)["oldest"]

    def run(command, **_options):
        commands.append(list(map(str, command)))
        failing = oldest in command
        return subprocess.CompletedProcess(command, int(failing))

    monkeypatch.setattr("subprocess.run", run)
    assert numba_ends.main([]) == 1
    assert "failed: oldest\n" in capsys.readouterr().out
    (tests,) = (command for command in commands if "pytest" in command[1:3])
    assert str(numba_ends.PLACE / "newest") in tests[0]
    for path in numba_ends.TESTS:
        assert path in tests and (Path(numba_ends.ROOT) / path).exists()
