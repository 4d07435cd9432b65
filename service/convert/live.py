"""Live questions at the boundary: from a stored table and a change of its flanks to curves."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from fe_contact.analysis import CondensedPair, condensed_pair
from fe_contact.ste import SteDatabase
from service.convert.answers import curve_json
from service.convert.case import boundary_errors, gear_pair
from service.convert.units import UM
from service.problems import BadInput, Fault, NotAnalysed
from service.schemas import Case
from service.schemas.live import LiveInput
from service.schemas.reading import validated

Json = dict[str, Any]

_PLACES = ("pair.", "load.", "errors.")


def condensed_of(file: Path, cache: Path) -> tuple[Case, CondensedPair]:
    """Return the case of a stored table, and its gears with the compliance that it was computed with.

    Raises
    ------
    NotAnalysed
        The compliance is no longer in the cache.
    """
    database = SteDatabase.from_netcdf(file)
    # strict models take JSON's lists for tuples only from text
    case = Case.model_validate_json(json.dumps(database.metadata.case))
    with boundary_errors():
        found = condensed_pair(gear_pair(case), database, dict(case.effects), cache)
    if found is None:
        raise NotAnalysed(
            "The compliance of these gears is not in the cache of the service. Submit the case as a job of "
            "the process analyze with another positions or level, which computes it again."
        )
    return case, found


def live_curves(case: Case, bodies: CondensedPair, change: LiveInput) -> Json:
    """Return the curves of the changed flanks; raises `BadInput` by the fields of the question."""
    try:
        pair = gear_pair(changed_case(case, change))
        with boundary_errors():
            table = bodies.table(pair, np.array(change.torque_n_m), change.misalignment_um * UM)
        curves = [curve_json(table, torque_n_m=float(torque)) for torque in table.torque]
    except BadInput as error:
        raise BadInput(_as_asked(fault) for fault in error.faults) from None
    ledger: Any = table.metadata.effect_ledger
    return {
        "curves": curves,
        "effects": {entry["name"]: entry["on"] for entry in ledger},
        "beyond_load_patches": table.metadata.receipt["beyond_load_patches"],
    }


def changed_case(case: Case, change: LiveInput) -> Case:
    """Return the case with the flanks of a question, checked as a case is."""
    facts = case.model_dump(mode="json")
    for name in ("pinion", "wheel"):
        facts["pair"][name] |= getattr(change, name).model_dump(mode="json", exclude_none=True)
    return validated(Case, facts)


def _as_asked(fault: Fault) -> Fault:
    """Name a fault by the field of the question."""
    name = next((fault.field.removeprefix(p) for p in _PLACES if fault.field.startswith(p)), fault.field)
    return Fault(name, fault.value, fault.bound, fault.suggestion)
