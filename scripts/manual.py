"""Run what the manual shows: the files, commands and Python of its pages, and compare the output they show.

    python scripts/manual.py [--renew] [PAGE ...]     every tutorial and how-to guide, or those of these names

Lists every line that a page shows and no command printed, beside the line of the output that is closest, and
takes pictures into docs/images/manual. With --renew lines get the numbers of today.

Blocks of a page are run in order. `toml` whose first line is ``# NAME.toml`` is saved under that name, `sh`
has one `loa` command a line (a backslash continues it), `python` is executed and sees the names of the blocks
before it. Every line of `text` is the beginning of a line that the command before it printed: same words,
numbers within 2 %. Pages share a folder, so that a guide can go on with the files of a tutorial: those that
made its files are run before it.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from typer.testing import CliRunner

from lineofaction.cli.commands import app

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "images" / "manual"
NEEDS_A_SERVICE = {"call-a-service"}  # its scripts are run by tests/flow/test_client_page.py
_BLOCK = re.compile(r"^```(toml|sh|python|text)\n(.*?)^```$", re.M | re.S)
_NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
_MADE = re.compile(r"""^# (\S+\.toml)$|(?:-o|--out)[ ",]+([\w./-]+)|Path\("([^"]+)"\)\.write_text""", re.M)
_PICTURE = re.compile(r"\]\((?:\.\./)*images/manual/([^)]+)\)")


def pages() -> list[Path]:
    """Return the pages that run: tutorials first, in the order of their indexes."""
    return [
        index.parent / f"{name}.md"
        for index in (ROOT / "docs" / "tutorials" / "index.md", ROOT / "docs" / "how-to" / "index.md")
        for name in re.findall(r"^([a-z0-9-]+)$", index.read_text("utf-8"), re.M)
        if name not in NEEDS_A_SERVICE
    ]


@dataclass(frozen=True)
class Stale:
    """A line of a page that no command printed."""

    offset: int
    """Offset of the line's first character in the page."""
    line: str
    nearest: str
    """Line of the output whose beginning is most similar."""
    renewed: str | None
    """The line with the numbers of the one line of the output that has its words; None without such a line.
    """

    def __str__(self) -> str:
        """Write the line above what is closest to it."""
        left = " (left, no partner)" * (self.renewed is None)
        return f"  shown:   {self.line}\n  nearest: {self.nearest}{left}"


def run_page(page: Path) -> Iterator[Stale]:
    """Run the blocks of a page in the working directory and yield every line that no command printed.

    Raises
    ------
    AssertionError
        A command failed, or a file has no name.
    """
    output = ""
    names: dict[str, object] = {}
    for block in _BLOCK.finditer(page.read_text("utf-8")):
        language, text = block.groups()
        if language == "toml":
            name = re.match(r"# (\S+\.toml)\n", text)
            assert name, f"{page.name}: a file without its name: {text.splitlines()[0]}"
            Path(name[1]).write_text(text, encoding="utf-8")
        elif language == "sh":
            output = "".join(_command(line) for line in text.replace("\\\n", "").splitlines())
        elif language == "python":
            output = _python(text, page, names)
        else:
            yield from stale_lines(text, output, block.start(2))


def stale_lines(text: str, output: str, offset: int = 0) -> Iterator[Stale]:
    """Yield the lines of a block that are not in the output before it."""
    for line in text.splitlines(keepends=True):
        if not shown(line, output):
            yield Stale(offset, line.rstrip("\n"), nearest(line, output), renewed(line.rstrip("\n"), output))
        offset += len(line)


def renew(page: Path, stale: list[Stale]) -> None:
    """Write today's numbers into the lines of a page that have a partner in the output."""
    text = page.read_text("utf-8")
    for found in reversed(stale):
        assert text.startswith(found.line, found.offset), f"{page.name} changed while it ran"
        if found.renewed is not None:
            text = text[: found.offset] + found.renewed + text[found.offset + len(found.line) :]
    page.write_text(text, encoding="utf-8")


def needed(page: Path) -> list[Path]:
    """Return a page after the pages whose files it needs, and their own needs first."""
    before = pages()[: pages().index(page)]
    named = set(re.findall(r"[\w.-]+", _run(page))) - _made(page)
    makers = [next((other for other in reversed(before) if name in _made(other)), page) for name in named]
    first = sorted({found for maker in makers if maker != page for found in needed(maker)}, key=before.index)
    return [*first, page]


def _run(page: Path) -> str:
    """Return the blocks of a page that are run."""
    return "\n".join(text for language, text in _BLOCK.findall(page.read_text("utf-8")) if language != "text")


def _made(page: Path) -> set[str]:
    """Return names of files and folders that a page writes."""
    return {name.rpartition("/")[2] for names in _MADE.findall(_run(page)) for name in names if name}


def pictures(page: Path) -> list[str]:
    """Return the pictures of a page that its commands make, relative to `PICTURES`."""
    return _PICTURE.findall(page.read_text("utf-8"))


def _command(line: str) -> str:
    """Run one command of `loa` and return its output."""
    program, *arguments = shlex.split(line, comments=True)
    assert program == "loa", line
    done = CliRunner(env={"COLUMNS": "200"}).invoke(app, arguments, catch_exceptions=False)
    assert done.exit_code == 0, f"{line}: {done.output}"
    return done.output


def _python(text: str, page: Path, names: dict[str, object]) -> str:
    """Execute a block of Python on the names that blocks before it left; return its output."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(text, str(page), "exec"), names)
    return printed.getvalue()


def shown(line: str, output: str) -> bool:
    """Tell whether a line of the output begins with the same words and these numbers."""
    return any(
        _has_words_of(line, other) and _alike(line, other) == len(_NUMBER.findall(line))
        for other in output.splitlines()
    )


def nearest(line: str, output: str) -> str:
    """Return the line of the output that begins with most of the same words, then of the same numbers."""
    words = _words(line)

    def likeness(other: str) -> tuple[int, int]:
        same = [a == b for a, b in zip(words, _words(other), strict=False)]
        return [*same, False].index(False), _alike(line, other)

    return max(output.splitlines(), key=likeness, default="")


def renewed(line: str, output: str) -> str | None:
    """Return a line with today's numbers, from the one line of the output that has its words.

    Rows of a table have the same words; of them it is the one that begins with the same number.
    """
    partners = list(dict.fromkeys(other for other in output.splitlines() if _has_words_of(line, other)))
    if len(partners) > 1:
        partners = [other for other in partners if other.split()[:1] == line.split()[:1]]
    if len(partners) != 1:
        return None
    numbers = iter(_NUMBER.findall(partners[0]))
    return _NUMBER.sub(lambda _: next(numbers), line)


def _has_words_of(line: str, other: str) -> bool:
    words = _words(line)
    return words == _words(other)[: len(words)]


def _alike(line: str, other: str) -> int:
    """Count the numbers of a line that are within 2 % of those of the other in their positions."""
    pairs = zip(map(float, _NUMBER.findall(line)), map(float, _NUMBER.findall(other)), strict=False)
    return sum(abs(a - b) <= 0.02 * max(abs(a), abs(b)) for a, b in pairs)


def _words(line: str) -> list[str]:
    """Return the words of a line with a mark in place of each number."""
    return _NUMBER.sub("#", line).split()


@contextlib.contextmanager
def folder() -> Iterator[Path]:
    """Work in a temporary folder with a copy of the examples and a separate cache."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as name:
        shutil.copytree(ROOT / "examples", Path(name) / "examples")
        os.environ["XDG_CACHE_HOME"] = str(Path(name) / "cache")
        os.chdir(name)
        try:
            yield Path(name)
        finally:
            os.chdir(before)


def main(arguments: list[str]) -> None:
    """Run pages, list stale lines, and store their pictures."""
    names = {name for name in arguments if name != "--renew"}
    chosen = [page for page in pages() if not names or page.stem in names]
    unknown = names.difference(page.stem for page in chosen)
    if unknown:
        sys.exit(f"no page of this name: {', '.join(sorted(unknown))}")
    left = 0
    with folder() as made:
        for page in dict.fromkeys(first for last in chosen for first in needed(last)):
            stale = list(run_page(page))
            if page not in chosen:
                continue
            print(f"{page.relative_to(ROOT)}: {len(stale)} lines are not shown", *stale, sep="\n", flush=True)
            if "--renew" in arguments:
                renew(page, stale)
                stale = [found for found in stale if found.renewed is None]
            left += len(stale)
            for picture in pictures(page):
                (PICTURES / picture).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(made / picture, PICTURES / picture)
    sys.exit(left > 0)


if __name__ == "__main__":
    main(sys.argv[1:])
