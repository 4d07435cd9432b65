"""In which axial directions a bearing's rings are held in their seats: locating and non-locating bearings.

References
----------
.. [1] ISO 5593:2019, Rolling bearings - Vocabulary: locating and non-locating bearing.
"""

from __future__ import annotations

from bounds import Choice, Declared, Kind
from dynamics.bearing_rows.ball_bearing import BallBearing
from dynamics.bearing_rows.roller_bearing import RollerBearing
from dynamics.checks import one_of
from dynamics.errors import InputError

BOTH, POSITIVE, NEGATIVE, NONE = "both", "positive", "negative", "none"
LOCATING = Declared(
    Kind.CHOICE,
    "",
    Choice((BOTH, POSITIVE, NEGATIVE, NONE)),
    "Directions along z in which its rings are held in their seats. positive, negative: only against a shaft "
    "that is pushed along z, against z, as in a cross-located pair; none: a non-locating (floating) bearing, "
    "one ring of which slides",
    BOTH,
    later=True,
)
ALONG, AGAINST = 1, 2
HELD = {BOTH: ALONG | AGAINST, POSITIVE: ALONG, NEGATIVE: AGAINST, NONE: 0}
"""The directions as bits."""


def check_locating(row: BallBearing | RollerBearing, locating: str) -> None:
    """Refuse a row with a contact angle of which a ring slides: it would carry nothing at all.

    Raises
    ------
    InputError
        `locating` is none of the choices, or the row has a contact angle and not both directions are held.
    """
    one_of("locating", locating, list(HELD))
    if locating != BOTH and row.contact_angle != 0.0:
        bound = f'"{BOTH}" with a contact angle, whose sign is the direction in which the row holds'
        raise InputError("locating", locating, bound, "State the contact angle's sign instead.")
