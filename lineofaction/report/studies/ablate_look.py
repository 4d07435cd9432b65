"""The look of ablations of cases and of scenes: what both have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, FloatArray, Line, Panel, Table


@dataclass(frozen=True)
class Look:
    """The look of an ablation.

    ``change(ablation, entry)`` is the change of peak-to-peak by leaving an effect out, m; `signed` writes one
    in um. `caption` says how to read the plot, `table` lists all effects in figures.
    """

    what: str
    title: str
    change: Callable[[Any, Any], float]
    signed: Callable[[float], str]
    caption: Callable[[Any], str]
    panels: Callable[[Any], tuple[Panel, ...]]
    table: Callable[[Any], Table]

    def words(self, ablation: Any, entry: Any) -> str:
        """Write the change of peak-to-peak by leaving an effect out."""
        return f"{self.signed(1e6 * self.change(ablation, entry))} µm"

    def ordered(self, ablation: Any) -> list[Any]:
        """Return the effects, the largest change of peak-to-peak first."""
        return sorted(ablation.effects, key=lambda entry: -abs(self.change(ablation, entry)))


def over_orders(
    ablation: Any, amplitude: Callable[[Any], FloatArray], title: str, label: str, unit: float
) -> Panel:
    """Draw amplitudes over the mesh orders: as decided, and with each effect toggled."""
    states = [("as decided", ablation.nominal)]
    states += [(f"{'without' if row.on else 'with'} {row.name}", row.toggled) for row in ablation.effects]
    lines = [
        _line(index, name.replace("_", " "), unit * amplitude(figures))
        for index, (name, figures) in enumerate(states)
    ]
    drawn = tuple(line for line in lines if not np.isnan(line.y).all())
    return Panel(Axis("mesh order"), Axis(label, "log"), drawn, title=title)


def _line(index: int, name: str, amplitude: FloatArray) -> Line:
    """One state; nothing is drawn where there is no vibration."""
    order = np.arange(1, amplitude.size + 1, dtype=float)
    color = palette.INK if index == 0 else palette.category(index - 1)
    width = 2.6 if index == 0 else 1.2
    return Line(
        name, order, np.where(amplitude > 0.0, amplitude, np.nan), color, "solid", width, markers=True
    )
