"""The condensed bodies of a stored table, from the cache of compliances."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fe_contact.analysis.live.condensed_contacts import CondensedContacts
from fe_contact.analysis.live.condensed_pair import CondensedPair
from fe_contact.analysis.live.condensed_request import OF_BODIES
from fe_contact.analysis.pairs.pair_contact import bodies_are_cached, pair_contact
from fe_contact.analysis.request.request import Checked, Request
from fe_contact.analysis.request.request_check import checked_request
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions
from fe_contact.planning.plan import Plan
from fe_contact.ste import SteDatabase


def condensed_pair(
    pair: ParallelAxes,
    database: SteDatabase,
    effects: Mapping[str, str],
    cache: Path | None,
    *,
    compute: bool = False,
) -> CondensedPair | None:
    """Fetch the compliance with which a table was computed; None if it is not in the cache.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        Of the table's case.
    database : SteDatabase
        Its receipt and ledger say which bodies it had.
    effects : mapping
        Choices of effects of the case.
    cache : Path, optional
        Directory of flank compliances. The coarse meshes of the error estimate are taken from it too; where
        they are not in it (the table has a minimal receipt), errors of the mesh are those expected of it.
    compute : bool
        Compute what is missing, coarse meshes as well, and keep it there: with one gear after the other, so
        that a second attempt goes on after the last that was finished.
    """
    checked, plan = _as_computed(pair, database, effects)
    changes = database.center_distance_change
    if not (compute or bodies_are_cached(pair, plan, cache, changes)):
        return None
    coarse = None
    if compute or bodies_are_cached(pair, plan, cache, changes, coarse=True):
        coarse = pair_contact(pair, plan, cache, coarse=True, distance_changes=changes)
    contacts = CondensedContacts.of(pair_contact(pair, plan, cache, distance_changes=changes), coarse)
    entries = [entry for entry in database.metadata.effect_ledger if isinstance(entry, dict)]
    neglected = {  # effects of the bodies that the scene called for and nobody switched off, and why
        entry["name"]: str(entry["decision"])
        for entry in entries
        if entry["name"] in OF_BODIES
        and (entry["on"], entry["called_for"], entry["choice"]) == (False, True, "auto")
    }
    return CondensedPair(checked, contacts, neglected)


def _as_computed(
    pair: ParallelAxes, database: SteDatabase, effects: Mapping[str, str]
) -> tuple[Checked, Plan]:
    """Return the request of a table, its model bound to the bodies it had, and their plan."""
    receipt, ledger = database.metadata.receipt, database.metadata.effect_ledger
    choice, plane_stress = receipt["choice"], receipt["plan"]["model"] == "plane_stress"
    on = {entry["name"]: bool(entry["on"]) for entry in ledger if isinstance(entry, dict)}
    bodies = {name: "on" if on[name] else "off" for name in OF_BODIES}
    model = "plane_stress" if plane_stress else "auto"
    options = AnalysisOptions(
        level=choice["level"], model=model, effects={**effects, **bodies}, receipt="minimal"
    )
    request = Request(
        pair,
        np.asarray(database.force),
        options,
        np.zeros(1),
        np.zeros(1),
        database.period if database.period > 1 else None,
    )
    checked = checked_request(request, check_size=False, neglect=False)
    return checked, checked.plan(choice["level"], choice["slices"])
