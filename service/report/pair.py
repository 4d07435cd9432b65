"""The gear pair behind a database, as far as its metadata tells."""

from __future__ import annotations

import json

from pydantic import ValidationError

from fe_contact.geometry import GearPair
from fe_contact.geometry.iso6336_stiffness import iso6336_stiffness
from fe_contact.ste import SteDatabase
from service.convert.case import gear_pair
from service.schemas import Case


def pair_of(database: SteDatabase) -> GearPair | None:
    """Return the pair of the case that the database echoes; None if it echoes none of this kind."""
    try:
        return gear_pair(Case.model_validate_json(_json(database)))
    except ValidationError:
        return None


def iso_mesh_stiffness(database: SteDatabase) -> float | None:
    """Mean mesh stiffness of ISO 6336-1 in N/m per m of face width, above 100 N/mm; None without a pair."""
    pair = pair_of(database)
    return None if pair is None else iso6336_stiffness(pair).mesh_stiffness


def _json(database: SteDatabase) -> str:
    """Write the echoed case as JSON: strict models take lists for tuples only there."""
    return json.dumps(database.metadata.case)
