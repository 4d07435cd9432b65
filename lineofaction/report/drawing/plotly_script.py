"""The JavaScript of plotly, from its wheel."""

from __future__ import annotations

from importlib.resources import files


def plotly_script() -> str:
    """Return plotly.js, whole and minified; of the Python package nothing else is loaded."""
    return (files("plotly") / "package_data" / "plotly.min.js").read_text("utf-8")
