"""First figures of a table that is being refined, in one line."""

from __future__ import annotations

from bounds import engineering
from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate
from lineofaction.gearbox.units import UM


def draft_line(table: SteDatabase, refining: str) -> str:
    """Return mean and peak-to-peak with their errors at the highest load, and what is refined."""
    curve = table.curve(force=float(table.force[-1]), allow_failed=True)
    mean, ripple = _figure(curve.mean), _figure(curve.peak_to_peak)
    return f"draft: mean {mean} um, p-p {ripple} um at {curve.torque:.6g} N m (refining {refining})"


def _figure(estimate: Estimate) -> str:
    return f"{estimate.value / UM:.4g} +- {engineering(estimate.error / UM, 1)}"
