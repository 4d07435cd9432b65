"""The optional parts of a gear's body, by the names of the fields in which gears have them."""

from __future__ import annotations

from collections.abc import Mapping

from bounds import Declared, Kind
from fe_contact.body.bore_seat import BoreSeat
from fe_contact.body.gear_blank import GearBlank


def _part(kind: type, description: str) -> Declared:
    """Return the declaration of a part."""
    return Declared(Kind.PART, "", None, description, part=kind)


PARTS: Mapping[str, Declared] = {
    "blank": _part(GearBlank, "Rim, web and hub; left out: a solid body"),
    "seat": _part(BoreSeat, "Seat of the bore; left out: the whole bore is fixed"),
}
