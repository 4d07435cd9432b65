"""What a table holds beside its transmission error: ripple, deviations, stiffness, sharing, deflection."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.effects import EFFECTS, ContactScene
from fe_contact.effects.influence.deflection_budget import DeflectionBudget, deflection_budget
from fe_contact.ste import Curve, SteDatabase
from fe_contact.types import BoolArray, Json
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
    unit_of,
)
from lineofaction.report.tables.pair import iso_mesh_stiffness, pair_of
from lineofaction.report.tables.ste import (
    aligned,
    aligned_index,
    few_loads,
    load_curve,
    load_labels,
    load_lines,
    mean_over,
    middle_load,
    pair_range,
    pairs_in_words,
    pitches_shown,
    position_axis,
    shown_loads,
    shown_rows,
    ste_shown,
)

HARMONICS = 8
_UM = 1e6
_DEPTH = 1e-4  # of the largest harmonic: 80 dB, the lowest level drawn
_ROOM = 0.02  # of the range of torques, beside its ends


def ripple_over_torque(database: SteDatabase) -> Figure:
    """Draw peak-to-peak with its error, and harmonics as they are and in dB, over torque."""
    curves = {load: load_curve(database, load) for load in shown_loads(database)}
    torque = np.array([curve.torque for curve in curves.values()])
    room = _ROOM * float(np.ptp(torque))
    across = Axis("torque on the driving gear, N m", limits=(torque[0] - room, torque[-1] + room))
    tones = [curve.harmonics[:HARMONICS] for curve in curves.values()]
    value, error = (
        _UM * np.array([[getattr(e, name) for e in row] for row in tones]) for name in ("value", "error")
    )
    known = ~(error >= value)  # also where no error was estimated
    level = 20.0 * np.log10(np.maximum(value, _DEPTH * value.max()))
    return Figure(
        key="ripple",
        title="Ripple over torque",
        caption="Peak-to-peak STE with the band of its error, and its mesh harmonics; dotted: below their "
        "errors.",
        alternative=_ripple_words({f"at {load_labels(database)[k]}": c for k, c in curves.items()}),
        content=(
            _ripple(across, torque, curves),
            _harmonics(across, torque, value, known, "amplitude, µm"),
            _harmonics(across, torque, level, known, "amplitude, dB re 1 µm"),
        ),
        table=_table(database, curves),
    )


def _ripple(across: Axis, torque: FloatArray, curves: dict[int, Curve]) -> Panel:
    """Draw peak-to-peak."""
    sizes = [curve.peak_to_peak for curve in curves.values()]
    value, error = (_UM * np.array(these) for these in ([e.value for e in sizes], [e.error for e in sizes]))
    line = Line("peak to peak", torque, value, palette.BLUE, markers=True, band=error)
    top = 1.05 * float(np.nanmax(value + np.nan_to_num(error)))
    return Panel(across, Axis("peak to peak, µm", limits=(0.0, top)), (line,), title="Peak to peak")


def _harmonics(across: Axis, torque: FloatArray, values: FloatArray, known: BoolArray, label: str) -> Panel:
    """Draw the harmonics (n, H), each labeled by its number; solid lines where they are known."""
    lines: list[Line] = []
    for order in range(values.shape[1]):
        name, color = f"{order + 1}", palette.ordered(order, values.shape[1])
        lines.append(Line(name, torque, values[:, order], color, "dot", 1.2, label=name))
        sure = np.where(known[:, order], values[:, order], np.nan)
        if known[:, order].any():
            lines.append(Line(name, torque, sure, color, markers=True))
    return Panel(across, Axis(label), tuple(lines), title=f"Mesh harmonics 1 to {HARMONICS}")


def _ripple_words(curves: dict[str, Curve]) -> str:
    """Say where, by the names of the curves, the ripple is least and largest, and whether that is shown."""
    ripple = {name: curve.peak_to_peak for name, curve in curves.items()}
    least, most = (ripple[end(ripple, key=lambda name: ripple[name].value)] for end in (min, max))
    where = {name: f"{number(_UM * e.value, 3)} µm {name}" for name, e in ripple.items()}
    ends = [next(where[name] for name, e in ripple.items() if e is end) for end in (least, most)]
    if most.value - least.value <= least.error + most.error:
        return f"Peak to peak, {ends[0]} to {ends[1]}, changes by no more than its errors."
    return f"Peak to peak is least, {ends[0]}, and largest, {ends[1]}."


def _table(database: SteDatabase, curves: dict[int, Curve]) -> Table:
    """Amplitudes of the harmonics at every load."""
    labels = load_labels(database)
    rows = tuple(
        (labels[load], *(number(_UM * harmonic.value, 3) for harmonic in curve.harmonics[:HARMONICS]))
        for load, curve in curves.items()
    )
    head = ("torque", *(f"harmonic {k}, µm" for k in range(1, HARMONICS + 1)))
    return Table("Mesh harmonics by load", head, rows)


# Peak-to-peak transmission error over the misalignment and center-distance axes of a database.


@dataclass(frozen=True)
class _Deviation:
    """One axis of more than one value: how it is named, its values, and the curves (n, F) there."""

    name: str
    axis: Axis
    at: FloatArray
    curves: tuple[tuple[Curve, ...], ...]

    @property
    def places(self) -> list[str]:
        """Name its values."""
        return [f"{self.name} {number(float(value), 3)} {unit_of(self.axis.label)}" for value in self.at]


def has_deviations(database: SteDatabase) -> bool:
    """Whether the database has an axis to draw over."""
    return max(database.misalignment.size, database.center_distance_change.size) > 1


def deviation_curves(database: SteDatabase) -> Figure:
    """Draw peak-to-peak STE, one line for each of a few loads, over each axis of more than one value.

    The other deviation is kept at the value nearest to zero.
    """
    deviations = _deviations(database)
    return Figure(
        key="deviations",
        title=f"Peak-to-peak transmission error over {' and '.join(d.name for d in deviations)}",
        caption="Bands: errors. Each deviation alone, the other at its stored value nearest to zero. "
        "Misalignment > 0: the gap grows towards the +z end of the face, and the load moves to the −z end. "
        "Seen from +z, the driving gear turns clockwise.",
        alternative=" ".join(_words(database, deviation) for deviation in deviations),
        content=tuple(_panel(database, deviation) for deviation in deviations),
        table=_deviation_table(database, deviations),
    )


def _deviations(database: SteDatabase) -> list[_Deviation]:
    """Return the axes of more than one value."""
    misalignment, change = aligned(database)
    skew, distance = database.misalignment, database.center_distance_change
    found = []
    if skew.size > 1:
        axis = Axis("misalignment over the common face width, µm")
        curves = tuple(_curves(database, float(m), change) for m in skew)
        found.append(_Deviation("misalignment", axis, 1e6 * skew, curves))
    if distance.size > 1:
        axis = Axis("change of the center distance, mm")
        curves = tuple(_curves(database, misalignment, float(d)) for d in distance)
        found.append(_Deviation("change of the center distance", axis, 1e3 * distance, curves))
    return found


def _curves(database: SteDatabase, misalignment: float, change: float) -> tuple[Curve, ...]:
    point = {"misalignment": misalignment, "center_distance_change": change}
    return tuple(database.curve(force=float(force), **point, allow_failed=True) for force in database.force)


def _panel(database: SteDatabase, deviation: _Deviation) -> Panel:
    """Draw peak-to-peak and its error."""
    sizes = [[curve.peak_to_peak for curve in row] for row in deviation.curves]
    value, error = (
        1e6 * np.array(these)
        for these in ([[e.value for e in row] for row in sizes], [[e.error for e in row] for row in sizes])
    )
    lines = tuple(
        replace(line, markers=True, band=error[:, k])
        for line, k in zip(load_lines(database, deviation.at, value), few_loads(database), strict=True)
    )
    top = 1.05 * max(float(np.nanmax(line.y + np.nan_to_num(line.band))) for line in lines)
    return Panel(deviation.axis, Axis("peak to peak, µm", limits=(0.0, top)), lines)


def _words(database: SteDatabase, deviation: _Deviation) -> str:
    """Say where peak to peak is least and largest at the largest load."""
    names = [f"at {name}" for name in deviation.places]
    said = _ripple_words(dict(zip(names, (row[-1] for row in deviation.curves), strict=True)))
    return f"At {load_labels(database)[-1]} {said[0].lower()}{said[1:]}"


def _deviation_table(database: SteDatabase, deviations: list[_Deviation]) -> Table:
    """Every load at every deviation."""
    loads, labels = shown_loads(database), load_labels(database)
    rows = tuple(
        (name, *(number(1e6 * row[k].peak_to_peak.value) for k in loads))
        for deviation in deviations
        for name, row in zip(deviation.places, deviation.curves, strict=True)
    )
    return Table("Peak to peak, µm", ("deviation", *(labels[k] for k in loads)), rows)


# Secant mesh stiffness per unit of face width, beside the mean mesh stiffness of ISO 6336-1.


_N_PER_MM_UM = 1e-9  # N/m per m of face width to N/(mm µm)
_CAPTION = "Transverse mesh force over static transmission error and face width."
_STANDARD = (
    " The dashed line is the mean mesh stiffness c γα of ISO 6336-1 method B, which includes a correction of "
    "0.8 for real gears."
)


def mesh_stiffness(database: SteDatabase) -> Figure:
    """Draw the transverse mesh force over STE and face width, one line per load."""
    position, values = secant_stiffness(database)
    iso = iso_mesh_stiffness(database)
    lines = load_lines(database, position, values * _N_PER_MM_UM)
    top = 1.08 * max(*(float(np.nanmax(line.y)) for line in lines), (iso or 0.0) * _N_PER_MM_UM)
    references = () if iso is None else (Reference("ISO 6336-1, c γα", iso * _N_PER_MM_UM, "horizontal"),)
    y = Axis("secant mesh stiffness, N/(mm µm)", limits=(0.0, top))
    return Figure(
        key="mesh_stiffness",
        title="Mesh stiffness",
        caption=_CAPTION + (_STANDARD if iso is not None else ""),
        alternative=_stiffness_words(database, position, values, iso),
        content=(Panel(position_axis(database), y, lines, references),),
        table=_stiffness_table(database, position, values, iso),
    )


def secant_stiffness(database: SteDatabase) -> tuple[FloatArray, FloatArray]:
    """Return the positions shown (n,) and F_bt / (STE b) there, (n, F), in N/m per m of face width."""
    position, values = ste_shown(database)
    facts = database.facts
    force = database.force * math.cos(facts.base_helix_angle)
    return position, force / (values * facts.face_width)


def _stiffness_words(
    database: SteDatabase, position: FloatArray, values: FloatArray, iso: float | None
) -> str:
    """Compare the middle load's mean with the standard's value."""
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
    """Lowest, mean and highest stiffness at every load."""
    columns = values * _N_PER_MM_UM
    rows = [
        (label, number(np.nanmin(v), 4), number(mean_over(position, v), 4), number(np.nanmax(v), 4))
        for label, v in zip(load_labels(database), columns.T, strict=True)
    ]
    if iso is not None:
        rows.append(("ISO 6336-1 method B", "", number(iso * _N_PER_MM_UM, 4), ""))
    return Table("Secant mesh stiffness, N/(mm µm)", ("torque", "lowest", "mean", "highest"), tuple(rows))


# Force that each tooth pair carries as it passes through the mesh, and its share of the load.


_MOST_NAMES = 8  # of pairs that are named in full
_SHARING_MARGIN = 1.12  # of the largest share: for the names
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
        alternative=_sharing_words(database, loads),
        content=tuple(_sharing_panel(database, load) for load in loads),
        table=_sharing_table(database),
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


def _sharing_panel(database: SteDatabase, load: int) -> Panel:
    """One load's forces, each pair named at the middle of its way."""
    position, followed = pair_shares(database, load)
    names = {pair: _name(pair, short=len(followed) > _MOST_NAMES) for pair in followed}
    force = float(database.force[load])
    lines = tuple(
        Line(names[pair], position, force * _in_mesh(share), palette.tooth_pair(pair))
        for pair, share in followed.items()
    )
    top = _SHARING_MARGIN * max(float(np.nanmax(share)) for share in followed.values())
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


def _sharing_words(database: SteDatabase, loads: list[int]) -> str:
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


def _sharing_table(database: SteDatabase) -> Table:
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


# What the mean transmission error under load is made of: teeth, bodies, contact, modifications, shafts.


_BUDGET_MARGIN = 1.2  # of the largest part: for the numbers
_NOTE = 0.4  # of the distance of bars: for the number of the last one on a narrow screen
_LEAST = 0.0005
"""Part of the mean below which there is no bar."""


def budget_figure(database: SteDatabase, load: int) -> Figure | None:
    """Draw the parts of the mean STE at a stored load as bars; None without a pair."""
    budget = _budget(database, load)
    if budget is None:
        return None
    mean = _UM * float(np.mean(budget.total))
    parts = {name: sides for name, sides in _parts(budget).items() if _counts(sides, mean)}
    table_mean = _UM * load_curve(database, load).mean.value
    return Figure(
        key="deflection_budget",
        title=f"Parts of the mean transmission error at {load_labels(database)[load]}",
        caption="Each part is its displacement along the line of action, weighted by the forces on the "
        "flanks. Teeth, bodies and contact are springs in closed form here: their mean is "
        f"{number(mean, 4)} µm, that of the table {number(table_mean, 4)} µm.",
        alternative=_budget_words(parts, mean, load_labels(database)[load]),
        content=(_budget_panel(parts, mean),),
        table=_budget_table(parts, mean),
    )


def _budget(database: SteDatabase, load: int) -> DeflectionBudget | None:
    """Split the transmission error of the table's model."""
    pair, ledger = pair_of(database), database.metadata.effect_ledger
    entries: list[Json] = (
        [{"name": k, **v} for k, v in ledger.items()] if isinstance(ledger, dict) else ledger
    )
    if pair is None:
        return None
    skew, change = (np.array([value]) for value in aligned(database))
    scene = ContactScene(pair, database.torque[load : load + 1], EFFECTS, skew, change)
    known = {effect.name for effect in EFFECTS}
    choices = {
        str(entry["name"]): "on" if entry["on"] else "off" for entry in entries if entry["name"] in known
    }
    return deflection_budget(scene, choices)


def _parts(budget: DeflectionBudget) -> dict[str, tuple[float, ...]]:
    """Return the means in um by name, one value or those of pinion and wheel."""

    def means(*values: FloatArray) -> tuple[float, ...]:
        return tuple(_UM * float(np.mean(value)) for value in values)

    return {
        "tooth bending and shear": means(*budget.teeth),
        "gear bodies": means(*budget.bodies),
        "Hertz contact": means(budget.contact),
        "shafts and bearings": means(budget.shafts),
        "flank modifications": means(budget.modification),
        "misalignment": means(budget.misalignment),
        "tip corners": means(budget.corner),
    }


def _counts(sides: tuple[float, ...], mean: float) -> bool:
    return abs(sum(sides)) > _LEAST * mean


def _budget_panel(parts: dict[str, tuple[float, ...]], mean: float) -> Panel:
    """Draw one bar for each part, its size above it."""
    place, sizes = np.arange(len(parts), dtype=float), np.array([sum(sides) for sides in parts.values()])
    notes = tuple(
        Note(
            float(x) - 0.2,
            max(float(size), 0.0),
            f"{number(float(size), 3)} µm, {number(100.0 * float(size) / mean, 2)} %",
        )
        for x, size in zip(place, sizes, strict=True)
    )
    names = tuple(zip(map(float, place), parts, strict=True))
    x = Axis("", limits=(-0.6, len(parts) + _NOTE), names=names)
    y = Axis(
        "part of the mean STE, µm",
        limits=(
            min(0.0, _BUDGET_MARGIN * float(sizes.min())),
            _BUDGET_MARGIN * float(sizes.max()),
        ),
    )
    return Panel(
        x, y, notes=notes, bars=(Bars("part of the mean STE", place, sizes, 0.0, 0.6, palette.BLUE),)
    )


def _budget_words(parts: dict[str, tuple[float, ...]], mean: float, label: str) -> str:
    """Name the largest part."""
    name = max(parts, key=lambda name: sum(parts[name]))
    size = sum(parts[name])
    share = f"{number(size, 3)} of {number(mean, 4)} µm, {number(100.0 * size / mean, 2)} %"
    return f"At {label} the largest part of the mean transmission error is of {name}: {share}."


def _budget_table(parts: dict[str, tuple[float, ...]], mean: float) -> Table:
    """Both gears' parts, their sum, and its part of the mean."""
    rows = tuple(
        (
            name,
            *(number(side, 3) if len(sides) > 1 else "" for side in (sides * 2)[:2]),
            number(sum(sides), 3),
            f"{100.0 * sum(sides) / mean:.1f}",
        )
        for name, sides in parts.items()
    )
    head = ("part", "pinion, µm", "wheel, µm", "both, µm", "% of the mean")
    return Table("Parts of the mean transmission error", head, rows)
