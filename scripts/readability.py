"""Write how readable the documentation is: Flesch reading ease of every page, docs/lab/readability.md.

python scripts/readability.py [BEFORE]        BEFORE: a folder with an earlier docs/ and README.md

Flesch (1948): 206.835 - 1.015 words per sentence - 84.6 syllables per word; 60 is plain English, 30 hard.
Only running text counts: no code, tables, definitions, headings, pictures. Syllables are groups of vowels,
less a final e.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "lab" / "readability.md"
FOLDERS = ("tutorials", "how-to", "theory", "decisions", "lab")
_NOT_TEXT = (
    r"```.*?```",
    r"<!--.*?-->",
    r"^\|.*$",
    r"^`.*\n: .*(?:\n  .*)*",
    r"^ {4}.*$",
    r"^#.*$",
    r"!\[[^]]*\]\([^)]*\)",
)


@dataclass(frozen=True)
class Text:
    """Counts of running text; they add up."""

    sentences: int = 0
    words: int = 0
    syllables: int = 0

    def __add__(self, other: Text) -> Text:
        return Text(
            self.sentences + other.sentences, self.words + other.words, self.syllables + other.syllables
        )

    @property
    def reading_ease(self) -> float:
        """Flesch reading ease."""
        return 206.835 - 1.015 * self.words / self.sentences - 84.6 * self.syllables / self.words


def running_text(page: str) -> str:
    """Return the sentences of a page in Markdown; paragraphs and items of lists end with a full stop."""
    for pattern in _NOT_TEXT:
        page = re.sub(
            pattern, "\n\n", page, flags=re.M | re.S if "```" in pattern or "<" in pattern else re.M
        )
    page = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", page)
    page = re.sub(r"`[^`]*`", "code", page)
    return re.sub(r"\s*(?:\n\s*\n|\n\s*(?:[-*]|\d+\.) )\s*", ". ", page)


def counted(page: str) -> Text:
    """Count sentences, words and syllables of a page."""
    sentences = [
        re.findall(r"[A-Za-z][A-Za-z'-]*", part) for part in re.split(r"[.!?]\s", running_text(page))
    ]
    words = [word for sentence in sentences for word in sentence]
    return Text(sum(map(bool, sentences)), len(words), sum(map(syllables, words)))


def syllables(word: str) -> int:
    """Count the groups of vowels of a word, without a silent e; at least one."""
    word = word.lower()
    groups = len(re.findall(r"[aeiouy]+", word))
    silent = word.endswith("e") and not word.endswith(("le", "ee")) and groups > 1
    return max(1, groups - silent)


def by_part(root: Path) -> dict[str, Text]:
    """Return the counts of the README, the reference pages and each folder of the documentation."""
    groups = {"README": [root / "README.md"], "reference": sorted((root / "docs").glob("*.md"))}
    groups |= {name: sorted((root / "docs" / name).glob("*.md")) for name in FOLDERS}
    return {
        name: sum((counted(page.read_text("utf-8")) for page in pages), Text())
        for name, pages in groups.items()
    }


def table(after: dict[str, Text], before: dict[str, Text]) -> str:
    """Return the page's table; a part that was not there before has no figure."""
    rows = ["| part | words before | ease before | words | ease |", "|---|---:|---:|---:|---:|"]
    for name, text in after.items():
        old = before.get(name, Text())
        was = f"{old.words} | {old.reading_ease:.0f}" if old.words else " | "
        rows.append(f"| {name} | {was} | {text.words} | {text.reading_ease:.0f} |")
    return "\n".join(rows)


def main(before: Path | None) -> None:
    """Write the page."""
    after = by_part(ROOT)
    old = by_part(before) if before else {}
    after["all"], old["all"] = (sum(parts.values(), Text()) for parts in (after, old))
    PAGE.write_text(f"# Readability\n\n{HEAD}\n\n{table(after, old)}\n", encoding="utf-8")


HEAD = """Flesch reading ease of the running text: 60 is plain English, 30 is hard. Code, tables, definitions
of fields and headings do not count. `python scripts/readability.py BEFORE` renews this page; *before* is
version 0.2.0."""

if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
