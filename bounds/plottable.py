"""Results that draw themselves with the figures of the report, and give the numbers drawn."""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas


class Plottable:
    """A result with plots; the program draws them, which is loaded where it made or read the result."""

    def plot(self, view: str = "", *, axes: Any = None, interactive: bool = False) -> Any:
        """Draw a figure of the report, with its bands of error.

        Raises `ImportError`: the result was made by a library alone, without ``import lineofaction``.

        Parameters
        ----------
        view : str
            Words of the figure's name or title, as ``"harmonics"``, or of the titles of its panels, as
            ``"K-chart"``; default: the first figure. A wrong one is refused with a list of all.
        axes : matplotlib Axes, or a sequence of them, optional
            One for each panel, which is drawn there; default: a new figure of pyplot.
        interactive : bool
            Return a figure of plotly in place of axes.

        Returns
        -------
        ndarray of Axes (n,), one for each panel, from top to bottom; or plotly's Figure
        """
        return _program("plot").plot(self, view, axes=axes, interactive=interactive)

    def to_dataframe(self, view: str = "") -> pandas.DataFrame:
        """Return the numbers that `plot` draws of a view, one row per point.

        Columns are panel, curve, label of the axis and coordinate in its unit (`x_axis`, `x`, `y_axis`, `y`),
        `error` (half-height of the band; NaN: none is stated), and of maps what their colors are and their
        values (`value_of`, `value`). Raises as `plot`.
        """
        frame: pandas.DataFrame = _program("to_dataframe").dataframe(self, view)
        return frame

    def main_figures(self) -> tuple[str, list[tuple[str, str]]] | None:
        """Return the title and the main figures of the report, rows of name and text.

        None where the program that draws is not loaded or not installed.
        """
        if "lineofaction" not in sys.modules:
            return None
        try:
            report = import_module("lineofaction.report.summary")
        except ModuleNotFoundError:  # the base installation has no plots
            return None
        title_and_rows: tuple[str, list[tuple[str, str]]] | None = report.summary(self)
        return title_and_rows


def _program(method: str) -> Any:
    """Return the program, which has the figures; raises `ImportError` where it is not loaded."""
    program = sys.modules.get("lineofaction")
    if program is None:
        raise ImportError(f"figures are of the program: import lineofaction, then call {method} again")
    return program
