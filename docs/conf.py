"""The documentation site: Sphinx with MyST pages. `scripts/docs` builds it."""

import shutil
from importlib.metadata import version as installed
from importlib.resources import as_file, files
from pathlib import Path

from sphinx.application import Sphinx

project = "lineofaction"
author = "the lineofaction authors"
version = release = installed("lineofaction")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
]
source_suffix = {".md": "markdown"}
# In the source tree alone: decisions, and what scripts write: measurements, hard cases, licenses.
exclude_patterns = ["decisions/*", "lab/*", "licenses.md"]
myst_enable_extensions = ["deflist", "dollarmath"]
myst_heading_anchors = 4

autodoc_typehints = "none"  # signatures have them
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_ivar = True  # attributes are a list, not entries of the index

html_theme = "furo"
html_static_path = ["_static", "images/relief.wav"]
html_css_files = ["formulas.css"]
html_title = "lineofaction"
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_copyright = False

mathjax_path = "mathjax/tex-chtml.js"


def setup(app: Sphinx) -> None:
    """Let the site bring MathJax along."""
    app.connect("build-finished", _bring_mathjax)


def _bring_mathjax(app: Sphinx, failure: Exception | None) -> None:
    fonts = Path("output", "chtml", "fonts", "woff-v2")
    with as_file(files("mathjax") / "static" / "mathjax" / "es5") as package:
        there = Path(app.outdir, "_static", "mathjax")
        shutil.copytree(package / fonts, there / fonts, dirs_exist_ok=True)
        shutil.copy(package / "tex-chtml.js", there)
