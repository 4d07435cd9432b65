"""Pitch deviations of single teeth (ISO 1328-1)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from bounds import Declared, Kind, SiNote, integers
from fe_contact.errors import InputError, within
from fe_contact.geometry.tooth_flank import repeats_after
from fe_contact.types import FloatArray

LARGEST = 1e-3
"""Largest pitch deviation, m. Larger ones are taken for micrometers given as meters."""

_IN_M = SiNote("In m: 5 µm is 5e-6.")


@dataclass(frozen=True)
class PitchDeviation:
    """Deviation of the loaded flank of every tooth from its position.

    Raises `InputError`: a deviation that is no number, or larger than 1 mm.

    Notes
    -----
    A chart counts its arcs one way round. Counted in the direction in which the loaded flanks face, F_pi has
    the sign used here; counted the other way it has the opposite one.

    References
    ----------
    ISO 1328-1:2013: f_pi, f_p, F_pi, F_p.
    """

    cumulative: tuple[float, ...] = ()
    """Individual cumulative pitch deviation (index deviation) F_pi of every tooth in m, an arc on the
    reference circle in the transverse section; empty: none. > 0: the flank lies nearer to its mate than it
    should (material in excess), so that it touches early. In the order in which the teeth come into mesh,
    whichever gear; the first tooth is that of pair 0 at position 0.
    """

    def __post_init__(self) -> None:
        checked = (
            within(f"pitch_deviation[{tooth}]", value, -LARGEST, LARGEST, _IN_M)
            for tooth, value in enumerate(self.cumulative)
        )
        object.__setattr__(self, "cumulative", tuple(checked))

    @classmethod
    def of_single_pitches(cls, single: Sequence[float]) -> Self:
        """Return the deviations of teeth from their individual single pitch deviations f_pi in m.

        Entry i is that of the pitch from the tooth before to tooth i, the first from the last tooth on. Its
        mean over the gear, which a full circle does not have, is taken out: F_pi counts from the last tooth.
        Raises `InputError`: a deviation that is no number, or larger than 1 mm.
        """
        values = [
            within(f"single_pitch_deviation[{tooth}]", value, -LARGEST, LARGEST, _IN_M)
            for tooth, value in enumerate(single)
        ]
        deviations = np.array(values) - np.mean(values or [0.0])
        return cls(tuple(np.cumsum(deviations).tolist()))

    @property
    def neutral(self) -> bool:
        """Whether every tooth is in its position."""
        return not any(self.cumulative)

    @property
    def individual(self) -> FloatArray:
        """Individual single pitch deviations f_pi in m: each tooth against the one before it in the list."""
        values = np.array(self.cumulative)
        return np.asarray(values - np.roll(values, 1))

    @property
    def single(self) -> float:
        """Single pitch deviation f_p in m: the largest f_pi, whatever its sign."""
        return float(np.abs(self.individual).max(initial=0.0))

    @property
    def total(self) -> float:
        """Total cumulative pitch deviation F_p in m: the range of F_pi."""
        return float(np.ptp(self.cumulative)) if self.cumulative else 0.0

    @property
    def period(self) -> int:
        """Number of teeth after which the deviations repeat: 1 where all are equal."""
        return repeats_after(self.cumulative)

    @property
    def reversed(self) -> PitchDeviation:
        """The same teeth for the other sense of rotation; the first one stays."""
        return PitchDeviation(self.cumulative[:1] + self.cumulative[:0:-1])

    def on_line_of_action(self, transverse_pressure_angle: float) -> FloatArray:
        """Deviation of every tooth along the transverse line of action, m: F_pi cos(alpha_t)."""
        return np.array(self.cumulative or (0.0,)) * math.cos(transverse_pressure_angle)

    def check_fits(self, teeth: int) -> None:
        """Refuse a list that is not as long as the gear has teeth, naming the field of the gear."""
        count = len(self.cumulative)
        if count not in (0, teeth):
            remedy = "One value per tooth, in the order of meshing."
            raise InputError("pitch_deviation", f"{count} values", f"a list of {teeth}", remedy)


NO_PITCH_DEVIATION = PitchDeviation()


def counted(low: int, high: int) -> Declared:
    """Return the declaration of a number of teeth."""
    return Declared(Kind.COUNT, "", integers(low, high), "Number of teeth", 20)
