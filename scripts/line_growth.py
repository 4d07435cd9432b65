"""Print how many lines the subjects of each house have, and what came and went since a revision.

Usage: line_growth.py [REVISION]   without one: the lines of today. A subject is a folder or file of a house.
"""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import structure

MIN = 100
"""Lines of change of a subject that is printed."""


def lines_of_today() -> Counter[str]:
    """Return the lines of each subject."""
    lines: Counter[str] = Counter()
    for house in structure.HOUSES:
        for file in structure.files_of(house):
            lines[subject_of(file.relative_to(structure.ROOT))] += file.read_text("utf-8").count("\n")
    return lines


def changes_since(revision: str) -> Iterator[tuple[str, int, int]]:
    """Yield subject, lines that came and lines that went, of each file that changed."""
    folders = [house.replace(".", "/") for house in structure.HOUSES]
    command = ["git", "diff", "--numstat", "--no-renames", revision, "--", *folders]
    numstat = subprocess.run(command, cwd=structure.ROOT, check=True, capture_output=True, text=True).stdout
    for line in numstat.splitlines():
        came, went, name = line.split("\t")
        if name.endswith(".py"):
            yield subject_of(Path(name)), int(came), int(went)


def subject_of(file: Path) -> str:
    """Return the folder or file of a house that a file belongs to."""
    house = structure.house_of(".".join(file.with_suffix("").parts)) or file.parts[0]
    depth = house.count(".") + 2
    return "/".join(file.parts[:depth])


def table(lines: Counter[str], changes: Iterator[tuple[str, int, int]]) -> str:
    """Return the lines of all houses, and of each subject that changed much."""
    came, went = Counter[str](), Counter[str]()
    for subject, more, less in changes:
        came[subject] += more
        went[subject] += less
    rows = [f"{sum(lines.values()):7d} lines, +{came.total()} -{went.total()}"]
    for subject in sorted(set(came) | set(went), key=lambda subject: went[subject] - came[subject]):
        if came[subject] + went[subject] >= MIN:
            rows.append(f"{lines[subject]:7d} {subject}  +{came[subject]} -{went[subject]}")
    return "\n".join(rows)


if __name__ == "__main__":
    if "".join(sys.argv[1:]):
        print(table(lines_of_today(), changes_since(sys.argv[1])))
    else:
        for name, number in lines_of_today().most_common():
            print(f"{number:7d} {name}")
