"""The mesh-force table: plain arrays, all that dynamics needs of an STE database."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from fe_contact.types import FloatArray


@dataclass(frozen=True, eq=False)
class ForceTable:
    """Levels of constant mesh force over position; read-only arrays.

    Attributes
    ----------
    position : (P,) array
        Knots in transverse base pitches, increasing in [0, period).
    level : (L,) array
        Transverse mesh force F_bt in N at the levels, increasing, level[0] = 0 (lift-off).
    misalignment : (M,) array
        m; length 1 = no such axis.
    center_distance_change : (D,) array
        m; length 1 = no such axis.
    deflection : (M, D, P, L) array
        Transmission error at level k in m, increasing in k.
    deflection_slope : (M, D, P, L) array
        Its derivative in position, m per base pitch.
    stiffness : (M, D, P, L) array
        dF_bt / d(deflection) in N/m, limited so that the force is monotone; 0 at lift-off.
    stiffness_slope : (M, D, P, L) array
        Its derivative in position, N/m per base pitch.
    period : int
        Whole base pitches after which the table repeats.
    deflection_derivative, stiffness_derivative : (2, 2, 2, M, D, P, L) arrays or None
        Differentiated once (1) or not (0) in misalignment, center-distance change and position: what the C1
        interpolant over all axes uses. None without a second knot of misalignment or center distance.
    face_centroid : (M, D, P, L) array or None
        Centroid of the load from mid-face at each level, m, towards positive z of the driving gear; at
        lift-off that of the lowest load.
    sliding_share, sliding_lever : (M, D, P, L) arrays or None
        Sums over the pairs of load share times the sign of y, and times |y| (m): y is the place of a pair's
        contact from the pitch point, > 0 where it recedes.
    """

    position: FloatArray
    level: FloatArray
    misalignment: FloatArray
    center_distance_change: FloatArray
    deflection: FloatArray
    deflection_slope: FloatArray
    stiffness: FloatArray
    stiffness_slope: FloatArray
    period: int = 1
    deflection_derivative: FloatArray | None = None
    stiffness_derivative: FloatArray | None = None
    face_centroid: FloatArray | None = None
    sliding_share: FloatArray | None = None
    sliding_lever: FloatArray | None = None

    def __post_init__(self) -> None:
        for entry in fields(self):
            if entry.name == "period" or getattr(self, entry.name) is None:
                continue
            array = np.array(getattr(self, entry.name), dtype=float, order="C")
            array.flags.writeable = False
            object.__setattr__(self, entry.name, array)
