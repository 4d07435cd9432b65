"""Run what the manual shows: the files, commands and Python of its pages, and compare the output they show.

    python scripts/manual.py        runs tutorials and how-to guides and renews docs/images/manual

Blocks of a page are run in order. `toml` whose first line is ``# NAME.toml`` is saved under that name, `sh`
has one `loa` command a line (a backslash continues it), `python` is executed. Every line of `text` is the
beginning of a line that the command before it printed: same words, numbers within 2 %. Pages share a folder,
so that a guide can go on with the files of a tutorial.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from typer.testing import CliRunner

from lineofaction.cli.commands import app

ROOT = Path(__file__).parents[1]
PICTURES = ROOT / "docs" / "images" / "manual"
NEEDS_A_SERVICE = {"call-a-service"}  # its scripts are run by tests/flow/test_client_page.py
_BLOCK = re.compile(r"^```(toml|sh|python|text)\n(.*?)^```$", re.M | re.S)
_NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
_PICTURE = re.compile(r"\]\((?:\.\./)*images/manual/([^)]+)\)")


def pages() -> list[Path]:
    """Return the pages that run: tutorials first, in the order of their indexes."""
    return [
        index.parent / f"{name}.md"
        for index in (ROOT / "docs" / "tutorials" / "index.md", ROOT / "docs" / "how-to" / "index.md")
        for name in re.findall(r"^([a-z0-9-]+)$", index.read_text("utf-8"), re.M)
        if name not in NEEDS_A_SERVICE
    ]


def run_page(page: Path) -> None:
    """Run the blocks of a page in the working directory.

    Raises
    ------
    AssertionError
        A command failed, or what the page shows is not what came out.
    """
    output = ""
    for language, text in _BLOCK.findall(page.read_text("utf-8")):
        if language == "toml":
            name = re.match(r"# (\S+\.toml)\n", text)
            assert name, f"{page.name}: a file without its name: {text.splitlines()[0]}"
            Path(name[1]).write_text(text, encoding="utf-8")
        elif language == "sh":
            output = "".join(_command(line) for line in text.replace("\\\n", "").splitlines())
        elif language == "python":
            output = _python(text, page)
        else:
            missing = [line for line in text.splitlines() if not shown(line, output)]
            assert not missing, f"{page.name} shows {missing}\n{output}"


def pictures(page: Path) -> list[str]:
    """Return the pictures of a page that its commands make, relative to `PICTURES`."""
    return _PICTURE.findall(page.read_text("utf-8"))


def _command(line: str) -> str:
    """Run one command of `loa` and return what it printed."""
    program, *arguments = shlex.split(line, comments=True)
    assert program == "loa", line
    done = CliRunner(env={"COLUMNS": "200"}).invoke(app, arguments, catch_exceptions=False)
    assert done.exit_code == 0, f"{line}: {done.output}"
    return done.output


def _python(text: str, page: Path) -> str:
    """Execute a block and return what it printed."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(text, str(page), "exec"), {})
    return printed.getvalue()


def shown(line: str, output: str) -> bool:
    """Tell whether a line of the output begins with the same words and these numbers."""
    words, numbers = _taken_apart(line)
    return any(
        words == other[: len(words)]
        and all(abs(a - b) <= 0.02 * max(abs(a), abs(b)) for a, b in zip(numbers, found, strict=False))
        for other, found in map(_taken_apart, output.splitlines())
    )


def _taken_apart(line: str) -> tuple[list[str], list[float]]:
    """Return the words of a line with a mark in place of each number, and the numbers."""
    return _NUMBER.sub("#", line).split(), [float(number) for number in _NUMBER.findall(line)]


@contextlib.contextmanager
def folder() -> Iterator[Path]:
    """Work in a folder of its own that has the examples beside it, on a cache of its own."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as name:
        shutil.copytree(ROOT / "examples", Path(name) / "examples")
        os.environ["XDG_CACHE_HOME"] = str(Path(name) / "cache")
        os.chdir(name)
        try:
            yield Path(name)
        finally:
            os.chdir(before)


def main() -> None:
    """Run all pages and keep their pictures."""
    with folder() as made:
        for page in pages():
            run_page(page)
            for picture in pictures(page):
                (PICTURES / picture).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(made / picture, PICTURES / picture)


if __name__ == "__main__":
    main()
