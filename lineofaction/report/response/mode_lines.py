"""Natural modes of a run: their lines over speed, their table, and their moving parts.

The modes of a run belong to its equilibrium at rest, or they whirl and change their frequency with speed. An
order meets a mode at the mesh frequency whose multiple by that order is the mode's frequency. B: blocks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dynamics.results import RunResult
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, FloatArray, Panel, Table, number

MAX_MODES, MIN_DISTANCE = 8, 0.01
"""Most lines in a diagram, and least distance of two lines over its highest frequency."""
_CIRCULAR = 0.1  # least size of a whirl, 1 on a circle, that has a sense
MOVES, MET = "moves, share of the kinetic energy", "met by mesh order at mesh frequency"
MODES_CAPTION = {
    False: "Dashed: natural frequencies about the static equilibrium",
    True: "Dashed: whirl modes about the static equilibrium, at the speeds of the run",
}
_COLORS = {
    "natural modes": palette.ORANGE,
    "forward whirl": palette.SKY,
    "backward whirl": palette.VERMILLION,
    "whirl in a plane": palette.ORANGE,
}
OTHERS = "others"
_WIDTH = 0.62  # of a bar


@dataclass(frozen=True)
class ModeLine:
    """A mode over the blocks of a diagram: legend, color, frequency (B,), Hz, and the part that moves most.

    `shares` maps parts to their shares of the kinetic energy; empty for runs that do not hold them.
    """

    name: str
    color: str
    frequency: FloatArray
    moves: str
    shares: dict[str, float]


def whirling(run: RunResult) -> bool:
    """Whether the run has modes over speed."""
    return "over_speed" in run.modes


def mode_lines(run: RunResult, mesh_frequency: FloatArray, top: float) -> list[ModeLine]:
    """Return lines of the lowest modes below `top`, Hz, that do not overlap, over mesh frequencies (B,)."""
    frequencies, whirls = _frequencies(run, mesh_frequency)
    modes = run.modes["over_speed"] if whirling(run) else run.modes
    lines: list[ModeLine] = []
    for index in np.argsort(frequencies[:, 0]) if frequencies.size else ():
        values = frequencies[index]
        is_separate = all(np.max(np.abs(line.frequency - values)) > MIN_DISTANCE * top for line in lines)
        if 0.0 < values[0] < top and is_separate:
            name = whirl_name(whirls[index]) if whirling(run) else "natural modes"
            shares = dict(modes["moves"][index]) if "moves" in modes else {}
            part = str(next(iter(shares)) if "moves" in modes else modes["freedom"][int(index)])
            lines.append(ModeLine(name, _COLORS[name], values, part, shares))
    return lines[:MAX_MODES]


def _frequencies(run: RunResult, mesh_frequency: FloatArray) -> tuple[FloatArray, list[float]]:
    """Return the frequencies (modes, B), Hz, and each mode's whirl at the highest speed."""
    if not whirling(run):
        rest = np.array(run.modes.get("frequency", ()), dtype=float)
        return np.repeat(rest[:, None], mesh_frequency.size, axis=1), [0.0] * rest.size
    over = run.modes["over_speed"]
    knots = np.array(over["mesh_frequency"][0])
    lines = [np.interp(mesh_frequency, knots, np.array(row)) for row in over["frequency"]]
    return np.array(lines).reshape(-1, mesh_frequency.size), [row[-1] for row in over["whirl"]]


def whirl_name(whirl: float) -> str:
    """Return the name of a whirl mode by its sense: 1 forward, -1 backward, about 0 in a plane."""
    if abs(whirl) < _CIRCULAR:
        return "whirl in a plane"
    return "forward whirl" if whirl > 0.0 else "backward whirl"


def mode_table(run: RunResult, top: float, orders: int) -> Table | None:
    """List the modes below `top` (Hz) and the mesh orders that meet them within the speeds of the run."""
    if not run.modes:
        return None
    low, high = float(run.mesh_frequency[0].min()), float(run.mesh_frequency[0].max())
    whirls = whirling(run)
    modes = run.modes["over_speed"] if whirls else run.modes
    rows = []
    for index, (frequency, ratio) in enumerate(zip(modes["frequency"], modes["damping_ratio"], strict=True)):
        line, damping = np.atleast_1d(frequency), np.atleast_1d(ratio)
        if not 0.0 < line[0] < top:
            continue
        ends = (line[0], line[-1]) if whirls else line
        frequencies = [number(end, 4) for end in ends]
        whirl = (whirl_name(modes["whirl"][index][-1]),) if whirls else ()
        met = _met(modes["mesh_frequency"][0] if whirls else None, line, orders, (low, high))
        rows.append((*frequencies, number(100.0 * float(damping[-1]), 2), *whirl, _moves(modes, index), met))
    if whirls:
        over_speed = ("at rest, Hz", "at the highest speed, Hz", "damping ratio there, %", "whirl")
        return Table("Whirl modes in the range of the diagram", (*over_speed, MOVES, MET), tuple(rows))
    head = ("natural frequency, Hz", "damping ratio, %", MOVES, MET)
    return Table("Natural modes in the range of the diagram", head, tuple(rows))


def _moves(modes: dict[str, Any], index: int) -> str:
    """Return the moving parts of a mode as text; if they are not known, the freedom that moves most."""
    if "moves" not in modes:
        return str(modes["freedom"][index])
    return "; ".join(f"{name} {number(100.0 * share, 2)} %" for name, share in modes["moves"][index].items())


def _meeting(mesh: FloatArray, line: FloatArray, order: int) -> float | None:
    """Return the mesh frequency at which an order meets a mode from below; None if it does not."""
    gap = line - order * mesh
    crossed = np.flatnonzero((gap[:-1] > 0.0) & (gap[1:] <= 0.0))
    if not crossed.size:
        return None
    i = int(crossed[0])
    # linear between neighboring speeds
    return float(mesh[i] + (mesh[i + 1] - mesh[i]) * gap[i] / (gap[i] - gap[i + 1]))


def _met(mesh: list[float] | None, line: FloatArray, orders: int, ends: tuple[float, float]) -> str:
    """Name the orders up to `orders` that meet a mode between the mesh frequencies `ends`.

    `line` is the mode's frequency over the mesh frequencies `mesh`; without `mesh` it is one number.
    """
    meetings = []
    for order in range(1, orders + 1):
        meeting = float(line[0]) / order if mesh is None else _meeting(np.array(mesh), line, order)
        if meeting is not None and ends[0] <= meeting <= ends[1]:
            meetings.append(f"{order} at {number(meeting, 3)} Hz")
    return ", ".join(meetings) or "none"


def mode_bars(modes: Sequence[str], shares: Sequence[Mapping[str, float]], energy: str) -> Panel:
    """Draw a bar for each mode, made up of its parts' shares of an energy.

    Parameters
    ----------
    modes : sequence of str, (a,)
        Names, below the bars.
    shares : sequence of mapping of str to float, (a,)
        Shares by part, each at least 0; the rest up to 1 is drawn as others.
    energy : str
        Name of the energy in the label.
    """
    position, base = np.arange(float(len(modes))), np.zeros(len(modes))
    bars = []
    for index, part in enumerate(_largest_parts(shares)):
        top = base + [100.0 * mode_shares.get(part, 0.0) for mode_shares in shares]
        bars.append(Bars(part, position, top, base, width=_WIDTH, color=palette.CATEGORIES[index]))
        base = top
    rest = np.where(base > 0.0, 100.0, 0.0)
    if np.any(rest > base + 0.5):  # half a per cent is not drawn
        bars.append(Bars(OTHERS, position, rest, base, width=_WIDTH, color=palette.GRID))
    share = Axis(f"share of the {energy}, %", limits=(0.0, 100.0))
    return Panel(Axis.of_names(modes, "mode"), share, bars=tuple(bars))


def _largest_parts(shares: Sequence[Mapping[str, float]]) -> list[str]:
    """Return the parts with the largest energy in all modes together, as many as there are colors."""
    total: dict[str, float] = {}
    for mode_shares in shares:
        for part, share in mode_shares.items():
            total[part] = total.get(part, 0.0) + share
    return sorted(total, key=lambda part: -total[part])[: len(palette.CATEGORIES)]
