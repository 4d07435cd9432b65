"""What moves in the modes of a Campbell diagram."""

from __future__ import annotations

from dynamics.orders import Waterfall
from dynamics.results import RunResult
from lineofaction.report.drawing.figure import Figure, number
from lineofaction.report.drawing.mode_bars import mode_bars
from lineofaction.report.drawing.mode_lines import ModeLine, mode_lines, whirling
from lineofaction.report.runs.campbell import top_frequency
from lineofaction.report.runs.run_view import Signal


def mode_shares(run: RunResult, signal: Signal, made: Waterfall) -> Figure | None:
    """Draw the shares of the parts in the kinetic energy of each mode of the diagram; None without modes."""
    modes = mode_lines(run, made.mesh_frequency, top_frequency(run, signal, made))
    shown = [mode for mode in modes if mode.shares]
    if not shown:
        return None
    names = [f"{number(float(mode.frequency[0]), 4)} Hz" for mode in shown]
    where = "whirl modes at the highest speed of the run" if whirling(run) else "natural modes"
    return Figure(
        key="mode_shares",
        title="What moves in the modes of the Campbell diagram",
        caption=f"Kinetic energy of the {where} by shaft and kind of motion, named by their frequency "
        "at the start of the run. Parts below a twentieth are among the others.",
        alternative=_words(shown[0], names[0]),
        content=(mode_bars(names, [mode.shares for mode in shown], "kinetic energy"),),
    )


def _words(mode: ModeLine, name: str) -> str:
    """Say what moves in the lowest mode."""
    part, share = max(mode.shares.items(), key=lambda item: item[1])
    return f"In the lowest mode, {name}, {number(100.0 * share, 2)} % of the kinetic energy are of {part}."
