"""The documentation site: Sphinx with MyST pages. `scripts/docs` builds it."""

import inspect
import logging
import shutil
import sys
from functools import cached_property
from importlib.metadata import version as installed
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.errors import PycodeError
from sphinx.pycode import ModuleAnalyzer

sys.path.append(str(Path(__file__).parent))  # notebook_pages
sys.path.append(str(Path(__file__).parents[1] / "scripts"))
import service_pages

# furo's styles of code (a11y_pygments) set the root logger, where nothing has, to say what every package logs
logging.basicConfig(level=logging.WARNING)

EXTRA = Path(__file__).parents[1] / "out" / "site"  # pages that scripts write: docs/lab/index.md

project = "lineofaction"
author = "the lineofaction authors"
version = release = installed("lineofaction")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "notebook_pages",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}  # the gallery writes the latter
# In the source tree alone: decisions, notes on measurements.
exclude_patterns = ["decisions/*", "lab/*", "paper/*", "validation-table.md", "gallery/*.ipynb"]
sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",  # all of them are run
    "within_subsection_order": "FileNameSortKey",
    "min_reported_time": 1000,  # s: of no use to a reader
    "capture_repr": (),
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,
    "abort_on_example_error": True,
}
myst_enable_extensions = ["deflist", "dollarmath"]
myst_heading_anchors = 4

autodoc_typehints = "none"  # signatures have them
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_ivar = True  # attributes are a list, not entries of the index

html_theme = "furo"
html_static_path = ["_static", "images/relief.wav"]
html_extra_path = [str(folder) for folder in [EXTRA] if folder.exists()]
html_css_files = ["formulas.css"]
html_title = "lineofaction"
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_copyright = False

mathjax_path = "mathjax/tex-chtml.js"


def setup(app: Sphinx) -> None:
    """Let the site bring MathJax along, list routes, and list fields in the text of their class."""
    app.connect("build-finished", _bring_mathjax)
    app.connect("source-read", _list_routes)
    app.connect("autodoc-process-docstring", _list_fields, priority=400)  # before napoleon reads the list
    app.connect("autodoc-skip-member", _is_field)


def _list_routes(_app: Sphinx, _name: str, source: list[str]) -> None:
    source[0] = service_pages.with_routes(source[0], service_pages.described)


def _list_fields(
    _app: Sphinx, what: str, _name: str, described: Any, _options: Any, lines: list[str]
) -> None:
    """Append the texts below the fields of a class to its own, as a list of attributes."""
    if what != "class":
        return
    try:
        texts = ModuleAnalyzer.for_module(described.__module__).find_attr_docs()
    except PycodeError:
        return
    entries = [(field, text) for (kind, field), text in texts.items() if kind == described.__qualname__]
    if entries and "Attributes" not in lines:
        lines += ["", "Attributes", "----------"]
        for field, text in entries:
            lines += [field, *(f"    {line}".rstrip() for line in text), ""]


def _is_field(_app: Sphinx, what: str, _name: str, member: Any, _skip: bool, _options: Any) -> bool | None:
    """Leave fields out of the entries of a class: its text lists them."""
    method = inspect.isroutine(member) or isinstance(
        member, property | cached_property | classmethod | staticmethod
    )
    return True if what == "class" and not method and not inspect.isclass(member) else None


def _bring_mathjax(app: Sphinx, failure: Exception | None) -> None:
    fonts = Path("output", "chtml", "fonts", "woff-v2")
    with as_file(files("mathjax") / "static" / "mathjax" / "es5") as package:
        there = Path(app.outdir, "_static", "mathjax")
        shutil.copytree(package / fonts, there / fonts, dirs_exist_ok=True)
        shutil.copy(package / "tex-chtml.js", there)
