"""The distance of teeth whose flanks can carry load at once."""

from __future__ import annotations

import math

from fe_contact.geometry import Toothing


def usual_reach(gear: Toothing) -> int:
    """Return the largest distance of two teeth that can carry load at once.

    That is the length of the involute and the lead of the helix over the face, in base pitches.
    """
    across = abs(math.tan(gear.base_helix_angle)) * gear.face_width
    length = abs(gear.tip_roll_length - gear.form_roll_length) + across
    return min(max(1, math.ceil(length / gear.base_pitch)), gear.teeth // 2)
