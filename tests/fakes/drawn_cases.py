"""Tests marked `drawn` run a fifth of their cases by day, and all with `--all` and where their file is named.

Which fifth follows from the names of the cases and from the version of the project: it is the same in every
run and every worker, the next version draws another, and five versions in a row draw every case.
"""

import re
import zlib
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import TypeVar

import pytest

PART = 5
_PROJECT = Path(__file__).parents[2] / "pyproject.toml"
_by_day = False

Case = TypeVar("Case")


def leave_to_the_night(items: Iterable[pytest.Item]) -> None:
    global _by_day  # noqa: PLW0603 (what a run draws inside of its tests it knows once)
    _by_day = True
    functions: dict[str, list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("drawn") and not item.get_closest_marker("nightly"):
            functions.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for cases in functions.values():
        drawn = draw([case.nodeid for case in cases], turn())
        for case in cases:
            if case.nodeid not in drawn:
                case.add_marker(pytest.mark.nightly)


def drawn_part(cases: Sequence[Case], name_of: Callable[[Case], str] = str) -> list[Case]:
    """Return a fifth of the cases that a test walks by itself, or all of them where all run."""
    names = draw(map(name_of, cases), turn()) if _by_day else set(map(name_of, cases))
    return [case for case in cases if name_of(case) in names]


def draw(names: Iterable[str], turn: int) -> set[str]:
    """Return a fifth of the names, at least one: of their order by check sum, those at this turn."""
    ordered = sorted(names, key=lambda name: (zlib.crc32(name.encode()), name))
    return set(ordered[turn % min(PART, len(ordered)) :: PART])


@cache
def turn() -> int:
    """Return a number that the next version has one more of."""
    version = re.search(r'^version = "(.+)"', _PROJECT.read_text(encoding="utf-8"), re.MULTILINE)
    return sum(map(int, re.findall(r"\d+", version[1])))
