"""Share of the load that each tooth pair carries as it passes through the mesh."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase
from service.drawing import palette
from service.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Table, number
from service.tables.aligned import (
    aligned_index,
    load_labels,
    middle_load,
    pitches_shown,
    position_axis,
    shown_loads,
    shown_rows,
)
from service.tables.pairs_in_contact import pair_range, pairs_in_words

_CARRIES = 1e-6  # a pair with less than this share nowhere carries load


def load_sharing(database: SteDatabase) -> Figure:
    """Draw the share of each pair against position at the lowest, middle and highest load."""
    shown = shown_loads(database)
    loads = sorted({shown[0], middle_load(database), shown[-1]})
    return Figure(
        key="load_sharing",
        title="Load sharing between tooth pairs",
        caption="One line is one pair of teeth from entering the mesh to leaving it; at every position the "
        "shares sum to one. Pair 0 touches at the pitch point at position 0; pair +1 is one pitch ahead.",
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
    """One load's shares, the pair that is ahead first."""
    position, followed = pair_shares(database, load)
    lines = tuple(
        Line(f"pair {pair:+d}" if pair else "pair 0", position, _in_mesh(share), palette.category(-pair % 6))
        for pair, share in sorted(followed.items(), reverse=True)
    )
    y = Axis("share of the load", limits=(0.0, 1.05))
    return Panel(position_axis(database), y, lines, title=load_labels(database)[load])


def _in_mesh(share: FloatArray) -> FloatArray:
    """Leave out where the pair is far from carrying load; its line starts and ends at zero."""
    carries = np.concatenate([[False], share > 0.0, [False]])
    near = carries[:-2] | carries[1:-1] | carries[2:]
    return np.where(near, share, np.nan)


def _words(database: SteDatabase, loads: list[int]) -> str:
    """Say for how much of a pitch one pair carries everything, or how many share the load."""
    if all(pair_range(database, load)[0] > 1 for load in loads):
        return (
            "; ".join(f"{pairs_in_words(database, load)} at {load_labels(database)[load]}" for load in loads)
            + ": no pair is ever alone."
        )
    m, d = aligned_index(database)
    parts = []
    for load in loads:
        alone = np.nanmax(database.load_share[:, load, m, d, :], axis=-1) > 1 - _CARRIES
        parts.append(
            f"{number(100 * float(np.mean(alone)), 2)} % of the positions at {load_labels(database)[load]}"
        )
    return f"One pair carries the whole load in {', '.join(parts)}; elsewhere two or more pairs share it."


def _table(database: SteDatabase) -> Table:
    """Shares at the middle load, eight positions in a pitch."""
    m, d = aligned_index(database)
    load = middle_load(database)
    steps = np.linspace(0, len(database.position), 8, endpoint=False).astype(int)
    rows = tuple(
        (number(database.position[p], 3), *(number(v, 3) for v in database.load_share[p, load, m, d, :]))
        for p in steps
    )
    head = ("position, base pitches", *(f"pair {int(j):+d}" if j else "pair 0" for j in database.pair))
    return Table(f"Share of the load at {load_labels(database)[load]}", head, rows)
