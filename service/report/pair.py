"""The gear pair behind a database, as far as its metadata tells."""

from __future__ import annotations

import json

from pydantic import ValidationError

from fe_contact.geometry import FlankModification, Gear, GearPair, PitchDeviation
from fe_contact.geometry.iso6336_stiffness import iso6336_stiffness
from fe_contact.material import Material
from fe_contact.ste import SteDatabase
from fe_contact.types import Json
from service.convert.case import gear_pair
from service.schemas import Case


def pair_of(database: SteDatabase) -> GearPair | None:
    """Return the pair of the case that the database echoes: a case file, or a request in SI; else None."""
    case = database.metadata.case
    try:
        # strict models take JSON's lists for tuples only from text
        return gear_pair(Case.model_validate_json(json.dumps(case)))
    except ValidationError:
        return _from_si(case)


def iso_mesh_stiffness(database: SteDatabase) -> float | None:
    """Mean mesh stiffness of ISO 6336-1 in N/m per m of face width, above 100 N/mm; None without a pair."""
    pair = pair_of(database)
    return None if pair is None else iso6336_stiffness(pair).mesh_stiffness


def _from_si(case: Json) -> GearPair | None:
    """Rebuild the pair of a request that was made from Python."""
    try:
        pair = case["pair"]
        return GearPair(_gear(pair["pinion"]), _gear(pair["wheel"]), pair["center_distance"])
    except (KeyError, TypeError):
        return None


def _gear(content: Json) -> Gear:
    """Rebuild one gear from its fields."""
    parts = {
        "modification": FlankModification(**content["modification"]),
        "material": Material(**content["material"]),
        "pitch_deviation": PitchDeviation(**content.get("pitch_deviation", {})),
    }
    return Gear(**(content | parts))
