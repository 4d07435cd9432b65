"""The error a caller allows: a part of the quantity or, where that is less, an absolute one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bounds import SiNote, engineering
from fe_contact.errors import within
from fe_contact.types import FloatArray

LARGEST_RELATIVE, LARGEST_FLOOR = 0.5, 1e-3
"""Parts of the quantity, and m."""


@dataclass(frozen=True)
class AllowedError:
    """The larger of a part of a quantity and an absolute floor.

    One per cent of a ripple of 30 nm cannot be measured: below `scale` the floor counts.
    """

    relative: float = 0.01
    """Relative part of the error, of mean or peak-to-peak STE."""
    floor: float = 20e-9
    """Absolute part of the error, m; 0: the relative part alone."""

    def __post_init__(self) -> None:
        within("tolerance", self.relative, 1e-4, LARGEST_RELATIVE, "0.01 means one per cent.")
        within(
            "tolerance_floor", self.floor, 0.0, LARGEST_FLOOR, SiNote("In m: 20 nm is 2e-8; 0 means none.")
        )

    @classmethod
    def from_value(cls, tolerance: AllowedError | float | None) -> AllowedError | None:
        """Return the allowed error of a request; a number alone is its relative part."""
        if tolerance is None or isinstance(tolerance, AllowedError):
            return tolerance
        return cls(tolerance)

    def of(self, value: FloatArray) -> FloatArray:
        """Return the error in m that quantities in m may have."""
        return self.relative * self.scale(value)

    def scale(self, value: FloatArray) -> FloatArray:
        """Return the size in m of which errors of quantities in m are parts: `relative` of it is allowed."""
        return np.maximum(np.abs(value), self.least_scale)

    @property
    def least_scale(self) -> float:
        """The size in m below which the floor counts."""
        return self.floor / self.relative

    def part_text(self, change: float) -> str:
        """Return the text of the part of the tolerance that a change takes, in parts of `scale`."""
        return f"{engineering(100.0 * change / self.relative, 2)} % of the tolerance ({self.text})"

    @property
    def text(self) -> str:
        """Both parts."""
        part = f"{100.0 * self.relative:.3g} %"
        return f"{part} or {1e9 * self.floor:.3g} nm" if self.floor else part


RELATIVE = AllowedError(floor=0.0)
"""Allowed error of a run without a requested tolerance. Its absolute part is zero."""
