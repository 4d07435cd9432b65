"""In which directions a bearing of a REXS model holds its shaft along the axis of the scene.

``axial_force_absorption`` is by the bearing's own u: ``positive`` holds a shaft that is pushed along u. Two
writers' files, of cross-located deep groove bearings and of tapered ones, have it at the bearing of the
larger u, as in a housing whose covers hold the outer rings.
"""

from __future__ import annotations

from dynamics.bearing_rows.locating import BOTH, NEGATIVE, NONE, POSITIVE
from lineofaction.gearbox.from_rexs.part import Part

ITEM, ROW_ITEM = "axial_force_absorption", "axial_force_absorption_of_row"
_LOCATING = {"both_directions": BOTH, "positive": POSITIVE, "negative": NEGATIVE, "no_direction": NONE}
_OPPOSITE = {POSITIVE: NEGATIVE, NEGATIVE: POSITIVE}


def axial_location(part: Part, sense: int, item: str = ITEM) -> str | None:
    """Return the directions along z in which a bearing, or its row, holds its shaft.

    Parameters
    ----------
    part : Part
        The bearing, or its row.
    sense : int
        +1 where u of the bearing is along z, -1 where it is against it.
    item : str
        The attribute.

    Returns
    -------
    str or None
        both, positive, negative, none; None where the file does not say.
    """
    stated = _LOCATING.get(part.text(item, "directions in which it holds the shaft, by its own u") or "")
    if stated in _OPPOSITE and sense < 0:
        part.say(item, "derived", f"{_OPPOSITE[stated]} along z: its u is against z")
        return _OPPOSITE[stated]
    return stated


def contact_side(part: Part, row: Part | None, sense: int) -> int | str:
    """Return the sign of the contact angle of a row, +1 where it holds a shaft that is pushed along z.

    The row's own direction counts, else that of the bearing; the reason where neither says or they differ.
    """
    senses = {POSITIVE: 1, NEGATIVE: -1}
    own = senses.get(axial_location(part, sense) or "")
    of_row = None if row is None else senses.get(axial_location(row, sense, ROW_ITEM) or "")
    if own is not None and of_row is not None and own != of_row:
        return f"{ITEM} of the bearing and of its row are opposite"
    side = of_row or own
    return side or f"{ITEM} does not say which direction its contact angle holds: positive or negative"
