"""The gear pair behind a result: its name and dimensions, and itself as far as metadata tell."""

from __future__ import annotations

import json
from collections.abc import Callable

from pydantic import ValidationError

from fe_contact.geometry import (
    BoreSeat,
    FlankModification,
    Gear,
    GearBlank,
    GearPair,
    InternalGearPair,
    ParallelAxes,
    PitchDeviation,
    RingGear,
)
from fe_contact.geometry.iso6336_stiffness import iso6336_stiffness
from fe_contact.material import Material
from fe_contact.ste import PairFacts, SteDatabase
from fe_contact.types import Json
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.schemas import Case

_PARTS: dict[str, Callable[..., object]] = {
    "modification": FlankModification,
    "material": Material,
    "pitch_deviation": PitchDeviation,
    "blank": GearBlank,
    "seat": BoreSeat,
}


def pair_of(database: SteDatabase) -> ParallelAxes | None:
    """Return the pair of the case that the database echoes: a case file, or a request in SI; else None."""
    case = database.metadata.case
    try:
        # strict models take JSON's lists for tuples only from text
        return gear_pair(Case.model_validate_json(json.dumps(case)))
    except ValidationError:
        return _from_si(case)


def iso_mesh_stiffness(database: SteDatabase) -> float | None:
    """Mean mesh stiffness of ISO 6336-1 in N/m per m of face width, above 100 N/mm; None without a pair.

    None for a ring gear too: its approximation by a rack says nothing of the rim.
    """
    pair = pair_of(database)
    return iso6336_stiffness(pair).mesh_stiffness if isinstance(pair, GearPair) else None


def _from_si(case: Json) -> ParallelAxes | None:
    """Rebuild the pair of a request that was made from Python."""
    try:
        pair = case["pair"]
        pinion, wheel, distance = pair["pinion"], pair["wheel"], pair["center_distance"]
        if "rim_diameter" in wheel:
            return InternalGearPair(Gear(**_fields(pinion)), RingGear(**_fields(wheel)), distance)
        return GearPair(Gear(**_fields(pinion)), Gear(**_fields(wheel)), distance)
    except (KeyError, TypeError):
        return None


def _fields(content: Json) -> Json:
    parts = {name: kind(**content[name]) for name, kind in _PARTS.items() if content.get(name) is not None}
    return content | parts


def pair_title(facts: PairFacts) -> str:
    """Name a pair by its teeth."""
    one, other = facts.teeth
    return f"Gear pair {one}/{other}, internal" if facts.internal else f"Gear pair {one}/{other}"


def pair_lead(facts: PairFacts) -> str:
    """Say the dimensions of a pair."""
    return (
        f"center distance {1e3 * facts.center_distance:.6g} mm, "
        f"face width {1e3 * facts.face_width:.6g} mm, base pitch {1e3 * facts.base_pitch:.5g} mm"
    )
