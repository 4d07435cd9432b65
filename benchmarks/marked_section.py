"""Sections of pages that are written by the benchmarks."""

from __future__ import annotations

from pathlib import Path


def replace_section(page: Path, name: str, text: str) -> None:
    """Write `text` between the marks of a section.

    Raises
    ------
    ValueError
        The page has no such section.
    """
    begin, end = (f"<!-- {word} {name}: written by scripts/bench --publish -->" for word in ("begin", "end"))
    before, found, rest = page.read_text(encoding="utf-8").partition(begin)
    _, ended, after = rest.partition(end)
    if not (found and ended):
        raise ValueError(f"{page} has no section between {begin} and {end}")
    page.write_text(f"{before}{begin}\n{text}{end}{after}", encoding="utf-8")
