"""Modes as bars: how the energy of each is shared among parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Panel

OTHERS = "others"
_WIDTH = 0.62


def mode_bars(modes: Sequence[str], shares: Sequence[Mapping[str, float]], energy: str) -> Panel:
    """Draw a bar for each mode, made up of its parts' shares of an energy.

    Parameters
    ----------
    modes : sequence of str, (a,)
        Names, below the bars.
    shares : sequence of mapping of str to float, (a,)
        By part, each at least 0; the rest up to 1 is drawn as others.
    energy : str
        Of the label.
    """
    place, base = np.arange(len(modes), dtype=float), np.zeros(len(modes))
    bars = []
    for index, part in enumerate(largest_parts(shares)):
        top = base + [100.0 * of.get(part, 0.0) for of in shares]
        bars.append(Bars(part, place, top, base, _WIDTH, palette.CATEGORIES[index]))
        base = top
    rest = np.where(base > 0.0, 100.0, 0.0)
    if np.any(rest > base + 0.5):
        bars.append(Bars(OTHERS, place, rest, base, _WIDTH, palette.GRID))
    names = tuple(zip(map(float, place), modes, strict=True))
    x = Axis("mode", limits=(-0.6, len(modes) - 0.4), names=names)
    return Panel(x, Axis(f"share of the {energy}, %", limits=(0.0, 100.0)), bars=tuple(bars))


def largest_parts(shares: Sequence[Mapping[str, float]]) -> list[str]:
    """Return the parts that have most of the energy of all modes together, as many as there are colors."""
    total: dict[str, float] = {}
    for of in shares:
        for part, share in of.items():
            total[part] = total.get(part, 0.0) + share
    return sorted(total, key=lambda part: -total[part])[: len(palette.CATEGORIES)]
