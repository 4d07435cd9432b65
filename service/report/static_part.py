"""What the page says of an STE database: main results, figures, accuracy, cost, effects and case."""

from __future__ import annotations

from typing import Any

import numpy as np

from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate
from service.report.aligned import load_curve, load_labels, middle_load
from service.report.database_surface import database_surface
from service.report.facts import facts, records
from service.report.figure import Table, number
from service.report.load_sharing import load_sharing
from service.report.mesh_stiffness import mesh_stiffness
from service.report.page import Headline, Section
from service.report.ste_curves import ste_curves

_RESIDUALS = ("equilibrium", "penetration", "tension", "complementarity")
_LEDGER = (
    ("name", "effect"),
    ("on", "simulated"),
    ("reason", "because"),
    ("worth", "worth"),
    ("cost", "cost"),
)


def static_headlines(database: SteDatabase) -> tuple[Headline, ...]:
    """Mean and peak-to-peak STE at the middle load, with their errors."""
    load = middle_load(database)
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


def static_sections(database: SteDatabase) -> tuple[Section, ...]:
    """All parts of the page that one database fills."""
    metadata = database.metadata
    curves = Section("Static transmission error", figures=(ste_curves(database), load_sharing(database)))
    stiffness = Section(
        "Mesh stiffness and the table", figures=(mesh_stiffness(database), database_surface(database))
    )
    accuracy = Section(
        "Accuracy and cost of the table",
        "Errors are half-widths of the band around each number; the receipt says where the time went.",
        tables=(_accuracy(database), *receipt_tables(metadata.receipt)),
    )
    effects = Section("Effects", tables=(ledger_table(metadata.effect_ledger),))
    case = Section("Case", "With every default that was taken.", tables=(facts("Case", metadata.case),))
    return curves, stiffness, accuracy, effects, case


def ledger_table(ledger: Any) -> Table:
    """Tabulate which effects were simulated, why, and what they are worth."""
    entries = [{"name": k, **v} for k, v in ledger.items()] if isinstance(ledger, dict) else ledger
    known = [{title: entry.get(field) for field, title in _LEDGER} for entry in entries]
    return records("Effect ledger", known)


def receipt_tables(receipt: dict[str, Any]) -> tuple[Table, ...]:
    """Tabulate time by stage, then everything else the receipt says."""
    stages = receipt.get("stages")
    rest = facts("Receipt", {name: value for name, value in receipt.items() if name != "stages"})
    if not isinstance(stages, dict):
        return (rest,)
    return records("Time by stage", [{"stage": name, **times} for name, times in stages.items()]), rest


def _accuracy(database: SteDatabase) -> Table:
    """Worst error estimate and residuals over the table."""
    good = ~database.failed
    relative = database.error_estimate[good] / database.static_transmission_error[good]
    rows = [
        ("points", f"{database.status.size}, {database.n_failed} failed"),
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
    return f"± {_um(estimate.error, 2)} µm"


def _um(value: float, digits: int = 4) -> str:
    """Write metres as micrometres."""
    return number(1e6 * value, digits)
