"""Pages of the site from the notebooks of examples/notebooks: their text, code and stored outputs.

The outputs are those that `scripts/notebooks.py --renew` stores and the night compares; nothing is run here.
"""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docutils import nodes
from myst_parser.parsers.sphinx_ import MystParser
from sphinx.application import Sphinx

NOTEBOOKS = Path(__file__).parents[1] / "examples" / "notebooks"
PAGES = Path(__file__).parent / "notebooks"  # Sphinx reads pages below its own folder alone

_IN_TREE = re.compile(r"\.\./((?:\.\./)*)examples/(notebooks|gallery)/")
"""Links that lead to the files where a page is read in the tree, and to their pages on the site."""


class NotebookParser(MystParser):
    """Parser of a notebook as the MyST page that it amounts to."""

    supported = ("ipynb",)

    def parse(self, inputstring: str, document: nodes.document) -> None:
        """Parse the text of a notebook file into a document."""
        super().parse("\n\n".join(_blocks(json.loads(inputstring))), document)


def _blocks(notebook: dict[str, Any]) -> Iterator[str]:
    for cell in notebook["cells"]:
        text = "".join(cell["source"])
        yield text if cell["cell_type"] == "markdown" else _fenced("python", text)
        for output in cell.get("outputs", ()):
            data = {"text/plain": output.get("text", ())} | output.get("data", {})
            if picture := data.get("image/png"):
                yield f"![Figure of the cell above](data:image/png;base64,{''.join(picture.split())})"
            else:
                yield _fenced("text", "".join(data["text/plain"]))


def _fenced(language: str, text: str) -> str:
    return f"````{language}\n{text.rstrip()}\n````"


def _copy_notebooks(_app: Sphinx) -> None:
    shutil.rmtree(PAGES, ignore_errors=True)
    shutil.copytree(NOTEBOOKS, PAGES, ignore=lambda _, names: {n for n in names if not n.endswith(".ipynb")})


def _link_pages(_app: Sphinx, _name: str, source: list[str]) -> None:
    source[0] = _IN_TREE.sub(r"\1\2/", source[0]).replace("gallery/GALLERY_HEADER.rst", "gallery/index.rst")


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the parser, copy the notebooks before pages are read, and let links lead to their pages."""
    app.add_source_suffix(".ipynb", "ipynb")
    app.add_source_parser(NotebookParser)
    app.connect("builder-inited", _copy_notebooks, priority=100)
    app.connect("source-read", _link_pages)
    return {"parallel_read_safe": True}
