"""Mesh stiffness, load sharing, and deflections by part: shares of the mean transmission error."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.effects import EFFECTS, ContactScene
from fe_contact.effects.influence.deflection_budget import DeflectionBudget, deflection_budget
from fe_contact.ste import SteDatabase
from fe_contact.types import Json
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Bars,
    Figure,
    FloatArray,
    Line,
    Note,
    Panel,
    Reference,
    Table,
    number,
)
from lineofaction.report.pair import iso_mesh_stiffness, pair_of
from lineofaction.report.ste.curves import (
    aligned,
    aligned_index,
    drawn_loads,
    drawn_pitches,
    drawn_rows,
    drawn_ste,
    load_curve,
    load_labels,
    load_lines,
    mean_over,
    middle_load,
    pair_count_text,
    pair_range,
    position_axis,
)

_N_PER_MM_UM = 1e-9  # N/m per m of face width to N/(mm µm)
_CAPTION = "Transverse mesh force over static transmission error and face width."
_STANDARD = (
    " The dashed line is the mean mesh stiffness c γα of ISO 6336-1 method B, which includes a correction of "
    "0.8 for real gears."
)
_MAX_NAMES = 8  # most pairs that are named in full
_SHARING_MARGIN = 1.12  # top of the axis over the largest share, with room for names
_END = 0.03  # share of the width within which a high part of a curve counts as its end
_CARRIES = 1e-6  # a pair with less than this share nowhere carries load
_BUDGET_MARGIN = 1.5  # top of the axis over the largest part, with room for two lines of numbers
_NOTE = 0.1  # room over the distance of bars for the number of the last bar on a narrow screen
_MIN = 0.0005
"""Part of the mean below which there is no bar."""


def mesh_stiffness(database: SteDatabase) -> Figure:
    """Draw the transverse mesh force over STE and face width, one line per load."""
    position, values = secant_stiffness_curves(database)
    iso = iso_mesh_stiffness(database)
    lines = load_lines(database, position, values * _N_PER_MM_UM)
    top = 1.08 * max(*(float(np.nanmax(line.y)) for line in lines), (iso or 0.0) * _N_PER_MM_UM)
    references = () if iso is None else (Reference("ISO 6336-1, c γα", iso * _N_PER_MM_UM, "horizontal"),)
    y = Axis("secant mesh stiffness, N/(mm µm)", limits=(0.0, top))
    return Figure(
        key="mesh_stiffness",
        title="Mesh stiffness",
        caption=_CAPTION + (_STANDARD if iso is not None else ""),
        alternative=_stiffness_text(database, position, values, iso),
        content=(Panel(position_axis(database), y, lines, references),),
        table=_stiffness_table(database, position, values, iso),
    )


def secant_stiffness_curves(database: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """Return the positions shown (n,) and F_bt / (STE b) there, (n, F), in N/m per m of face width."""
    position, values = drawn_ste(database)
    geometry = database.geometry
    force = database.force * math.cos(geometry.base_helix_angle)
    return position, force / (values * geometry.face_width)


def _stiffness_text(
    database: SteDatabase, position: FloatArray, values: FloatArray, iso: float | None
) -> str:
    load = middle_load(database)
    mean = mean_over(position, values[:, load]) * _N_PER_MM_UM
    text = f"Mean {number(mean, 3)} N/(mm µm) at {load_labels(database)[load]}"
    if iso is None:
        return f"{text}."
    standard = iso * _N_PER_MM_UM
    beyond = 100.0 * (mean / standard - 1.0)
    side = "above" if beyond > 0.0 else "below"
    return f"{text}, {number(abs(beyond), 2)} % {side} the {number(standard, 4)} N/(mm µm) of ISO 6336-1."


def _stiffness_table(
    database: SteDatabase, position: FloatArray, values: FloatArray, iso: float | None
) -> Table:
    columns = values * _N_PER_MM_UM
    rows = [
        (label, number(np.nanmin(v), 4), number(mean_over(position, v), 4), number(np.nanmax(v), 4))
        for label, v in zip(load_labels(database), columns.T, strict=True)
    ]
    if iso is not None:
        rows.append(("ISO 6336-1 method B", "", number(iso * _N_PER_MM_UM, 4), ""))
    return Table("Secant mesh stiffness, N/(mm µm)", ("torque", "lowest", "mean", "highest"), tuple(rows))


def load_sharing(database: SteDatabase) -> Figure:
    """Draw the force on each pair against position at the lowest, middle and highest load."""
    drawn = drawn_loads(database)
    loads = sorted({drawn[0], middle_load(database), drawn[-1]})
    heaviest = loads[-1]
    m, d = aligned_index(database)
    share = float(np.nanmax(database.load_share[:, heaviest, m, d]))
    force = f"{number(share * float(database.force[heaviest]), 3)} N"
    pitches, period = drawn_pitches(database), database.period
    truncated = f" Shown are the first {pitches} of {period} base pitches." if pitches < period else ""
    return Figure(
        key="load_sharing",
        title="Load sharing between tooth pairs",
        caption="One line is one pair of teeth from entering the mesh to leaving it; at every position the "
        "normal forces sum to that of the torque. Pair 0 touches at the pitch point at position 0; pair +1 "
        f"is one pitch ahead.{truncated}",
        alternative=f"A pair carries at most {force}, {number(100.0 * share, 3)} % of the load, at "
        f"{load_labels(database)[heaviest]}. {_alone(database, loads)}",
        content=tuple(_sharing_panel(database, load) for load in loads),
        table=_sharing_table(database),
    )


def pair_shares(database: SteDatabase, load: int) -> tuple[FloatArray, dict[int, FloatArray]]:
    """Return the positions shown (n,), and the shares there of each pair that carries load at any of them.

    The database counts pairs anew at every whole pitch: its pair j is the pair j + 1 seen one pitch earlier.
    """
    m, d = aligned_index(database)
    position, rows = drawn_rows(database)
    share = database.load_share[rows, load, m, d, :]
    first, last = int(database.pair[0]), int(database.pair[-1])
    followed = {}
    for pair in range(first - drawn_pitches(database), last + 1):
        column = pair + np.floor(position).astype(int) - first
        stored = (column >= 0) & (column <= last - first)
        complete = np.where(stored, share[np.arange(rows.size), np.clip(column, 0, last - first)], 0.0)
        if np.nanmax(complete) > _CARRIES:
            followed[pair] = complete
    return position, followed


def _sharing_panel(database: SteDatabase, load: int) -> Panel:
    """Draw the forces of one load, each pair named at the middle of its way."""
    position, followed = pair_shares(database, load)
    force = float(database.force[load])
    lines = []
    for pair, share in followed.items():
        name = _name(pair, short=len(followed) > _MAX_NAMES)
        lines.append(Line(name, position, force * _in_mesh(share), palette.tooth_pair(pair)))
    top = _SHARING_MARGIN * max(float(np.nanmax(share)) for share in followed.values())
    marks = []
    for part in (0.0, 0.25, 0.5, 0.75, 1.0):
        if part <= top:
            marks.append((force * part, f"{number(force * part, 3)} N, {100.0 * part:.0f} %"))
    axes = (
        position_axis(database),
        Axis("normal force on a pair, N and %", limits=(0.0, force * top), names=tuple(marks)),
    )
    title, notes = load_labels(database)[load], tuple(map(_note, lines))
    return Panel(*axes, tuple(lines), title=title, notes=notes)


def _name(pair: int, *, short: bool = False) -> str:
    number_of_pair = f"{pair:+d}" if pair else "0"
    return number_of_pair if short else f"pair {number_of_pair}"


def _note(line: Line) -> Note:
    """Name a pair over its largest share; where that is at an end of the panel, at the middle of its way."""
    drawn = np.flatnonzero(line.y > 0.0)
    high = drawn[line.y[drawn] > 0.98 * np.nanmax(line.y)]
    at_end = np.ptp(line.x[high]) < _END * np.ptp(line.x) and {high[0], high[-1]} & {0, line.x.size - 1}
    among = drawn if at_end else high
    center = 0.5 * (line.x[among[0]] + line.x[among[-1]])
    middle = int(among[np.abs(line.x[among] - center).argmin()])
    left = bool(high[-1] == line.x.size - 1)
    return Note(float(line.x[middle]), float(line.y[middle]), line.name, left=left)


def _in_mesh(share: FloatArray) -> FloatArray:
    """Return a share without the positions far from load; its line begins and ends at zero."""
    carries = np.concatenate([[False], share > 0.0, [False]])
    near = carries[:-2] | carries[1:-1] | carries[2:]
    return np.where(near, share, np.nan)


def _alone(database: SteDatabase, loads: list[int]) -> str:
    labels = load_labels(database)
    if all(pair_range(database, load)[0] > 1 for load in loads):
        counts = "; ".join(f"{pair_count_text(database, load)} at {labels[load]}" for load in loads)
        return f"{counts}: no pair is ever alone."
    m, d = aligned_index(database)
    position = np.append(database.position, database.period)
    parts = []
    for load in loads:
        alone = np.nanmax(database.load_share[:, load, m, d, :], axis=-1) > 1 - _CARRIES
        part = 100.0 * mean_over(position, np.append(alone, alone[0]).astype(float))
        parts.append(f"{number(part, 2)} % of the mesh cycle at {labels[load]}")
    return f"One pair carries the whole load in {', '.join(parts)}; otherwise two or more pairs share it."


def _sharing_table(database: SteDatabase) -> Table:
    m, d = aligned_index(database)
    load = middle_load(database)
    steps = np.linspace(0, len(database.position), 8, endpoint=False).astype(int)
    force = float(database.force[load])
    rows = []
    for p in steps:
        shares = database.load_share[p, load, m, d, :]
        forces = (f"{number(force * share, 3)} ({100.0 * share:.1f} %)" for share in shares)
        rows.append((number(database.position[p], 3), *forces))
    head = ("position, base pitches", *(_name(int(j)) for j in database.pair))
    return Table(f"Normal force on each pair at {load_labels(database)[load]}, N", head, tuple(rows))


def budget_figure(database: SteDatabase, load: int) -> Figure | None:
    """Draw the parts of the mean STE at a stored load as bars; None without a pair."""
    budget = _budget(database, load)
    if budget is None:
        return None
    mean = 1e6 * float(np.mean(budget.total))
    parts = {name: sides for name, sides in _parts(budget).items() if abs(sum(sides)) > _MIN * mean}
    table_mean = 1e6 * load_curve(database, load).mean.value
    return Figure(
        key="deflection_budget",
        title=f"Parts of the mean transmission error at {load_labels(database)[load]}",
        caption="Each part is its displacement along the line of action, weighted by the forces on the "
        "flanks. Teeth, bodies and contact are springs in closed form here: their mean is "
        f"{number(mean, 4)} µm, that of the table {number(table_mean, 4)} µm.",
        alternative=_budget_text(parts, mean, load_labels(database)[load]),
        content=(_budget_panel(parts, mean),),
        table=_budget_table(parts, mean),
    )


def _budget(database: SteDatabase, load: int) -> DeflectionBudget | None:
    pair = pair_of(database)
    if pair is None:
        return None
    skew, change = (np.array([value]) for value in aligned(database))
    scene = ContactScene(pair, database.torque[load : load + 1], EFFECTS, skew, change)
    ledger = database.metadata.effect_ledger
    entries: list[Json] = (
        [{"name": k, **v} for k, v in ledger.items()] if isinstance(ledger, dict) else ledger
    )
    choices = {str(entry["name"]): "on" if entry["on"] else "off" for entry in entries}
    known = {effect.name for effect in EFFECTS}
    return deflection_budget(scene, {name: choices[name] for name in choices if name in known})


def _parts(budget: DeflectionBudget) -> dict[str, tuple[float, ...]]:
    """Return the means in um by name, one value, or two for pinion and wheel."""

    def means(*values: FloatArray) -> tuple[float, ...]:
        return tuple(1e6 * float(np.mean(value)) for value in values)

    return {
        "tooth bending and shear": means(*budget.teeth),
        "gear bodies": means(*budget.bodies),
        "Hertz contact": means(budget.contact),
        "shafts and bearings": means(budget.shafts),
        "flank modifications": means(budget.modification),
        "misalignment": means(budget.misalignment),
        "tip corners": means(budget.corner),
    }


def _budget_panel(parts: dict[str, tuple[float, ...]], mean: float) -> Panel:
    position = np.arange(float(len(parts)))
    sizes = np.array([sum(sides) for sides in parts.values()])
    notes = []
    for x, size in zip(position, sizes, strict=True):
        text = f"{number(size, 3)} µm\n{number(100.0 * float(size) / mean, 2)} %"  # narrower than a bar
        notes.append(Note(float(x) - 0.3, max(float(size), 0.0), text))
    ends = (min(0.0, _BUDGET_MARGIN * float(sizes.min())), _BUDGET_MARGIN * float(sizes.max()))
    bars = Bars("part of the mean STE", position, sizes, base=0.0, width=0.6, color=palette.BLUE)
    axes = Axis.of_names(tuple(parts), beyond=_NOTE), Axis("part of the mean STE, µm", limits=ends)
    return Panel(*axes, notes=tuple(notes), bars=(bars,))


def _budget_text(parts: dict[str, tuple[float, ...]], mean: float, label: str) -> str:
    name = max(parts, key=lambda name: sum(parts[name]))
    size = sum(parts[name])
    share = f"{number(size, 3)} of {number(mean, 4)} µm, {number(100.0 * size / mean, 2)} %"
    return f"At {label} the largest part of the mean transmission error is of {name}: {share}."


def _budget_table(parts: dict[str, tuple[float, ...]], mean: float) -> Table:
    rows = []
    for name, sides in parts.items():
        gears = [number(side, 3) for side in sides] if len(sides) > 1 else ["", ""]
        rows.append((name, *gears, number(sum(sides), 3), f"{100.0 * sum(sides) / mean:.1f}"))
    head = ("part", "pinion, µm", "wheel, µm", "both, µm", "% of the mean")
    return Table("Parts of the mean transmission error", head, tuple(rows))
