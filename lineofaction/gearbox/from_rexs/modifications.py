"""Readers of the components that modify a flank."""

from __future__ import annotations

from collections.abc import Callable

from lineofaction.gearbox.from_rexs.account import Fate
from lineofaction.gearbox.from_rexs.flank_modification import Modification, PlainFlank
from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.from_rexs.helix_modifications import (
    end_relief,
    helix_crowning,
    helix_slope,
    profile_twist,
)
from lineofaction.gearbox.from_rexs.profile_modifications import (
    profile_crowning,
    profile_relief,
    profile_slope,
)
from lineofaction.gearbox.from_rexs.topography import topographical_modification

READERS: dict[str, Callable[[PlainFlank, Part], Modification]] = {
    "tip_relief": profile_relief,
    "root_relief": profile_relief,
    "profile_crowning": profile_crowning,
    "profile_slope": profile_slope,
    "helix_crowning": helix_crowning,
    "helix_slope": helix_slope,
    "end_relief_datum_face": end_relief,
    "end_relief_non_datum_face": end_relief,
    "profile_twist": profile_twist,
    "topographical_modification": topographical_modification,
}
"""Readers of the components that modify a flank, by type. A reader raises `BadInput` where an amount is
missing, or where it is stated at a place that the flank does not have."""

_WITHOUT_EXTENT: tuple[Fate, str] = ("refused", "REXS states no extent of it along the face")
_MEASURED: tuple[Fate, str] = ("ignored", "measured deviations are no part of the nominal flank")
UNREAD = {
    "triangular_tip_relief": _WITHOUT_EXTENT,
    "triangular_root_relief": _WITHOUT_EXTENT,
    "profile_deviation": _MEASURED,
    "helix_deviation": _MEASURED,
}
"""Fates, with their reasons, of the components of a flank that no reader here takes."""
