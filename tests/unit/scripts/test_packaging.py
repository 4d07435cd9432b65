"""What is packaged is all that the packages need: files that are no Python are easily forgotten."""

import tomllib
from fnmatch import fnmatch
from pathlib import Path, PurePath

import pytest
from packaging.specifiers import SpecifierSet
from repository import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
DATA = PROJECT["tool"]["setuptools"]["package-data"]
PACKAGES = ("host", "bounds", "model_studies", "fe_contact", "dynamics", "lineofaction", "service")


def packaged(file: Path) -> bool:
    """Whether a pattern of the package data, of the package itself or one above it, takes a file."""
    for package, patterns in DATA.items():
        folder = ROOT if package == "*" else ROOT / package.replace(".", "/")
        if file.is_relative_to(folder):
            name = PurePath(file.name) if package == "*" else file.relative_to(folder)
            if any(_matches(name, PurePath(pattern)) for pattern in patterns):
                return True
    return False


def _matches(name: PurePath, pattern: PurePath) -> bool:
    """Whether a pattern takes a name; its part ``**`` stands for any number of folders."""
    if "**" not in pattern.parts:
        return len(name.parts) == len(pattern.parts) and name.match(str(pattern))
    at = pattern.parts.index("**")
    first, last = pattern.parts[:at], pattern.parts[at + 1 :]
    ends = zip(name.parts[: len(first)] + name.parts[-len(last) :], first + last, strict=False)
    return len(name.parts) >= len(first) + len(last) and all(fnmatch(part, known) for part, known in ends)


def test_the_index_names_every_python_that_installs_it():
    pythons = SpecifierSet(PROJECT["project"]["requires-python"])
    admitted = [
        f"Programming Language :: Python :: 3.{minor}" for minor in range(30) if f"3.{minor}" in pythons
    ]
    named = [text for text in PROJECT["project"]["classifiers"] if ":: Python :: 3." in text]
    assert named == admitted


def test_patterns_take_files_at_any_depth():
    """Loops are built into the folder of the package by `scripts/run`."""
    pattern = PurePath("shipped_loops/**/*.nb[ic]")
    assert _matches(PurePath("shipped_loops/dynamics/forces/elements.potential.nbc"), pattern)
    assert _matches(PurePath("shipped_loops/index.nbi"), pattern)
    assert not _matches(PurePath("shipped_loops/dynamics/forces/notes.txt"), pattern)
    assert not _matches(PurePath("other_loops/a.nbc"), pattern)


@pytest.mark.parametrize("package", PACKAGES)
def test_every_file_of_a_package_is_packaged(package):
    found = (f for f in (ROOT / package).rglob("*") if f.is_file() and "__pycache__" not in f.parts)
    files = [f for f in found if f.suffix != ".py"]
    assert [str(f.relative_to(ROOT)) for f in files if not packaged(f)] == []


@pytest.mark.parametrize("package", PACKAGES)
def test_every_folder_of_modules_is_a_package(package):
    folders = {f.parent for f in (ROOT / package).rglob("*.py")}
    assert [str(f.relative_to(ROOT)) for f in folders if not (f / "__init__.py").is_file()] == []


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_say_that_they_are_typed(package):
    assert (ROOT / package / "py.typed").is_file()


def test_the_source_distribution_holds_what_a_clone_holds():
    manifest = (ROOT / "MANIFEST.in").read_text(encoding="utf-8").split()
    named = {*manifest, *PACKAGES, "pyproject.toml", "README.md", "LICENSE", "MANIFEST.in"}
    hidden = (".", "out", "build", "dist")
    there = {f.name for f in ROOT.iterdir() if not f.name.startswith(hidden) and f.suffix != ".egg-info"}
    assert there - {"__pycache__"} <= named
