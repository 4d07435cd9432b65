"""The documentation site: Sphinx with MyST pages. `scripts/docs` builds it."""

from importlib.metadata import version as installed

project = "lineofaction"
author = "the lineofaction authors"
version = release = installed("lineofaction")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
source_suffix = {".md": "markdown"}
# In the source tree alone: decisions, and what scripts write: measurements, hard cases, licenses.
exclude_patterns = ["decisions/*", "lab/*", "licenses.md"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 4

autodoc_typehints = "none"  # signatures have them
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_ivar = True  # attributes are a list, not entries of the index

html_theme = "furo"
html_title = "lineofaction"
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_copyright = False
