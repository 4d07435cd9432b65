"""The receipt of a condensed pair's table: errors by source, cost by stage, assumptions."""

from __future__ import annotations

from collections.abc import Sequence

from fe_contact.analysis.checks.assumptions import Assumption
from fe_contact.analysis.database.contact_receipt import failed_points
from fe_contact.analysis.estimates.assessed_table import AssessedTable
from fe_contact.analysis.estimates.error_sources import worst_residual
from fe_contact.analysis.request.solved_run import SolvedOperatingPoint
from fe_contact.ste.curve_errors import BETWEEN_NODES
from fe_contact.types import Json
from model_studies.stage_clock import StageClock


def condensed_receipt(
    run: SolvedOperatingPoint, table: AssessedTable, assumptions: Sequence[Assumption], clock: StageClock
) -> Json:
    """Return the receipt of a condensed pair's table: errors by source, cost by stage, assumptions."""
    errors = table.to_json()
    missing = [name for name in errors["not_estimated"] if name not in BETWEEN_NODES]
    known = {name: value for name, value in errors["curve_error"].items() if name not in BETWEEN_NODES}
    return (
        clock.to_json()
        | errors
        | {
            "curve_error": known,
            "not_estimated": missing,
            "plan": run.plan.to_json(),
            "beyond_load_patches": int(run.solution.beyond.sum()),
            "residuals_max": worst_residual(run.solution),
            "failed_points": failed_points([run.solution]),
            "assumptions": [assumption.to_json() for assumption in assumptions],
        }
    )
