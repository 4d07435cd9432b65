"""Noise that makes a table invalid: an STE that falls with load."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fe_contact.errors import FeContactError
from fe_contact.ste import SteDatabase
from lineofaction.hardcases.contact.contact_case import even_positions
from lineofaction.hardcases.scene import Measured, Scenes
from lineofaction.hardcases.tables import COMPLIANCE, table_of

SCENES = Scenes("table")

_SEED = 20260103

_AMPLITUDE = 0.4e-6


@SCENES.add(
    "noise_breaks_monotonicity",
    "Noise larger than what STE gains from load to load: there is no force to a given STE.",
    "Refused with place and amount; repaired by isotonic regression STE grows with load, no value moves by "
    "more than the noise, the table comes nearer to the truth, and the change is reported.",
)
def _broken_monotonicity() -> Sequence[Measured]:
    """Add noise of a fraction of a micrometer to a table of close loads; refuse it, then repair it."""
    position, force = even_positions(32), np.linspace(500.0, 3000.0, 26)
    clean = COMPLIANCE * force * (1.0 + 0.2 * np.cos(2.0 * np.pi * position))[:, None]
    noise = np.random.default_rng(_SEED).uniform(-_AMPLITUDE, _AMPLITUDE, clean.shape)
    noisy = clean + noise
    table = table_of(position, force, noisy, np.zeros(32))
    refusal = _refusal(table)
    repaired, report = table.monotone_repaired()
    ste = repaired.static_transmission_error[:, :, 0, 0]
    noisy_error, error = (np.sqrt(np.mean((values - clean) ** 2)) for values in (noisy, ste))
    stored = repaired.metadata.receipt.get("monotone_repair", {})
    sample = repaired.force_at(position[:, None], np.linspace(0.0, 1.1 * ste.max(), 300))
    return (
        Measured(
            "load series that fall",
            np.any(np.diff(noisy, axis=1) <= 0.0, axis=1).sum(),
            minimum=10,
        ),
        Measured(
            "refused as it is, naming position and force",
            "position" in refusal and "force" in refusal,
            minimum=1,
        ),
        Measured("least growth of STE after repair, m", np.diff(ste, axis=1).min(), minimum=1e-15),
        Measured("largest change over the noise", report.largest_change / (2.0 * _AMPLITUDE), maximum=1.0),
        Measured("error of the repaired over that of the noisy table", error / noisy_error, maximum=1.0),
        Measured(
            "reported change over that of the receipt",
            report.largest_change / stored["largest_change"],
            maximum=1.0,
            minimum=1.0,
        ),
        Measured(
            "least change of force with approach, N",
            np.diff(sample.force, axis=1).min(),
            minimum=-1e-9,
        ),
    )


def _refusal(table: SteDatabase) -> str:
    """Return the table's refusal of a query for a force; empty if it answers."""
    try:
        table.force_table()
    except FeContactError as error:
        return str(error)
    return ""
