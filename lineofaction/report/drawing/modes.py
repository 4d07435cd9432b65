"""Natural modes in plots: frequencies over speed as lines, parts of a mode as bars."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dynamics.results import RunResult
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, FloatArray, Panel, Table, number

SHOWN_MODES, LEAST_DISTANCE, CIRCULAR = 8, 0.01, 0.1
MOVES = "moves, share of the kinetic energy"
CAPTION = {
    False: "Dashed: natural frequencies about the static equilibrium",
    True: "Dashed: whirl modes about the static equilibrium, at the speeds of the run",
}
_COLOURS = {
    "natural modes": palette.ORANGE,
    "forward whirl": palette.SKY,
    "backward whirl": palette.VERMILLION,
    "whirl in a plane": palette.ORANGE,
}


@dataclass(frozen=True)
class ModeLine:
    """A mode over the blocks of a diagram: its name in the legend, color, frequency (B,), Hz, what moves.

    `shares` are those of the parts in its kinetic energy; empty for runs that do not hold them.
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
    """Return the lowest modes below `top` (Hz) that lie apart, over mesh frequencies (B,), Hz."""
    frequencies, whirls = _frequencies(run, mesh_frequency)
    modes = run.modes["over_speed"] if whirling(run) else run.modes
    kept: list[ModeLine] = []
    for index in np.argsort(frequencies[:, 0]) if frequencies.size else ():
        values = frequencies[index]
        apart = all(np.max(np.abs(line.frequency - values)) > LEAST_DISTANCE * top for line in kept)
        if 0.0 < values[0] < top and apart:
            name = _name(whirls[index]) if whirling(run) else "natural modes"
            shares = dict(modes["moves"][index]) if "moves" in modes else {}
            kept.append(ModeLine(name, _COLOURS[name], values, _most(modes, int(index)), shares))
    return kept[:SHOWN_MODES]


def _frequencies(run: RunResult, mesh_frequency: FloatArray) -> tuple[FloatArray, list[float]]:
    """Frequencies (a, B), and each mode's whirl at the highest speed."""
    if not whirling(run):
        rest = np.array(run.modes.get("frequency", ()), dtype=float)
        return np.repeat(rest[:, None], mesh_frequency.size, axis=1), [0.0] * rest.size
    over = run.modes["over_speed"]
    knots = np.array(over["mesh_frequency"][0])
    lines = [np.interp(mesh_frequency, knots, np.array(row)) for row in over["frequency"]]
    return np.array(lines).reshape(-1, mesh_frequency.size), [row[-1] for row in over["whirl"]]


def _name(whirl: float) -> str:
    if abs(whirl) < CIRCULAR:
        return "whirl in a plane"
    return "forward whirl" if whirl > 0.0 else "backward whirl"


def mode_table(run: RunResult, top: float, orders: int) -> Table | None:
    """List the modes below `top` (Hz) and the mesh orders that meet them within the speeds of the run."""
    modes = run.modes
    if not modes:
        return None
    low, high = float(run.mesh_frequency[0].min()), float(run.mesh_frequency[0].max())
    if whirling(run):
        return _whirl_table(modes["over_speed"], top, orders, (low, high))
    rows = []
    for index, (frequency, ratio) in enumerate(zip(modes["frequency"], modes["damping_ratio"], strict=True)):
        if not 0.0 < frequency < top:
            continue
        met = [(k, frequency / k) for k in range(1, orders + 1) if low <= frequency / k <= high]
        rows.append((number(frequency, 4), number(100.0 * ratio, 2), _moves(modes, index), _met(met)))
    head = (
        "natural frequency, Hz",
        "damping ratio, %",
        MOVES,
        "met by mesh order at mesh frequency",
    )
    return Table("Natural modes in the range of the diagram", head, tuple(rows))


def _whirl_table(over: dict[str, Any], top: float, orders: int, ends: tuple[float, float]) -> Table:
    """List whirl modes at rest and at the highest speed."""
    mesh = np.array(over["mesh_frequency"][0])
    rows = []
    branches = zip(over["frequency"], over["damping_ratio"], over["whirl"], strict=True)
    for index, (values, ratio, whirl) in enumerate(branches):
        line = np.array(values)
        if not 0.0 < line[0] < top:
            continue
        met = [
            (k, where)
            for k in range(1, orders + 1)
            if (where := _meeting(mesh, line - k * mesh)) is not None and ends[0] <= where <= ends[1]
        ]
        rows.append(
            (
                number(float(line[0]), 4),
                number(float(line[-1]), 4),
                number(100.0 * ratio[-1], 2),
                _name(whirl[-1]),
                _moves(over, index),
                _met(met),
            )
        )
    head = (
        "at rest, Hz",
        "at the highest speed, Hz",
        "damping ratio there, %",
        "whirl",
        MOVES,
        "met by mesh order at mesh frequency",
    )
    return Table("Whirl modes in the range of the diagram", head, tuple(rows))


def _most(modes: dict[str, Any], index: int) -> str:
    """Name what moves most in a mode."""
    return str(next(iter(modes["moves"][index])) if "moves" in modes else modes["freedom"][index])


def _moves(modes: dict[str, Any], index: int) -> str:
    """Write what moves in a mode; of a run that does not hold it, the freedom that moves most."""
    if "moves" not in modes:
        return str(modes["freedom"][index])
    return "; ".join(f"{name} {number(100.0 * share, 2)} %" for name, share in modes["moves"][index].items())


def _meeting(mesh: FloatArray, gap: FloatArray) -> float | None:
    """Mesh frequency at which a mode less an order changes its sign, linear between the speeds."""
    crossed = np.flatnonzero((gap[:-1] > 0.0) & (gap[1:] <= 0.0))
    if not crossed.size:
        return None
    i = int(crossed[0])
    return float(mesh[i] + (mesh[i + 1] - mesh[i]) * gap[i] / (gap[i] - gap[i + 1]))


def _met(met: list[tuple[int, float]]) -> str:
    return ", ".join(f"{k} at {number(where, 3)} Hz" for k, where in met) or "none"


# Modes as bars: how the energy of each is shared among parts.


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
