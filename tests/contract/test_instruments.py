"""An instrument can be deleted: only rows name it from outside, and the tree without it works."""

import shutil
import subprocess
import sys
from collections.abc import Set as AbstractSet
from pathlib import Path

import instruments
import links
import pytest
import structure
from repository import ROOT

NAMES = sorted(instruments.instruments())
WORK = f"""
import importlib, pkgutil, sys
from importlib.util import find_spec
for house in filter(find_spec, {structure.HOUSES!r}):
    package = importlib.import_module(house)
    for module in pkgutil.walk_packages(package.__path__, house + "."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
from lineofaction.gearbox.registry import Studies
from lineofaction.report.presentation import presentation_of
from service.app import create_app
from service.settings import Settings
studies = [study for study in vars(Studies).values() if hasattr(study, "takes")]
for study in studies:
    study.inputs, study.run, study.answer, presentation_of(study)
create_app(Settings(data_directory=sys.argv[1]))
print(*(study.name for study in studies))
"""


def inside(name: str) -> AbstractSet[str]:
    """Return the modules that go with an instrument."""
    gone = instruments.with_dependents([name])
    return {module for one in gone for module in instruments.modules().within(instruments.instruments()[one])}


@pytest.mark.law
@pytest.mark.parametrize("name", NAMES)
def test_only_rows_name_an_instrument_from_outside(name):
    modules, importers = inside(name), instruments.modules().importers()
    assert modules
    outside = {(one, module) for module in modules for one in importers.get(module, ())}
    assert not [
        (one, module)
        for one, module in outside
        if instruments.is_product(one) and one not in modules and not instruments.is_row(one)
    ]


@pytest.mark.parametrize("name", NAMES)
def test_what_an_instrument_alone_uses_goes_with_it(name):
    modules, importers = inside(name), instruments.modules().importers()
    used = {
        module: {one for one in importers.get(module, ()) if not instruments.is_row(one)}
        for module in instruments.modules().files
        if instruments.is_product(module) and not module.endswith("__init__")
    }
    alone = {module for module, users in used.items() if users and users <= modules}
    assert alone <= modules


def test_paths_exist_and_belong_to_one_instrument():
    rows = instruments.instruments().values()
    paths = [path for one in rows for path in one.paths]
    assert len(paths) == len(set(paths))
    paths += [f"docs/{page}" for one in rows for page in one.pages]
    assert [path for path in paths if not (ROOT / path).exists()] == []


def test_links_to_a_page_that_goes_leave_their_text_or_their_entry(tmp_path):
    (tmp_path / "docs").mkdir()
    page = tmp_path / "docs" / "page.md"
    page.write_text(
        "Read [how](gone.md#x) or [what](left.md).\n\n- [gone](gone.md)\n  further\n- [left](left.md), then "
        "[gone](gone.md)\n\n| q | [a](gone.md) |\n\n```{toctree}\ngone\nleft\n```\n"
    )
    (tmp_path / "docs" / "left.md").write_text("")
    links.without_pages(tmp_path, {tmp_path / "docs" / "gone.md"})
    assert page.read_text() == (
        "Read how or [what](left.md).\n\n- [left](left.md), then gone\n\n\n```{toctree}\nleft\n```\n"
    )
    assert links.dangling_links(tmp_path) == []


def test_scripts_of_the_page_lose_the_rows_of_those_that_went(tmp_path):
    script = tmp_path / "rows.js"
    script.write_text('import { gone, more } from "./gone.js";\nconst ROWS = [\n  gone,\n  left,\n];\n')
    links.without_scripts(tmp_path, {"gone.js"})
    assert script.read_text() == "const ROWS = [\n  left,\n];\n"
    assert links.dangling_imports(tmp_path) == []


def copy_of_tree(folder: Path) -> Path:
    """Copy the houses and what stands on them, as far as it is under version control or new."""
    for name in ("tests", "benchmarks", "examples", "scripts", "docs", *structure.HOUSES):
        top = name.partition(".")[0]
        shutil.copytree(
            ROOT / top, folder / top, ignore=shutil.ignore_patterns("__pycache__"), dirs_exist_ok=True
        )
    for name in ("pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, folder)
    return folder


def dangling(tree: Path) -> set[str]:
    """Return the broken links of a tree's manual, and the imports of missing scripts of its page."""
    return {*links.dangling_links(tree), *links.dangling_imports(tree / instruments.PAGE)}


def check_work_without(name: str, folder: Path) -> None:
    tree = copy_of_tree(folder)
    gone = instruments.retire([name], tree)
    assert dangling(tree) <= dangling(ROOT)
    done = subprocess.run(
        [sys.executable, "-P", "-c", WORK, str(folder / "data")],
        cwd=tree, capture_output=True, text=True, check=False, timeout=300,
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(tree), "HOME": str(folder)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    studies = done.stdout.split()
    assert len(studies) > 10
    assert not {study.replace("-", "_") for study in studies} & set(gone)


@pytest.mark.law
def test_the_tree_without_an_instrument_works(tmp_path):
    """The one whose number the files of the tree draw: another with every change."""
    drawn = sum(file.stat().st_size for house in structure.HOUSES for file in structure.files_of(house))
    check_work_without(NAMES[drawn % len(NAMES)], tmp_path)


@pytest.mark.nightly
@pytest.mark.parametrize("name", NAMES)
def test_the_tree_without_any_instrument_works(name, tmp_path):
    check_work_without(name, tmp_path)
