"""Force that each tooth pair carries as it passes through the mesh, and its share of the load."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Note, Panel, Table, number
from lineofaction.report.tables.aligned import (
    aligned_index,
    load_labels,
    mean_over,
    middle_load,
    pitches_shown,
    position_axis,
    shown_loads,
    shown_rows,
)
from lineofaction.report.tables.pairs_in_contact import pair_range, pairs_in_words

_MOST_NAMES = 8  # of pairs that are named in full
_ROOM = 1.12  # of the largest share: for the names
_END = 0.03  # of the panel's width
_CHARACTER = 0.008  # of a name, in parts of the panel's width
_CARRIES = 1e-6  # a pair with less than this share nowhere carries load


def load_sharing(database: SteDatabase) -> Figure:
    """Draw the force on each pair against position at the lowest, middle and highest load."""
    shown = shown_loads(database)
    loads = sorted({shown[0], middle_load(database), shown[-1]})
    return Figure(
        key="load_sharing",
        title="Load sharing between tooth pairs",
        caption="One line is one pair of teeth from entering the mesh to leaving it; at every position the "
        "normal forces sum to that of the torque. Pair 0 touches at the pitch point at position 0; pair +1 "
        "is one pitch ahead.",
        alternative=_words(database, loads),
        content=tuple(_panel(database, load) for load in loads),
        table=_table(database),
    )


def pair_shares(database: SteDatabase, load: int) -> tuple[FloatArray, dict[int, FloatArray]]:
    """Follow each pair over the pitches shown.

    The database counts pairs anew at every whole pitch: its pair j is the pair j + 1 seen one pitch earlier.
    Returns the positions (n,) and, per pair that carries load somewhere, its share there.
    """
    m, d = aligned_index(database)
    position, rows = shown_rows(database)
    share = database.load_share[rows, load, m, d, :]
    first, last = int(database.pair[0]), int(database.pair[-1])
    followed = {}
    for pair in range(first - pitches_shown(database), last + 1):
        column = pair + np.floor(position).astype(int) - first
        stored = (column >= 0) & (column <= last - first)
        whole = np.where(stored, share[np.arange(rows.size), np.clip(column, 0, last - first)], 0.0)
        if np.nanmax(whole) > _CARRIES:
            followed[pair] = whole
    return position, followed


def _panel(database: SteDatabase, load: int) -> Panel:
    """One load's forces, each pair named at the middle of its way."""
    position, followed = pair_shares(database, load)
    names = {pair: _name(pair, short=len(followed) > _MOST_NAMES) for pair in followed}
    force = float(database.force[load])
    lines = tuple(
        Line(names[pair], position, force * _in_mesh(share), palette.tooth_pair(pair))
        for pair, share in followed.items()
    )
    top = _ROOM * max(float(np.nanmax(share)) for share in followed.values())
    notes = tuple(_note(line) for line in lines)
    marks = tuple(
        (force * share, f"{number(force * share, 3)} N, {100.0 * share:.0f} %")
        for share in (0.0, 0.25, 0.5, 0.75, 1.0)
        if share <= top
    )
    y = Axis("normal force on a pair, N and %", limits=(0.0, force * top), names=marks)
    return Panel(position_axis(database), y, lines, title=load_labels(database)[load], notes=notes)


def _name(pair: int, *, short: bool = False) -> str:
    number_of_pair = f"{pair:+d}" if pair else "0"
    return number_of_pair if short else f"pair {number_of_pair}"


def _note(line: Line) -> Note:
    """Name a pair over its largest share; where that is at an end of the panel, at the middle of its way."""
    drawn = np.flatnonzero(line.y > 0.0)
    high = drawn[line.y[drawn] > 0.98 * np.nanmax(line.y)]
    at_end = np.ptp(line.x[high]) < _END * np.ptp(line.x) and {high[0], high[-1]} & {0, line.x.size - 1}
    among = drawn if at_end else high
    middle = int(among[np.abs(line.x[among] - 0.5 * (line.x[among[0]] + line.x[among[-1]])).argmin()])
    return Note(
        float(line.x[middle]), float(line.y[middle]), line.name, left=bool(high[-1] == line.x.size - 1)
    )


def _in_mesh(share: FloatArray) -> FloatArray:
    """Leave out where the pair is far from carrying load; its line starts and ends at zero."""
    carries = np.concatenate([[False], share > 0.0, [False]])
    near = carries[:-2] | carries[1:-1] | carries[2:]
    return np.where(near, share, np.nan)


def _words(database: SteDatabase, loads: list[int]) -> str:
    """Say how much a pair carries at the highest load, and how long it is alone."""
    load = loads[-1]
    share = max(float(np.nanmax(one)) for one in pair_shares(database, load)[1].values())
    largest = f"{number(share * float(database.force[load]), 3)} N, {number(100.0 * share, 3)} % of the load"
    return f"A pair carries at most {largest}, at {load_labels(database)[load]}. {_alone(database, loads)}"


def _alone(database: SteDatabase, loads: list[int]) -> str:
    """Say for how much of a pitch one pair carries everything, or how many share the load."""
    if all(pair_range(database, load)[0] > 1 for load in loads):
        return (
            "; ".join(f"{pairs_in_words(database, load)} at {load_labels(database)[load]}" for load in loads)
            + ": no pair is ever alone."
        )
    m, d = aligned_index(database)
    position, rows = shown_rows(database)
    parts = []
    for load in loads:
        alone = np.nanmax(database.load_share[rows, load, m, d, :], axis=-1) > 1 - _CARRIES
        part = 100.0 * mean_over(position, alone.astype(float))
        parts.append(f"{number(part, 2)} % of the mesh cycle at {load_labels(database)[load]}")
    return f"One pair carries the whole load in {', '.join(parts)}; otherwise two or more pairs share it."


def _table(database: SteDatabase) -> Table:
    """Tabulate forces and shares at the middle load, eight positions in a pitch."""
    m, d = aligned_index(database)
    load = middle_load(database)
    steps = np.linspace(0, len(database.position), 8, endpoint=False).astype(int)
    force = float(database.force[load])
    rows = tuple(
        (number(database.position[p], 3), *(_both(force, v) for v in database.load_share[p, load, m, d, :]))
        for p in steps
    )
    head = ("position, base pitches", *(_name(int(j)) for j in database.pair))
    return Table(f"Normal force on each pair at {load_labels(database)[load]}, N", head, rows)


def _both(force: float, share: float) -> str:
    return f"{number(force * share, 3)} ({100.0 * share:.1f} %)"
