"""The error of contacts in the positions of rigid flanks: flanks tilt as teeth bend, and contacts move."""

from __future__ import annotations

import math

from fe_contact.geometry import ParallelAxes
from fe_contact.hertz import contact_modulus
from fe_contact.types import FloatArray

_ALIKE, _UNLIKE = 0.1, 0.35
"""Mean change of STE over p R/(E* m^2), of gears of one material and what unlike ones add to it.

Of 12 pairs in plane strain, 17 to 90 teeth, external and internal, steel and 9 GPa, R/m of 1.7 to 12, STE of
2 to 70 um: 0.04 to 0.15, and 0.2 to 0.55.
"""


def flank_tilt(pair: ParallelAxes, force: FloatArray) -> FloatArray:
    """Return the part of the mean transmission error that the tilt of the flanks takes off.

    The approach falls by 3 R tau^2/2 on a pair of teeth, R the relative radius of curvature, and the tilt tau
    grows with p/(E* m). In gears of one material those of both flanks nearly cancel
    (docs/theory/contact.md, "What a fixed place leaves out").

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    force : ndarray
        Normal forces, N.
    """
    first, second = (gear.material for gear in (pair.pinion, pair.wheel))
    soft, stiff = 1.0 / first.plane_strain_modulus, 1.0 / second.plane_strain_modulus
    unlike = (soft - stiff) / (soft + stiff)
    line_load = force * math.cos(pair.base_helix_angle) / pair.face_width
    radius = 1.0 / abs(float(pair.relative_curvature(pair.path_of_contact.pitch_point)))
    slenderness = radius / pair.pinion.normal_module**2
    return (_ALIKE + _UNLIKE * unlike**2) * line_load * slenderness / contact_modulus(first, second)
