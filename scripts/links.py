"""Take links to files that went out of the manual, and their imports out of the scripts of the page."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator
from pathlib import Path

LINK = re.compile(r"(!?)\[([^]]*)\]\(([^)\s#]*)(#[^)\s]*)?\)")
"""A link or a picture of Markdown: mark of a picture, text, target, anchor."""
FENCE = "```"
ENTRY = re.compile(r"\s*(?:[-*]|\d+\.) |\|")
"""Beginning of an entry of a list, or of a row of a table."""
IMPORT = re.compile(r'import (?:\{([^}]*)\} from )?"\./([\w]+\.js)";')
"""An import of a script of the page: names, file."""


def without_pages(tree: Path, gone: Collection[Path]) -> None:
    """Remove the links to pages that went from all others of a tree.

    An entry of a list or a row of a table that begins with such a link, or whose only link it is, goes whole;
    of any other link the text stays.
    """
    for page in pages_of(tree):
        text = page.read_text("utf-8")
        new = "\n".join(_lines_without(text.split("\n"), page, gone))
        if new != text:
            page.write_text(new, "utf-8")


def pages_of(tree: Path) -> Iterator[Path]:
    """Yield the pages of the manual, the README among them."""
    yield from (page for page in [tree / "README.md"] if page.exists())
    yield from sorted((tree / "docs").rglob("*.md"))


def _lines_without(lines: list[str], page: Path, gone: Collection[Path]) -> Iterator[str]:
    contents, entry_goes = False, False
    for line in lines:
        if line.startswith(FENCE):
            contents = line.startswith(f"{FENCE}{{toctree}}")
        if contents and _file(page, f"{line.strip()}.md") in gone:
            continue
        begins = ENTRY.match(line) is not None
        if begins or not line.startswith(" "):
            entry_goes = begins and _is_of(line, page, gone)
        if not entry_goes:
            yield LINK.sub(lambda link: _text_of(link, page, gone), line)


def _is_of(entry: str, page: Path, gone: Collection[Path]) -> bool:
    """Whether the first link of an entry of a list or row leads to a page that went."""
    link = LINK.search(entry)
    return link is not None and _file(page, link[3]) in gone


def _text_of(link: re.Match[str], page: Path, gone: Collection[Path]) -> str:
    return link[2] if _file(page, link[3]) in gone else link[0]


def _file(page: Path, target: str) -> Path:
    """Return the file that a link of a page names."""
    return Path(os.path.normpath(page.parent / target))


def dangling_links(tree: Path) -> list[str]:
    """Return links of the manual to files that are not there, and missing entries of tables of contents."""
    missing = []
    for page in pages_of(tree):
        contents = False
        for line in page.read_text("utf-8").split("\n"):
            if line.startswith(FENCE):
                contents = line.startswith(f"{FENCE}{{toctree}}")
            targets = [link[3] for link in LINK.finditer(line) if link[3] and ":" not in link[3]]
            targets += [f"{line}.md"] if contents and re.fullmatch(r"[\w./-]+", line) else []
            missing += [
                f"{page.relative_to(tree)}: {target}"
                for target in targets
                if not _file(page, target).exists()
            ]
    return missing


def without_scripts(folder: Path, gone: Collection[str]) -> None:
    """Remove imports of scripts that went from those left, with the lines that begin with an imported name.

    A script of the page names what belongs to an instrument in rows of a list: a line each, which begins with
    the name that is imported.
    """
    for script in sorted(folder.glob("*.js")):
        names, lines = set[str](), []
        for line in script.read_text("utf-8").split("\n"):
            found = IMPORT.match(line)
            if found and found[2] in gone:
                names |= {name.strip() for name in (found[1] or "").split(",")}
            elif not re.match(rf"\s+(?:{'|'.join(sorted(names)) or '(?!)'})\b", line):
                lines.append(line)
        if names:
            script.write_text("\n".join(lines), "utf-8")


def dangling_imports(folder: Path) -> list[str]:
    """Return imports of scripts that are not there."""
    return [
        f"{script.name}: {found[2]}"
        for script in sorted(folder.glob("*.js"))
        for found in IMPORT.finditer(script.read_text("utf-8"))
        if not (folder / found[2]).exists()
    ]
