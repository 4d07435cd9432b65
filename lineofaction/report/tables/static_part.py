"""An STE database on the page: main results, figures, accuracy, cost, effects and case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bounds import leftover
from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate
from lineofaction.gearbox.convert.effects import by_size, influence_place, influence_words, trifles_title
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Reference, Table, number
from lineofaction.report.drawing.page import Headline, Part, Section
from lineofaction.report.drawing.tables import (
    EffectRow,
    effect_table,
    effects_section,
    facts,
    records,
    side_by_side,
)
from lineofaction.report.tables.over_torque import (
    budget_figure,
    deviation_curves,
    has_deviations,
    load_sharing,
    mesh_stiffness,
    ripple_over_torque,
)
from lineofaction.report.tables.pair import data_sheet_section, pair_of
from lineofaction.report.tables.ste import (
    aligned_index,
    headline_load,
    load_curve,
    load_labels,
    middle_load,
    position_axis,
    shown_loads,
    shown_rows,
    ste_curves,
    ste_spectrum,
)

# Position of the load along the face, and the largest pressure, over position.


def has_face_load(database: SteDatabase) -> bool:
    """Whether the load moves along the face: a table in three dimensions of a helical or misaligned pair."""
    moves = np.nanmax(database.face_centroid) - np.nanmin(database.face_centroid)
    return bool(moves > 1e-6 * database.facts.face_width)


def face_load(database: SteDatabase) -> Figure:
    """Draw load centroid and peak pressure at the middle load, one line per misalignment."""
    load, (_, d) = middle_load(database), aligned_index(database)
    centroid = 1e3 * database.face_centroid[:, load, :, d]
    pressure = 1e-6 * database.max_pressure[:, load, :, d]
    label = load_labels(database)[load]
    return Figure(
        key="face_load",
        title="Load along the face",
        caption="Above: distance of the load's centroid from the pinion's mid-face. Below: the largest Hertz "
        f"pressure anywhere on the flanks{_waves(database)}; at a tip edge the true pressure is singular.",
        alternative=f"At {label} the load acts from {number(float(np.nanmin(centroid)), 3)} to "
        f"{number(float(np.nanmax(centroid)), 3)} mm from mid-face; the largest pressure is "
        f"{number(float(np.nanmax(pressure)), 3)} MPa.",
        content=(
            Panel(
                position_axis(database),
                Axis("load centroid, mm"),
                _lines(database, centroid),
                (Reference("mid-face", 0.0, "horizontal"),),
                title=label,
            ),
            Panel(position_axis(database), Axis("largest pressure, MPa"), _lines(database, pressure)),
        ),
    )


def _waves(database: SteDatabase) -> str:
    """Say what of the pressure is the model's."""
    return (
        ", which fluctuates as the contact lines pass from slice to slice of the model"
        if database.facts.base_helix_angle
        else ""
    )


def _lines(database: SteDatabase, values: FloatArray) -> tuple[Line, ...]:
    """Draw `values` (P, M) over the pitches shown, dark for the first misalignment."""
    position, rows = shown_rows(database)
    names = [f"misalignment {number(1e6 * float(m), 3)} µm" for m in database.misalignment]
    return tuple(
        Line(
            name,
            position,
            values[rows, m],
            palette.ordered(m, len(names)),
            label=name if len(names) > 1 else "",
        )
        for m, name in enumerate(names)
    )


# Largest flank pressure and place of the load along the face over torque.


_MPA, _MM = 1e-6, 1e3
_ROOM = 0.02  # of the torques' range, at both ends


def flanks_over_torque(database: SteDatabase) -> Figure:
    """Draw the largest pressure over torque, and where the load moves along the face, its range."""
    loads = list(shown_loads(database))
    m, d = aligned_index(database)
    torque = database.torque[loads]
    pressure = _MPA * np.nanmax(database.max_pressure[:, loads, m, d], axis=0)
    centroid = _MM * database.face_centroid[:, loads, m, d]
    ends = np.stack([np.nanmin(centroid, axis=0), np.nanmean(centroid, axis=0), np.nanmax(centroid, axis=0)])
    room = _ROOM * float(np.ptp(torque))
    across = Axis("torque on the driving gear, N m", limits=(torque[0] - room, torque[-1] + room))
    y = Axis("largest pressure, MPa", limits=(0.0, 1.05 * float(pressure.max())))
    line = Line("largest pressure", torque, pressure, palette.BLUE, markers=True)
    panels: tuple[Panel, ...] = (Panel(across, y, (line,), title="Flank pressure"),)
    panels += (_centroid(across, torque, ends),) if has_face_load(database) else ()
    return Figure(
        key="flanks_over_torque",
        title="Flank pressure over torque"
        if len(panels) == 1
        else "Flank pressure and load centroid over torque",
        caption="The largest Hertz pressure of the mesh cycle at every stored load"
        + ("; below, how far the load's centroid is from the pinion's mid-face." if len(panels) > 1 else "."),
        alternative=_words(database, loads, pressure),
        content=panels,
        table=_table(database, loads, pressure, ends),
    )


def _centroid(across: Axis, torque: FloatArray, ends: FloatArray) -> Panel:
    """Draw the least, mean and largest distance from mid-face over the cycle."""
    names = ("least", "mean", "largest")
    colors = (palette.SKY, palette.BLUE, palette.VERMILLION)
    lines = tuple(
        Line(name, torque, values, color, markers=True, label=name)
        for name, values, color in zip(names, ends, colors, strict=True)
    )
    mark = Reference("mid-face", 0.0, "horizontal")
    return Panel(across, Axis("load centroid, mm"), lines, (mark,), title="Load along the face")


def _words(database: SteDatabase, loads: list[int], pressure: FloatArray) -> str:
    """Say how much the pressure grows for the growth of the torque."""
    names, torque = load_labels(database), database.torque
    first, last = loads[0], loads[-1]
    growth = f"{number(float(torque[last] / torque[first]), 3)} times the torque"
    return (
        f"The largest pressure grows from {number(float(pressure[0]), 3)} MPa at {names[first]} to "
        f"{number(float(pressure[-1]), 3)} MPa at {names[last]}: "
        f"{number(float(pressure[-1] / pressure[0]), 3)} times for {growth}."
    )


def _table(database: SteDatabase, loads: list[int], pressure: FloatArray, ends: FloatArray) -> Table:
    """Pressure and centroid at every load."""
    labels = load_labels(database)
    rows = tuple(
        (labels[k], number(float(p), 4), *(number(float(end), 3) for end in column))
        for k, p, column in zip(loads, pressure, ends.T, strict=True)
    )
    places = (f"{name} centroid, mm" for name in ("least", "mean", "largest"))
    return Table("Flanks by load", ("torque", "largest pressure, MPa", *places), rows)


_RESIDUALS = ("equilibrium", "penetration", "tension", "complementarity")
_DECISIONS = {
    "name": "effect",
    "cost": "cost",
    "decision": "decision",
    "price": "price of the choice",
    "checked": "checked",
}


_UNBOUNDED = "no error is stated for it"
"""Why the largest pressure has no error: where it is largest differs between meshes and between slices."""


def static_headlines(database: SteDatabase, force: float | None = None) -> tuple[Headline, ...]:
    """Mean and peak-to-peak STE and the largest pressure at the stored load nearest to `force` (N)."""
    load = headline_load(database, force)
    at = (slice(None), load, *aligned_index(database))
    pressure = float(np.nanmax(database.max_pressure[at]))
    edge = float(np.nanmax(database.edge_pressure[at])) if database.edge_pressure.size else 0.0
    remark = f"{_UNBOUNDED}{edge_words(edge)}"
    curve, label = load_curve(database, load), load_labels(database)[load]
    return (
        Headline(f"mean STE at {label}", f"{_um(curve.mean.value)} µm", _band(curve.mean)),
        Headline(
            f"peak-to-peak STE at {label}", f"{_um(curve.peak_to_peak.value)} µm", _band(curve.peak_to_peak)
        ),
        Headline(
            f"largest pressure at {label}",
            f"{number(1e-6 * pressure, 4)} MPa",
            remark,
        ),
    )


def edge_words(pressure: float) -> str:
    """Name the pressure (Pa) of contacts that reach an edge apart from that of the flank; nothing for 0."""
    return f"; up to {number(1e-6 * pressure, 4)} MPa at edges, indicative" if pressure > 0.0 else ""


def static_alarms(database: SteDatabase) -> tuple[str, ...]:
    """Say loudly which points failed."""
    return (database.failure_message(),) if database.n_failed else ()


def static_results(database: SteDatabase, force: float | None = None) -> tuple[Section, ...]:
    """Show what one database says of its pair; the deflection is split at the load nearest to `force` (N)."""
    pair = pair_of(database)
    sheet = () if pair is None else (data_sheet_section(pair),)
    sharing = Section("Load sharing", figures=(load_sharing(database),))
    return (*sheet, _transmission_error(database), sharing, *_stiffness(database, force), *_flanks(database))


def _transmission_error(database: SteDatabase) -> Section:
    """Show STE and its ripple over position, torque, order, misalignment and center distance."""
    figures = [ste_curves(database)]
    figures += [ripple_over_torque(database)] if len(shown_loads(database)) > 1 else []
    figures += [ste_spectrum(database)]
    figures += [deviation_curves(database)] if has_deviations(database) else []
    return Section("Static transmission error", figures=tuple(figures))


def _stiffness(database: SteDatabase, force: float | None) -> tuple[Section, ...]:
    """Show the mesh stiffness and what yields.

    Over a longer period the deflection holds the teeth's errors, and a secant through them means nothing.
    """
    if database.period > 1:
        return ()
    text, figures = "", [mesh_stiffness(database)]
    budget = budget_figure(database, headline_load(database, force))
    if budget is None:
        text = "The table does not contain its pair, so its deflection is not split into parts."
    else:
        figures.append(budget)
    return (Section("Mesh stiffness and deflection", text, figures=tuple(figures)),)


def _flanks(database: SteDatabase) -> tuple[Section, ...]:
    """Show pressure and place of the load over torque and over position."""
    figures: list[Figure] = [flanks_over_torque(database)] if len(shown_loads(database)) > 1 else []
    figures += [face_load(database)] if has_face_load(database) else []
    return (Section("Flank pressure and load along the face", figures=tuple(figures)),) if figures else ()


def static_making(database: SteDatabase) -> tuple[Section, ...]:
    """Show how exact the database is, what it cost, and what it was made from."""
    metadata = database.metadata
    text = "Errors are half-widths of the band around each number."
    accuracy = Section("Accuracy of the table", text, tables=(_accuracy(database),), part=Part.ACCURACY)
    text = "With all defaults filled in. Numbers without a unit are in SI."
    case = Section("Case", text, folded=case_tables(metadata.case), part=Part.INPUT)
    receipt = Section(
        "Receipt of the table",
        tables=(_stages(metadata.receipt),),
        folded=(facts("Receipt", _without(metadata.receipt, "stages")), _software(database)),
        part=Part.RECEIPT,
    )
    return contact_effects(metadata.effect_ledger), accuracy, case, receipt


def contact_effects(ledger: Any) -> Section:
    """Tabulate which effects were simulated, why, and their influence; trifles and decisions are folded."""
    entries = [{"name": k, **v} for k, v in ledger.items()] if isinstance(ledger, dict) else ledger
    shown, trifles = by_size(entries)
    where = influence_place(entries)
    text = f"Effects in the contact: estimated change without each, {where}." if where else ""
    folded: tuple[Table, ...] = (
        (effect_table(trifles_title(trifles), map(_effect_row, trifles)),) if trifles else ()
    )
    decided = [{title: entry.get(field) for field, title in _DECISIONS.items()} for entry in entries]
    folded += (records("Decisions on the effects in the contact", decided),)
    return effects_section(text, map(_effect_row, shown), folded)


def _effect_row(entry: Mapping[str, Any]) -> EffectRow:
    return EffectRow(entry["name"], "contact", entry["on"], influence_words(entry), entry["reason"])


def case_tables(case: dict[str, Any]) -> tuple[Table, ...]:
    """Tabulate both gears beside each other, then the rest of the case."""
    pair = case.get("pair")
    if not isinstance(pair, dict) or not {"pinion", "wheel"} <= set(pair):
        return (facts("Case", case),)
    gears = side_by_side("Gears", {"pinion (drives)": pair["pinion"], "wheel": pair["wheel"]})
    rest = {**_without(pair, "pinion", "wheel"), **_without(case, "pair")}
    return gears, facts("Pair, loads and accuracy", rest)


def _stages(receipt: dict[str, Any]) -> Table:
    """Tabulate CPU and wall seconds by stage."""
    stages = receipt.get("stages")
    entries = stages.items() if isinstance(stages, dict) else ()
    rows = tuple(
        (name, *(number(float(times.get(clock, math.nan)), 3) for clock in ("cpu_seconds", "wall_seconds")))
        for name, times in entries
    )
    return Table("Time by stage", ("stage", "CPU s", "wall s"), rows)


def _software(database: SteDatabase) -> Table:
    """Tabulate the versions and the content hash."""
    metadata = database.metadata
    return facts("Made with", {**metadata.software_versions, "content_hash": metadata.content_hash})


def _without(content: dict[str, Any], *names: str) -> dict[str, Any]:
    """Return the content without some of its fields."""
    return {name: value for name, value in content.items() if name not in names}


def _accuracy(database: SteDatabase) -> Table:
    """Worst error estimate and residuals over the table."""
    good = ~database.failed
    relative = database.error_estimate[good] / database.static_transmission_error[good]
    rows = [("points", f"{database.status.size}, {database.n_failed} failed")]
    if np.isnan(relative).any():
        rows += [("error estimate", "not estimated")]
    else:
        rows += [
            ("largest error estimate, µm", _um(float(np.max(database.error_estimate[good])), 2)),
            ("median error estimate, % of STE", number(100.0 * float(np.median(relative)), 2)),
        ]
    worst = np.max(np.abs(database.residuals[good]), axis=0)
    rows += [
        (f"largest residual, {name}", leftover(float(value), 2))
        for name, value in zip(_RESIDUALS, worst, strict=True)
    ]
    return Table("Accuracy", ("quantity", "value"), tuple(rows))


def _band(estimate: Estimate) -> str:
    return "not estimated" if math.isnan(estimate.error) else f"± {_um(estimate.error, 2)} µm"


def _um(value: float, digits: int = 4) -> str:
    return number(1e6 * value, digits)
