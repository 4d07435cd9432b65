"""Tutorials and how-to guides run as they stand, show what comes out, and answer newcomers in two clicks."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
SPEC = importlib.util.spec_from_file_location("manual", ROOT / "scripts" / "manual.py")
assert SPEC and SPEC.loader
manual = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(manual)


@pytest.fixture(scope="module")
def folder() -> Iterator[Path]:
    with manual.folder() as made:
        yield made


# Ten seconds and more, but for the tutorials and for pages whose files others read.
LONG = {
    *("deflect", "from-rexs-to-dba", "hear-a-gearbox", "planetary-stage", "quiet-flanks-by-search"),
    *("ripple-map", "tolerances", "vibration"),
}
PAGES = [
    pytest.param(page, id=page.stem, marks=[pytest.mark.nightly] * (page.stem in LONG))
    for page in manual.pages()
]


@pytest.mark.law  # those after it need what it leaves
@pytest.mark.parametrize("page", PAGES)
def test_the_page_runs_and_makes_its_pictures(page: Path, folder: Path) -> None:
    manual.run_page(page)
    assert [name for name in manual.pictures(page) if not (folder / name).is_file()] == []


def test_a_number_that_is_wrong_is_seen() -> None:
    output = "torque N m  force N\n     100  2660.4 ±2\n"
    assert manual.shown("100 2660 ±2", output)
    assert not manual.shown("100 2760 ±2", output)
    assert not manual.shown("torque kN m", output)


def links(page: Path) -> set[Path]:
    targets = re.findall(r"\]\(([^)#\s]+\.md)", page.read_text("utf-8"))
    return {(page.parent / target).resolve() for target in targets}


def questions() -> list[tuple[str, Path]]:
    rows = re.findall(r"^\d+\. \[([^]]+)\]\(([^)#]+)", (DOCS / "questions.md").read_text("utf-8"), re.M)
    return [(question, (DOCS / target).resolve()) for question, target in rows]


def test_there_are_twenty_questions() -> None:
    assert len(questions()) == 20


@pytest.mark.parametrize(("question", "answer"), questions(), ids=lambda value: getattr(value, "stem", ""))
def test_a_question_is_answered_within_two_clicks(question: str, answer: Path) -> None:
    front, list_of_questions = DOCS / "index.md", DOCS / "questions.md"
    doors = links(front) - {list_of_questions}
    assert answer in doors | {page for door in doors for page in links(door)}, question
