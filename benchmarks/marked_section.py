"""Sections of the measured pages that the benchmarks write, each between its marks."""

from __future__ import annotations

from pathlib import Path

MEASURED = Path(__file__).parents[1] / "out" / "site" / "measured"
"""Folder of the measured pages; `scripts/docs` publishes them beside the site."""


def replace_section(page: Path, name: str, text: str) -> None:
    """Write `text` between the marks of a section; a page or a section that is not there yet is begun."""
    begin, end = (f"<!-- {word} {name}: written by scripts/bench --publish -->" for word in ("begin", "end"))
    content = page.read_text(encoding="utf-8") if page.exists() else f"# {page.stem.capitalize()}, measured\n"
    before, _, rest = content.partition(begin)
    if rest:
        after = rest.partition(end)[2]
    else:
        before, after = f"{content}\n## {name[:1].upper()}{name[1:]}\n\n", "\n"
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(f"{before}{begin}\n{text}{end}{after}", encoding="utf-8")
