"""Results that draw themselves with the figures of the report."""

from __future__ import annotations

import sys
from typing import Any


class Plottable:
    """A result with plots; the program draws them, which is loaded where it made or read the result."""

    def plot(self, view: str = "", *, axes: Any = None, interactive: bool = False) -> Any:
        """Draw a figure of the report, with its bands of error.

        Raises `ImportError`: the result was made by a library alone, without ``import lineofaction``.

        Parameters
        ----------
        view : str
            Words of the figure's name or title, as ``"harmonics"``; default: the first figure. A wrong one is
            refused with a list of all.
        axes : matplotlib Axes, or a sequence of them, optional
            One for each panel, which is drawn there; default: a new figure of pyplot.
        interactive : bool
            Return a figure of plotly in place of axes.

        Returns
        -------
        ndarray of Axes (n,), one for each panel, from top to bottom; or plotly's Figure
        """
        program = sys.modules.get("lineofaction")
        if program is None:
            raise ImportError("plots are drawn by the program: import lineofaction, then call plot again")
        return program.plot(self, view, axes=axes, interactive=interactive)
