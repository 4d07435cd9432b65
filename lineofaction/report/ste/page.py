"""An STE database on the page: main results, figures, accuracy, cost, effects and case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from bounds import leftover
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.answers import inserted_json, source_rows
from lineofaction.gearbox.convert.effects import by_size, influence_point, influence_text, trifles_title
from lineofaction.gearbox.units import boundary_ledger
from lineofaction.report.drawing.figure import Figure, Table, number, um
from lineofaction.report.drawing.page import Part, Section
from lineofaction.report.drawing.tables import (
    EffectRow,
    effect_table,
    effects_section,
    records,
    settings_table,
    side_by_side,
)
from lineofaction.report.pair import data_sheet_section, pair_of, tolerance_class_of
from lineofaction.report.ste.curves import drawn_loads, headline_load, load_labels, ste_curves
from lineofaction.report.ste.over_torque import (
    deviation_curves,
    face_load,
    flanks_over_torque,
    has_deviations,
    has_face_load,
    ripple_over_torque,
)
from lineofaction.report.ste.spectrum import ste_spectrum, ste_waterfall
from lineofaction.report.ste.stiffness import budget_figure, load_sharing, mesh_stiffness
from lineofaction.report.ste.teeth import tooth_sections

_RESIDUALS = ("equilibrium", "penetration", "tension", "complementarity")
_INSERTED = {
    "torque_n_m": "torques, N m",
    "misalignment_um": "misalignments, µm",
    "center_distance_change_mm": "changes of the center distance, mm",
}
_DECISIONS = {
    "name": "effect",
    "cost": "cost",
    "decision": "decision",
    "price": "price of the choice",
    "checked": "checked",
}


def static_alarms(database: SteDatabase) -> tuple[str, ...]:
    """Return the alarm that names failed points; empty if none failed."""
    return (database.failure_message(),) if database.n_failed else ()


def static_results(database: SteDatabase, force: float | None = None) -> tuple[Section, ...]:
    """Return the sections of results; what has one load is drawn at the load nearest to `force`, N."""
    pair = pair_of(database)
    sheet = () if pair is None else (data_sheet_section(pair, tolerance_class_of(database)),)
    sharing = Section("Load sharing", figures=(load_sharing(database),))
    teeth = tooth_sections(database, headline_load(database, force))
    rest = *_stiffness(database, force), *_flanks(database, force)
    return (*sheet, _transmission_error(database, force), sharing, *teeth, *rest)


def _transmission_error(database: SteDatabase, force: float | None) -> Section:
    figures = [ste_curves(database), ste_spectrum(database, force)]
    if len(drawn_loads(database)) > 1:
        figures.insert(1, ripple_over_torque(database))
        figures.append(ste_waterfall(database))
    if has_deviations(database):
        figures.append(deviation_curves(database))
    return Section("Static transmission error", figures=tuple(figures))


def _stiffness(database: SteDatabase, force: float | None) -> tuple[Section, ...]:
    """Return the section of mesh stiffness and of deflections by part; none over a period of several pitches.

    There the deflection contains the errors of single teeth, and a secant stiffness has no meaning.
    """
    if database.period > 1:
        return ()
    text = ""
    figures = [mesh_stiffness(database)]
    budget = budget_figure(database, headline_load(database, force))
    if budget is None:
        text = "The table does not contain its pair, so its deflection is not split into parts."
    else:
        figures.append(budget)
    return (Section("Mesh stiffness and deflection", text, figures=tuple(figures)),)


def _flanks(database: SteDatabase, force: float | None) -> tuple[Section, ...]:
    figures: list[Figure] = []
    if len(drawn_loads(database)) > 1:
        figures.append(flanks_over_torque(database))
    if has_face_load(database):
        figures.append(face_load(database, force))
    return (Section("Flank pressure and load along the face", figures=tuple(figures)),) if figures else ()


def static_making(database: SteDatabase) -> tuple[Section, ...]:
    """Return the sections on effects, errors, inputs and cost of the database."""
    metadata = database.metadata
    text = "Errors are half-widths of the band around each number."
    bias = metadata.receipt.get("bias")
    if bias:
        text += f" {bias['words'][0].upper()}{bias['words'][1:]}."
    tables = _accuracy(database), _by_source(database)
    accuracy = Section("Accuracy of the table", text, tables=tables, part=Part.ACCURACY)
    text = "With all defaults filled in. Numbers without a unit are in SI."
    case = Section("Case", text, folded=case_tables(metadata.case), part=Part.INPUT)
    versions = {**metadata.software_versions, "content_hash": metadata.content_hash}
    stages = metadata.receipt.get("stages")
    rows = []
    for name, times in stages.items() if isinstance(stages, dict) else ():
        cpu, wall = times.get("cpu_seconds", math.nan), times.get("wall_seconds", math.nan)
        rows.append((name, number(float(cpu), 3), number(float(wall), 3)))
    receipt = Section(
        "Receipt of the table",
        tables=(Table("Time by stage", ("stage", "CPU s", "wall s"), tuple(rows)),),
        folded=(
            settings_table("Receipt", _without(metadata.receipt, "stages")),
            settings_table("Made with", versions),
        ),
        part=Part.RECEIPT,
    )
    return contact_effects(boundary_ledger(metadata.effect_ledger)), accuracy, case, receipt


def contact_effects(ledger: Any) -> Section:
    """Tabulate the effects in the contact with reason and influence; small ones and decisions are folded."""
    entries = [{"name": k, **v} for k, v in ledger.items()] if isinstance(ledger, dict) else ledger
    large, trifles = by_size(entries)
    point = influence_point(entries)
    text = f"Effects in the contact: estimated change without each, {point}." if point else ""
    folded = [effect_table(trifles_title(trifles), map(_effect_row, trifles))] if trifles else []
    decision = [{title: entry.get(field) for field, title in _DECISIONS.items()} for entry in entries]
    folded.append(records("Decisions on the effects in the contact", decision))
    return effects_section(text, map(_effect_row, large), tuple(folded))


def _effect_row(entry: Mapping[str, Any]) -> EffectRow:
    return entry["name"], "contact", entry["on"], influence_text(entry), entry["reason"]


def case_tables(case: dict[str, Any]) -> tuple[Table, ...]:
    """Tabulate both gears side by side, then the rest of the case."""
    pair = case.get("pair")
    if not isinstance(pair, dict) or not {"pinion", "wheel"} <= set(pair):
        return (settings_table("Case", case),)
    gears = side_by_side("Gears", {"pinion (drives)": pair["pinion"], "wheel": pair["wheel"]})
    rest = {**_without(pair, "pinion", "wheel"), **_without(case, "pair")}
    return gears, settings_table("Pair, loads and accuracy", rest)


def _without(content: dict[str, Any], *names: str) -> dict[str, Any]:
    return {name: value for name, value in content.items() if name not in names}


def _accuracy(database: SteDatabase) -> Table:
    """Tabulate the worst error estimate and residuals, and inserted nodes."""
    good = ~database.failed
    relative = database.error_estimate[good] / database.static_transmission_error[good]
    rows = [("points", f"{database.status.size}, {database.n_failed} failed")]
    if np.isnan(relative).any():
        rows.append(("error estimate", "not estimated"))
    else:
        rows.append(("largest error estimate, µm", um(np.max(database.error_estimate[good]), 2)))
        rows.append(("median error estimate, % of STE", number(100.0 * float(np.median(relative)), 2)))
    worst = np.nanmax(np.abs(database.residuals[good]), axis=0)  # NaN: base pitches by derivatives
    for name, value in zip(_RESIDUALS, worst, strict=True):
        rows.append((f"largest residual, {name}", leftover(float(value), 2)))
    for axis, nodes in inserted_json(database).items():
        if axis in _INSERTED:
            inserted = ", ".join(number(node, 4) for node in nodes)
            rows.append((f"inserted to meet the tolerance, {_INSERTED[axis]}", inserted))
    return Table("Accuracy", ("quantity", "value"), tuple(rows))


def _by_source(database: SteDatabase) -> Table:
    """Tabulate the errors of the figures at the highest load by source."""
    rows = []
    for name, *errors in source_rows(database.metadata.receipt, -1):
        rows.append((name, *(um(error, 2) for error in errors)))
    head = ("source", "mean, µm", "peak to peak, µm", "harmonic 1, µm")
    return Table(f"Errors by source at {load_labels(database)[-1]}", head, tuple(rows))
