"""An STE database on the page: main results, figures, accuracy, cost, effects and case."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate
from service.convert.effect_sizes import by_size, influence_place, influence_words, trifles_title
from service.drawing.facts import facts, records, side_by_side
from service.drawing.figure import Table, number
from service.drawing.page import Headline, Section
from service.tables.aligned import headline_load, load_curve, load_labels, shown_loads
from service.tables.data_sheet import data_sheet_section
from service.tables.deviation_curves import deviation_curves, has_deviations
from service.tables.face_load import face_load, has_face_load
from service.tables.load_sharing import load_sharing
from service.tables.mesh_stiffness import mesh_stiffness
from service.tables.pair import pair_of
from service.tables.ripple_over_torque import ripple_over_torque
from service.tables.ste_curves import ste_curves
from service.tables.ste_spectrum import ste_spectrum

_RESIDUALS = ("equilibrium", "penetration", "tension", "complementarity")
_LEDGER = (
    ("name", "effect"),
    ("on", "simulated"),
    ("reason", "because"),
    ("without", "without it"),
    ("cost", "cost"),
    ("decision", "decision"),
    ("price", "price of the choice"),
    ("checked", "checked"),
)


def static_headlines(database: SteDatabase, force: float | None = None) -> tuple[Headline, ...]:
    """Mean and peak-to-peak STE at the stored load nearest to `force` (N), or the middle one."""
    load = headline_load(database, force)
    curve, label = load_curve(database, load), load_labels(database)[load]
    return (
        Headline(f"mean STE at {label}", f"{_um(curve.mean.value)} µm", _band(curve.mean)),
        Headline(
            f"peak-to-peak STE at {label}", f"{_um(curve.peak_to_peak.value)} µm", _band(curve.peak_to_peak)
        ),
    )


def static_alarms(database: SteDatabase) -> tuple[str, ...]:
    """Say loudly which points failed."""
    return (database.failure_message(),) if database.n_failed else ()


def static_results(database: SteDatabase) -> tuple[Section, ...]:
    """Show what one database says of its pair."""
    over_torque = (ripple_over_torque(database),) if len(shown_loads(database)) > 1 else ()
    drawn = (ste_curves(database), *over_torque, ste_spectrum(database), load_sharing(database))
    curves = Section("Static transmission error", figures=drawn)
    # over a longer period the deflection holds the teeth's errors, and a secant through them means nothing
    secant = (Section("Mesh stiffness", figures=(mesh_stiffness(database),)),) if database.period == 1 else ()
    pair = pair_of(database)
    sheet = () if pair is None else (data_sheet_section(pair),)
    return (*sheet, curves, *_across_face(database), *secant)


def _across_face(database: SteDatabase) -> tuple[Section, ...]:
    """Show the deviations and the face, where the database has any of them."""
    figures = [deviation_curves(database)] if has_deviations(database) else []
    figures += [face_load(database)] if has_face_load(database) else []
    title = "Misalignment, center distance and the face"
    return (Section(title, figures=tuple(figures)),) if figures else ()


def static_making(database: SteDatabase) -> tuple[Section, ...]:
    """Show how exact the database is, what it cost, and what it was made from."""
    metadata = database.metadata
    accuracy = Section(
        "Accuracy and cost of the table",
        "Errors are half-widths of the band around each number; the receipt says where the time went.",
        tables=(_accuracy(database), _stages(metadata.receipt)),
        folded=(facts("Receipt", _without(metadata.receipt, "stages")), _software(database)),
    )
    effects = effects_section(metadata.effect_ledger)
    text = "With every default that was taken. Numbers without a unit are in SI."
    case = Section("Case", text, tables=case_tables(metadata.case))
    return accuracy, effects, case


def effects_section(ledger: Any) -> Section:
    """Tabulate which effects were simulated, why, and their influence; trifles are folded away."""
    entries = [{"name": k, **v} for k, v in ledger.items()] if isinstance(ledger, dict) else ledger
    shown, trifles = by_size(entries)
    where = influence_place(entries)
    caption = f"Effect ledger; without an effect: change by leaving it out, estimated {where}"
    main = _ledger_table(caption, shown) if where else records("Effect ledger", _columns(entries))
    folded = (_ledger_table(trifles_title(trifles), trifles),) if trifles else ()
    return Section("Effects", tables=(main,), folded=folded)


def _ledger_table(caption: str, entries: Sequence[Mapping[str, Any]]) -> Table:
    """Tabulate effects."""
    return records(caption, _columns([{**entry, "without": influence_words(entry)} for entry in entries]))


def _columns(entries: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return what is tabulated of a ledger; without estimates there is no column for them."""
    fields = [
        (field, title) for field, title in _LEDGER if field != "without" or any(field in e for e in entries)
    ]
    return [{title: entry.get(field) for field, title in fields} for entry in entries]


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
        (f"largest residual, {name}", number(float(value), 2))
        for name, value in zip(_RESIDUALS, worst, strict=True)
    ]
    return Table("Accuracy", ("quantity", "value"), tuple(rows))


def _band(estimate: Estimate) -> str:
    """Half-width of the error band."""
    return "not estimated" if math.isnan(estimate.error) else f"± {_um(estimate.error, 2)} µm"


def _um(value: float, digits: int = 4) -> str:
    """Write meters as micrometers."""
    return number(1e6 * value, digits)
